/* Contact of surfaces with themselves and each other: what a rule that meets (forces/force.h) keeps between its ops.
 *
 *   begin   P = X; pairs of features that may come near are found anew where a vertex has left its way; all that are
 *           kept are looked at: distance, normal, places of contact; those nearer than thickness and a twentieth are near
 *   push    each of these, in a fixed order (slabs.c), is brought to its thickness, with friction; or in an implicit solve presses (press.c);
 *           where that was raised in the midst of a run, slowly (sk_easing)
 *   faces   colliders hold what lies between particles (faces.c), before a push and while limits are swept
 *   bound   no vertex goes further than its pairs allow, so that nothing passes
 *
 * A pair is a vertex and a triangle, or two edges; they have no corner in common, and their bodies are no pair to be
 * ignored. Which pairs are kept is decided by what is expected: each vertex goes on at some velocity, from where it was
 * when it was last looked for, is never farther from there than its reach, and goes hardly any other way in a substep.
 * What goes otherwise is looked for anew, with its neighbours, and nobody else. What lies around a leaf is left out
 * while it is known to keep apart (calm.h), and so is a sheet that lies spread out (spread.h). What is done with a pair
 * depends on the state before and after the substep alone. So a search too many changes no bit, and a state that was
 * saved and loaded goes on as it would have. What has gone through each other all the same is led apart (tangle.h).
 *
 * The bound is a division of space by planes for each pair (planar division: arXiv 2604.15513), where it is needed: a
 * vertex goes the least share of its way that any of its pairs allows, and a minimum knows no order. Velocities of who goes less
 * than he would are shared with what holds him (impact.c). */
#ifndef SK_CONTACT_TOUCH_H
#define SK_CONTACT_TOUCH_H

#include "contact/calm.h"
#include "contact/faces.h"
#include "contact/pairs.h"
#include "contact/press.h"
#include "contact/push.h"
#include "contact/search/boxes.h"
#include "contact/skin.h"
#include "contact/spread.h"
#include "contact/tangle.h"

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
typedef bool sk_course_kernel(const sk_vec4 *x, const sk_vec4 *before, size_t packed, size_t slots,
                              const sk_course_block *block, real time, const sk_vec3 *shift, const sk_vec3 *gone,
                              real jump, uint16_t *off, real *way);

/* Which features of a leaf are looked for: bits. */
typedef struct sk_hot {
    uint8_t vertices, edges, triangles;
} sk_hot;

/* Around which lanes of a block of the tree, counted from 1, a leaf lies: bits. */
typedef struct sk_ring_mark {
    uint32_t block, lanes;
} sk_ring_mark;

/* A leaf's features have boxes, or are to have them; or it is out (spread.h), and has no box itself. */
enum { SK_IS_FEATURED = 1, SK_TO_BE_FEATURED, SK_IS_OUT };

/* What one thread finds of a search: all that is kept is put together in their order, so that no bit depends on them. */
enum { SK_MOST_PARTS = 16 };
typedef struct sk_search_part {
    uint32_t *block;    /* of the tree */
    sk_ring_mark *ring; /* of leaves */
    struct {
        uint32_t *data;
        size_t count, capacity;
    } first, second;       /* leaves whose boxes meet */
    uint32_t *start;       /* of leaves, while partners are put in order */
    sk_pairs batch, fresh; /* pairs whose boxes may meet, and all of them that may come near */
    size_t next, end;      /* of leaves or leaves' pairs, those still to be looked at */
} sk_search_part;

