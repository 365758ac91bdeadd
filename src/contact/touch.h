/* Contact of surfaces with themselves and each other: what a rule that meets (forces/force.h) keeps between its ops.
 *
 *   begin   P = X; pairs of features that may come near are found anew where a vertex has left its way; all that are
 *           kept are looked at: distance, normal, places of contact; those nearer than thickness and a twentieth are near
 *   push    each of these, in a fixed order, is brought to its thickness, with friction
 *   bound   no vertex goes further than its pairs allow, so that nothing passes
 *
 * A pair is a vertex and a triangle, or two edges; they have no corner in common, and their bodies are no pair to be
 * ignored. Which pairs are kept is decided by what is expected: each vertex goes on at some velocity, from where it was
 * when it was last looked for, is never farther from there than its reach, and goes hardly any other way in a substep.
 * What goes otherwise is looked for anew, with its neighbours, and nobody else. What lies around a leaf is left out
 * while it is known to keep apart (calm.h). What is done with a pair depends on the state before and after the substep
 * alone. So a search too many changes no bit, and a state that was saved and loaded goes on as it would have. What has
 * gone through each other all the same is led apart (tangle.h).
 *
 * The bound is a division of space by planes for each pair (planar division: arXiv 2604.15513), where it is needed: a
 * vertex goes the least share of its way that any of its pairs allows, and a minimum knows no order. */
#ifndef SK_CONTACT_TOUCH_H
#define SK_CONTACT_TOUCH_H

#include <string.h>

#include "base/wide_types.h"
#include "contact/calm.h"
#include "contact/tangle.h"
#include "forces/force.h"
#include "particles/particles.h"
#if defined(__wasm_simd128__) && !defined(SKEIN_DOUBLE)
#include <wasm_simd128.h>
#define SK_QUADS_OF_WASM
#endif

/* Features that lie together, by their first numbers: up to two triangles with an edge in common, or edges of a rope.
 * Each vertex and edge belongs to one leaf alone. */
typedef struct sk_leaf {
    uint32_t first_vertex, first_edge, first_triangle;
    uint8_t vertices, edges, triangles;
} sk_leaf;

/* What can touch, in numbers of its own. */
typedef struct sk_skin {
    size_t vertex_count, edge_count, triangle_count, leaf_count;
    uint32_t *particle; /* of vertices: the user's index */
    uint32_t *piece;    /* of vertices: what hangs together has one number */
    sk_vec4 *built;     /* as they were built */
    uint32_t (*edge)[2], (*triangle)[3];
    sk_leaf *leaf;
    real *thickness, *friction; /* of vertices: those of their body; a thickness of 0: the rule's */
    real thickest; /* m: of these thicknesses; 0: no body has its own, and both arrays mean nothing */
    bool all_own;  /* and every body has */
    real longest; /* m: of edges, as they were built */
    real spacing; /* m: what lies between features of one surface that have no corner in common, as they were built */
    uint32_t *leaf_start, *leaf_of; /* those of vertex v: leaf_of[leaf_start[v]] to leaf_of[leaf_start[v + 1]] */
} sk_skin;

/* Bodies of which some pairs do not meet (ignored.c). */
typedef struct sk_ignored {
    bool any;
    uint16_t *of_leaf; /* of leaves: the number of their body among those that are named, or 0 */
    uint8_t *pair;     /* width x width: whether these two do not meet */
    size_t width;
} sk_ignored;

/* Pairs, one array a number, padded to whole blocks of sixteen. Corners: a vertex and a triangle's three, or an edge's two
 * and another's two. The normal leads from the second feature to the first; `share` says where on them they are nearest:
 * u, v of a triangle's second and third corner, or how far along each edge. */
typedef struct sk_pairs {
    uint32_t *corner[4];
    uint64_t *key; /* the order of pairs: both leaves, and which of their features */
    real *distance, *thickness, *normal[3], *share[2];
    uint8_t *settled; /* of a bound: planes divide it, */
    uint8_t *closes;  /* or have to; what kernels find out */
    size_t count, capacity;
} sk_pairs;

