/* Wide arithmetic, for one instruction set: see kernels.h, which includes this.
 *
 * A *block* is sixteen slots of a state vector, 64 reals. Its layout is one of two:
 *   quads   x y z w | x y z w | ...        the canonical one: good for reaching single particles
 *   packed  x16 | y16 | z16 | w16          while a plan runs: good for sixteen at once
 */
#ifndef SK_BASE_WIDE_H
#define SK_BASE_WIDE_H

#ifdef SK_ONE_ISA
#define SK_INLINE static __attribute__((unused)) // for sanitizers, which would check every copy
#else
#define SK_INLINE static inline __attribute__((always_inline, unused))
#endif

SK_INLINE sk_wide sk_splat(real a) {
    return (sk_wide){a, a, a, a, a, a, a, a, a, a, a, a, a, a, a, a};
}

SK_INLINE sk_wide sk_select(sk_mask mask, sk_wide yes, sk_wide no) {
    return (sk_wide)((mask & (sk_mask)yes) | (~mask & (sk_mask)no));
}

/* yes where the mask is set, else 0. */
SK_INLINE sk_wide sk_keep(sk_mask mask, sk_wide yes) {
    return (sk_wide)(mask & (sk_mask)yes);
}

/* What the processor works on at once. Where it is narrower than a wide, compilers turn comparisons and
 * shuffles of a wide into single lanes, so these are written in parts. */
enum { native_bytes = SK_WIDTH };
typedef real native __attribute__((vector_size(native_bytes)));
typedef sk_lane_int native_mask __attribute__((vector_size(native_bytes)));
typedef real sk_quad __attribute__((vector_size(4 * sizeof(real))));
typedef real sk_eight __attribute__((vector_size(8 * sizeof(real))));
enum { native_parts = (int)(sizeof(sk_wide) / native_bytes) };
typedef union parts {
    sk_wide wide;
    sk_mask mask;
    native native[native_parts];
    native_mask native_mask[native_parts];
    sk_quad quad[4];
} parts;

#define SK_COMPARISON(name, operation)                                                                   \
    SK_INLINE sk_mask name(sk_wide a, sk_wide b) {                                                       \
        parts pa = {.wide = a}, pb = {.wide = b}, out;                                                   \
        for (int i = 0; i < native_parts; i++) out.native_mask[i] = pa.native[i] operation pb.native[i]; \
        return out.mask;                                                                                 \
    }
SK_COMPARISON(sk_more, >)
SK_COMPARISON(sk_at_most, <=)
SK_COMPARISON(sk_differ, !=)
#undef SK_COMPARISON

SK_INLINE sk_mask sk_positive(sk_wide a) {
    return sk_more(a, (sk_wide){0});
}
SK_INLINE sk_mask sk_negative(sk_wide a) {
    return sk_more((sk_wide){0}, a);
}

/* Exact: the nearest real to the root, on every machine. */
SK_INLINE sk_wide sk_wide_sqrt(sk_wide a) {
    parts p = {.wide = a};
    for (int i = 0; i < native_parts; i++) {
#if SK_WIDTH == 64 && defined(SKEIN_DOUBLE)
        p.native[i] = (native)_mm512_sqrt_pd((__m512d)p.native[i]);
#elif SK_WIDTH == 64
        p.native[i] = (native)_mm512_sqrt_ps((__m512)p.native[i]);
#elif SK_WIDTH == 32 && defined(SKEIN_DOUBLE)
        p.native[i] = (native)_mm256_sqrt_pd((__m256d)p.native[i]);
#elif SK_WIDTH == 32
        p.native[i] = (native)_mm256_sqrt_ps((__m256)p.native[i]);
#elif defined(__x86_64__) && defined(SKEIN_DOUBLE)
        p.native[i] = (native)_mm_sqrt_pd((__m128d)p.native[i]);
#elif defined(__x86_64__)
        p.native[i] = (native)_mm_sqrt_ps((__m128)p.native[i]);
#else
        for (size_t l = 0; l < sizeof(native) / sizeof(real); l++) p.native[i][l] = sk_sqrt(p.native[i][l]);
#endif
    }
    return p.wide;
}

SK_INLINE sk_wide sk_wide_abs(sk_wide a) {
    const sk_lane_int all_but_sign = sizeof(real) == 8 ? (sk_lane_int)INT64_MAX : (sk_lane_int)INT32_MAX;
    return (sk_wide)((sk_mask)a & all_but_sign);
}

