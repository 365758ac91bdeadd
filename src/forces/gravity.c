/* Gravity: F = m g on every particle. */
#define SK_ARITHMETIC_OF double
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct gravity_params {
    double acceleration[3];
} gravity_params;

// ---- arithmetic ----
SK_INLINE vec3 gravity_force(gravity_params p, vec3 v, num mass) {
    return times(mass, PARAM3(p.acceleration));
}
// ---- end of arithmetic ----

#define SK_UNIT gravity
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS gravity_params
#define PUSH gravity_force
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_VEC3(gravity_params, acceleration, "acceleration", "m/s2", 0, -9.81, 0, "the free fall's acceleration"),
};

static double potential(const void *params, const double x[3], double mass, double time) {
    static const double rests[3];
    double f[3];
    (void)time;
    at(params, rests, mass, f);
    return -(f[0] * x[0] + f[1] * x[1] + f[2] * x[2]);
}

const sk_force_type sk_gravity = {
    .kind = {"gravity", "weight: the same acceleration for every particle", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(gravity_params)},
    .domain = SK_OVER_PARTICLES,
    .sets = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .at_velocity = at,
    .potential = potential,
    .shader = {.arithmetic = "forces/gravity"},
};
#endif
