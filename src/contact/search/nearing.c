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
#include "contact/lanes.h"
#include "contact/search/bits.h"

SK_INLINE const sk_wide *part_of(const real *reals, size_t k) {
    return (const sk_wide *)(const void *)(reals + k);
}

/* How far both features may go towards each other. */
SK_INLINE sk_wide ways_of(const sk_wide4 way[4], int first) {
    sk_wide longest[2] = {sk_splat(0), sk_splat(0)};
    for (int c = 0; c < 4; c++) longest[c >= first] = sk_most_wide(longest[c >= first], way[c].w);
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
        else if (c < first) low = sk_least_wide(low, at), low_after = sk_least_wide(low_after, after);
        else if (c == first) high = at, high_after = after;
        else high = sk_most_wide(high, at), high_after = sk_most_wide(high_after, after);
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

void SK_KERNEL(corners_closing)(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs) {
    closing(x, way, values, pairs, 1);
}

void SK_KERNEL(edges_closing)(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs) {
    closing(x, way, values, pairs, 2);
}

/* What lies on a side, along a normal: the least of the first feature's corners and the most of the second's. */
typedef struct sides {
    sk_wide low, high;
} sides;

SK_INLINE sides with_corner(sides s, bool first, sk_wide3 n, sk_wide3 apart) {
    sk_wide at = sk_dot_wide(n, apart);
    if (first) s.low = sk_least_wide(s.low, at);
    else s.high = sk_most_wide(s.high, at);
    return s;
}

/* The pair's normal of where it begins keeps it apart while its vertices go on straight, where it does so in the end.
 * Bits of those that it does not. */
SK_INLINE uint32_t nearing_bits(const nearest_points *points, const sk_wide4 x[4], const sk_wide4 end[4], int first,
                                const sk_nearing_values *values) {
    sides s = {sk_splat(SK_REAL_MAX), sk_splat(-SK_REAL_MAX)};
    sk_wide relative = sk_splat(0), reach[2] = {sk_splat(0), sk_splat(0)}, jump[2] = {sk_splat(0), sk_splat(0)};
    sk_wide3 way[4];
    for (int c = 0; c < 4; c++) {
        s = with_corner(s, c < first, points->normal, between(end[c], end[0]));
        reach[c >= first] = sk_most_wide(reach[c >= first], x[c].w);
        jump[c >= first] = sk_most_wide(jump[c >= first], end[c].w);
        way[c] = between(end[c], x[c]);
    }
    for (int a = 0; a < first; a++)
        for (int b = first; b < 4; b++) {
            sk_wide3 apart = {way[a].x - way[b].x, way[a].y - way[b].y, way[a].z - way[b].z};
            relative = sk_most_wide(relative, sk_dot_wide(apart, apart));
        }
    sk_wide reaches = reach[0] + reach[1], step = sk_splat(values->per) * sk_wide_sqrt(relative);
    sk_wide closing = sk_splat(values->closing) * (step + jump[0] + jump[1]);
    sk_wide need = reaches + sk_splat(values->rounding) + sk_most_wide(closing, sk_splat(values->near));
    return sk_more_bits(need, sk_least_wide(s.low - s.high, points->distance));
}

/* The same of a substep, whatever shares of their ways they go. */
SK_INLINE uint32_t nearing_on_ways(const nearest_points *points, const sk_wide4 x[4], const sk_wide4 end[4], int first,
                                   const sk_nearing_values *values) {
    sides s = {sk_splat(SK_REAL_MAX), sk_splat(-SK_REAL_MAX)};
    sk_wide reach[2] = {sk_splat(0), sk_splat(0)};
    for (int c = 0; c < 4; c++) { // it may stay, too
        s = with_corner(s, c < first, points->normal, between(end[c], x[0]));
        s = with_corner(s, c < first, points->normal, between(x[c], x[0]));
        reach[c >= first] = sk_most_wide(reach[c >= first], x[c].w);
    }
    sk_wide need = sk_splat(values->shares) * points->distance + sk_splat(values->near) + (reach[0] + reach[1]);
    return sk_more_bits(need, sk_least_wide(s.low - s.high, points->distance));
}

/* Some pairs at once: their corners where they begin and end, where they are nearest, and which of them are found. Each
 * is a loop by itself, whose rounds overlap: what takes long in one would hold up all that follows in the same. */
enum { AT_ONCE = 64, AT_ONCE_PARTS = AT_ONCE / SK_PART };
typedef struct looked_at {
    sk_wide4 from[AT_ONCE_PARTS][4], to[AT_ONCE_PARTS][4];
    SK_VECTOR_ALIGNED real distance[AT_ONCE], normal[3][AT_ONCE], share[2][AT_ONCE];
    uint64_t mask;
} looked_at;

SK_INLINE sk_wide *lanes_of(real *reals, size_t part) {
    return (sk_wide *)(void *)(reals + part * SK_PART);
}

SK_INLINE void note_points(looked_at *some, size_t part, const nearest_points *points) {
    *lanes_of(some->distance, part) = points->distance;
    *lanes_of(some->normal[0], part) = points->normal.x;
    *lanes_of(some->normal[1], part) = points->normal.y;
    *lanes_of(some->normal[2], part) = points->normal.z;
    for (int c = 0; c < 2; c++) *lanes_of(some->share[c], part) = points->share[c];
}

SK_INLINE nearest_points points_of(looked_at *some, size_t part) {
    return (nearest_points){.distance = *lanes_of(some->distance, part),
                            .normal = {*lanes_of(some->normal[0], part), *lanes_of(some->normal[1], part),
                                       *lanes_of(some->normal[2], part)}};
}

SK_INLINE void look_at(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values, const sk_pairs *pairs,
                       size_t begin, size_t parts, int sort, bool ways, looked_at *some) {
    const int first = sort == SK_EDGES ? 2 : 1;
    for (size_t p = 0; p < parts; p++)
        for (int c = 0; c < 4; c++) {
            some->from[p][c] = sk_gather(x, pairs->corner[c] + begin + p * SK_PART);
            some->to[p][c] = sk_gather(end, pairs->corner[c] + begin + p * SK_PART);
        }
    for (size_t p = 0; p < parts; p++) {
        nearest_points points = nearest_points_of(some->from[p], sort);
        note_points(some, p, &points);
    }
    some->mask = 0;
    for (size_t p = 0; p < parts; p++) {
        nearest_points points = points_of(some, p);
        uint32_t bits = ways ? nearing_on_ways(&points, some->from[p], some->to[p], first, values)
                             : nearing_bits(&points, some->from[p], some->to[p], first, values);
        some->mask |= (uint64_t)bits << p * SK_PART;
    }
}

#if SK_WIDTH == 64

SK_INLINE void take_numbers(uint32_t *to, const uint32_t *from, uint64_t mask, size_t count) {
    for (size_t k = 0; k < count; k += 16, mask >>= 16) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi32((__mmask16)mask, _mm512_loadu_si512(from + k)));
        to += __builtin_popcountll(mask & 0xffff);
    }
}

