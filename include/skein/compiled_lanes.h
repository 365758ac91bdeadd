/* Sixteen elements at a time, or as many as the processor works on at once: numbers, the operations of formulas with
 * their guards, and particles on their way in and out. For compiled_walk.h, which see; without a formula there is
 * nothing here. Lanes do not meet, so that their number does not matter for the bits. */
#ifndef SKEIN_COMPILED_LANES_H
#define SKEIN_COMPILED_LANES_H

#include <skein/compiled.h>

#ifdef SKEIN_PARTICLES

#ifdef __FAST_MATH__
#error "-ffast-math would take the guards away, and give other bits: compile this file without it"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF // no fused operations: they round otherwise
#define SKEIN_UNROLLED
#else
#pragma GCC optimize("fp-contract=off,no-math-errno")
#define SKEIN_UNROLLED _Pragma("GCC unroll 8")
#endif
#pragma GCC diagnostic ignored "-Wpsabi" // all that takes or returns vectors is inlined

#include <string.h>
#ifdef __x86_64__
#include <immintrin.h>
#endif

/* ---- lanes: as many as the processor works on at once, but four ---- */

#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512BW__) && defined(__AVX512VL__)
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_AVX512
#define SKEIN_LANE_BYTES 64
#elif defined(__AVX2__)
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_AVX2
#define SKEIN_LANE_BYTES 32
#else
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_PLAIN
#ifdef SKEIN_DOUBLE
#define SKEIN_LANE_BYTES 32
#else
#define SKEIN_LANE_BYTES 16
#endif
#endif
#ifdef SKEIN_DOUBLE
#define SKEIN_LANES (SKEIN_LANE_BYTES / 8)
typedef int64_t skein_lane_int;
#else
#define SKEIN_LANES (SKEIN_LANE_BYTES / 4)
typedef int32_t skein_lane_int;
#endif

#define SKEIN_INLINE static inline __attribute__((always_inline, unused))

typedef skein_real skein_lanes __attribute__((vector_size(SKEIN_LANE_BYTES)));
typedef skein_lane_int skein_mask __attribute__((vector_size(SKEIN_LANE_BYTES))); /* -1 or 0 a lane */
typedef skein_real skein_quad __attribute__((vector_size(4 * sizeof(skein_real))));
typedef skein_lanes skein_lanes_in_memory __attribute__((may_alias));

SKEIN_INLINE skein_lanes skein_splat(skein_real a) {
    return a - (skein_lanes){0};
}
SKEIN_INLINE skein_lanes skein_keep(skein_mask mask, skein_lanes yes) {
    return (skein_lanes)(mask & (skein_mask)yes);
}
SKEIN_INLINE skein_lanes skein_select(skein_mask mask, skein_lanes yes, skein_lanes no) {
    return (skein_lanes)((mask & (skein_mask)yes) | (~mask & (skein_mask)no));
}
SKEIN_INLINE skein_lanes skein_abs(skein_lanes a) {
    const skein_lane_int all_but_sign = (skein_lane_int)((uint64_t)-1 >> (65 - 8 * sizeof(skein_real)));
    return (skein_lanes)((skein_mask)a & all_but_sign);
}
SKEIN_INLINE skein_lanes skein_square_root(skein_lanes a) {
#if defined(__AVX512F__) && SKEIN_LANE_BYTES == 64 && defined(SKEIN_DOUBLE)
    return (skein_lanes)_mm512_sqrt_pd((__m512d)a);
#elif defined(__AVX512F__) && SKEIN_LANE_BYTES == 64
    return (skein_lanes)_mm512_sqrt_ps((__m512)a);
#elif defined(__AVX__) && defined(SKEIN_DOUBLE)
    return (skein_lanes)_mm256_sqrt_pd((__m256d)a);
#elif defined(__AVX2__)
    return (skein_lanes)_mm256_sqrt_ps((__m256)a);
#elif defined(__x86_64__) && !defined(SKEIN_DOUBLE)
    return (skein_lanes)_mm_sqrt_ps((__m128)a);
#elif defined(SKEIN_DOUBLE)
    for (int l = 0; l < SKEIN_LANES; l++) a[l] = __builtin_sqrt(a[l]);
    return a;
#else
    for (int l = 0; l < SKEIN_LANES; l++) a[l] = __builtin_sqrtf(a[l]);
    return a;
#endif
}
SKEIN_INLINE skein_lanes skein_load(const skein_real *from) {
    return *(const skein_lanes_in_memory *)(const void *)from;
}
SKEIN_INLINE void skein_store(skein_real *to, skein_lanes a) {
    *(skein_lanes_in_memory *)(void *)to = a;
}

