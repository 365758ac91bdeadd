/* Arithmetic of vectors, for one instruction set: see kernels.h, which includes this, and wide_types.h.
 *
 * A *block* is sixteen slots of a state vector, 64 reals. Its layout is one of two:
 *   quads   x y z w | x y z w | ...        the canonical one: good for reaching single particles
 *   packed  x16 | y16 | z16 | w16          while a plan runs: good for many at once
 * What takes a slot here wants the first of a part: a multiple of SK_PART.
 */
#ifndef SK_BASE_WIDE_H
#define SK_BASE_WIDE_H

#include <skein/inside/layout.h>
#include <skein/inside/wide_types.h>

#ifdef SK_ONE_ISA
#define SK_INLINE static __attribute__((unused)) // for sanitizers, which would check every copy
#else
#define SK_INLINE static inline __attribute__((always_inline, unused))
#endif

SK_INLINE sk_wide sk_splat(real a) {
    return a - (sk_wide){0};
}

SK_INLINE sk_wide sk_select(sk_mask mask, sk_wide yes, sk_wide no) {
    return (sk_wide)((mask & (sk_mask)yes) | (~mask & (sk_mask)no));
}

/* yes where the mask is set, else 0. */
SK_INLINE sk_wide sk_keep(sk_mask mask, sk_wide yes) {
    return (sk_wide)(mask & (sk_mask)yes);
}

/* a + b where the mask is set; elsewhere a, to the bit: + 0 would make 0 of a -0, where a vector is not left out. */
SK_INLINE sk_wide sk_plus_where(sk_mask mask, sk_wide a, sk_wide b) {
    return sk_select(mask, a + b, a);
}

SK_INLINE sk_mask sk_more(sk_wide a, sk_wide b) {
    return a > b;
}
SK_INLINE sk_mask sk_at_most(sk_wide a, sk_wide b) {
    return a <= b;
}
SK_INLINE sk_mask sk_differ(sk_wide a, sk_wide b) {
    return a != b;
}
SK_INLINE sk_mask sk_positive(sk_wide a) {
    return a > (sk_wide){0};
}
SK_INLINE sk_mask sk_negative(sk_wide a) {
    return a < (sk_wide){0};
}

/* Exact: the nearest real to the root, on every machine. */
SK_INLINE sk_wide sk_wide_sqrt(sk_wide a) {
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
    return (sk_wide)_mm512_sqrt_pd((__m512d)a);
#elif SK_WIDTH == 64
    return (sk_wide)_mm512_sqrt_ps((__m512)a);
#elif SK_WIDTH == 32 && defined(SKEIN_DOUBLE)
    return (sk_wide)_mm256_sqrt_pd((__m256d)a);
#elif SK_WIDTH == 32
    return (sk_wide)_mm256_sqrt_ps((__m256)a);
#elif defined(__x86_64__) && defined(SKEIN_DOUBLE)
    return (sk_wide)_mm_sqrt_pd((__m128d)a);
#elif defined(__x86_64__)
    return (sk_wide)_mm_sqrt_ps((__m128)a);
#elif defined(__wasm_simd128__) && defined(SKEIN_DOUBLE)
    return (sk_wide)wasm_f64x2_sqrt((v128_t)a);
#elif defined(__wasm_simd128__)
    return (sk_wide)wasm_f32x4_sqrt((v128_t)a);
#elif defined(__aarch64__) && defined(SKEIN_DOUBLE)
    return (sk_wide)vsqrtq_f64((float64x2_t)a);
#elif defined(__aarch64__)
    return (sk_wide)vsqrtq_f32((float32x4_t)a);
#else
    for (int l = 0; l < SK_PART; l++) a[l] = sk_sqrt(a[l]);
    return a;
#endif
}

SK_INLINE sk_wide sk_wide_abs(sk_wide a) {
    const sk_lane_int all_but_sign = sizeof(real) == 8 ? (sk_lane_int)INT64_MAX : (sk_lane_int)INT32_MAX;
    return (sk_wide)((sk_mask)a & all_but_sign);
}

/* Bit l of the result: whether a > b in lane l. */
SK_INLINE uint32_t sk_more_bits(sk_wide a, sk_wide b) {
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_GT_OQ);
#elif SK_WIDTH == 64
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GT_OQ);
#elif SK_WIDTH == 32 && defined(SKEIN_DOUBLE)
    return (uint32_t)_mm256_movemask_pd((__m256d)(a > b));
