/* Nearest points of pairs that are kept, and which are near (closest.h). */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT closest
SK_KERNELS(sk_closest_kernel, corners);
SK_KERNELS(sk_closest_kernel, edges);

#ifdef SK_ISA
#include "contact/closest.h"

SK_INLINE sk_wide *part_of(real *reals, size_t k) {
    return (sk_wide *)(void *)(reals + k);
}

SK_INLINE void note_near(sk_pairs *pairs, size_t k, sk_wide distance) {
    sk_wide near = sk_splat(SK_NEAR_THICKNESSES) * *part_of(pairs->thickness, k);
    uint32_t bits = sk_more_bits(near, distance);
    for (size_t l = 0; l < SK_PART; l++) pairs->closes[k + l] = (uint8_t)((bits >> l & 1) * SK_IS_NEAR);
}

SK_INLINE void look_at(const sk_vec4 *x, sk_pairs *pairs, int sort) {
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        sk_wide4 corner[4];
        for (int c = 0; c < 4; c++) corner[c] = sk_gather(x, pairs->corner[c] + k);
        nearest_points points = nearest_points_of(corner, sort);
        *part_of(pairs->distance, k) = points.distance;
        *part_of(pairs->normal[0], k) = points.normal.x;
        *part_of(pairs->normal[1], k) = points.normal.y;
        *part_of(pairs->normal[2], k) = points.normal.z;
        for (int c = 0; c < 2; c++) *part_of(pairs->share[c], k) = points.share[c];
        note_near(pairs, k, points.distance);
    }
}

void SK_KERNEL(corners)(const sk_vec4 *x, sk_pairs *pairs) {
    look_at(x, pairs, SK_CORNERS);
}

void SK_KERNEL(edges)(const sk_vec4 *x, sk_pairs *pairs) {
    look_at(x, pairs, SK_EDGES);
}
#else
sk_closest_kernel *const sk_closest[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners), SK_EACH_ISA(edges)};
#endif