/* Nearest points of all pairs, from the places x of their corners; and which are near: `closes`. */
typedef void sk_closest_kernel(const sk_vec4 *x, sk_pairs *pairs);

/* Finds out which pairs, of places x before a substep, might lose their gap by any shares of these ways (w: their length)
 * and which do by all of them: `closes`. Pairs need their distance and normal. */
enum { SK_CLOSES = 1, SK_MAY_CLOSE = 2, SK_IS_NEAR = 4 };
typedef struct sk_closing_values {
    real least, rounding; /* m: what is less does not close at all; how well a distance is known */
    real longest;         /* of all ways, m */
} sk_closing_values;
typedef void sk_closing_kernel(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs);

/* Takes over those pairs that may come near or close on their vertices' ways, from x (w: their reach) to `end`, with where they
 * are nearest at x; there is room for as many, and a block. */
typedef struct sk_nearing_values {
    real near, rounding, closing, per; /* m; m; share of a step; steps that the way has, inverse */
    real shares; /* of any shares of the way: what is left of a gap that counts as closed; 0: all of the way */
} sk_nearing_values;
typedef void sk_nearing_kernel(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                               const sk_pairs *pairs, sk_pairs *fresh);

/* A box that goes on: where it is when it begins, and when it ends. In between its sides are no farther out than on a
 * straight way. */
typedef real sk_quad __attribute__((vector_size(4 * sizeof(real))));
typedef struct sk_box {
    sk_quad low[2], high[2];
} sk_box;

/* (For WebAssembly clang goes lane by lane, which takes a heap's boxes five times as long.) */
#ifdef SK_QUADS_OF_WASM
static inline sk_quad sk_least_quad(sk_quad a, sk_quad b) {
    return (sk_quad)wasm_f32x4_pmin((v128_t)b, (v128_t)a); // a where it is less
}

static inline sk_quad sk_most_quad(sk_quad a, sk_quad b) {
    return (sk_quad)wasm_f32x4_pmax((v128_t)b, (v128_t)a);
}
#else
static inline sk_quad sk_least_quad(sk_quad a, sk_quad b) {
    for (int k = 0; k < 4; k++) a[k] = a[k] < b[k] ? a[k] : b[k];
    return a;
}

static inline sk_quad sk_most_quad(sk_quad a, sk_quad b) {
    for (int k = 0; k < 4; k++) a[k] = a[k] > b[k] ? a[k] : b[k];
    return a;
}
#endif

/* Makes a box so wide that it has another one inside. */
static inline void sk_box_widen(sk_box *box, const sk_box *by) {
    for (int end = 0; end < 2; end++) {
        box->low[end] = sk_least_quad(box->low[end], by->low[end]);
        box->high[end] = sk_most_quad(box->high[end], by->high[end]);
    }
}

/* Boxes of a leaf's features, for many to be compared at once: in cells, features side by side. Of a cell's number the last
 * sixteen bits are kept: leaves are a quarter of that wide at most, and what two of them that meet are apart is half of it, so
 * that a difference is right where numbers wrap around. At each end there are six rows: low ones along each axis, and
 * high ones. Leaves that are wider (`wide`) are compared by their boxes. */
enum {
    SK_CELL_ROWS = 12,
    SK_LEAF_EDGES = 5,
    SK_LEAF_VERTICES = 4,
    SK_LEAF_CORNERS = SK_LEAF_VERTICES + 2, /* vertices, and triangles */
    SK_WIDEST_LEAF = (1 << 14) - 1,         /* cells */
    /* where a row begins that has so many numbers; after those of the first end, it stands whether the leaf is too wide */
#define SK_CELL_ROW(row, numbers) ((row) * (numbers) + ((row) >= SK_CELL_ROWS / 2))
    SK_EDGES_WIDE = SK_CELL_ROWS / 2 * SK_LEAF_EDGES,
    SK_CORNERS_WIDE = SK_CELL_ROWS / 2 * SK_LEAF_CORNERS
};
typedef struct sk_edge_cells {
    _Alignas(64) int16_t number[64]; /* (eight are read of each row) */
} sk_edge_cells;
typedef struct sk_corner_cells {
    _Alignas(32) int16_t number[80];
} sk_corner_cells;