#elif SK_WIDTH == 32
    return (uint32_t)_mm256_movemask_ps((__m256)(a > b));
#elif defined(__x86_64__) && defined(SKEIN_DOUBLE)
    return (uint32_t)_mm_movemask_pd((__m128d)(a > b));
#elif defined(__x86_64__)
    return (uint32_t)_mm_movemask_ps((__m128)(a > b));
#elif defined(__wasm_simd128__) && defined(SKEIN_DOUBLE)
    return (uint32_t)wasm_i64x2_bitmask((v128_t)(a > b));
#elif defined(__wasm_simd128__)
    return (uint32_t)wasm_i32x4_bitmask((v128_t)(a > b));
#else
    sk_mask more = a > b;
    uint32_t bits = 0;
    for (int l = 0; l < SK_PART; l++) bits |= more[l] ? 1u << l : 0;
    return bits;
#endif
}

SK_INLINE bool sk_any(sk_mask mask) {
#if SK_WIDTH == 64
    return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0;
#elif SK_WIDTH == 32
    return !_mm256_testz_si256((__m256i)mask, (__m256i)mask);
#else
    uint64_t words[2];
    memcpy(words, &mask, sizeof words);
    return (words[0] | words[1]) != 0;
#endif
}

/* 0, 1, 2 ... */
SK_INLINE sk_wide sk_lane_numbers(void) {
    static const SK_VECTOR_ALIGNED real numbers[SK_LANES] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return *(const sk_wide *)(const void *)numbers;
}

/* The lanes of a part that begins at `slot` whose slots are in [first, end). */
SK_INLINE sk_mask sk_lanes_between(size_t slot, size_t first, size_t end) {
    if (first <= slot && slot + SK_PART <= end) return ~(sk_mask){0}; // nearly all parts
    const sk_wide lanes = sk_lane_numbers();
    real low = first > slot ? (real)(first - slot) : 0, high = end > slot ? (real)(end - slot) : 0;
    return sk_at_most(sk_splat(low), lanes) & sk_more(sk_splat(high), lanes);
}

/* The sum of a block's lanes, which come in parts, in one order on every machine: halves are added to each other until
 * one lane is left. */
SK_INLINE real sk_sum(const sk_wide part[SK_PARTS]) {
    sk_wide sum[SK_PARTS];
    for (int i = 0; i < SK_PARTS; i++) sum[i] = part[i];
    for (int half = SK_PARTS / 2; half; half /= 2)
        for (int i = 0; i < half; i++) sum[i] += sum[i + half];
#if SK_WIDTH == 64
    typedef real half_wide __attribute__((vector_size(SK_WIDTH / 2)));
#ifdef SKEIN_DOUBLE
    half_wide s =
        __builtin_shufflevector(sum[0], sum[0], 0, 1, 2, 3) + __builtin_shufflevector(sum[0], sum[0], 4, 5, 6, 7);
    enum { LEFT = 4 };
#else
    half_wide s = __builtin_shufflevector(sum[0], sum[0], 0, 1, 2, 3, 4, 5, 6, 7) +
                  __builtin_shufflevector(sum[0], sum[0], 8, 9, 10, 11, 12, 13, 14, 15);
    enum { LEFT = 8 };
#endif
#else
    sk_wide s = sum[0];
    enum { LEFT = SK_PART };
#endif
    real lane[LEFT];
    memcpy(lane, &s, sizeof lane);
    for (int half = LEFT / 2; half; half /= 2)
        for (int l = 0; l < half; l++) lane[l] += lane[l + half];
    return lane[0];
}

