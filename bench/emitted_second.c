/* Second derivatives by what the emitter writes (emit.c; the build puts it into emitted/), sixteen at a time, in the
 * library's own arithmetic: the lower triangle, as by_hand_second.c gives it. */
#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/polynomial.h"

#define SK_UNIT bench_emitted_second
SK_KERNELS(by_hand_function, neo_hookean);
SK_KERNELS(by_hand_function, stvk);

#ifdef SK_ISA

#include "base/wide_elementary.h"

typedef struct lanes {
    sk_wide3 x[4];
    sk_wide parameter[BY_HAND_MOST_PARAMETERS];
} lanes;

#define FORMULA(name) SK_INLINE void EMITTED(const lanes *e, const by_hand_input *in, size_t n)
#define REAL sk_wide
#define NUMBER(x) sk_splat((real)(x))
#define AXIS_0 x
#define AXIS_1 y
#define AXIS_2 z
#define POSITION(particle, axis) e->x[particle].AXIS_##axis
#define PARAMETER(index) e->parameter[index]
#define VALUE(component, x) (void)(x)
#define GRADIENT(component, particle, axis, x) (void)(x)
#define HESSIAN(row, column, x) put(in, (row) * ((row) + 1) / 2 + (column), n, (x))
#define RECIPROCAL(x) reciprocal(x)
#define LESS(a, b, yes, no) sk_select(sk_more(b, a), yes, no)
#define LOG(x) sk_wide_log(x)

SK_INLINE sk_wide reciprocal(sk_wide x) {
    sk_wide least = sk_splat(SK_LEAST_NORMAL);
    return sk_keep(sk_at_most(least, sk_wide_abs(x)), 1 / x);
}
SK_INLINE void put(const by_hand_input *in, size_t entry, size_t n, sk_wide x) {
    memcpy(in->output + entry * in->stride + n, &x, sizeof x);
}
SK_INLINE void load(lanes *e, const by_hand_input *in, size_t n, int particles, int parameters) {
    for (int k = 0; k < particles; k++) {
        sk_wide4 p = sk_gather((const sk_vec4 *)(const void *)in->positions, in->slot[k] + n);
        e->x[k] = (sk_wide3){p.x, p.y, p.z};
    }
    for (int k = 0; k < parameters; k++) memcpy(&e->parameter[k], in->parameter[k] + n, sizeof(sk_wide));
}

#define EMITTED formula_neo_hookean
#include "emitted/second_neo_hookean.h"
#undef EMITTED
#define EMITTED formula_stvk
#include "emitted/second_stvk.h"
#undef EMITTED

#define RUN(name_, particles_, parameters_)               \
    void SK_KERNEL(name_)(const by_hand_input *in) {      \
        for (size_t n = 0; n < in->count; n += SK_PART) { \
            lanes e;                                      \
            load(&e, in, n, particles_, parameters_);     \
            formula_##name_(&e, in, n);                   \
        }                                                 \
    }
RUN(neo_hookean, 4, 10)
RUN(stvk, 3, 5)

#else

#define KERNEL(name_)                                                   \
    void emitted_second_##name_(const by_hand_input *in) {              \
        static by_hand_function *const versions[] = SK_EACH_ISA(name_); \
        versions[sk_isa_choose()](in);                                  \
    }
KERNEL(neo_hookean)
KERNEL(stvk)

#endif
