/* Gravity: F = m g on every particle. */
#include "forces/force.h"

typedef struct gravity_params {
    double acceleration[3];
} gravity_params;

static const skein_field fields[] = {
    SK_VEC3(gravity_params, acceleration, "acceleration", "m/s2", 0, -9.81, 0, "the free fall's acceleration"),
};

static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const gravity_params *params = ((const sk_force *)row->rule)->params;
    const sk_vec4 *v = run->vector[SK_V];
    sk_vec4 *f = run->vector[row->dst];
    sk_vec3 g = sk_v3_of(params->acceleration);
    for (size_t i = begin; i < end; i++) sk_accumulate(&f[i], sk_scale(v[i].w, g));
}

const sk_force_type sk_gravity = {
    .kind = {"gravity", "weight: the same acceleration for every particle", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(gravity_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = kernel,
};