SK_INLINE sk_wide sk_dot_wide(sk_wide3 a, sk_wide3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* ---- turned lanes ---- */

/* A row of sixteen reals, turned: lane l of it is lane (l + shift) mod 16 of what it was. (From whole parts, for loads
 * across what has just been stored would wait.) */
SK_INLINE void sk_rotate_lanes(sk_wide *to, const sk_wide *row, int shift) {
    int from = (shift & (SK_LANES - 1)) / SK_PART, first = shift & (SK_PART - 1);
    sk_wide part[SK_PARTS + 1];
    for (int p = 0; p <= SK_PARTS; p++) part[p] = row[(p + from) & (SK_PARTS - 1)];
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
    const sk_mask lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    for (int p = 0; p < SK_PARTS; p++)
        to[p] = (sk_wide)_mm512_permutex2var_pd((__m512d)part[p], (__m512i)(lanes + first), (__m512d)part[p + 1]);
#elif SK_WIDTH == 64
    const sk_mask lanes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    to[0] = (sk_wide)_mm512_permutexvar_ps((__m512i)(lanes + first), (__m512)part[0]);
#elif SK_WIDTH == 32 && !defined(SKEIN_DOUBLE)
    // each part by itself first: indices count mod 8
    const sk_mask lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    __m256 low = _mm256_permutevar8x32_ps((__m256)part[0], (__m256i)(lanes + first));
    __m256 high = _mm256_permutevar8x32_ps((__m256)part[1], (__m256i)(lanes + first));
    __m256 of_next = (__m256)(lanes + first > 7);
    to[0] = (sk_wide)_mm256_blendv_ps(low, high, of_next), to[1] = (sk_wide)_mm256_blendv_ps(high, low, of_next);
#elif SK_WIDTH == 32 || !defined(SKEIN_DOUBLE)
#define FROM(...) \
    for (int p = 0; p < SK_PARTS; p++) to[p] = __builtin_shufflevector(part[p], part[p + 1], __VA_ARGS__)
    if (first == 1) FROM(1, 2, 3, 4);
    else if (first == 2) FROM(2, 3, 4, 5);
    else if (first == 3) FROM(3, 4, 5, 6);
    else FROM(0, 1, 2, 3);
#undef FROM
#else
    for (int p = 0; p < SK_PARTS; p++) to[p] = first ? __builtin_shufflevector(part[p], part[p + 1], 1, 2) : part[p];
#endif
}

/* ---- quads and packed ---- */

#if SK_WIDTH == 16 && defined(SKEIN_DOUBLE)

/* As many particles as a part has, anywhere in a vector of quads, and back. Here a quad is two vectors. */
SK_INLINE sk_wide4 sk_gather(const sk_vec4 *vector, const uint32_t *slot) {
    const sk_wide *a = (const sk_wide *)(const void *)(vector + slot[0]);
    const sk_wide *b = (const sk_wide *)(const void *)(vector + slot[1]);
    return (sk_wide4){__builtin_shufflevector(a[0], b[0], 0, 2), __builtin_shufflevector(a[0], b[0], 1, 3),
                      __builtin_shufflevector(a[1], b[1], 0, 2), __builtin_shufflevector(a[1], b[1], 1, 3)};
}

SK_INLINE void sk_scatter(sk_vec4 *vector, const uint32_t *slot, sk_wide4 p) {
    sk_wide *a = (sk_wide *)(void *)(vector + slot[0]), *b = (sk_wide *)(void *)(vector + slot[1]);
    a[0] = __builtin_shufflevector(p.x, p.y, 0, 2), a[1] = __builtin_shufflevector(p.z, p.w, 0, 2);
    b[0] = __builtin_shufflevector(p.x, p.y, 1, 3), b[1] = __builtin_shufflevector(p.z, p.w, 1, 3);
}

#else

/* In each group of four lanes, rows become columns, which is its own inverse: q[k] holds the quads of particles k,
 * 4 + k, 8 + k, 12 + k. */
SK_INLINE sk_wide4 sk_transpose(sk_wide q0, sk_wide q1, sk_wide q2, sk_wide q3) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
#define LOW_LANES 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29
#define HIGH_LANES 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31
#define FIRST_PAIRS 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29
#define LAST_PAIRS 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31
#elif SK_WIDTH == 64 || (SK_WIDTH == 32 && !defined(SKEIN_DOUBLE))
#define LOW_LANES 0, 8, 1, 9, 4, 12, 5, 13
#define HIGH_LANES 2, 10, 3, 11, 6, 14, 7, 15
#define FIRST_PAIRS 0, 1, 8, 9, 4, 5, 12, 13
#define LAST_PAIRS 2, 3, 10, 11, 6, 7, 14, 15
#else
#define LOW_LANES 0, 4, 1, 5
#define HIGH_LANES 2, 6, 3, 7
#define FIRST_PAIRS 0, 1, 4, 5
#define LAST_PAIRS 2, 3, 6, 7
#endif
    sk_wide xy01 = __builtin_shufflevector(q0, q1, LOW_LANES), zw01 = __builtin_shufflevector(q0, q1, HIGH_LANES);
    sk_wide xy23 = __builtin_shufflevector(q2, q3, LOW_LANES), zw23 = __builtin_shufflevector(q2, q3, HIGH_LANES);
    return (sk_wide4){__builtin_shufflevector(xy01, xy23, FIRST_PAIRS), __builtin_shufflevector(xy01, xy23, LAST_PAIRS),
                      __builtin_shufflevector(zw01, zw23, FIRST_PAIRS), __builtin_shufflevector(zw01, zw23, LAST_PAIRS)};
#undef LOW_LANES
#undef HIGH_LANES
#undef FIRST_PAIRS
#undef LAST_PAIRS
}

