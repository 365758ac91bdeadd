/* Lookahead Euler: the derivative at the explicitly predicted end of the substep, applied from its start.
 * Courses often call it implicit Euler, but nothing is solved:
 *
 *   x~ = x + h v,   v~ = v + h w F(x, v);   x' = x + h v~,   v' = v + h w F(x~, v~)
 *
 * First order. It loses energy like an implicit method, but is stable only while h is under 1/omega. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(40)};

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_save(builder);
    sk_write_derivative(builder);
    sk_write_stage(builder, h, SK_V, SK_F);
    sk_write_stage_time(builder, 1);
    sk_write_derivative(builder);
    sk_write_stage(builder, h, SK_V, SK_F);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 1, 0, 0}, matrix);
}

const sk_method_type sk_lookahead_euler = {
    .kind = {"lookahead_euler",
             "explicit, with the derivative at the predicted end of the substep: first order, loses energy",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
