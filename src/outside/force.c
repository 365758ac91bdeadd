/* Registered forces by functions, which get many particles in one call. */
#include "base/layout.h"
#include "outside/outside.h"

static void kernel(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const void *params = ((const sk_force *)op->rule)->params;
    const skein_force_type *given = sk_outside_of(params)->given;
    double time = run->time - op->before_end;
    for (size_t first = begin; first < end; first += SKEIN_LANES) {
        skein_lanes in = {0};
        skein_real out[3][SKEIN_LANES] = {{0}};
        size_t count = end - first < SKEIN_LANES ? end - first : SKEIN_LANES;
        for (size_t i = 0; i < count; i++) {
            sk_vec4 x = sk_load(run->vector[SK_X], op->packed, first + i);
            sk_vec4 v = sk_load(run->vector[SK_V], op->packed, first + i);
            in.x[0][i] = x.x, in.x[1][i] = x.y, in.x[2][i] = x.z;
            in.v[0][i] = v.x, in.v[1][i] = v.y, in.v[2][i] = v.z;
            in.mass[i] = v.w;
        }
        given->force(sk_given_params(params), time, &in, out);
        for (size_t i = 0; i < count; i++)
            if (in.mass[i] > 0)
                sk_add_at(run->vector[op->dst], op->packed, first + i, sk_v3(out[0][i], out[1][i], out[2][i]));
    }
}

static double energy(const void *params, const double x[3], double mass, double time) {
    const skein_force_type *given = sk_outside_of(params)->given;
    return given->energy(sk_given_params(params), time, x, mass);
}

static bool at(const void *params, const double x[3], double time, double force[3]) {
    const skein_force_type *given = sk_outside_of(params)->given;
    skein_lanes in = {.mass = {1}};
    skein_real out[3][SKEIN_LANES] = {{0}};
    for (int k = 0; k < 3; k++) in.x[k][0] = (skein_real)x[k];
    given->force(sk_given_params(params), time, &in, out);
    for (int k = 0; k < 3; k++) force[k] = (double)out[k][0];
    return true;
}

void sk_outside_force(sk_outside *outside, const skein_force_type *given) {
    sk_force_type *type = &outside->type.force;
    type->domain = SK_OVER_PARTICLES;
    type->on_velocity = given->on_velocity;
    type->kernel = (sk_kernels){SK_ANY_ISA(kernel)};
    type->at = at;
    if (given->energy) type->potential = energy;
    type->making = &outside->making;
}
