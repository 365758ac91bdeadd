/* Which side is whose, where two surfaces begin in one place: one and the same for all of their pairs. Distances of nothing leave it to
 * rounding, which has it another way from pair to pair, and what is pushed to and fro gains energy in every substep: two cubes of 1 m, one right on
 * top of the other, had 2 to 54 J for good, and 1e-6 m above each other came to rest. */
#include "contact/touch.h"

/* The mean of its triangles' normals by their areas, of any length. */
static sk_vec3 normal_at(const sk_touch *touch, uint32_t v) {
    const sk_skin *skin = &touch->skin;
    sk_vec3 sum = {0, 0, 0};
    for (uint32_t i = skin->leaf_start[v]; i < skin->leaf_start[v + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++) {
            const uint32_t *corner = skin->triangle[t];
            if (corner[0] != v && corner[1] != v && corner[2] != v) continue;
            const sk_vec3 a = sk_xyz(touch->p[corner[0]]), b = sk_xyz(touch->p[corner[1]]),
                          c = sk_xyz(touch->p[corner[2]]);
            sum = sk_add(sum, sk_cross(sk_sub(b, a), sk_sub(c, a)));
        }
    }
    return sum;
}

static sk_vec3 unit(sk_vec3 a) {
    const real length = sk_length(a);
    return length > 0 ? sk_scale(1 / length, a) : (sk_vec3){0, 0, 0};
}

/* As the faces of a feature look, of which `count` corners begin at one. */
static sk_vec3 facing(const sk_touch *touch, const sk_pairs *pairs, size_t k, int first, int count) {
    uint32_t v[3] = {0};
    for (int c = 0; c < count; c++) v[c] = pairs->corner[first + c][k];
    if (count == 3) {
        const sk_vec3 a = sk_xyz(touch->p[v[0]]);
        return unit(sk_cross(sk_sub(sk_xyz(touch->p[v[1]]), a), sk_sub(sk_xyz(touch->p[v[2]]), a)));
    }
    sk_vec3 sum = {0, 0, 0};
    for (int c = 0; c < count; c++) sum = sk_add(sum, unit(normal_at(touch, v[c])));
    return unit(sum);
}

/* Where solids have faces in one plane, as many begin that somebody piles up, no edge goes through a triangle: it lies in it. So of two
 * solids the later one is taken to be a little farther along an axis that no mesh has, by less than the least gap that a bound leaves. */
sk_vec3 sk_touch_aside(const sk_touch *touch, uint32_t one, uint32_t other) {
    const sk_skin *skin = &touch->skin;
    const uint32_t a = skin->piece[one], b = skin->piece[other];
    if (a == b || !skin->closed[a] || !skin->closed[b]) return (sk_vec3){0, 0, 0};
    const real far = (real)0.5 * SK_LEAST_GAP * touch->thickness * (a > b ? 1 : -1);
    return (sk_vec3){(real)0.7 * far, (real)0.6 * far, (real)0.37 * far};
}

/* Who touches a solid goes out of it; or, where faces of two look about the same way, to where it is taken to be. Of two sheets that with
 * the lesser number is behind the other, as its own faces look. */
static void choose_side(const sk_touch *touch, sk_pairs *pairs, int sort, size_t k) {
    const real alike =
        (real)0.45; // a cube's corner and an edge of it are by 0.8, corners of cubes that stand on each other by 0.33
    const int split = sort == SK_EDGES ? 2 : 1;
    const uint32_t first = pairs->corner[0][k], second = pairs->corner[split][k];
    const uint32_t a = touch->skin.piece[first], b = touch->skin.piece[second];
    if (a == b) return;
    const int of_a = touch->skin.closed[a], of_b = touch->skin.closed[b];
    sk_vec3 out_of[2] = {{0, 0, 0}, {0, 0, 0}};
    if (of_a || (!of_b && a < b)) out_of[0] = sk_scale(of_a < 0 ? -1 : 1, facing(touch, pairs, k, 0, split));
    if (of_b || (!of_a && a > b)) out_of[1] = sk_scale(of_b < 0 ? -1 : 1, facing(touch, pairs, k, split, 4 - split));
    const sk_vec3 n = unit(sk_dot(out_of[0], out_of[1]) > alike ? sk_touch_aside(touch, first, second)
                                                                : sk_sub(out_of[1], out_of[0]));
    if (!(sk_dot(n, n) > 0)) return;
    pairs->normal[0][k] = n.x, pairs->normal[1][k] = n.y, pairs->normal[2][k] = n.z;
}

void sk_touch_choose_side(sk_touch *touch, int sort, uint32_t entry) {
    __atomic_store_n(&touch->tangle.forced, true,
                     __ATOMIC_RELAXED); // it may be the wrong one all the same; threads choose for several
    choose_side(touch, entry & 1 ? &touch->late[sort] : &touch->kept[sort], sort, entry / 2);
}

void sk_touch_choose_sides(sk_touch *touch) {
    const real none = SK_NO_GAP * touch->thickness;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->near[sort].count; i++) {
            const uint32_t entry = touch->near[sort].data[i];
            if (sk_pairs_of(touch, sort, entry)->distance[entry / 2] < none) sk_touch_choose_side(touch, sort, entry);
        }
}
