/* Nearest triangles of a part's points at once, for files of kernels: boxes and triangles are looked at for all lanes
 * together, as long as one of them has nothing nearer. Points of a part mostly lie close by each other, so that they want
 * the same boxes. What a lane finds is the nearest of all triangles, of equally near ones the first: whoever
 * its neighbours are, and however wide the vector is. */
#include "colliders/trimesh.h"

SK_INLINE sk_wide trimesh_box(const sk_tree_node *node, sk_wide3 p) {
    sk_wide none = {0}, sum = {0};
    const sk_wide at[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        sk_wide below = node->low[k] - at[k], above = at[k] - node->high[k];
        sk_wide out = sk_select(sk_more(below, above), below, above);
        out = sk_select(sk_more(out, none), out, none);
        sum += out * out;
    }
    return sum;
}

/* From a corner along a side: the square of what is left of the way there from the nearest point of the side. */
SK_INLINE sk_wide trimesh_side(sk_wide3 from, const real side[3], sk_wide along, real per) {
    sk_wide t = along * per;
    t = sk_keep(sk_positive(t), t);
    t = sk_select(sk_more(t, sk_splat(1)), sk_splat(1), t);
    sk_wide3 left = {from.x - t * side[0], from.y - t * side[1], from.z - t * side[2]};
    return sk_dot_wide(left, left);
}

/* The square of the distance to a triangle. */
SK_INLINE sk_wide trimesh_facet(const sk_facet *f, sk_wide3 p) {
    sk_wide3 ap = {p.x - f->a[0], p.y - f->a[1], p.z - f->a[2]};
    sk_wide d1 = ap.x * f->ab[0] + ap.y * f->ab[1] + ap.z * f->ab[2];
    sk_wide d2 = ap.x * f->ac[0] + ap.y * f->ac[1] + ap.z * f->ac[2];
    sk_wide v = (f->cc * d1 - f->bc * d2) * f->per_area, w = (f->bb * d2 - f->bc * d1) * f->per_area;
    sk_wide none = {0};
    sk_mask over = (v >= none) & (w >= none) & sk_at_most(v + w, sk_splat(1));
    sk_wide3 left = {ap.x - v * f->ab[0] - w * f->ac[0], ap.y - v * f->ab[1] - w * f->ac[1],
                     ap.z - v * f->ab[2] - w * f->ac[2]};
    sk_wide square = sk_dot_wide(left, left);
    if (!sk_any(~over)) return square;
    const real bc[3] = {f->ac[0] - f->ab[0], f->ac[1] - f->ab[1], f->ac[2] - f->ab[2]};
    sk_wide3 bp = {ap.x - f->ab[0], ap.y - f->ab[1], ap.z - f->ab[2]};
    sk_wide one = trimesh_side(ap, f->ab, d1, f->per_bb), two = trimesh_side(ap, f->ac, d2, f->per_cc);
    sk_wide three = trimesh_side(bp, bc, d2 - d1 + (f->bb - f->bc), f->per_ee);
    one = sk_select(sk_more(one, two), two, one);
    one = sk_select(sk_more(one, three), three, one);
    return sk_select(over, square, one);
}

SK_INLINE uint32_t trimesh_bits(sk_mask mask) {
    return sk_more_bits(sk_keep(mask, sk_splat(1)), (sk_wide){0});
}

/* In each lane: `best`, the square of how far to look, becomes the nearest triangle's, and `found` its number; -1 where there is none
 * so near. Lanes with a `best` under 0 look nowhere. */
SK_INLINE void trimesh_near(const sk_trimesh *m, sk_wide3 p, sk_wide *best, sk_mask *found) {
    struct {
        sk_wide square;
        uint32_t node;
    } stack[64];
    const real less = (real)0.999, slack = m->slack;
    uint32_t depth = 0, n = 0;
    sk_wide square = trimesh_box(&m->node[0], p);
    *found = (sk_mask){0} - 1;
    for (;;) {
        if (sk_any(sk_at_most(square * less - slack, *best) & ~sk_negative(*best))) {
            const sk_tree_node *node = &m->node[n];
            if (!node->count) {
                sk_wide left = trimesh_box(&m->node[n + 1], p), right = trimesh_box(&m->node[node->first], p);
                uint32_t swap = trimesh_bits(sk_more(left, right)), keep = trimesh_bits(sk_more(right, left));
                bool right_first = __builtin_popcount(swap) > __builtin_popcount(keep);
                stack[depth].node = right_first ? n + 1 : node->first;
                stack[depth++].square = right_first ? left : right;
                n = right_first ? node->first : n + 1;
                square = right_first ? right : left;
                continue;
            }
            for (uint32_t t = node->first; t < node->first + node->count; t++) {
                sk_wide here = trimesh_facet(&m->facet[t], p);
                sk_mask number = (sk_mask){0} + (sk_lane_int)t;
                sk_mask nearer = sk_more(*best, here) | ((here == *best) & ((*found < 0) | (number < *found)));
                *best = sk_select(nearer, here, *best);
                *found = (nearer & number) | (~nearer & *found);
            }
        }
        if (!depth) return;
        n = stack[--depth].node, square = stack[depth].square;
    }
}
