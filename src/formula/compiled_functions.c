/* The elementary functions that compiled formulas call: those of tapes, on arrays. */
#include "formula/compiled_code.h"

#include "base/elementary.h"
#include "base/isa.h"
#include "base/kernels.h"
#include "base/polynomial.h"
#include "base/wide_types.h"

#define SK_UNIT compiled
SK_KERNELS(const skein_elementary, functions);

#ifdef SK_ISA

#include "base/wide_elementary.h"

#ifdef SKEIN_DOUBLE
#define ON_ARRAYS(name_)                                              \
    static void name_##_of(const real *x, real *out, size_t count) {  \
        for (size_t i = 0; i < count; i++) out[i] = sk_##name_(x[i]); \
    }
static void atan2_of(const real *y, const real *x, real *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = sk_atan2(y[i], x[i]);
}
static void pow_of(const real *x, const real *y, real *out, size_t count) {
    for (size_t i = 0; i < count; i++) out[i] = sk_pow(x[i], y[i]);
}
#else
#define ON_ARRAYS(name_)                                             \
    static void name_##_of(const real *x, real *out, size_t count) { \
        sk_wide a;                                                   \
        for (size_t i = 0; i < count; i += SK_PART) {                \
            memcpy(&a, x + i, sizeof a);                             \
            a = sk_wide_##name_(a);                                  \
            memcpy(out + i, &a, sizeof a);                           \
        }                                                            \
    }
static void atan2_of(const real *y, const real *x, real *out, size_t count) {
    sk_wide a, b;
    for (size_t i = 0; i < count; i += SK_PART) {
        memcpy(&a, y + i, sizeof a);
        memcpy(&b, x + i, sizeof b);
        a = sk_wide_atan2(a, b);
        memcpy(out + i, &a, sizeof a);
    }
}
static void pow_of(const real *x, const real *y, real *out, size_t count) {
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

const skein_elementary SK_KERNEL(functions) = {exp_of,  log_of,  sin_of,   cos_of, tan_of,
                                               asin_of, acos_of, atan2_of, pow_of};

#else

/* The set that works on no more at once than the code does. */
const skein_elementary *sk_compiled_elementary(uint32_t lanes) {
    static const skein_elementary *const functions[] = SK_EACH_ISA(functions);
#ifdef SK_X86_ISAS
    size_t bytes = lanes * sizeof(real);
    return functions[bytes >= 64 ? SK_ISA_AVX512 : bytes >= 32 && sizeof(real) == 4 ? SK_ISA_AVX2 : SK_ISA_SSE];
#else
    (void)lanes;
    return functions[0];
#endif
}
#endif