SK_INLINE void take_long_numbers(uint64_t *to, const uint64_t *from, uint64_t mask, size_t count) {
    for (size_t k = 0; k < count; k += 8, mask >>= 8) {
        _mm512_storeu_si512(to, _mm512_maskz_compress_epi64((__mmask8)mask, _mm512_loadu_si512(from + k)));
        to += __builtin_popcountll(mask & 0xff);
    }
}

SK_INLINE void take_reals(real *to, const real *from, uint64_t mask, size_t count) {
    if (sizeof(real) == sizeof(uint32_t))
        take_numbers((uint32_t *)(void *)to, (const uint32_t *)(const void *)from, mask, count);
    else take_long_numbers((uint64_t *)(void *)to, (const uint64_t *)(const void *)from, mask, count);
}

/* Takes those over that are found. */
SK_INLINE void take_found(const looked_at *some, const sk_pairs *pairs, size_t begin, size_t count, sk_pairs *fresh) {
    const size_t n = fresh->count;
    const uint64_t mask = some->mask;
    for (int c = 0; c < 4; c++) take_numbers(fresh->corner[c] + n, pairs->corner[c] + begin, mask, count);
    take_long_numbers(fresh->key + n, pairs->key + begin, mask, count);
    take_reals(fresh->distance + n, some->distance, mask, count);
    for (int c = 0; c < 3; c++) take_reals(fresh->normal[c] + n, some->normal[c], mask, count);
    for (int c = 0; c < 2; c++) take_reals(fresh->share[c] + n, some->share[c], mask, count);
    fresh->count = n + (size_t)__builtin_popcountll(mask);
}

#else

SK_INLINE void take_found(const looked_at *some, const sk_pairs *pairs, size_t begin, size_t count, sk_pairs *fresh) {
    uint32_t which[AT_ONCE + SK_BITS_AFTER];
    count = sk_list_bits(which, 0, some->mask, AT_ONCE, 0);
    for (size_t i = 0, n = fresh->count; i < count; i++, n++) {
        const size_t k = which[i];
        for (int c = 0; c < 4; c++) fresh->corner[c][n] = pairs->corner[c][begin + k];
        fresh->key[n] = pairs->key[begin + k];
        fresh->distance[n] = some->distance[k];
        for (int c = 0; c < 3; c++) fresh->normal[c][n] = some->normal[c][k];
        for (int c = 0; c < 2; c++) fresh->share[c][n] = some->share[c][k];
    }
    fresh->count += count;
}

#endif

SK_INLINE void nearing(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values, const sk_pairs *pairs,
                       sk_pairs *fresh, int sort, bool ways) {
    looked_at some;
    for (size_t begin = 0; begin < pairs->count; begin += AT_ONCE) {
        const size_t left = pairs->count - begin, count = left < AT_ONCE ? left : AT_ONCE;
        look_at(x, end, values, pairs, begin, (count + SK_PART - 1) / SK_PART, sort, ways, &some);
        if (left < AT_ONCE) some.mask &= ((uint64_t)1 << left) - 1; // the rest of a block is nobody's
        take_found(&some, pairs, begin, count, fresh);
    }
}

void SK_KERNEL(corners_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                                const sk_pairs *pairs, sk_pairs *fresh) {
    if (values->shares > 0) nearing(x, end, values, pairs, fresh, SK_CORNERS, true);
    else nearing(x, end, values, pairs, fresh, SK_CORNERS, false);
}

void SK_KERNEL(edges_nearing)(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                              const sk_pairs *pairs, sk_pairs *fresh) {
    if (values->shares > 0) nearing(x, end, values, pairs, fresh, SK_EDGES, true);
    else nearing(x, end, values, pairs, fresh, SK_EDGES, false);
}
#else
sk_closing_kernel *const sk_closing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_closing),
                                                                    SK_EACH_ISA(edges_closing)};
sk_nearing_kernel *const sk_nearing[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners_nearing),
                                                                    SK_EACH_ISA(edges_nearing)};
#endif