/* The quads of every fourth slot side by side, and back: as inserts and extracts, since of shuffles gcc makes a dozen.
 */
SK_INLINE sk_wide sk_join_quads(const sk_vec4 *vector, const uint32_t *slot) {
    const real *first = (const real *)(vector + slot[0]);
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
    __m512d q = _mm512_castpd256_pd512(_mm256_load_pd(first));
    return (sk_wide)_mm512_insertf64x4(q, _mm256_load_pd((const real *)(vector + slot[4])), 1);
#elif SK_WIDTH == 64
    __m512 q = _mm512_castps128_ps512(_mm_load_ps(first));
    q = _mm512_insertf32x4(q, _mm_load_ps((const real *)(vector + slot[4])), 1);
    q = _mm512_insertf32x4(q, _mm_load_ps((const real *)(vector + slot[8])), 2);
    return (sk_wide)_mm512_insertf32x4(q, _mm_load_ps((const real *)(vector + slot[12])), 3);
#elif SK_WIDTH == 32 && !defined(SKEIN_DOUBLE)
    return (sk_wide)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(first)),
                                         _mm_load_ps((const real *)(vector + slot[4])), 1);
#else
    return *(const sk_wide *)(const void *)first;
#endif
}

SK_INLINE void sk_part_quads(sk_vec4 *vector, const uint32_t *slot, sk_wide q) {
    real *first = (real *)(vector + slot[0]);
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
    _mm256_store_pd(first, _mm512_castpd512_pd256((__m512d)q));
    _mm256_store_pd((real *)(vector + slot[4]), _mm512_extractf64x4_pd((__m512d)q, 1));
#elif SK_WIDTH == 64
    _mm_store_ps(first, _mm512_castps512_ps128((__m512)q));
    _mm_store_ps((real *)(vector + slot[4]), _mm512_extractf32x4_ps((__m512)q, 1));
    _mm_store_ps((real *)(vector + slot[8]), _mm512_extractf32x4_ps((__m512)q, 2));
    _mm_store_ps((real *)(vector + slot[12]), _mm512_extractf32x4_ps((__m512)q, 3));
#elif SK_WIDTH == 32 && !defined(SKEIN_DOUBLE)
    _mm_store_ps(first, _mm256_castps256_ps128((__m256)q));
    _mm_store_ps((real *)(vector + slot[4]), _mm256_extractf128_ps((__m256)q, 1));
#else
    *(sk_wide *)(void *)first = q;
#endif
}

/* As many particles as a part has, anywhere in a vector of quads, and back. */
SK_INLINE sk_wide4 sk_gather(const sk_vec4 *vector, const uint32_t *slot) {
    return sk_transpose(sk_join_quads(vector, slot), sk_join_quads(vector, slot + 1), sk_join_quads(vector, slot + 2),
                        sk_join_quads(vector, slot + 3));
}

SK_INLINE void sk_scatter(sk_vec4 *vector, const uint32_t *slot, sk_wide4 p) {
    sk_wide4 q = sk_transpose(p.x, p.y, p.z, p.w);
    sk_part_quads(vector, slot, q.x), sk_part_quads(vector, slot + 1, q.y);
    sk_part_quads(vector, slot + 2, q.z), sk_part_quads(vector, slot + 3, q.w);
}

#endif

/* Whole quads in a vector: x, y and z of q and the fourth lane of r; the fourth lane for all four. In two lanes there is no
 * quad. (As shuffles, which are one blend: of a mask that is constant gcc makes three operations.) */
