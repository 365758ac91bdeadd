/* Explicit Euler: x' = x + h v, v' = v + h w F(x, v), both from the start of the substep. First order. It
 * gains energy: an undamped spring grows by 1 + (omega h)^2 a substep in the square of its amplitude, however
 * small the substep; a damped one is stable while h is under 2 zeta/omega. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(100)};

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_derivative(builder);
    sk_write_start(builder);
    sk_write_sum(builder, SK_X, 1, SK_X, h, SK_V);
    sk_write_stage_time(builder, 1);
    sk_write_kick(builder, SK_V, SK_V, h, SK_F);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 0, 0, 0}, matrix);
}

const sk_method_type sk_explicit_euler = {
    .kind = {"explicit_euler", "positions and velocities both from the start of the substep: first order, gains energy",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