typedef struct sk_touch {
    sk_skin skin;
    sk_ignored ignored;
    sk_calm calm;
    sk_spread spread;
    sk_tangle tangle;
    struct sk_tasks *tasks; /* of the run */
    uint64_t shape;         /* of the world that the skin was made from */
    sk_isa isa;
    bool alone;               /* no other rule meets */
    bool found;               /* whether the pairs are of this skin */
    bool followed;            /* the last bound has seen where all went */
    bool implicit;            /* an implicit solve presses, and takes who is held back as he is */
    bool corrects;            /* the method corrects positions: edges are held taut (taut.c) */
    bool remembers;           /* all have been seen */
    bool held;                /* a vertex is pinned */
    bool untouched;           /* hardly any pairs are kept: courses may be wide */
    bool loaded;              /* p and inverse are of this substep */
    bool holds;               /* what was known of patches when the last bound ended still is so */
    bool boxed;               /* whether boxes are those of the courses; */
    bool still;               /* they are those of a substep's ways, all of them */
    bool aimed;               /* `at` and `in_the_end` are those of this substep's ways */
    real thickness;           /* that pairs were found for, m: the largest of any pair; */
    real usual;               /* and the rule's, of bodies that have none of their own; */
    real less;                /* and so much nearer surfaces may be for now, where that was raised (sk_easing) */
    real now, until;          /* substeps since the last search for all, and how long that holds */
    uint64_t clock;           /* substeps in all */
    size_t storm, next_storm; /* substeps that are left in which nobody has a course; and of the next such time */
    size_t searched_since;    /* searches since the last one for all */
    size_t lost_since;        /* how many have been lost since then, each as often as it was */
    sk_vec3 drift;            /* how far all went in a substep then, in the mean; */
    sk_vec3 common;           /* and what all go together in this one, or pins (bound.c) */
    real longest;             /* m: of the ways in this substep, less what all go together; */
    real farthest;            /* and with that, of those that have a course */
    sk_vec3 frame_step;       /* how far the frame of courses goes in a substep, as it did last, */
    sk_vec3 shift[2];         /* and has gone before this one and after it */
    /* by slot */
    const sk_vec4 *x;      /* while a substep is taken */
    const sk_vec4 *before; /* X before the substep: `copied`, or, while nobody asks, what the method keeps; or NULL */
    sk_vec4 *copied;       /* a copy of it */
    bool start_is_kept;    /* the method keeps it until the bound */
    sk_course_block *course_block;
    uint16_t *off;
    uint32_t *vertex_at;
    size_t slots, slot_capacity;
    /* by vertex */
    uint32_t *slot;
    uint32_t *inner_slot;     /* of those within solids */
    sk_vec4 *p;               /* the place before the substep */
    sk_vec4 *q;               /* after it */
    sk_vec4 *way;             /* from `stand` to q, less what all go together; w: how far that leads from p, at most */
    sk_vec4 *stand;           /* where it is after a substep if it goes none of its way, less the same: p, or */
    sk_vec4 *yielded;         /* where who is in the way of pins has room (yield.c) */
    uint8_t *slab;            /* of space, in which it begins a push (slabs.c) */
    uint8_t *rank;            /* how far from a pin, in pairs; SK_STANDS: nobody moves it */
    sk_vec4 *at, *in_the_end; /* of a search: where it is expected now, and when that ends */
    sk_course *course;
    sk_seen *seen;
    real *inverse;            /* mass, 1/kg */
    real *share, *next_share; /* of its way that it may go */
    uint8_t *lowered;         /* its share was, in the last round */
    uint8_t *loses;           /* of pieces of the skin: what who of it is held back loses (impact.c) */
    uint32_t *waiting;        /* those whose edges are still to be looked at, in a ring; */
    uint8_t *waits;           /* and whether it is one of them */
    uint8_t *lost;            /* it is looked for */
    uint8_t *wild;            /* it has left its course and has none: it is looked for on its way in each substep */
    size_t wild_count;
    /* of the search */
    sk_box *corner_box; /* of vertices: where they are, and in its fourth number how much wider a box has to be */
    sk_box *vertex_box, *edge_box, *triangle_box, *leaf_box;
    sk_box *hot_box; /* of those features of a leaf that are looked for */
    sk_hot *hot;
    sk_edge_cells *edge_cells; /* of leaves */
    sk_corner_cells *corner_cells;
    real cells; /* a metre */
    sk_tree tree;
    uint8_t *torn;       /* leaves that have blown up (torn.c), */
    real *room;          /* and by how much, m, they had not when it was asked, which was, if ever, */
    sk_vec4 *asked_at;   /* with vertices there */
    real torn_room;      /* the least */
    uint64_t torn_clock; /* the substep that it is known of */
    bool torn_asked, any_torn, torn_changed;
    uint8_t *anew, *moved; /* leaves that are looked for, and whose boxes are new; */
    uint8_t *featured;     /* whether their features have boxes, too */
    bool everybody;        /* all features of all leaves are looked for */
    uint8_t *changed;      /* slots of a level of the tree, and of the next one */
    bool refit;            /* all of the tree is old */
    uint32_t *start;       /* of leaves, and one more: where their partners begin */
    struct {
        uint32_t *data;
        size_t count, capacity;
    } first, partner; /* leaves whose boxes meet: the first and the second of both, in order */
    sk_search_part part[SK_MOST_PARTS];
    int part_count;
    sk_pairs kept[SK_PAIR_SORTS];     /* of the last search for all, in their order; */
    sk_pairs late[SK_PAIR_SORTS];     /* and of searches since then, one after the other */
    size_t told_apart[SK_PAIR_SORTS]; /* late pairs of which it is known whether they may close */
    sk_pairs fresh;
    sk_pair_list near[SK_PAIR_SORTS];       /* in the order of leaves; */
    sk_divided_list divided[SK_PAIR_SORTS]; /* in this substep */
    sk_yielding_list yielding;
    sk_closing_list may_close[SK_PAIR_SORTS]; /* and in none */
    sk_presses press;
    sk_push_list pushes;
    struct {
        sk_pair_place *data;
        size_t count, capacity;
    } order, other_order;             /* of late pairs that are near, or of those that are divided */
    uint64_t searches, given_up;      /* how often it searched, and gave up: */
    uint64_t told;                    /* of these the world knows; */
    bool asked_crowded, told_crowded; /* whether a body of this skin is too thick for its edges; and of one */
    sk_faces faces;
} sk_touch;