/* Boxes of leaves, and of sixteen of those below, up to one: by slots, in which leaves that were built near each other
 * are near. Sixteen slots are a block. */
enum { SK_TREE_LEVELS = 9, SK_TREE_SHIFT = 4, SK_TREE_WIDTH = 1 << SK_TREE_SHIFT };
typedef struct sk_tree_block {
    _Alignas(64) real low[2][3][SK_TREE_WIDTH], high[2][3][SK_TREE_WIDTH];
} sk_tree_block;
typedef struct sk_tree {
    sk_tree_block *block[SK_TREE_LEVELS];
    size_t blocks[SK_TREE_LEVELS]; /* of each level; the last one has one */
    int levels;
    uint32_t *leaf_at; /* of slots */
    bool still;        /* boxes end where they begin */
} sk_tree;
/* Lists the blocks of the lowest level, from the first one on, that a box may meet at some time. */
typedef size_t sk_tree_blocks_kernel(const sk_tree *tree, const sk_box *box, size_t first, uint32_t *block);
/* Lists who of some lanes of block a may meet whom of block b, or of later lanes than their own if asked for: the lane of a,
 * and behind it in four bits that of b. Boxes of the former are those of leaves. At most SK_TREE_WIDTH squared. */
typedef size_t sk_tree_hits_kernel(const sk_tree *tree, size_t a, size_t b, uint32_t lanes, const sk_box *box, bool forward,
                                   uint32_t *hit);

/* Some of the pairs that are kept: twice where a pair is, and one more if it is a late one. */
typedef struct sk_pair_list {
    uint32_t *data;
    size_t count, capacity;
} sk_pair_list;

/* Those that may close, with their corners. */
typedef struct sk_closing_pair {
    uint32_t entry, corner[4];
} sk_closing_pair;
typedef struct sk_closing_list {
    sk_closing_pair *data;
    size_t count, capacity;
} sk_closing_list;

/* A pair's key, and where it is. */
typedef struct sk_pair_place {
    uint64_t key;
    uint32_t at;
} sk_pair_place;

enum { SK_CORNERS, SK_EDGES, SK_PAIR_SORTS }; /* vertex and triangle, edge and edge: the order of pairs */

/* Where a vertex is expected: at `from` at time 0, and on by `step` a substep; in a frame that moves as all do. */
typedef struct sk_course {
    sk_vec3 from, step;
    real reach; /* how far from there it may be, m */
} sk_course;

/* Where a vertex was when it last got a course, how far it then went in a substep, and which substep that was. */
typedef struct sk_seen {
    sk_vec3 at, step;
    uint64_t clock;
} sk_seen;

/* Courses of sixteen slots; the square of a reach is without end where no vertex has a course. */
typedef struct sk_course_block {
    _Alignas(64) real from[3][16], step[3][16], square[16];
} sk_course_block;
/* Whether a vertex has left its reach, among `slots` slots of x, or has gone another way in a substep, from `before` on, than
 * its course by more than a jump, whose square is given; in a frame that went on by `gone` in it. Bits of the lanes of
 * each sixteen that have. Without `before`, nobody has jumped; else the square of the longest way from there is found, too. */
typedef bool sk_course_kernel(const sk_vec4 *x, const sk_vec4 *before, size_t packed, size_t slots, const sk_course_block *block,
                              real time, const sk_vec3 *shift, const sk_vec3 *gone, real jump, uint16_t *off, real *way);

/* Which features of a leaf are looked for: bits. */
typedef struct sk_hot {
    uint8_t vertices, edges, triangles;
} sk_hot;

