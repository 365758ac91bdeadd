/* Which pairs may come near while their vertices go on, and which lose their gap in a substep, a vector of them at a time. */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT nearing
SK_KERNELS(sk_closing_kernel, corners_closing);
SK_KERNELS(sk_closing_kernel, edges_closing);
SK_KERNELS(sk_nearing_kernel, corners_nearing);
SK_KERNELS(sk_nearing_kernel, edges_nearing);

#ifdef SK_ISA

SK_INLINE sk_wide3 between(sk_wide4 a, sk_wide4 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}

SK_INLINE sk_wide at_least(sk_wide a, real least) {
    return sk_select(sk_more(sk_splat(least), a), sk_splat(least), a);
}

SK_INLINE const sk_wide *part_of(const real *reals, size_t k) {
    return (const sk_wide *)(const void *)(reals + k);
}

SK_INLINE sk_wide least_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(b, a), a, b);
}

SK_INLINE sk_wide most_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(a, b), a, b);
}

SK_INLINE void note_bits(sk_pairs *pairs, size_t k, uint32_t bits) {
    for (size_t l = 0; l < SK_PART; l++) pairs->closes[k + l] = (uint8_t)(bits >> l & 1);
}

/* Where the corners of a part's pairs are along their normals, and after the step. */
SK_INLINE void along(const sk_vec4 *x, const sk_vec4 *step, const sk_pairs *pairs, size_t k, sk_wide at[4],
                     sk_wide after[4]) {
    sk_wide3 n = {*part_of(pairs->normal[0], k), *part_of(pairs->normal[1], k), *part_of(pairs->normal[2], k)};
    sk_wide4 origin = sk_gather(x, pairs->corner[0] + k);
    for (int c = 0; c < 4; c++) {
        sk_wide4 way = sk_gather(step, pairs->corner[c] + k);
        at[c] = c ? sk_dot_wide(n, between(sk_gather(x, pairs->corner[c] + k), origin)) : sk_splat(0);
        after[c] = at[c] + sk_dot_wide(n, (sk_wide3){way.x, way.y, way.z});
    }
}

/* A little more than those that do: they are looked at again, one by one. */
SK_INLINE void note_closing(sk_pairs *pairs, size_t k, sk_wide before, sk_wide after, real least) {
    sk_wide room = at_least(sk_splat((real)0.99 * (1 - SK_LEFT_OVER)) * (before - sk_splat(least)), 0);
    note_bits(pairs, k, sk_more_bits(before - room, after));
}

void SK_KERNEL(corners_closing)(const sk_vec4 *x, const sk_vec4 *step, real least, sk_pairs *pairs) {
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        sk_wide at[4], after[4];
        along(x, step, pairs, k, at, after);
        note_closing(pairs, k, at[0] - most_of(at[1], most_of(at[2], at[3])),
                     after[0] - most_of(after[1], most_of(after[2], after[3])), least);
    }
}

void SK_KERNEL(edges_closing)(const sk_vec4 *x, const sk_vec4 *step, real least, sk_pairs *pairs) {
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        sk_wide at[4], after[4];
        along(x, step, pairs, k, at, after);
        note_closing(pairs, k, least_of(at[0], at[1]) - most_of(at[2], at[3]),
                     least_of(after[0], after[1]) - most_of(after[2], after[3]), least);
    }
}

/* The pair's normal of where it begins keeps it apart while its vertices go on straight, where it does so in the end; or,
 * of a substep, whatever shares of their ways they go. */
SK_INLINE void note_nearing(sk_pairs *pairs, size_t k, const sk_wide4 x[4], const sk_wide4 end[4], int first,
                            const sk_nearing_values *values) {
    sk_wide3 n = {*part_of(pairs->normal[0], k), *part_of(pairs->normal[1], k), *part_of(pairs->normal[2], k)}, way[4];
    sk_wide low = sk_splat(SK_REAL_MAX), high = sk_splat(-SK_REAL_MAX), relative = sk_splat(0);
    sk_wide reach[2] = {sk_splat(0), sk_splat(0)};
    for (int c = 0; c < 4; c++) {
        sk_wide at = sk_dot_wide(n, between(end[c], values->shares > 0 ? x[0] : end[0]));
        if (c < first) low = least_of(low, at);
        else high = most_of(high, at);
        if (values->shares > 0) { // it may stay, too
            at = sk_dot_wide(n, between(x[c], x[0]));
            if (c < first) low = least_of(low, at);
            else high = most_of(high, at);
        }
        reach[c >= first] = most_of(reach[c >= first], x[c].w);
        way[c] = between(end[c], x[c]);
    }
    for (int a = 0; a < first; a++)
        for (int b = first; b < 4; b++) {
            sk_wide3 apart = {way[a].x - way[b].x, way[a].y - way[b].y, way[a].z - way[b].z};
            relative = most_of(relative, sk_dot_wide(apart, apart));
        }
    sk_wide reaches = reach[0] + reach[1], step = sk_splat(values->per) * sk_wide_sqrt(relative);
    sk_wide closing = sk_splat(values->closing) * (step + reaches + reaches);
    sk_wide need = reaches + sk_splat(values->rounding) + most_of(closing, sk_splat(values->near));
    sk_wide distance = *part_of(pairs->distance, k);
    if (values->shares > 0) need = sk_splat(values->shares) * distance + sk_splat(values->near);
    note_bits(pairs, k, sk_more_bits(need, least_of(low - high, distance)));
}

SK_INLINE void nearing(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values, sk_pairs *pairs,
                       int first) {
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        sk_wide4 from[4], to[4];
        for (int c = 0; c < 4; c++)
            from[c] = sk_gather(x, pairs->corner[c] + k), to[c] = sk_gather(end, pairs->corner[c] + k);
        note_nearing(pairs, k, from, to, first, values);
    }
}

void SK_KERNEL(corners_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                                sk_pairs *pairs) {
    nearing(x, end, values, pairs, 1);
}

void SK_KERNEL(edges_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values, sk_pairs *pairs) {
    nearing(x, end, values, pairs, 2);
}
#else
sk_closing_kernel *const sk_closing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_closing),
                                                                    SK_EACH_ISA(edges_closing)};
sk_nearing_kernel *const sk_nearing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_nearing),
                                                                    SK_EACH_ISA(edges_nearing)};
#endif
