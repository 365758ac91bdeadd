/* Contact of surfaces with themselves and each other: what a rule that meets (forces/force.h) keeps between its rows.
 *
 *   begin   P = X; pairs of features that may come near are found anew if a vertex has left its reach;
 *           those nearer than thickness and a quarter are looked at closely: distance, normal, places of contact
 *   push    each of them, in a fixed order, is brought to its thickness, with friction
 *   bound   no vertex goes further than its pairs allow, so that nothing passes
 *
 * A pair is a vertex and a triangle, or two edges; they have no corner in common. Which pairs are kept is decided by
 * distances at some earlier state S and by how far each vertex may go from there, its reach; what is done with a pair
 * depends on the state before and after the substep alone. So a search too many changes no bit, and a state that was
 * saved and loaded goes on as it would have.
 *
 * The bound is a division of space by planes for each pair (planar division: arXiv 2604.15513), where it is needed: a
 * vertex goes the least share of its way that any of its pairs allows, and a minimum knows no order. */
#ifndef SK_CONTACT_TOUCH_H
#define SK_CONTACT_TOUCH_H

#include "forces/force.h"
#include "particles/particles.h"

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
} sk_skin;

/* Pairs, one array a number, padded to whole blocks of sixteen. Corners: a vertex and a triangle's three, or an edge's two
 * and another's two. The normal leads from the second feature to the first; `share` says where on them they are nearest:
 * u, v of a triangle's second and third corner, or how far along each edge. */
typedef struct sk_pairs {
    uint32_t *corner[4];
    real *distance, *thickness, *normal[3], *share[2];
    uint8_t *settled; /* of a bound: planes divide it */
    size_t count, capacity;
} sk_pairs;

/* Nearest points of all pairs, from the places x of their corners. */
typedef void sk_closest_kernel(const sk_vec4 *x, sk_pairs *pairs);

typedef struct sk_box {
    real low[3], high[3];
} sk_box;

enum { SK_CORNERS, SK_EDGES, SK_PAIR_SORTS }; /* vertex and triangle, edge and edge: the order of pairs */

typedef struct sk_touch {
    sk_skin skin;
    uint64_t shape; /* of the world that the skin was made from */
    sk_isa isa;
    bool found;   /* whether the pairs are of this skin */
    bool gave_up; /* the last search did, at a thousand pairs a vertex: nothing meets until one does not */
    real thickness; /* and of this thickness, m */
    /* by vertex */
    sk_vec4 *p;    /* the place before the substep; w: how far it is from s */
    sk_vec4 *q;    /* after it */
    sk_vec4 *way;  /* from p to q, less what all go together; w: its length */
    sk_vec4 *s;    /* at the last search, going along with all */
    real *reach;   /* how far from s it may be */
    real *inverse; /* mass, 1/kg */
    real *share, *next_share; /* of its way that it may go */
    real most_moved, most_way; /* the largest w of p and way */
    /* of the search */
    sk_box *vertex_box, *edge_box, *triangle_box, *leaf_box, *sorted_box;
    uint32_t *cell, *item, *start;
    size_t start_capacity;
    struct {
        uint32_t *data;
        size_t count, capacity;
    } list;
    sk_pairs kept[SK_PAIR_SORTS], near[SK_PAIR_SORTS], closing[SK_PAIR_SORTS], rest;
    uint64_t searches;
} sk_touch;

typedef struct sk_contact_params {
    double thickness, friction;
} sk_contact_params;

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
void sk_pairs_release(sk_pairs *pairs, sk_allocator *allocator);
static inline void sk_pairs_copy(sk_pairs *to, const sk_pairs *from, size_t k) {
    for (int c = 0; c < 4; c++) to->corner[c][to->count] = from->corner[c][k];
    to->thickness[to->count] = from->thickness[k];
    to->distance[to->count++] = from->distance[k];
}

/* ---- closest.c ---- */

/* By sort of pairs. */
extern sk_closest_kernel *const sk_closest[SK_PAIR_SORTS][SK_ISA_COUNT];

/* ---- search.c ---- */

/* Finds all pairs that may come nearer than `limit` while vertices stay within their reach of p; s becomes p. False when
 * there is no memory. */
bool sk_touch_search(sk_touch *touch, sk_allocator *allocator, real thickness, real limit);
/* The boxes of all features: what lies within the reach of its vertices (NULL: none has any), and half the limit around. */
void sk_touch_boxes(sk_touch *touch, const real *reach, real limit);
/* Calls `meet` for all leaves whose boxes overlap, in the order of (a, b). */
bool sk_touch_meet(sk_touch *touch, sk_allocator *allocator, bool (*meet)(void *data, size_t a, size_t b), void *data);

/* ---- bound.c ---- */

sk_row_kernel sk_touch_bound;

/* ---- crossings.c ---- */

/* How many edges go through a triangle, of the places x of slots. False when there is no memory. */
bool sk_touch_crossings(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                        size_t *count);

/* ---- touch.c ---- */

/* Pairs that are looked at closely are nearer than so many thicknesses. */
#define SK_NEAR_THICKNESSES ((real)1.25)

/* Finds pairs anew, with reaches for vertices that go on by way[v].w a substep. */
bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, real thickness);
/* The most that corners of a pair's two features have of w. */
static inline void sk_most_of_features(const sk_pairs *pairs, int sort, size_t k, const sk_vec4 *x, real most[2]) {
    real w[4];
    for (int c = 0; c < 4; c++) w[c] = x[pairs->corner[c][k]].w;
    most[0] = sort == SK_EDGES ? sk_max(w[0], w[1]) : w[0];
    most[1] = sort == SK_EDGES ? sk_max(w[2], w[3]) : sk_max(w[1], sk_max(w[2], w[3]));
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