typedef struct sk_contact_params {
    double thickness, friction, recovery;
    int32_t more_substeps;
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

/* How far a pair that is `distance` apart is led to: to its thickness, or, while that is eased, to what of it there is by now; who is
 * farther apart stays so. */
static inline real sk_pair_goal(const sk_touch *touch, uint32_t a, uint32_t b, real thickness, real distance) {
    if (!(touch->less > 0)) return thickness;
    const sk_skin *skin = &touch->skin;
    const bool own[2] = {skin->thickest > 0 && skin->thickness[a] > 0, skin->thickest > 0 && skin->thickness[b] > 0};
    const real less = touch->less * (real)0.5 * (real)(2 - own[0] - own[1]);
    return sk_min(thickness, sk_max(sk_pair_thickness(touch, a, b) - less, distance));
}

/* Of the same: the mean of both. */
static inline real sk_pair_friction(const sk_touch *touch, uint32_t a, uint32_t b, real rule) {
    const sk_skin *skin = &touch->skin;
    if (!(skin->thickest > 0)) return rule;
    real first = skin->thickness[a] > 0 ? skin->friction[a] : rule,
         second = skin->thickness[b] > 0 ? skin->friction[b] : rule;
    return (real)0.5 * (first + second);
}

/* ---- touching.c ---- */

bool sk_touch_touching(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                       skein_surface_contact *out, size_t most, size_t *count);

/* ---- tangle.c ---- */

/* Whether a pair is of what is around an edge and what is around a triangle that go through each other (tangle.h). */
bool sk_pair_is_tangled(const sk_touch *touch, const uint32_t corner[4], int sort);

/* ---- way_out.c ---- */

/* Turns the way that a solid's crossings lead it to the shortest one out of the first other solid that it crosses, where this is much shorter; returns
 * whether it did. */
bool sk_tangle_way_out(const sk_touch *touch, uint32_t one, sk_vec3 *way);

/* ---- kept.c ---- */

/* Takes fresh pairs over: instead of all that are kept, or of those with a vertex that was looked for. In the midst of a
 * bound no pair changes its place. */
bool sk_touch_keep(sk_touch *touch, sk_allocator *allocator, int sort, bool all, bool midst);
/* Lets all pairs go of whose leaves one is out (spread.h); before a bound. */
void sk_touch_leave_out(sk_touch *touch);
/* Lists those that are near, in the order of leaves. */
bool sk_touch_find_near(sk_touch *touch, sk_allocator *allocator, int sort);
/* Those that a bound has divided, in order; until the next list. NULL when there is no memory. */
const sk_pair_place *sk_touch_order_divided(sk_touch *touch, sk_allocator *allocator, int sort);
/* The pairs that an entry of a list is about, and where it is there. */
static inline const sk_pairs *sk_pairs_of(const sk_touch *touch, int sort, uint32_t entry) {
    return entry & 1 ? &touch->late[sort] : &touch->kept[sort];
}
static inline size_t sk_pairs_kept(const sk_touch *touch) {
    size_t count = 0;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) count += touch->kept[sort].count + touch->late[sort].count;
    return count;
}

/* ---- course.c ---- */

extern sk_course_kernel *const sk_course_off[SK_ISA_COUNT];

/* ---- torn.c ---- */

/* Whether a leaf has blown up, of places p of vertices. */
bool sk_leaf_is_torn(const sk_touch *touch, size_t leaf, const sk_vec4 *p);
/* Finds out which are before this substep (`torn`), unless it is known; if that has changed, all are to be looked for. To be asked before
 * anybody is, and, where somebody was torn, in each substep. */
