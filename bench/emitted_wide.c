/* Values and gradients by what the emitter writes (emit.c; the build puts it into emitted/), sixteen at a time, in the
 * arithmetic of the library's own kernels. */
#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/polynomial.h"

#define SK_UNIT bench_emitted_wide
SK_KERNELS(by_hand_function, distance);
SK_KERNELS(by_hand_function, dihedral);
SK_KERNELS(by_hand_function, volume);
SK_KERNELS(by_hand_function, neo_hookean);
SK_KERNELS(by_hand_function, stvk);

#ifdef SK_ISA

#include "base/wide_elementary.h"

typedef struct lanes {
    sk_wide3 x[4], gradient[4];
    sk_wide parameter[BY_HAND_MOST_PARAMETERS], value, divisor;
    bool divided;
} lanes;

#define FORMULA(name) SK_INLINE void EMITTED(lanes *e)
#define REAL sk_wide
#define NUMBER(x) sk_splat((real)(x))
#define AXIS_0 x
#define AXIS_1 y
#define AXIS_2 z
#define POSITION(particle, axis) e->x[particle].AXIS_##axis
#define PARAMETER(index) e->parameter[index]
#define VALUE(component, x) e->value = (x)
#define GRADIENT(component, particle, axis, g) e->gradient[particle].AXIS_##axis = (g)
#define OPPOSITE(particle, of)                                     \
    e->gradient[particle] = (sk_wide3) {                           \
        -e->gradient[of].x, -e->gradient[of].y, -e->gradient[of].z \
    }
#define TEXT(text)
#define UNIT_DIVISOR(x) e->divided = true, e->divisor = (x)
#define RECIPROCAL(x) reciprocal(x)
#define SQRT(x) sk_wide_sqrt(x)
#define LESS(a, b, yes, no) sk_select(sk_more(b, a), yes, no)
#define LOG(x) sk_wide_log(x)
#define ATAN2(y, x) sk_wide_atan2(y, x)

SK_INLINE sk_wide reciprocal(sk_wide x) {
    sk_wide least = sk_splat(SK_LEAST_NORMAL);
    return sk_keep(sk_at_most(least, sk_wide_abs(x)), 1 / x);
}
SK_INLINE void load(lanes *e, const by_hand_input *in, size_t i, int particles, int parameters) {
    for (int k = 0; k < particles; k++) {
        sk_wide4 p = sk_gather((const sk_vec4 *)(const void *)in->positions, in->slot[k] + i);
        e->x[k] = (sk_wide3){p.x, p.y, p.z};
    }
    for (int k = 0; k < parameters; k++) memcpy(&e->parameter[k], in->parameter[k] + i, sizeof(sk_wide));
    e->divided = false;
}
SK_INLINE void store(lanes *e, const by_hand_input *in, size_t i, int particles) {
    sk_wide inverse = e->divided ? reciprocal(e->divisor) : (sk_wide){0};
    memcpy(in->output + i, &e->value, sizeof(sk_wide));
    for (int k = 0; k < particles; k++) {
        sk_wide3 g = e->gradient[k];
        if (e->divided) g = (sk_wide3){inverse * g.x, inverse * g.y, inverse * g.z};
        memcpy(in->output + (size_t)(3 * k + 1) * in->stride + i, &g.x, sizeof(sk_wide));
        memcpy(in->output + (size_t)(3 * k + 2) * in->stride + i, &g.y, sizeof(sk_wide));
        memcpy(in->output + (size_t)(3 * k + 3) * in->stride + i, &g.z, sizeof(sk_wide));
    }
}

#define EMITTED formula_distance
#include "emitted/distance.h"
#undef EMITTED
#define EMITTED formula_dihedral
#include "emitted/dihedral.h"
#undef EMITTED
#define EMITTED formula_volume
#include "emitted/volume.h"
#undef EMITTED
#define EMITTED formula_neo_hookean
#include "emitted/neo_hookean.h"
#undef EMITTED
#define EMITTED formula_stvk
#include "emitted/stvk.h"
#undef EMITTED

#define RUN(name_, particles_, parameters_)               \
    void SK_KERNEL(name_)(const by_hand_input *in) {      \
        for (size_t i = 0; i < in->count; i += SK_PART) { \
            lanes e;                                      \
            load(&e, in, i, particles_, parameters_);     \
            formula_##name_(&e);                          \
            store(&e, in, i, particles_);                 \
        }                                                 \
    }
RUN(distance, 2, 1)
RUN(dihedral, 4, 1)
RUN(volume, 4, 1)
RUN(neo_hookean, 4, 10)
RUN(stvk, 3, 5)

#else

#define KERNEL(name_)                                                   \
    void emitted_##name_(const by_hand_input *in) {                     \
        static by_hand_function *const versions[] = SK_EACH_ISA(name_); \
        versions[sk_isa_choose()](in);                                  \
    }
KERNEL(distance)
KERNEL(dihedral)
KERNEL(volume)
KERNEL(neo_hookean)
KERNEL(stvk)

#endif
