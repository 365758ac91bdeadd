/* Wide elementary functions, once for each instruction set (see kernels.h), with the bits of
 * elementary.h. In float they are elementary_lanes.h on as many lanes as the processor works on at once; in double, and
 * powers always, they go lane by lane. */
#include "base/elementary.h"
#include "base/polynomial.h"

#ifdef SKEIN_DOUBLE
#define SK_ELEMENTARY(name_) sk_##name_
#else
#define SK_ELEMENTARY(name_) sk_##name_##f
#endif
#define SK_LANE_BY_LANE(name_)                                                        \
    SK_INLINE sk_wide sk_wide_##name_(sk_wide x) {                                    \
        real lane_[SK_LANES];                                                         \
        memcpy(lane_, &x, sizeof x);                                                  \
        for (int l = 0; l < SK_LANES; l++) lane_[l] = SK_ELEMENTARY(name_)(lane_[l]); \
        memcpy(&x, lane_, sizeof x);                                                  \
        return x;                                                                     \
    }
#define SK_LANE_BY_LANE_2(name_)                                                    \
    SK_INLINE sk_wide sk_wide_##name_(sk_wide x, sk_wide y) {                       \
        real a[SK_LANES], b[SK_LANES];                                              \
        memcpy(a, &x, sizeof x);                                                    \
        memcpy(b, &y, sizeof y);                                                    \
        for (int l = 0; l < SK_LANES; l++) a[l] = SK_ELEMENTARY(name_)(a[l], b[l]); \
        memcpy(&x, a, sizeof x);                                                    \
        return x;                                                                   \
    }

SK_LANE_BY_LANE_2(pow)

#ifdef SKEIN_DOUBLE

SK_LANE_BY_LANE(exp)
SK_LANE_BY_LANE(log)
SK_LANE_BY_LANE(sin)
SK_LANE_BY_LANE(cos)
SK_LANE_BY_LANE(tan)
SK_LANE_BY_LANE(asin)
SK_LANE_BY_LANE(acos)
SK_LANE_BY_LANE_2(atan2)

#else

#define lane native
#define lane_int native_mask
#define lane_bits native_bits
#define lane_double native_double
#define LANE(name_) lane_##name_
#define LANE_INLINE SK_INLINE
#define LANE_SQRT LANE(sqrt)
#define LANE_REDUCE_FAR(x_, wide_, r_, quarters_) LANE(reduce_far)((x_), (wide_), &(r_), &(quarters_))
/* Less 0 makes vectors of numbers, and changes nothing. */
#define PICK(mask_, yes_, no_) LANE(pick)((mask_), (yes_) - (lane){0}, (no_) - (lane){0})

typedef uint32_t lane_bits __attribute__((vector_size(native_bytes)));
typedef double lane_double __attribute__((vector_size(2 * native_bytes)));
typedef uint64_t LANE(double_bits) __attribute__((vector_size(2 * native_bytes)));

SK_INLINE lane LANE(pick)(lane_int mask, lane yes, lane no) {
    return (lane)((mask & (lane_int)yes) | (~mask & (lane_int)no));
}

SK_INLINE lane_double LANE(widen)(lane x) {
    return __builtin_convertvector(x, lane_double);
}

SK_INLINE lane LANE(narrow)(lane_double x) {
    return __builtin_convertvector(x, lane);
}

SK_INLINE lane_bits LANE(last_bits)(lane_double x) {
    return __builtin_convertvector((LANE(double_bits))x, lane_bits);
}

SK_INLINE lane LANE(number_of)(lane_int i) {
    return __builtin_convertvector(i, lane);
}

SK_INLINE lane LANE(sqrt)(lane x) {
#if SK_WIDTH == 64
    return (lane)_mm512_sqrt_ps((__m512)x);
#elif SK_WIDTH == 32
    return (lane)_mm256_sqrt_ps((__m256)x);
#elif defined(__x86_64__)
    return (lane)_mm_sqrt_ps((__m128)x);
#else
    for (size_t l = 0; l < sizeof x / sizeof(real); l++) x[l] = sk_sqrt(x[l]);
    return x;
#endif
}

/* Angles so large are rare. */
SK_INLINE void LANE(reduce_far)(lane x, lane_double wide, lane_double *r, lane_bits *quarters) {
    enum { LANES = native_bytes / sizeof(float) };
    lane_int far = x >= 0x1p25f;
    uint64_t words[native_bytes / 8], any = 0;
    memcpy(words, &far, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) any |= words[i];
    for (int l = 0; l < LANES && any; l++) {
        double rest;
        uint32_t turns;
        if (!far[l]) continue;
        sk_reduce_far(wide[l], &rest, &turns);
        (*r)[l] = rest, (*quarters)[l] = turns;
    }
}

#include "base/elementary_lanes.h"

#define SK_IN_PARTS(name_)                                                             \
    SK_INLINE sk_wide sk_wide_##name_(sk_wide x) {                                     \
        parts p = {.wide = x};                                                         \
        for (int i = 0; i < native_parts; i++) p.native[i] = LANE(name_)(p.native[i]); \
        return p.wide;                                                                 \
    }
SK_IN_PARTS(exp)
SK_IN_PARTS(log)
SK_IN_PARTS(sin)
SK_IN_PARTS(cos)
SK_IN_PARTS(tan)
SK_IN_PARTS(asin)
SK_IN_PARTS(acos)
#undef SK_IN_PARTS

SK_INLINE sk_wide sk_wide_atan2(sk_wide y, sk_wide x) {
    parts py = {.wide = y}, px = {.wide = x};
    for (int i = 0; i < native_parts; i++) py.native[i] = LANE(atan2)(py.native[i], px.native[i]);
    return py.wide;
}

#undef lane
#undef lane_int
#undef lane_bits
#undef lane_double
#undef LANE
#undef LANE_INLINE
#undef LANE_SQRT
#undef LANE_REDUCE_FAR
#undef PICK

#endif

#undef SK_ELEMENTARY
#undef SK_LANE_BY_LANE
#undef SK_LANE_BY_LANE_2