/* Around which lanes of a block of the tree, counted from 1, a leaf lies: bits. */
typedef struct sk_ring_mark {
    uint32_t block, lanes;
} sk_ring_mark;

/* What one thread finds of a search: all that is kept is put together in their order, so that no bit depends on them. */
enum { SK_MOST_PARTS = 16 };
typedef struct sk_search_part {
    uint32_t *block; /* of the tree */
    sk_ring_mark *ring; /* of leaves */
    struct {
        uint32_t *data;
        size_t count, capacity;
    } first, second; /* leaves whose boxes meet */
    uint32_t *start; /* of leaves, while partners are put in order */
    sk_pairs batch, fresh; /* pairs whose boxes may meet, and all of them that may come near */
    size_t next, end; /* of leaves or leaves' pairs, those still to be looked at */
} sk_search_part;

typedef struct sk_touch {
    sk_skin skin;
    sk_ignored ignored;
    sk_calm calm;
    sk_tangle tangle;
    struct sk_tasks *tasks; /* of the run */
    uint64_t shape; /* of the world that the skin was made from */
    sk_isa isa;
    bool alone;      /* no other rule meets */
    bool found;      /* whether the pairs are of this skin */
    bool followed;   /* the last bound has seen where all went */
    bool remembers;  /* all have been seen */
    bool held;       /* a vertex is pinned */
    bool untouched;  /* hardly any pairs are kept: courses may be wide */
    bool loaded;     /* p and inverse are of this substep */
    bool holds;      /* what was known of patches when the last bound ended still is so */
    bool boxed;      /* whether boxes are those of the courses; */
    bool still;      /* they are those of a substep's ways, all of them */
    bool aimed;      /* `at` and `in_the_end` are those of this substep's ways */
    real thickness;  /* that pairs were found for, m: the largest of any pair; */
    real usual;      /* and the rule's, of bodies that have none of their own */
    real now, until; /* substeps since the last search for all, and how long that holds */
    uint64_t clock;  /* substeps in all */
    size_t storm, next_storm; /* substeps that are left in which nobody has a course; and of the next such time */
    size_t searched_since; /* searches since the last one for all */
    size_t lost_since; /* how many have been lost since then, each as often as it was */
    sk_vec3 drift;   /* how far all went in a substep then, in the mean; */
    sk_vec3 common;  /* and in this one */
    real longest;    /* m: of the ways in this substep, less what all go together; */
    real farthest;   /* and with that, of those that have a course */
    sk_vec3 frame_step; /* how far the frame of courses goes in a substep, as it did last, */
    sk_vec3 shift[2];   /* and has gone before this one and after it */
    /* by slot */
    sk_vec4 *before; /* X before the substep, as it was laid out */
    sk_course_block *course_block;
    uint16_t *off;
    uint32_t *vertex_at;
    size_t slots, slot_capacity;
    /* by vertex */
    uint32_t *slot;
    sk_vec4 *p;    /* the place before the substep */
    sk_vec4 *q;    /* after it */
    sk_vec4 *way;  /* from p to q, less what all go together; w: its length */
    sk_vec4 *at, *in_the_end; /* of a search: where it is expected now, and when that ends */
    sk_course *course;
    sk_seen *seen;
    real *inverse; /* mass, 1/kg */
    real *share, *next_share; /* of its way that it may go */
    uint8_t *lowered; /* its share was, in the last round */
    uint8_t *lost;    /* it is looked for */
    uint8_t *wild;    /* it has left its course and has none: it is looked for on its way in each substep */
    size_t wild_count;
    /* of the search */
    sk_box *corner_box; /* of vertices: where they are, and in its fourth number how much wider a box has to be */
    sk_box *vertex_box, *edge_box, *triangle_box, *leaf_box;
    sk_box *hot_box; /* of those features of a leaf that are looked for */
    sk_hot *hot;
    sk_edge_cells *edge_cells; /* of leaves */
    sk_corner_cells *corner_cells;
    real cells;                /* a metre */
    sk_tree tree;
    uint8_t *anew, *moved;        /* leaves that are looked for, and whose boxes are new; */
    uint8_t *featured;            /* those whose features have boxes, too (2: are to have them) */
    bool everybody;               /* all features of all leaves are looked for */
    uint8_t *changed;             /* slots of a level of the tree, and of the next one */
    bool refit;                   /* all of the tree is old */
    uint32_t *start;              /* of leaves, and one more: where their partners begin */
    struct {
        uint32_t *data;
        size_t count, capacity;
    } first, partner;             /* leaves whose boxes meet: the first and the second of both, in order */
    sk_search_part part[SK_MOST_PARTS];
    int part_count;
    sk_pairs kept[SK_PAIR_SORTS]; /* of the last search for all, in their order; */
    sk_pairs late[SK_PAIR_SORTS]; /* and of searches since then, one after the other */
    size_t told_apart[SK_PAIR_SORTS]; /* late pairs of which it is known whether they may close */
    sk_pairs fresh;
    sk_pair_list near[SK_PAIR_SORTS];       /* in the order of leaves; */
    sk_closing_list may_close[SK_PAIR_SORTS]; /* and in none */
    struct {
        sk_pair_place *data;
        size_t count, capacity;
    } order, other_order;         /* of late pairs that are near */
    uint64_t searches, given_up; /* how often it searched, and gave up: */
    bool told;                   /* the world was told so */
} sk_touch;

