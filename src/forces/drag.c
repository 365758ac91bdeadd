/* Air drag on particles: F = -(linear + rate m + quadratic |v|) v. */
#define SK_ARITHMETIC_OF double
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct drag_params {
    double linear, rate, quadratic;
} drag_params;

// ---- arithmetic ----
SK_INLINE num drag_at_speed(drag_params p, num speed, num mass) {
    return PARAM(p.linear) + PARAM(p.rate) * mass + PARAM(p.quadratic) * speed;
}

SK_INLINE vec3 drag_force(drag_params p, vec3 v, num mass) {
    num speed = NUM(0);
    if (p.quadratic != 0) speed = root(dot(v, v));
    return times(-drag_at_speed(p, speed, mass), v);
}
// ---- end of arithmetic ----

#define SK_UNIT drag
SK_KERNELS(sk_op_kernel, kernel);
SK_KERNELS(sk_op_kernel, resistance);
#define PARAMS drag_params
#define PUSH drag_force
#include "forces/each_particle.h"

#ifdef SK_ISA

/* The drag's derivative by velocity is (linear + rate m) + quadratic |v| across the motion, and that with twice the
 * speed along it. The larger one is used in both directions, which keeps a solve stable. */
void SK_KERNEL(resistance)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const drag_params p = *(const drag_params *)((const sk_force *)op->rule)->params;
    real a = (real)op->coefficient[0];
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        vec4 v = sk_load_part(run->vector[SK_V], slot, packed), d = sk_load_part(run->vector[op->dst], slot, packed);
        num growth = a * drag_at_speed(p, 2 * root(dot(xyz(v), xyz(v))), v.w);
        // slots without a particle stay without mass
        growth = sk_keep(v.w > 0, growth);
        d.x += growth, d.y += growth, d.z += growth;
        sk_store_part(run->vector[op->dst], slot, packed, d);
    }
}

#else

static const skein_field fields[] = {
    SK_REAL(drag_params, linear, "linear", "N s/m", 0, 0, SK_FAR, "air damping K of each particle: F = -K v"),
    SK_REAL(drag_params, rate, "rate", "1/s", 0, 0, SK_FAR,
            "the same by mass: speed decays as exp(-rate t) at any resolution"),
    SK_REAL(drag_params, quadratic, "quadratic", "N s2/m2", 0, 0, SK_FAR, "grows with the square of the speed"),
};

const sk_force_type sk_drag = {
    .kind = {"drag", "air damping, linear and quadratic in the speed", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(drag_params)},
    .domain = SK_OVER_PARTICLES,
    .on_velocity = true,
    .passive = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .at_velocity = at,
    .resistance = {SK_EACH_ISA(resistance)},
    .shader = {.arithmetic = "forces/drag"},
};
#endif
