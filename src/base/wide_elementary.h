/* Wide elementary functions, once for each instruction set (see kernels.h), with the bits of elementary.h. In float
 * they are elementary_lanes.h on as many lanes as the processor works on at once; in double, and for powers, lane by
 * lane. */
#include "base/elementary.h"
#include "base/polynomial.h"

#ifdef SKEIN_DOUBLE
#define SK_ELEMENTARY(name_) sk_##name_
#else
#define SK_ELEMENTARY(name_) sk_##name_##f
#endif
#define SK_LANE_BY_LANE(name_)                                                       \
    SK_INLINE sk_wide sk_wide_##name_(sk_wide x) {                                   \
        real lane_[SK_PART];                                                         \
        memcpy(lane_, &x, sizeof x);                                                 \
        for (int l = 0; l < SK_PART; l++) lane_[l] = SK_ELEMENTARY(name_)(lane_[l]); \
        memcpy(&x, lane_, sizeof x);                                                 \
        return x;                                                                    \
    }
#define SK_LANE_BY_LANE_2(name_)                                                   \
    SK_INLINE sk_wide sk_wide_##name_(sk_wide x, sk_wide y) {                      \
        real a[SK_PART], b[SK_PART];                                               \
        memcpy(a, &x, sizeof x);                                                   \
        memcpy(b, &y, sizeof y);                                                   \
        for (int l = 0; l < SK_PART; l++) a[l] = SK_ELEMENTARY(name_)(a[l], b[l]); \
        memcpy(&x, a, sizeof x);                                                   \
        return x;                                                                  \
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

#define lane sk_wide
#define lane_int sk_mask
#define lane_bits sk_wide_bits
#define lane_double sk_wide_double
#define LANE(name_) sk_wide_##name_
#define LANE_INLINE SK_INLINE
#define LANE_SQRT sk_wide_sqrt
#define LANE_REDUCE_FAR(x_, wide_, r_, quarters_) LANE(reduce_far)((x_), (wide_), &(r_), &(quarters_))
/* Subtracting a vector of 0 turns scalars into vectors, and changes no value. */
#define PICK(mask_, yes_, no_) sk_select((mask_), (yes_) - (lane){0}, (no_) - (lane){0})

typedef uint32_t lane_bits __attribute__((vector_size(SK_VECTOR_BYTES)));
typedef double lane_double __attribute__((vector_size(2 * SK_VECTOR_BYTES)));
typedef uint64_t LANE(double_bits) __attribute__((vector_size(2 * SK_VECTOR_BYTES)));

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

/* Lane by lane, since angles this large are rare. */
SK_INLINE void LANE(reduce_far)(lane x, lane_double wide, lane_double *r, lane_bits *quarters) {
    lane_int far = x >= 0x1p25f;
    if (!sk_any(far)) return;
    for (int l = 0; l < SK_PART; l++) {
        double rest;
        uint32_t turns;
        if (!far[l]) continue;
        sk_reduce_far(wide[l], &rest, &turns);
        (*r)[l] = rest, (*quarters)[l] = turns;
    }
}

#include "base/elementary_lanes.h"

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
