/* Who is held back holds his neighbours back, where the edge between them would tear.
 *
 * A bound looks at pairs, and pairs know of no edges. Where a fine mesh crumples, a corner that may go none of its way has a
 * neighbour that goes all of it, substep after substep; light corners that are held do not hold heavy ones in the method's own
 * correction either. Edges of 5 mm so came to be 50 mm long, and locked around each other for good.
 *
 * So an edge is let get no longer than it was before the substep, or wanted to be after it, or was built and a twentieth: as a
 * thread would catch what flies away. If it would, the one that goes the greater share of its way goes less. Planes of the
 * bound hold for smaller shares, too; and with equal shares an edge is never longer than the longer of before and after, for
 * lengths are convex. The twentieth is what lets a taut sheet turn: where one of its corners is stopped, neighbours go on a
 * third of a cell to one side, and the sheet does not stop as if it were a board.
 *
 * Only for methods that correct positions. After an implicit solve, a sheet that folds on rough ground no longer came to rest:
 * what it was held back by, the next solve took for a stretch. And not at who has yielded to pins, and is stretched by that. */
#include "contact/touch.h"

/* Vertices whose edges are to be looked at, in a ring. */
typedef struct waiting_ring {
    uint32_t *vertex;
    size_t first, count;
} waiting_ring;

/* The square of what an edge may be long. */
static real square_of_most(const sk_touch *touch, uint32_t a, uint32_t b) {
    const real slack = (real)(1.05 * 1.05);
    const sk_vec3 before = sk_sub(sk_xyz(touch->stand[b]), sk_xyz(touch->stand[a]));
    const sk_vec3 wanted = sk_add(before, sk_sub(sk_xyz(touch->way[b]), sk_xyz(touch->way[a])));
    const sk_vec3 built = sk_sub(sk_xyz(touch->skin.built[b]), sk_xyz(touch->skin.built[a]));
    return sk_max(sk_max(sk_dot(before, before), sk_dot(wanted, wanted)), slack * sk_dot(built, built));
}

/* Lowers the greater of both shares to what keeps the edge; returns whose it was, or UINT32_MAX. */
static uint32_t hold_edge(sk_touch *touch, uint32_t a, uint32_t b) {
    const real known = (real)1.0001; // of squares; so that what is lowered is lowered by more than rounding
    real *share = touch->next_share;
    if (share[a] == share[b]) return UINT32_MAX;
    if (sk_has_yielded(touch, a) || sk_has_yielded(touch, b)) return UINT32_MAX;
    if (share[a] > share[b]) {
        const uint32_t c = a;
        a = b, b = c;
    }
    if (!(touch->inverse[b] > 0)) return UINT32_MAX;
    const sk_vec3 way = sk_xyz(touch->way[b]),
                  stopped = sk_add(sk_xyz(touch->stand[a]), sk_scale(share[a], sk_xyz(touch->way[a])));
    const sk_vec3 from = sk_sub(sk_xyz(touch->stand[b]), stopped), to = sk_add(from, sk_scale(share[b], way));
    const real most = square_of_most(touch, a, b);
    if (!(sk_dot(to, to) > known * most)) return UINT32_MAX;
    // |from + s way|^2 = most: its greater root
    const real square = sk_dot(way, way), half = sk_dot(way, from),
               inside = half * half - square * (sk_dot(from, from) - most);
    const real root = inside > 0 && square > 0 ? (sk_sqrt(inside) - half) / square : share[a];
    const real held = sk_max(root, share[a]);
    if (!(held < share[b])) return UINT32_MAX;
    share[b] = held;
    return b;
}

static void wait_for(sk_touch *touch, waiting_ring *waiting, uint32_t v) {
    if (touch->waits[v]) return;
    touch->waits[v] = 1;
    waiting->vertex[(waiting->first + waiting->count++) % touch->skin.vertex_count] = v;
}

/* All edges at a vertex. An edge belongs to a leaf that has a feature with each of its ends. */
static void hold_around(sk_touch *touch, waiting_ring *waiting, uint32_t v) {
    const sk_skin *skin = &touch->skin;
    for (uint32_t i = skin->leaf_start[v]; i < skin->leaf_start[v + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (size_t e = leaf->first_edge; e < leaf->first_edge + leaf->edges; e++) {
            const uint32_t *end = skin->edge[e];
            if (end[0] != v && end[1] != v) continue;
            const uint32_t lowered = hold_edge(touch, end[0], end[1]);
            if (lowered != UINT32_MAX) wait_for(touch, waiting, lowered);
        }
    }
}

/* In the order of vertices, and of those that they lower: on one thread, so that the order is always the same. */
void sk_touch_hold_taut(sk_touch *touch) {
    const size_t count = touch->skin.vertex_count, most = 16 * count; // where all has blown up, the rest tears
    waiting_ring waiting = {.vertex = touch->waiting};
    for (size_t v = 0; v < count; v++)
        if (touch->next_share[v] < touch->share[v]) wait_for(touch, &waiting, (uint32_t)v);
    for (size_t n = 0; waiting.count; n++) {
        const uint32_t v = waiting.vertex[waiting.first];
        waiting.first = (waiting.first + 1) % count, waiting.count--;
        touch->waits[v] = 0;
        if (n < most) hold_around(touch, &waiting, v);
    }
}