#if SK_WIDTH > 16 || !defined(SKEIN_DOUBLE)
#define SK_WHOLE_QUADS
SK_INLINE sk_wide sk_with_fourth(sk_wide q, sk_wide r) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    return __builtin_shufflevector(q, r, 0, 1, 2, 19, 4, 5, 6, 23, 8, 9, 10, 27, 12, 13, 14, 31);
#elif SK_WIDTH == 64 || (SK_WIDTH == 32 && !defined(SKEIN_DOUBLE))
    return __builtin_shufflevector(q, r, 0, 1, 2, 11, 4, 5, 6, 15);
#else
    return __builtin_shufflevector(q, r, 0, 1, 2, 7);
#endif
}
SK_INLINE sk_wide sk_fourth_of_each(sk_wide q) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    return __builtin_shufflevector(q, q, 3, 3, 3, 3, 7, 7, 7, 7, 11, 11, 11, 11, 15, 15, 15, 15);
#elif SK_WIDTH == 64 || (SK_WIDTH == 32 && !defined(SKEIN_DOUBLE))
    return __builtin_shufflevector(q, q, 3, 3, 3, 3, 7, 7, 7, 7);
#else
    return __builtin_shufflevector(q, q, 3, 3, 3, 3);
#endif
}
/* x, y, z, 0 in every quad. */
SK_INLINE sk_wide sk_each_quad(real x, real y, real z) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    return (sk_wide){x, y, z, 0, x, y, z, 0, x, y, z, 0, x, y, z, 0};
#elif SK_WIDTH == 64 || (SK_WIDTH == 32 && !defined(SKEIN_DOUBLE))
    return (sk_wide){x, y, z, 0, x, y, z, 0};
#else
    return (sk_wide){x, y, z, 0};
#endif
}
#endif

/* As many particles as a part has, some of which may be in packed blocks: slots [0, packed). */
SK_INLINE sk_wide4 sk_gather_any(const sk_vec4 *vector, size_t packed, const uint32_t *slot) {
    if (!packed) return sk_gather(vector, slot);
    SK_VECTOR_ALIGNED real lane[4][SK_PART];
    for (size_t l = 0; l < SK_PART; l++) {
        sk_vec4 p = sk_load(vector, packed, slot[l]);
        lane[0][l] = p.x, lane[1][l] = p.y, lane[2][l] = p.z, lane[3][l] = p.w;
    }
    const sk_wide *rows = (const sk_wide *)(const void *)lane;
    return (sk_wide4){rows[0], rows[1], rows[2], rows[3]};
}

/* Where a packed block has the x of a slot; y is 16 reals further, and so on. */
SK_INLINE size_t sk_packed_place(size_t slot) {
    return 4 * (slot & ~(size_t)(SK_LANES - 1)) + (slot & (SK_LANES - 1));
}

/* The part that begins at `slot`, whatever its block's layout. */
SK_INLINE sk_wide4 sk_load_part(const sk_vec4 *vector, size_t slot, bool packed) {
    static const uint32_t in_order[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    if (!packed) return sk_gather(vector + slot, in_order);
    const sk_wide *w = (const sk_wide *)(const void *)((const real *)vector + sk_packed_place(slot));
    return (sk_wide4){w[0], w[SK_PARTS], w[2 * SK_PARTS], w[3 * SK_PARTS]};
}

SK_INLINE void sk_store_part(sk_vec4 *vector, size_t slot, bool packed, sk_wide4 a) {
    static const uint32_t in_order[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    if (!packed) {
        sk_scatter(vector + slot, in_order, a);
        return;
    }
    sk_wide *w = (sk_wide *)(void *)((real *)vector + sk_packed_place(slot));
    w[0] = a.x, w[SK_PARTS] = a.y, w[2 * SK_PARTS] = a.z, w[3 * SK_PARTS] = a.w;
}

/* The same where w is a mass that stays, or that nobody reads. */
SK_INLINE void sk_store_moved(sk_vec4 *vector, size_t slot, bool packed, sk_wide4 a) {
    if (!packed) {
        sk_store_part(vector, slot, packed, a);
        return;
    }
    sk_wide *w = (sk_wide *)(void *)((real *)vector + sk_packed_place(slot));
    w[0] = a.x, w[SK_PARTS] = a.y, w[2 * SK_PARTS] = a.z;
}

#endif
