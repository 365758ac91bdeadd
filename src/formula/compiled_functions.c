/* The elementary functions that compiled formulas call: those of tapes, on arrays. */
#ifdef SK_ISA

#include "base/wide_elementary.h"

#ifdef SKEIN_DOUBLE
#define ON_ARRAYS(name_)                                                     \
    static void SK_ISA(name_##_of)(const real *x, real *out, size_t count) { \
        for (size_t i = 0; i < count; i++) out[i] = sk_##name_(x[i]);        \
    }
static void SK_ISA(atan2_of)(const real *y, const real *x, real *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = sk_atan2(y[i], x[i]);
}
static void SK_ISA(pow_of)(const real *x, const real *y, real *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = sk_pow(x[i], y[i]);
}
#else
#define ON_ARRAYS(name_)                                                     \
    static void SK_ISA(name_##_of)(const real *x, real *out, size_t count) { \
        SK_ISA(native) a;                                                    \
        for (size_t i = 0; i < count; i += sizeof a / sizeof(real)) {        \
            memcpy(&a, x + i, sizeof a);                                     \
            a = SK_ISA(lane_##name_)(a);                                     \
            memcpy(out + i, &a, sizeof a);                                   \
        }                                                                    \
    }
static void SK_ISA(atan2_of)(const real *y, const real *x, real *out, size_t count) {
    SK_ISA(native) a, b;
    for (size_t i = 0; i < count; i += sizeof a / sizeof(real)) {
        memcpy(&a, y + i, sizeof a);
        memcpy(&b, x + i, sizeof b);
        a = SK_ISA(lane_atan2)(a, b);
        memcpy(out + i, &a, sizeof a);
    }
}
static void SK_ISA(pow_of)(const real *x, const real *y, real *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = sk_powf(x[i], y[i]);
}
#endif
ON_ARRAYS(exp)
ON_ARRAYS(log)
ON_ARRAYS(sin)
ON_ARRAYS(cos)
ON_ARRAYS(tan)
ON_ARRAYS(asin)
ON_ARRAYS(acos)
#undef ON_ARRAYS

#else

#include "formula/compiled.h"

#include "base/elementary.h"
#include "base/isa.h"
#include "base/polynomial.h"
#include "base/wide_types.h"

#define SK_KERNELS "formula/compiled_functions.c"
#include "base/for_each_isa.h"

#define FUNCTIONS(set_)                                                                                            \
    {                                                                                                              \
        exp_of_##set_, log_of_##set_, sin_of_##set_, cos_of_##set_, tan_of_##set_, asin_of_##set_, acos_of_##set_, \
            atan2_of_##set_, pow_of_##set_                                                                         \
    }

/* The set that works on no more at once than the code does. */
const skein_elementary *sk_compiled_elementary(uint32_t lanes) {
#ifdef SK_X86_ISAS
    static const skein_elementary functions[] = {FUNCTIONS(sse), FUNCTIONS(avx2), FUNCTIONS(avx512)};
    size_t bytes = lanes * sizeof(real);
    return &functions[bytes >= 64 ? SK_ISA_AVX512 : bytes >= 32 && sizeof(real) == 4 ? SK_ISA_AVX2 : SK_ISA_SSE];
#else
    static const skein_elementary functions = FUNCTIONS(plain);
    (void)lanes;
    return &functions;
#endif
}

#endif