/* ---- the formula's operations, with the guards of docs/formula.md ---- */

#ifdef SKEIN_DOUBLE
#define SKEIN_LEAST 2.2250738585072014e-308
#define SKEIN_MOST_EXP 709.0
#else
#define SKEIN_LEAST 1.17549435e-38f
#define SKEIN_MOST_EXP 88.0f
#endif

SKEIN_INLINE skein_lanes skein_reciprocal(skein_lanes x) {
    return skein_keep(skein_splat(SKEIN_LEAST) <= skein_abs(x), 1 / x);
}
SKEIN_INLINE skein_lanes skein_guarded_root(skein_lanes x) {
    return skein_square_root(skein_keep((skein_lanes){0} <= x, x));
}
SKEIN_INLINE skein_lanes skein_call(skein_function *function, skein_lanes x) {
    skein_lanes out;
    function((const skein_real *)&x, (skein_real *)&out, SKEIN_LANES);
    return out;
}
SKEIN_INLINE skein_lanes skein_call_two(skein_function_of_two *function, skein_lanes x, skein_lanes y) {
    skein_lanes out;
    function((const skein_real *)&x, (const skein_real *)&y, (skein_real *)&out, SKEIN_LANES);
    return out;
}
SKEIN_INLINE skein_lanes skein_guarded_exp(const skein_elementary *f, skein_lanes x) {
    skein_lanes most = skein_splat(SKEIN_MOST_EXP);
    return skein_call(f->exp, skein_select(x <= most, x, most));
}
SKEIN_INLINE skein_lanes skein_guarded_log(const skein_elementary *f, skein_lanes x) {
    skein_lanes least = skein_splat(SKEIN_LEAST);
    return skein_call(f->log, skein_select(least <= x, x, least));
}
SKEIN_INLINE skein_lanes skein_guarded_pow(const skein_elementary *f, skein_lanes x, skein_lanes y) {
    skein_lanes one = skein_splat(1), zero = {0};
    skein_lanes power = skein_keep(x > zero, skein_call_two(f->pow, skein_select(x > zero, x, one), y));
    return skein_select(y != zero, power, one);
}
SKEIN_INLINE skein_lanes skein_within_one(skein_lanes x) {
    skein_lanes one = skein_splat(1);
    x = skein_select(x > one, one, x);
    return skein_select(-one > x, -one, x);
}

/* ---- particles in and out ---- */

#if SKEIN_LANES == 4
#define SKEIN_LOW(a, b) __builtin_shufflevector(a, b, 0, 4, 1, 5)
#define SKEIN_HIGH(a, b) __builtin_shufflevector(a, b, 2, 6, 3, 7)
#define SKEIN_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 4, 5)
#define SKEIN_LAST(a, b) __builtin_shufflevector(a, b, 2, 3, 6, 7)
#elif SKEIN_LANES == 8
#define SKEIN_LOW(a, b) __builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13)
#define SKEIN_HIGH(a, b) __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15)
#define SKEIN_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13)
#define SKEIN_LAST(a, b) __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15)
#else
#define SKEIN_LOW(a, b) __builtin_shufflevector(a, b, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29)
#define SKEIN_HIGH(a, b) __builtin_shufflevector(a, b, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31)
#define SKEIN_FIRST(a, b) __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29)
#define SKEIN_LAST(a, b) __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31)
#endif

/* In each four lanes rows become columns, and back: q[k] holds the quads of particles k, 4 + k, 8 + k, 12 + k. */
SKEIN_INLINE void skein_transpose(skein_lanes q[4]) {
    skein_lanes xy01 = SKEIN_LOW(q[0], q[1]), zw01 = SKEIN_HIGH(q[0], q[1]);
    skein_lanes xy23 = SKEIN_LOW(q[2], q[3]), zw23 = SKEIN_HIGH(q[2], q[3]);
    q[0] = SKEIN_FIRST(xy01, xy23), q[1] = SKEIN_LAST(xy01, xy23);
    q[2] = SKEIN_FIRST(zw01, zw23), q[3] = SKEIN_LAST(zw01, zw23);
}

SKEIN_INLINE const skein_real *skein_quad_at(const skein_real *vector, uint32_t slot) {
    return vector + 4 * (size_t)slot;
}

