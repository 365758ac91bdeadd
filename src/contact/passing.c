/* Whether features of a pair come near each other on straight ways: looked at at so many moments, a vector of them at a time, and
 * between two of these they come no nearer than by half of what they go there. */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT passing
SK_KERNELS(sk_passes_kernel, corners);
SK_KERNELS(sk_passes_kernel, edges);

#ifdef SK_ISA
#include "contact/closest.h"
#include "contact/lanes.h"

enum { MOMENTS = 64 };

SK_INLINE bool passes(const sk_vec3 x[2][4], real near, int sort) {
    const int first = sort == SK_EDGES ? 2 : 1;
    sk_vec3 way[4];
    real longest = 0;
    for (int c = 0; c < 4; c++) way[c] = sk_sub(x[1][c], x[0][c]);
    for (int a = 0; a < first; a++)
        for (int b = first; b < 4; b++) {
            const sk_vec3 apart = sk_sub(way[a], way[b]);
            longest = sk_max(longest, sk_dot(apart, apart));
        }
    const sk_wide least = sk_splat(near + sk_sqrt(longest) / (2 * MOMENTS));
    for (int m = 0; m < MOMENTS; m += SK_PART) {
        sk_wide at;
        for (int l = 0; l < SK_PART; l++) at[l] = ((real)(m + l) + (real)0.5) / MOMENTS;
        sk_wide4 corner[4];
        for (int c = 0; c < 4; c++) {
            corner[c].x = sk_splat(x[0][c].x) + at * sk_splat(way[c].x);
            corner[c].y = sk_splat(x[0][c].y) + at * sk_splat(way[c].y);
            corner[c].z = sk_splat(x[0][c].z) + at * sk_splat(way[c].z);
            corner[c].w = sk_splat(0);
        }
        const nearest_points points = nearest_points_of(corner, sort);
        if (sk_more_bits(least, points.distance)) return true;
    }
    return false;
}

bool SK_KERNEL(corners)(const sk_vec3 x[2][4], real near) {
    return passes(x, near, SK_CORNERS);
}

bool SK_KERNEL(edges)(const sk_vec3 x[2][4], real near) {
    return passes(x, near, SK_EDGES);
}
#else
sk_passes_kernel *const sk_passes[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners), SK_EACH_ISA(edges)};
#endif