typedef struct sk_contact_params {
    double thickness, friction, recovery;
    char *ignore;
} sk_contact_params;

/* The largest thickness that a pair can have. */
static inline real sk_touch_thickest(const sk_touch *touch, const sk_contact_params *params) {
    real rule = (real)params->thickness, own = touch->skin.thickest;
    return touch->skin.all_own ? own : sk_max(own, rule);
}

/* Of a pair of features with these vertices: half of each one's. */
static inline real sk_pair_thickness(const sk_touch *touch, uint32_t a, uint32_t b) {
    const sk_skin *skin = &touch->skin;
    if (!(skin->thickest > 0)) return touch->thickness;
    real first = skin->thickness[a] > 0 ? skin->thickness[a] : touch->usual;
    real second = skin->thickness[b] > 0 ? skin->thickness[b] : touch->usual;
    return (real)0.5 * (first + second);
}

/* Of the same: the mean of both. */
static inline real sk_pair_friction(const sk_touch *touch, uint32_t a, uint32_t b, real rule) {
    const sk_skin *skin = &touch->skin;
    if (!(skin->thickest > 0)) return rule;
    real first = skin->thickness[a] > 0 ? skin->friction[a] : rule, second = skin->thickness[b] > 0 ? skin->friction[b] : rule;
    return (real)0.5 * (first + second);
}

/* ---- ignored.c ---- */

/* Reads the pairs of names, and numbers the leaves of the bodies that have them. False when there is no memory. */
bool sk_ignored_make(sk_ignored *ignored, sk_allocator *allocator, const sk_skin *skin, const char *text,
                     const sk_meeting_parts *parts);
void sk_ignored_release(sk_ignored *ignored, sk_allocator *allocator);
static inline bool sk_is_ignored(const sk_ignored *ignored, uint32_t a, uint32_t b) {
    return ignored->any && ignored->pair[ignored->of_leaf[a] * ignored->width + ignored->of_leaf[b]];
}

/* ---- touching.c ---- */

bool sk_touch_touching(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                       skein_surface_contact *out, size_t most, size_t *count);

/* ---- skin.c ---- */

/* Makes the skin of what a rule acts on: triangles, and edges that are in none, by the user's indices. False when there
 * is no memory: the skin is then empty. */
bool sk_skin_make(sk_skin *skin, sk_allocator *allocator, const sk_particles *particles, const sk_only *only,
                  const sk_meeting_parts *parts);
void sk_skin_release(sk_skin *skin, sk_allocator *allocator);

/* ---- pairs.c ---- */

