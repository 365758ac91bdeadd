/* Lookahead Euler: the derivative at the explicitly predicted end of the substep, applied from its start.
 * Courses often call it implicit Euler, but nothing is solved:
 *
 *   x~ = x + h v,   v~ = v + h w F(x, v);   x' = x + h v~,   v' = v + h w F(x~, v~)
 *
 * First order. It loses energy like an implicit method, but is stable only while h is under 1/omega. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(40)};

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    (void)params;
    return sk_refuse_rigid(rules, "lookahead_euler", error);
}

/* X = X0 + h V, V = V0 + h w F: a whole substep with the derivative at the present X and V. */
static void write_stage(sk_plan_builder *builder, double h) {
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_contacts(builder, SK_CONTACT_FORCE);
    sk_write_sum(builder, SK_X, 1, SK_X0, h, SK_V);
    sk_write_kick(builder, SK_V, SK_V0, h, SK_F);
}

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
    sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    write_stage(builder, h);
    sk_write_stage_time(builder, 1);
    write_stage(builder, h);
    sk_write_bounds(builder);
    sk_write_contacts(builder, SK_CONTACT_IMPULSE);
    sk_write_limits(builder, SK_V);
    sk_write_contacts(builder, SK_CONTACT_PUSH);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 1, 0, 0}, matrix);
}

const sk_method_type sk_lookahead_euler = {
    .kind = {"lookahead_euler",
             "explicit, with the derivative at the predicted end of the substep: first order, loses energy",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .check = check,
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