void sk_torn_know(sk_touch *touch, size_t packed);

/* ---- thickness.c ---- */

/* Puts down how thick the features of pairs are, from the first that is asked for on. */
void sk_touch_set_thickness(const sk_touch *touch, sk_pairs *pairs, size_t first, int sort);

/* ---- push.c ---- */

sk_op_kernel sk_touch_push;
/* The same in the midst of limits, which goes on with a push: nothing is led. */
sk_op_kernel sk_touch_push_on;
/* Pushes one off a collider, of X, and of V if that is the op's second source. */
void sk_touch_push_face(sk_touch *touch, const sk_run *run, const sk_op *op, const sk_face *face);
/* Where an implicit solve has pressed apart what is near: leads apart what goes through each other, and no more. */
sk_op_kernel sk_touch_lead;

/* ---- slabs.c ---- */

/* Deals what is near to slabs, once in a substep: what has come too near may come nearer to its thickness by `gain`, m, in a push; `friction`
 * is the rule's. False when there is no memory. */
bool sk_touch_deal(sk_touch *touch, sk_allocator *allocator, real gain, real friction);

/* ---- bound.c ---- */

sk_op_kernel sk_touch_bound;
/* The same within an implicit solve, which takes those that are held back as they are: their S is 0. */
sk_op_kernel sk_touch_hold;
/* Lists the pairs that may close on these ways: none of the others does, whatever shares are left. Of all, or of those
 * that came since it was last asked; those that went since then are pairs of nobody where they stand. */
bool sk_touch_list_closing(sk_touch *touch, sk_allocator *allocator, real least, bool all);
/* Looks for those that are lost, on their ways: they are wild from now on. */
bool sk_touch_search_ways(sk_touch *touch, sk_allocator *allocator);

/* ---- faces.c ---- */

/* Takes over which colliders there are; false when there is no memory. */
bool sk_faces_take(sk_faces *faces, sk_allocator *allocator, const sk_meeting_parts *parts);
/* Pushes edges and triangles out of colliders: with a coefficient of 1 those that are near now, else those that were where the last
 * substep ended. */
sk_op_kernel sk_touch_push_faces;
/* Where an implicit solve begins: those that are near then, or were where the last substep ended, with the surface where it will be. */
void sk_touch_start_faces(sk_touch *touch, sk_run *run, const sk_op *op);

/* ---- impact.c ---- */

/* Takes from who is held back, and X has been stored where he may go, what he loses of velocity. */
void sk_touch_lose_velocities(sk_touch *touch, const sk_run *run, const sk_op *op);
/* Takes from solids that are led out of each other the velocity with which they come nearer. */
void sk_touch_part_solids(sk_touch *touch, const sk_run *run, const sk_op *op);
/* Then shares what he has with what holds him. False when there is no memory. */
bool sk_touch_share_velocities(sk_touch *touch, sk_allocator *allocator, const sk_run *run, const sk_op *op);

/* ---- make/crowded.c ---- */

/* The first body that is too thick for its edges, as the force's kind says (sk_meeting); NULL: none, or there is no memory. */
const sk_meeting_body *sk_touch_crowded(const sk_touch *touch, sk_allocator *allocator, const sk_meeting_parts *parts,
                                        double usual, double *edge, double *thickness);

/* ---- taut.c ---- */

/* Lowers shares further (next_share, where they are less than share), so that no edge tears at who is held back. */
void sk_touch_hold_taut(sk_touch *touch);

/* ---- yield.c ---- */

/* Whether a pin goes through somebody who has no room: of the pairs whose gap pins take, at the shares that were found. */
bool sk_touch_is_passed(const sk_touch *touch);
/* Moves those that pins would pass to where they have room, and begins anew with whole ways from there. Gaps of less than
 * `least` are none. False when there is no memory. */
bool sk_touch_yield(sk_touch *touch, sk_allocator *allocator, real least);
enum { SK_STANDS = 255 };
/* Whether a vertex is pinned or has yielded, in a bound where somebody has. */
static inline bool sk_has_yielded(const sk_touch *touch, size_t v) {
    return touch->stand != touch->p && touch->rank[v] != SK_STANDS;
}

/* ---- crossings.c ---- */

/* How many edges go through a triangle, of the places x of slots. False when there is no memory. */
bool sk_touch_crossings(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                        size_t *count);
/* Loads the places x of slots, as no step would. */
void sk_touch_load_from(sk_touch *touch, const sk_vec4 *x, const uint32_t *slot_of);
/* Boxes of all leaves where they are loaded, each wider by `part`, and of a leaf's features: for lists of those that may
 * meet there. Who is torn meets nobody: in a step, who was before it; else who is where they are. */
