/* Midpoint (Runge-Kutta of order 2): half an explicit substep, then a whole one with the derivative found
 * there. It gains energy, though little: (omega h)^4/4 a substep in the square of the amplitude. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(40)};

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    (void)params;
    return sk_refuse_rigid(rules, "midpoint", error);
}

/* X = X0 + a V, V = V0 + a w F, with the derivative at the present X and V. */
static void write_stage(sk_plan_builder *builder, double a) {
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_contacts(builder, SK_CONTACT_FORCE);
    sk_write_sum(builder, SK_X, 1, SK_X0, a, SK_V);
    sk_write_kick(builder, SK_V, SK_V0, a, SK_F);
}

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
    sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    write_stage(builder, h / 2);
    sk_write_stage_time(builder, 0.5);
    write_stage(builder, h);
    sk_write_stage_time(builder, 1);
    sk_write_bounds(builder);
    sk_write_contacts(builder, SK_CONTACT_IMPULSE);
    sk_write_limits(builder, SK_V);
    sk_write_contacts(builder, SK_CONTACT_PUSH);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 0.5, 0, 0}, matrix);
}

const sk_method_type sk_midpoint = {
    .kind = {"midpoint",
             "the derivative at the middle of the substep: second order, two evaluations, gains a little energy",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .check = check,
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
