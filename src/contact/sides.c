/* Which side is whose, where two open surfaces begin in one place: one and the same for all of their pairs. Distances of nothing leave it to
 * rounding, which has it another way from pair to pair, and what is pushed to and fro gains energy in every substep. */
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
            const sk_vec3 a = sk_xyz(touch->p[corner[0]]), b = sk_xyz(touch->p[corner[1]]), c = sk_xyz(touch->p[corner[2]]);
            sum = sk_add(sum, sk_cross(sk_sub(b, a), sk_sub(c, a)));
        }
    }
    return sum;
}

/* The surface with the lesser number is behind the other, as its own faces look. Of two solids one would be in the other's skin so. */
static void choose_side(const sk_touch *touch, sk_pairs *pairs, size_t k) {
    const uint32_t first = pairs->corner[0][k], second = pairs->corner[2][k]; // of features that see each other
    const uint32_t a = touch->skin.piece[first], b = touch->skin.piece[second];
    if (a == b || (touch->skin.closed[a] && touch->skin.closed[b])) return;
    const sk_vec3 n = normal_at(touch, a < b ? first : second);
    const real square = sk_dot(n, n);
    if (!(square > 0)) return;
    const real scale = (a < b ? -1 : 1) / sk_sqrt(square);
    pairs->normal[0][k] = scale * n.x, pairs->normal[1][k] = scale * n.y, pairs->normal[2][k] = scale * n.z;
}

void sk_touch_choose_side(sk_touch *touch, int sort, uint32_t entry) {
    touch->tangle.forced = true; // it may be the wrong one all the same
    choose_side(touch, entry & 1 ? &touch->late[sort] : &touch->kept[sort], entry / 2);
}

void sk_touch_choose_sides(sk_touch *touch) {
    const real none = SK_NO_GAP * touch->thickness;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        for (size_t i = 0; i < touch->near[sort].count; i++) {
            const uint32_t entry = touch->near[sort].data[i];
            if (sk_pairs_of(touch, sort, entry)->distance[entry / 2] < none) sk_touch_choose_side(touch, sort, entry);
        }
}