/* Room for `need` pairs; false when there is no memory. */
bool sk_pairs_reserve(sk_pairs *pairs, sk_allocator *allocator, size_t need);
/* Fills the last block up with pairs of nobody. */
void sk_pairs_pad(sk_pairs *pairs);
/* Pairs [begin, end) as pairs of their own; begin is a multiple of sixteen. */
sk_pairs sk_pairs_between(const sk_pairs *pairs, size_t begin, size_t end);
/* Puts pairs [first, end) of others from `at` on. */
void sk_pairs_put(sk_pairs *pairs, size_t at, const sk_pairs *others, size_t first, size_t end);
/* Adds all of pairs [first, end) of others; there is room. */
void sk_pairs_take(sk_pairs *pairs, const sk_pairs *others, size_t first, size_t end);
void sk_pairs_release(sk_pairs *pairs, sk_allocator *allocator);
static inline void sk_pairs_copy(sk_pairs *to, const sk_pairs *from, size_t k) {
    for (int c = 0; c < 4; c++) to->corner[c][to->count] = from->corner[c][k];
    to->key[to->count] = from->key[k];
    to->settled[to->count] = from->settled[k];
    to->thickness[to->count] = from->thickness[k];
    to->distance[to->count++] = from->distance[k];
}
/* With its normal, and where its features are nearest. */
static inline void sk_pairs_copy_all(sk_pairs *to, const sk_pairs *from, size_t k) {
    for (int c = 0; c < 3; c++) to->normal[c][to->count] = from->normal[c][k];
    for (int c = 0; c < 2; c++) to->share[c][to->count] = from->share[c][k];
    sk_pairs_copy(to, from, k);
}

/* Of the eight pairs from k on, a multiple of eight, those of which kernels have found `what`: a bit in the byte of each. */
static inline uint64_t sk_pairs_that(const sk_pairs *pairs, size_t k, uint64_t what) {
    uint64_t found;
    memcpy(&found, pairs->closes + k, sizeof found);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    found = __builtin_bswap64(found);
#endif
    size_t left = pairs->count - k; // the rest of a block is nobody's
    if (left < sizeof found) found &= ((uint64_t)1 << 8 * left) - 1;
    return found & what * 0x0101010101010101u;
}
static inline size_t sk_first_of(uint64_t found) {
    return (size_t)__builtin_ctzll(found) / 8;
}

/* ---- tangle.c ---- */

/* Whether a pair is of what is around an edge and what is around a triangle that go through each other (tangle.h). */
bool sk_pair_is_tangled(const sk_touch *touch, const uint32_t corner[4], int sort);

/* ---- kept.c ---- */

/* Takes fresh pairs over: instead of all that are kept, or of those with a vertex that was looked for. In the midst of a
 * bound no pair changes its place. */
bool sk_touch_keep(sk_touch *touch, sk_allocator *allocator, int sort, bool all, bool midst);
/* Lists those that are near, in the order of leaves. */
bool sk_touch_find_near(sk_touch *touch, sk_allocator *allocator, int sort);
/* The pairs that an entry of a list is about, and where it is there. */
static inline const sk_pairs *sk_pairs_of(const sk_touch *touch, int sort, uint32_t entry) {
    return entry & 1 ? &touch->late[sort] : &touch->kept[sort];
}
static inline size_t sk_pairs_kept(const sk_touch *touch) {
    size_t count = 0;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) count += touch->kept[sort].count + touch->late[sort].count;
    return count;
}

/* ---- closest.c ---- */

/* By sort of pairs. */
extern sk_closest_kernel *const sk_closest[SK_PAIR_SORTS][SK_ISA_COUNT];
/* nearing.c */
extern sk_closing_kernel *const sk_closing[SK_PAIR_SORTS][SK_ISA_COUNT];
extern sk_nearing_kernel *const sk_nearing[SK_PAIR_SORTS][SK_ISA_COUNT];

/* ---- cells.c ---- */

real sk_cells_a_metre(const sk_touch *touch);
/* The cells of a leaf, from its boxes. */
void sk_touch_leaf_cells(sk_touch *touch, size_t leaf);

