/* Plain wind: the same force on every particle, so light particles are accelerated more. */
#define SK_ARITHMETIC_OF double
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct wind_params {
    double force[3];
} wind_params;

// ---- arithmetic ----
SK_INLINE vec3 wind_force(wind_params p, vec3 v, num mass) {
    return PARAM3(p.force);
}
// ---- end of arithmetic ----

#define SK_UNIT wind
SK_KERNELS(sk_op_kernel, kernel);
#define PARAMS wind_params
#define PUSH wind_force
#include "forces/each_particle.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_VEC3(wind_params, force, "force", "N", 0, 0, 0, "the force on each particle"),
};

const sk_force_type sk_wind = {
    .kind = {"wind", "the same force on every particle, whatever its mass", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(wind_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = {SK_EACH_ISA(kernel)},
    .at_velocity = at,
    .shader = {.arithmetic = "forces/wind"},
};
#endif
