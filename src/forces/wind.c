/* Plain wind: one force on every particle, so light particles fly faster. */
#include "forces/force.h"

typedef struct wind_params {
    double force[3];
} wind_params;

static const skein_field fields[] = {
    SK_VEC3(wind_params, force, "force", "N", 0, 0, 0, "the force on each particle"),
};

static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const wind_params *params = ((const sk_force *)row->rule)->params;
    sk_vec4 *f = run->vector[row->dst];
    sk_vec3 force = sk_v3_of(params->force);
    for (size_t i = begin; i < end; i++) sk_accumulate(&f[i], force);
}

const sk_force_type sk_wind = {
    .kind = {"wind", "the same force on every particle, whatever its mass", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(wind_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = kernel,
};