/* ---- features.c ---- */

/* Lists the pairs of features of leaf a and each of its partners whose boxes may meet and of which one is looked for, in
 * order; there is room for SK_LEAVES_PAIRS a partner. */
enum { SK_LEAVES_PAIRS = 64 }; /* of two leaves: 2 x 4 x 2 corners, 5 x 5 edges */
typedef void sk_features_kernel(const struct sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner,
                                size_t count);
extern sk_features_kernel *const sk_features[SK_PAIR_SORTS][SK_ISA_COUNT];
/* The key of their first pair. */
static inline uint64_t sk_leaves_key(uint32_t a, uint32_t b) {
    return (uint64_t)a << 36 | (uint64_t)b << 8;
}

/* ---- tree.c ---- */

extern sk_tree_blocks_kernel *const sk_tree_blocks[SK_ISA_COUNT];
extern sk_tree_hits_kernel *const sk_tree_hits[SK_ISA_COUNT];

/* ---- partners.c ---- */

bool sk_tree_make(sk_tree *tree, sk_allocator *allocator, const sk_skin *skin);
void sk_tree_release(sk_tree *tree, sk_allocator *allocator);
/* Lists leaves whose boxes may meet, each two once, of which one at least is looked for `anew`: `first`, and `partner`, the
 * same leaf or a later one; in order, but none where they are more than `most`. Those of calm patches if asked for. */
bool sk_touch_partners(sk_touch *touch, sk_allocator *allocator, size_t most, bool calm_too, bool *too_many);
/* Has each part's work done on a thread of its own: `work` looks at what is next in its part of [0, count) until there is
 * none or no room, for which `grow` is then asked. Parts follow each other in order; or each takes so many at a time, whoever
 * is done. False when there is no memory. */
typedef struct sk_parts_job {
    sk_touch *touch;
    int sort, search;
    size_t most;
    bool calm_too;
    size_t at_once; /* 0: in order */
    void (*work)(const struct sk_parts_job *job, sk_search_part *part);
    bool (*grow)(sk_search_part *part, sk_allocator *allocator);
} sk_parts_job;
bool sk_touch_work(const sk_parts_job *job, sk_allocator *allocator, size_t count, size_t least);
void sk_touch_release_parts(sk_touch *touch, sk_allocator *allocator);
/* Whether two boxes may meet at some time. */
static inline bool sk_boxes_meet(const sk_box *a, const sk_box *b) {
    typedef sk_lane_int lanes __attribute__((vector_size(4 * sizeof(real))));
    lanes apart = ((lanes)(a->low[0] > b->high[0]) & (lanes)(a->low[1] > b->high[1])) |
                  ((lanes)(b->low[0] > a->high[0]) & (lanes)(b->low[1] > a->high[1]));
    return !(apart[0] | apart[1] | apart[2]);
}

/* ---- course.c ---- */

extern sk_course_kernel *const sk_course_off[SK_ISA_COUNT];

/* ---- search.c ---- */

/* What is looked for: pairs of all vertices, or of those that are lost, for as long as all keep to their courses; or of
 * those that are lost for this one substep, on all shares of the ways that all go, and where these lead. */
typedef enum sk_touch_search_sort { SK_SEARCH_ALL, SK_SEARCH_LOST, SK_SEARCH_WAYS } sk_touch_search_sort;
/* False when there is no memory. */
bool sk_touch_search(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search);
/* Thicknesses: nearest points of edges that are all but parallel are no better known. */
#define SK_SEARCH_ROUNDING ((real)0.002)
/* The way that a vertex may still go. */
static inline sk_vec3 sk_way_left(const sk_touch *touch, size_t v) {
    return sk_scale(touch->share[v], sk_xyz(touch->way[v]));
}

/* ---- boxes.c ---- */