void sk_touch_put_boxes(sk_touch *touch, real part);
/* Lists those edges that go through a triangle where they are loaded, in the order of leaves; with `of`, if it is known
 * that of others none does, those around vertices that have it set. `aside`: of two solids one is taken to be a little aside (sides.c), or those with faces
 * in one plane would have none. False when there is no memory. */
bool sk_touch_list_crossings(sk_touch *touch, sk_allocator *allocator, const uint8_t *of, sk_crossing_list *list,
                             bool aside);

/* ---- sides.c ---- */

/* How far from where it is the solid with vertex `one` is taken to be, against that with vertex `other`, m; 0 where these are no two solids. */
sk_vec3 sk_touch_aside(const sk_touch *touch, uint32_t one, uint32_t other);
/* Gives a pair without a gap the normal that all pairs of its surfaces have, where these are in one place. */
void sk_touch_choose_side(sk_touch *touch, int sort, uint32_t entry);
/* The same of all that are near and have none. */
void sk_touch_choose_sides(sk_touch *touch);

/* ---- touch.c ---- */

/* Pairs that are looked at closely are nearer than so many thicknesses. */
#define SK_NEAR_THICKNESSES ((real)1.05)
/* Who goes another way in a substep than expected by more than this is lost, wherever that leads. What is much thinner than its edges are
 * long lies still only to within more than that. */
static inline real sk_most_jump(const sk_touch *touch) {
    return sk_max((real)0.4 * touch->thickness, (real)0.05 * touch->skin.spacing);
}
/* Of a gap, so much is left in a substep. */
#define SK_LEFT_OVER ((real)0.1)
/* What is less than this share of the thickness does not close at all. */
#define SK_LEAST_GAP ((real)0.0025)
/* And less than this is none: only what begins so has it. */
#define SK_NO_GAP ((real)0.00025)

/* Makes `before` a copy, which stays. */
void sk_touch_copy_start(sk_touch *touch);
/* Loads the places before the substep, unless they are. */
void sk_touch_load(sk_touch *touch, size_t packed);
/* What is looked for: pairs of all vertices, or of those that are lost, for as long as all keep to their courses; or of
 * those that are lost for this one substep, on all shares of the ways that all go, and where these lead. */
typedef enum sk_touch_search_sort { SK_SEARCH_ALL, SK_SEARCH_LOST, SK_SEARCH_WAYS } sk_touch_search_sort;
/* Looks for lost vertices; then, but of ways, looks at all pairs that are kept, at p. */
bool sk_touch_renew(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search);
/* After a bound that more follows in the same substep: what is near is listed anew, for it has let go of some pairs, and
 * found others. False when there is no memory. */
bool sk_touch_look_again(sk_touch *touch, sk_allocator *allocator);
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
/* The way that a vertex may still go. */
static inline sk_vec3 sk_way_left(const sk_touch *touch, size_t v) {
    return sk_scale(touch->share[v], sk_xyz(touch->way[v]));
}
/* The weights of a pair's corners at its nearest points: those of the second feature are negative. */
static inline void sk_weights_of(const sk_pairs *pairs, int sort, size_t k, real weight[4]) {
    real u = pairs->share[0][k], v = pairs->share[1][k];
    weight[0] = sort == SK_EDGES ? 1 - u : 1;
    weight[1] = sort == SK_EDGES ? u : u + v - 1;
    weight[2] = sort == SK_EDGES ? v - 1 : -u;
    weight[3] = -v;
}
/* How easily features of such weights are moved apart, 1/kg: the sum of w^2 / m. Where one is all but held by a pin, beside which it
 * touches, its far end would have to go a long way: it goes no further than twice what is missing, as pairs of features that are free,
 * and as heavy at all corners, never do. (Three curtains in one place, pinned along their upper edges, had 1e11 J.) */
static inline real sk_pair_resist(const sk_touch *touch, const uint32_t v[4], const real weight[4]) {
    real resist = 0, most = 0;
    for (int c = 0; c < 4; c++) {
        const real size = weight[c] < 0 ? -weight[c] : weight[c], gives = size * touch->inverse[v[c]];
        resist += size * size * touch->inverse[v[c]];
        most = sk_max(most, gives);
    }
    return sk_max(resist, (real)0.5 * most);
}

#endif