/* Bit l of the result: whether a > b in lane l. */
SK_INLINE uint32_t sk_more_bits(sk_wide a, sk_wide b) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_GT_OQ);
#else
    parts p = {.mask = sk_more(a, b)};
    uint32_t bits = 0;
    for (int i = 0; i < native_parts; i++) {
        enum { LANES = native_bytes / sizeof(real) };
#if SK_WIDTH == 64
        uint32_t part = _mm512_movepi64_mask((__m512i)p.native_mask[i]);
#elif SK_WIDTH == 32 && defined(SKEIN_DOUBLE)
        uint32_t part = (uint32_t)_mm256_movemask_pd((__m256d)p.native_mask[i]);
#elif SK_WIDTH == 32
        uint32_t part = (uint32_t)_mm256_movemask_ps((__m256)p.native_mask[i]);
#elif defined(__x86_64__) && defined(SKEIN_DOUBLE)
        uint32_t part = (uint32_t)_mm_movemask_pd((__m128d)p.native_mask[i]);
#elif defined(__x86_64__)
        uint32_t part = (uint32_t)_mm_movemask_ps((__m128)p.native_mask[i]);
#else
        uint32_t part = 0;
        for (int l = 0; l < LANES; l++) part |= p.native_mask[i][l] ? 1u << l : 0;
#endif
        bits |= part << (i * LANES);
    }
    return bits;
#endif
}

/* The lanes of a block that begins at `slot` whose slots are in [first, end). */
SK_INLINE sk_mask sk_lanes_between(size_t slot, size_t first, size_t end) {
    const sk_wide lanes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    real low = first > slot ? (real)(first - slot) : 0, high = end > slot ? (real)(end - slot) : 0;
    return sk_at_most(sk_splat(low), lanes) & sk_more(sk_splat(high), lanes);
}

/* The sum of the lanes, in one order on every machine. */
SK_INLINE real sk_sum(sk_wide a) {
#if SK_WIDTH == 64
    sk_eight eight = __builtin_shufflevector(a, a, 0, 1, 2, 3, 4, 5, 6, 7) +
                     __builtin_shufflevector(a, a, 8, 9, 10, 11, 12, 13, 14, 15);
    sk_quad q = __builtin_shufflevector(eight, eight, 0, 1, 2, 3) + __builtin_shufflevector(eight, eight, 4, 5, 6, 7);
#else
    parts p = {.wide = a};
    sk_quad q = (p.quad[0] + p.quad[2]) + (p.quad[1] + p.quad[3]);
#endif
    return (q[0] + q[2]) + (q[1] + q[3]);
}

SK_INLINE bool sk_any(sk_mask mask) {
    parts p = {.mask = mask};
#if SK_WIDTH == 64
    bool any = false;
    for (int i = 0; i < native_parts; i++)
        any |= _mm512_test_epi32_mask((__m512i)p.native_mask[i], (__m512i)p.native_mask[i]) != 0;
    return any;
#else
    native_mask all = p.native_mask[0];
    for (int i = 1; i < native_parts; i++) all |= p.native_mask[i];
    uint64_t words[native_bytes / 8], any = 0;
    memcpy(words, &all, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) any |= words[i];
    return any != 0;
#endif
}

SK_INLINE sk_wide sk_dot_wide(sk_wide3 a, sk_wide3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Lane l takes lane (l + shift) mod 16. */
SK_INLINE sk_wide sk_rotate(sk_wide a, int shift) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    const sk_mask lanes = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return (sk_wide)_mm512_permutexvar_ps((__m512i)(lanes + shift), (__m512)a); // takes indices mod 16
#else
    real twice[2 * SK_LANES];
    memcpy(twice, &a, sizeof a);
    memcpy(twice + SK_LANES, &a, sizeof a);
    memcpy(&a, twice + (shift & (SK_LANES - 1)), sizeof a);
    return a;
#endif
}

/* ---- quads and packed ---- */