/* Marks vertices that are lost, edges and triangles that have one, and the leaves of all these. */
void sk_touch_mark_hot(sk_touch *touch);
/* Boxes of all vertices and leaves, or of those that are new. */
void sk_touch_make_boxes(sk_touch *touch, sk_touch_search_sort sort);
/* Of features, boxes are made where their leaf meets another: few do, of a surface that touches nothing. */
void sk_touch_box_features(sk_touch *touch);
/* The box of a leaf, and those of its features, from those of vertices. */
void sk_touch_leaf_box(sk_touch *touch, size_t leaf);
void sk_touch_feature_boxes(sk_touch *touch, size_t leaf);

/* ---- thickness.c ---- */

/* Puts down how thick the features of pairs are, from the first that is asked for on. */
void sk_touch_set_thickness(const sk_touch *touch, sk_pairs *pairs, size_t first, int sort);

/* ---- bound.c ---- */

sk_op_kernel sk_touch_bound;

/* ---- crossings.c ---- */

/* How many edges go through a triangle, of the places x of slots. False when there is no memory. */
bool sk_touch_crossings(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                        size_t *count);
/* Loads the places x of slots, as no step would. */
void sk_touch_load_from(sk_touch *touch, const sk_vec4 *x, const uint32_t *slot_of);
/* Boxes of all leaves where they are loaded, each wider by `part`, and of a leaf's features: for lists of those that may
 * meet there. */
void sk_touch_put_boxes(sk_touch *touch, real part);
static inline void sk_touch_need_features(sk_touch *touch, size_t leaf) {
    if (!touch->featured[leaf]) sk_touch_feature_boxes(touch, leaf);
}
/* Lists those edges that go through a triangle where they are loaded, in the order of leaves; with `of`, if it is known
 * that of others none does, those around vertices that have it set. False when there is no memory. */
bool sk_touch_list_crossings(sk_touch *touch, sk_allocator *allocator, const uint8_t *of, sk_crossing_list *list);

/* ---- touch.c ---- */

/* Pairs that are looked at closely are nearer than so many thicknesses. */
#define SK_NEAR_THICKNESSES ((real)1.05)
/* Who goes another way in a substep than expected by more thicknesses than this is lost, wherever that leads. */
#define SK_MOST_JUMP ((real)0.4)
/* Of a gap, so much is left in a substep. */
#define SK_LEFT_OVER ((real)0.1)
/* What is less than this share of the thickness does not close at all. */
#define SK_LEAST_GAP ((real)0.0025)

/* Loads the places before the substep, unless they are. */
void sk_touch_load(sk_touch *touch, size_t packed);
/* Looks for lost vertices; then, but of ways, looks at all pairs that are kept, at p. */
bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search);
/* Where the frame of courses is, of places x of slots at some time: [0] before this substep, [1] after it. */
void sk_touch_set_frame(sk_touch *touch, const sk_vec4 *x, size_t packed, real time, int after);
/* Marks vertices that are not where they are expected as lost, and nobody else; returns whether there are any. */
bool sk_touch_mark_lost(sk_touch *touch, const sk_vec4 *x, size_t packed, real time, int after);
/* How far a vertex has moved at most since the last substep began. */
real sk_touch_farthest(sk_touch *touch, const sk_vec4 *x, size_t packed);
/* From now on, a vertex has its course, or none. */
void sk_touch_put_course(sk_touch *touch, size_t v, bool wild);
/* Where a vertex is expected at a time. */
static inline sk_vec3 sk_expected(const sk_course *course, real time) {
    return sk_add(course->from, sk_scale(time, course->step));
}
/* The weights of a pair's corners at its nearest points: those of the second feature are negative. */
static inline void sk_weights_of(const sk_pairs *pairs, int sort, size_t k, real weight[4]) {
    real u = pairs->share[0][k], v = pairs->share[1][k];
    weight[0] = sort == SK_EDGES ? 1 - u : 1;
    weight[1] = sort == SK_EDGES ? u : u + v - 1;
    weight[2] = sort == SK_EDGES ? v - 1 : -u;
    weight[3] = -v;
}

#endif
