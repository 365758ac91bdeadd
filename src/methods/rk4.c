/* The classical Runge-Kutta method of order 4: four evaluations a substep, weighted 1 2 2 1. Very exact on
 * smooth motion; stable while h is under 2.828/omega of the stiffest spring.
 *
 *   k1 at (x, v), k2 and k3 half a substep on, k4 a whole one on:   x' = x + h/6 (k1 + 2 k2 + 2 k3 + k4)
 *
 * The velocities of the stages add up in one temporary, their forces in another. Contact answers on the
 * force of every stage, and on velocities once, at the end. */
#include "methods/method.h"

static const sk_vector velocities = SK_T0, forces = SK_T1;

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(20)};

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    (void)params;
    return sk_refuse_rigid(rules, "rk4", error);
}

/* F at the present stage; adds it and V to the sums, with this weight. */
static void write_derivative(sk_plan_builder *builder, double weight, bool first) {
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_contacts(builder, SK_CONTACT_FORCE);
    if (first) {
        sk_write_sum(builder, velocities, weight, SK_V, 0, SK_NONE);
        sk_write_sum(builder, forces, weight, SK_F, 0, SK_NONE);
    } else {
        sk_write_sum(builder, velocities, 1, velocities, weight, SK_V);
        sk_write_sum(builder, forces, 1, forces, weight, SK_F);
    }
}

/* X = X0 + a v, V = V0 + a w f. */
static void write_move(sk_plan_builder *builder, double a, sk_vector v, sk_vector f) {
    sk_write_sum(builder, SK_X, 1, SK_X0, a, v);
    sk_write_kick(builder, SK_V, SK_V0, a, f);
}

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
    sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    write_derivative(builder, 1, true);
    write_move(builder, h / 2, SK_V, SK_F);
    sk_write_stage_time(builder, 0.5);
    write_derivative(builder, 2, false);
    write_move(builder, h / 2, SK_V, SK_F);
    write_derivative(builder, 2, false);
    write_move(builder, h, SK_V, SK_F);
    sk_write_stage_time(builder, 1);
    write_derivative(builder, 1, false);
    write_move(builder, h / 6, velocities, forces);
    sk_write_bounds(builder);
    sk_write_contacts(builder, SK_CONTACT_IMPULSE);
    sk_write_limits(builder, SK_V);
    sk_write_contacts(builder, SK_CONTACT_PUSH);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 1.0 / 2, 1.0 / 6, 1.0 / 24}, matrix);
}

const sk_method_type sk_rk4 = {
    .kind = {"rk4", "Runge-Kutta of fourth order: four evaluations a substep, very exact on smooth motion",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .check = check,
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
