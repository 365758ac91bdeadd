/* Which pairs may come near while their vertices go on, and which lose their gap in a substep, a vector of them at a
 * time. */
#include <string.h>

#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT nearing
SK_KERNELS(sk_closing_kernel, corners_closing);
SK_KERNELS(sk_closing_kernel, edges_closing);
SK_KERNELS(sk_nearing_kernel, corners_nearing);
SK_KERNELS(sk_nearing_kernel, edges_nearing);

#ifdef SK_ISA
#include "contact/closest.h"

SK_INLINE const sk_wide *part_of(const real *reals, size_t k) {
    return (const sk_wide *)(const void *)(reals + k);
}

SK_INLINE sk_wide least_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(b, a), a, b);
}

SK_INLINE sk_wide most_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(a, b), a, b);
}

/* How far both features may go towards each other. */
SK_INLINE sk_wide ways_of(const sk_wide4 way[4], int first) {
    sk_wide longest[2] = {sk_splat(0), sk_splat(0)};
    for (int c = 0; c < 4; c++) longest[c >= first] = most_of(longest[c >= first], way[c].w);
    return longest[0] + longest[1];
}

/* What is no nearer than this does not close, whatever shares of their ways its corners go. */
SK_INLINE sk_wide closing_distance(sk_wide ways, const sk_closing_values *values) {
    return sk_splat((real)1.13) * ways + sk_splat(values->least + values->rounding);
}

/* Whether pairs lose their gap along their normals: a little more than those that do, which are looked at one by one.
 */
SK_INLINE uint32_t closing_bits(const sk_vec4 *x, const sk_wide4 way[4], const sk_pairs *pairs, size_t k, int first,
                                real least) {
    sk_wide3 n = {*part_of(pairs->normal[0], k), *part_of(pairs->normal[1], k), *part_of(pairs->normal[2], k)};
    sk_wide4 origin = sk_gather(x, pairs->corner[0] + k);
    sk_wide low = sk_splat(0), high = low, low_after = low, high_after = low;
    for (int c = 0; c < 4; c++) {
        sk_wide at = c ? sk_dot_wide(n, between(sk_gather(x, pairs->corner[c] + k), origin)) : sk_splat(0);
        sk_wide after = at + sk_dot_wide(n, (sk_wide3){way[c].x, way[c].y, way[c].z});
        if (c == 0) low = at, low_after = after;
        else if (c < first) low = least_of(low, at), low_after = least_of(low_after, after);
        else if (c == first) high = at, high_after = after;
        else high = most_of(high, at), high_after = most_of(high_after, after);
    }
    sk_wide before = low - high, after = low_after - high_after;
    sk_wide room = at_least(sk_splat((real)0.99 * (1 - SK_LEFT_OVER)) * (before - sk_splat(least)), 0);
    return sk_more_bits(before - room, after);
}

SK_INLINE void closing(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs,
                       int first) {
    const sk_wide far = closing_distance(sk_splat(2 * values->longest), values);
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        memset(pairs->closes + k, 0, SK_PART);
        sk_wide distance = *part_of(pairs->distance, k);
        if (!sk_more_bits(far, distance)) continue;
        sk_wide4 ways[4];
        for (int c = 0; c < 4; c++) ways[c] = sk_gather(way, pairs->corner[c] + k);
        uint32_t may = sk_more_bits(closing_distance(ways_of(ways, first), values), distance);
        if (!may) continue;
        uint32_t closes = closing_bits(x, ways, pairs, k, first, values->least);
        for (size_t l = 0; l < SK_PART; l++)
            pairs->closes[k + l] = (uint8_t)((may >> l & 1) * (SK_MAY_CLOSE | (closes >> l & 1)));
    }
}

void SK_KERNEL(corners_closing)(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values,
                                sk_pairs *pairs) {
    closing(x, way, values, pairs, 1);
}

void SK_KERNEL(edges_closing)(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs) {
    closing(x, way, values, pairs, 2);
}

/* The pair's normal of where it begins keeps it apart while its vertices go on straight, where it does so in the end;
 * or, of a substep, whatever shares of their ways they go. Bits of those that it does not. */