/* In each group of four lanes, rows become columns: q[k] holds the quads of particles k, 4 + k, 8 + k, 12 + k. */
SK_INLINE sk_wide4 sk_transpose(sk_wide q0, sk_wide q1, sk_wide q2, sk_wide q3) {
    sk_wide4 out;
#if SK_WIDTH == 64
    sk_wide xy01 = __builtin_shufflevector(q0, q1, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    sk_wide zw01 = __builtin_shufflevector(q0, q1, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    sk_wide xy23 = __builtin_shufflevector(q2, q3, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    sk_wide zw23 = __builtin_shufflevector(q2, q3, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    out.x = __builtin_shufflevector(xy01, xy23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    out.y = __builtin_shufflevector(xy01, xy23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
    out.z = __builtin_shufflevector(zw01, zw23, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
    out.w = __builtin_shufflevector(zw01, zw23, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
#else
    parts p0 = {.wide = q0}, p1 = {.wide = q1}, p2 = {.wide = q2}, p3 = {.wide = q3}, x, y, z, w;
    typedef sk_quad quad;
    for (int g = 0; g < 4; g++) {
        quad xy01 = __builtin_shufflevector(p0.quad[g], p1.quad[g], 0, 4, 1, 5);
        quad zw01 = __builtin_shufflevector(p0.quad[g], p1.quad[g], 2, 6, 3, 7);
        quad xy23 = __builtin_shufflevector(p2.quad[g], p3.quad[g], 0, 4, 1, 5);
        quad zw23 = __builtin_shufflevector(p2.quad[g], p3.quad[g], 2, 6, 3, 7);
        x.quad[g] = __builtin_shufflevector(xy01, xy23, 0, 1, 4, 5);
        y.quad[g] = __builtin_shufflevector(xy01, xy23, 2, 3, 6, 7);
        z.quad[g] = __builtin_shufflevector(zw01, zw23, 0, 1, 4, 5);
        w.quad[g] = __builtin_shufflevector(zw01, zw23, 2, 3, 6, 7);
    }
    out = (sk_wide4){x.wide, y.wide, z.wide, w.wide};
#endif
    return out;
}

/* (As inserts and extracts where the processor has them whole: of shuffles gcc makes a dozen.) */
SK_INLINE sk_wide sk_join(const sk_vec4 *a, const sk_vec4 *b, const sk_vec4 *c, const sk_vec4 *d) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    __m512 q = _mm512_castps128_ps512(_mm_load_ps((const real *)a));
    q = _mm512_insertf32x4(q, _mm_load_ps((const real *)b), 1);
    q = _mm512_insertf32x4(q, _mm_load_ps((const real *)c), 2);
    return (sk_wide)_mm512_insertf32x4(q, _mm_load_ps((const real *)d), 3);
#elif SK_WIDTH == 32 && !defined(SKEIN_DOUBLE)
    parts p;
    p.native[0] = (native)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps((const real *)a)),
                                               _mm_load_ps((const real *)b), 1);
    p.native[1] = (native)_mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps((const real *)c)),
                                               _mm_load_ps((const real *)d), 1);
    return p.wide;
#else
    typedef sk_quad quad;
    parts p;
    p.quad[0] = *(const quad *)(const void *)a, p.quad[1] = *(const quad *)(const void *)b;
    p.quad[2] = *(const quad *)(const void *)c, p.quad[3] = *(const quad *)(const void *)d;
    return p.wide;
#endif
}

SK_INLINE void sk_part(sk_wide q, sk_vec4 *a, sk_vec4 *b, sk_vec4 *c, sk_vec4 *d) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    _mm_store_ps((real *)a, _mm512_castps512_ps128((__m512)q));
    _mm_store_ps((real *)b, _mm512_extractf32x4_ps((__m512)q, 1));
    _mm_store_ps((real *)c, _mm512_extractf32x4_ps((__m512)q, 2));
    _mm_store_ps((real *)d, _mm512_extractf32x4_ps((__m512)q, 3));
#else
    typedef sk_quad quad;
    parts p = {.wide = q};
    *(quad *)(void *)a = p.quad[0], *(quad *)(void *)b = p.quad[1], *(quad *)(void *)c = p.quad[2],
                   *(quad *)(void *)d = p.quad[3];
#endif
}

/* Sixteen particles anywhere in a vector of quads, and back. */
SK_INLINE sk_wide4 sk_gather(const sk_vec4 *vector, const uint32_t *slot) {
    sk_wide q[4];
    for (int k = 0; k < 4; k++)
        q[k] = sk_join(vector + slot[k], vector + slot[4 + k], vector + slot[8 + k], vector + slot[12 + k]);
    return sk_transpose(q[0], q[1], q[2], q[3]);
}

SK_INLINE void sk_scatter(sk_vec4 *vector, const uint32_t *slot, sk_wide4 a) {
    // transposing is its own inverse
    sk_wide4 q = sk_transpose(a.x, a.y, a.z, a.w);
    sk_part(q.x, vector + slot[0], vector + slot[4], vector + slot[8], vector + slot[12]);
    sk_part(q.y, vector + slot[1], vector + slot[5], vector + slot[9], vector + slot[13]);
    sk_part(q.z, vector + slot[2], vector + slot[6], vector + slot[10], vector + slot[14]);
    sk_part(q.w, vector + slot[3], vector + slot[7], vector + slot[11], vector + slot[15]);
}

/* The block that begins at `slot`, whatever its layout. */
SK_INLINE sk_wide4 sk_load_block(const sk_vec4 *vector, size_t slot, bool packed) {
    const sk_wide *w = (const sk_wide *)(const void *)(vector + slot);
    if (packed) return (sk_wide4){w[0], w[1], w[2], w[3]};
    static const uint32_t in_order[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    return sk_gather(vector + slot, in_order);
}

SK_INLINE void sk_store_block(sk_vec4 *vector, size_t slot, bool packed, sk_wide4 a) {
    sk_wide *w = (sk_wide *)(void *)(vector + slot);
    if (packed) {
        w[0] = a.x, w[1] = a.y, w[2] = a.z, w[3] = a.w;
        return;
    }
    static const uint32_t in_order[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    sk_scatter(vector + slot, in_order, a);
}

/* The same where w is a mass that stays, or that nobody reads. */
SK_INLINE void sk_store_moved(sk_vec4 *vector, size_t slot, bool packed, sk_wide4 a) {
    if (!packed) {
        sk_store_block(vector, slot, packed, a);
        return;
    }
    sk_wide *w = (sk_wide *)(void *)(vector + slot);
    w[0] = a.x, w[1] = a.y, w[2] = a.z;
}

#endif