/* The quads of every fourth slot side by side, and back. In float by instructions that put a quad from memory into its
 * place, which leaves the one unit that shuffles to the transposing. */
SKEIN_INLINE skein_lanes skein_join(const skein_real *vector, const uint32_t *slot) {
#if SKEIN_LANES == 16
    __m256 low = _mm256_castps128_ps256(_mm_load_ps(skein_quad_at(vector, slot[0])));
    low = _mm256_insertf128_ps(low, _mm_load_ps(skein_quad_at(vector, slot[4])), 1);
    __m512 all = _mm512_castps256_ps512(low);
    all = _mm512_insertf32x4(all, _mm_load_ps(skein_quad_at(vector, slot[8])), 2);
    return (skein_lanes)_mm512_insertf32x4(all, _mm_load_ps(skein_quad_at(vector, slot[12])), 3);
#elif SKEIN_LANES == 8 && SKEIN_LANE_BYTES == 32
    __m256 low = _mm256_castps128_ps256(_mm_load_ps(skein_quad_at(vector, slot[0])));
    return (skein_lanes)_mm256_insertf128_ps(low, _mm_load_ps(skein_quad_at(vector, slot[4])), 1);
#else
    skein_lanes out;
    for (int i = 0; i < SKEIN_LANES / 4; i++)
        memcpy((skein_real *)&out + 4 * i, skein_quad_at(vector, slot[4 * i]), sizeof(skein_quad));
    return out;
#endif
}

SKEIN_INLINE void skein_part(skein_real *vector, const uint32_t *slot, skein_lanes q) {
#if SKEIN_LANES == 16
    _mm_store_ps(vector + 4 * (size_t)slot[0], _mm512_castps512_ps128((__m512)q));
    _mm_store_ps(vector + 4 * (size_t)slot[4], _mm512_extractf32x4_ps((__m512)q, 1));
    _mm_store_ps(vector + 4 * (size_t)slot[8], _mm512_extractf32x4_ps((__m512)q, 2));
    _mm_store_ps(vector + 4 * (size_t)slot[12], _mm512_extractf32x4_ps((__m512)q, 3));
#elif SKEIN_LANES == 8 && SKEIN_LANE_BYTES == 32
    _mm_store_ps(vector + 4 * (size_t)slot[0], _mm256_castps256_ps128((__m256)q));
    _mm_store_ps(vector + 4 * (size_t)slot[4], _mm256_extractf128_ps((__m256)q, 1));
#else
    for (int i = 0; i < SKEIN_LANES / 4; i++)
        memcpy(vector + 4 * (size_t)slot[4 * i], (const skein_real *)&q + 4 * i, sizeof(skein_quad));
#endif
}

/* Where a slot's x is, and how far y, z and w are from each other. */
SKEIN_INLINE size_t skein_place(size_t packed, size_t slot, size_t *stride) {
    *stride = slot < packed ? 16 : 1;
    return slot < packed ? (slot & ~(size_t)15) * 4 + (slot & 15) : slot * 4;
}

/* Lanes are particles, q[0] their x, and so on. */
SKEIN_INLINE void skein_gather(skein_lanes q[4], const skein_real *vector, size_t packed, const uint32_t *slot) {
    if (!packed) {
        for (int k = 0; k < 4; k++) q[k] = skein_join(vector, slot + k);
        skein_transpose(q);
        return;
    }
    skein_real number[4][SKEIN_LANES] __attribute__((aligned(SKEIN_LANE_BYTES)));
    for (int l = 0; l < SKEIN_LANES; l++) {
        size_t stride, at = skein_place(packed, slot[l], &stride);
        for (size_t k = 0; k < 4; k++) number[k][l] = vector[at + k * stride];
    }
    for (int k = 0; k < 4; k++) q[k] = skein_load(number[k]);
}

SKEIN_INLINE void skein_scatter(skein_lanes q[4], skein_real *vector, size_t packed, const uint32_t *slot) {
    if (!packed) {
        skein_transpose(q);
        for (int k = 0; k < 4; k++) skein_part(vector, slot + k, q[k]);
        return;
    }
    for (int l = 0; l < SKEIN_LANES; l++) {
        size_t stride, at = skein_place(packed, slot[l], &stride);
        for (size_t k = 0; k < 3; k++) vector[at + k * stride] = q[k][l];
    }
}

#endif
#endif
