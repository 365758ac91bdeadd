/* Midpoint (Runge-Kutta of order 2): half an explicit substep, then a whole one with the derivative found
 * there. It gains energy, though little: (omega h)^4/4 a substep in the square of the amplitude. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(40)};

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_save(builder);
    sk_write_derivative(builder);
    sk_write_stage(builder, h / 2, SK_V, SK_F);
    sk_write_stage_time(builder, 0.5);
    sk_write_derivative(builder);
    sk_write_stage(builder, h, SK_V, SK_F);
    sk_write_stage_time(builder, 1);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 0.5, 0, 0}, matrix);
}

const sk_method_type sk_midpoint = {
    .kind = {"midpoint",
             "the derivative at the middle of the substep: second order, two evaluations, gains a little energy",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