SK_INLINE uint32_t nearing_bits(const nearest_points *points, const sk_wide4 x[4], const sk_wide4 end[4], int first,
                                const sk_nearing_values *values) {
    const sk_wide3 n = points->normal;
    sk_wide3 way[4];
    sk_wide low = sk_splat(SK_REAL_MAX), high = sk_splat(-SK_REAL_MAX), relative = sk_splat(0);
    sk_wide reach[2] = {sk_splat(0), sk_splat(0)}, jump[2] = {sk_splat(0), sk_splat(0)};
    for (int c = 0; c < 4; c++) {
        sk_wide at = sk_dot_wide(n, between(end[c], values->shares > 0 ? x[0] : end[0]));
        if (c < first) low = least_of(low, at);
        else high = most_of(high, at);
        if (values->shares > 0) { // it may stay, too
            at = sk_dot_wide(n, between(x[c], x[0]));
            if (c < first) low = least_of(low, at);
            else high = most_of(high, at);
            continue;
        }
        reach[c >= first] = most_of(reach[c >= first], x[c].w);
        jump[c >= first] = most_of(jump[c >= first], end[c].w);
        way[c] = between(end[c], x[c]);
    }
    if (values->shares > 0) {
        sk_wide enough = sk_splat(values->shares) * points->distance + sk_splat(values->near);
        return sk_more_bits(enough, least_of(low - high, points->distance));
    }
    for (int a = 0; a < first; a++)
        for (int b = first; b < 4; b++) {
            sk_wide3 apart = {way[a].x - way[b].x, way[a].y - way[b].y, way[a].z - way[b].z};
            relative = most_of(relative, sk_dot_wide(apart, apart));
        }
    sk_wide reaches = reach[0] + reach[1], step = sk_splat(values->per) * sk_wide_sqrt(relative);
    sk_wide closing = sk_splat(values->closing) * (step + jump[0] + jump[1]);
    sk_wide need = reaches + sk_splat(values->rounding) + most_of(closing, sk_splat(values->near));
    return sk_more_bits(need, least_of(low - high, points->distance));
}

/* Takes those of a part over whose bits are set, one after the other. */
SK_INLINE void take_part(const sk_pairs *pairs, size_t k, uint32_t bits, const nearest_points *points,
                         sk_pairs *fresh) {
    size_t n = fresh->count;
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
#define TAKE(to, from) _mm512_storeu_ps((to) + n, _mm512_maskz_compress_ps((__mmask16)bits, (__m512)(from)))
#define TAKE_WHOLE(to, from, mask) \
    _mm512_storeu_si512((to), _mm512_maskz_compress_epi64((__mmask8)(mask), _mm512_loadu_si512(from)))
    for (int c = 0; c < 4; c++)
        _mm512_storeu_si512(fresh->corner[c] + n,
                            _mm512_maskz_compress_epi32((__mmask16)bits, _mm512_loadu_si512(pairs->corner[c] + k)));
    TAKE(fresh->distance, points->distance);
    TAKE(fresh->normal[0], points->normal.x), TAKE(fresh->normal[1], points->normal.y),
        TAKE(fresh->normal[2], points->normal.z);
    TAKE(fresh->share[0], points->share[0]), TAKE(fresh->share[1], points->share[1]);
    TAKE_WHOLE(fresh->key + n, pairs->key + k, bits & 0xff);
    TAKE_WHOLE(fresh->key + n + __builtin_popcount(bits & 0xff), pairs->key + k + 8, bits >> 8);
    fresh->count = n + (size_t)__builtin_popcount(bits);
#undef TAKE
#undef TAKE_WHOLE
#else
    SK_VECTOR_ALIGNED real distance[SK_PART], normal[3][SK_PART], share[2][SK_PART];
    memcpy(distance, &points->distance, sizeof distance);
    memcpy(normal, &points->normal, sizeof normal);
    memcpy(share, points->share, sizeof share);
    for (; bits; bits &= bits - 1, n++) {
        size_t l = (size_t)__builtin_ctz(bits);
        for (int c = 0; c < 4; c++) fresh->corner[c][n] = pairs->corner[c][k + l];
        fresh->key[n] = pairs->key[k + l];
        fresh->distance[n] = distance[l];
        for (int c = 0; c < 3; c++) fresh->normal[c][n] = normal[c][l];
        for (int c = 0; c < 2; c++) fresh->share[c][n] = share[c][l];
    }
    fresh->count = n;
#endif
}

SK_INLINE void nearing(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values, const sk_pairs *pairs,
                       sk_pairs *fresh, int sort) {
    for (size_t k = 0; k < pairs->count; k += SK_PART) {
        sk_wide4 from[4], to[4];
        for (int c = 0; c < 4; c++)
            from[c] = sk_gather(x, pairs->corner[c] + k), to[c] = sk_gather(end, pairs->corner[c] + k);
        nearest_points points = nearest_points_of(from, sort);
        uint32_t bits = nearing_bits(&points, from, to, sort == SK_EDGES ? 2 : 1, values);
        if (pairs->count - k < SK_PART) bits &= (1u << (pairs->count - k)) - 1; // the rest of a block is nobody's
        take_part(pairs, k, bits, &points, fresh);
    }
}

void SK_KERNEL(corners_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                                const sk_pairs *pairs, sk_pairs *fresh) {
    nearing(x, end, values, pairs, fresh, SK_CORNERS);
}

void SK_KERNEL(edges_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                              const sk_pairs *pairs, sk_pairs *fresh) {
    nearing(x, end, values, pairs, fresh, SK_EDGES);
}
#else
sk_closing_kernel *const sk_closing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_closing),
                                                                    SK_EACH_ISA(edges_closing)};
sk_nearing_kernel *const sk_nearing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_nearing),
                                                                    SK_EACH_ISA(edges_nearing)};
#endif
