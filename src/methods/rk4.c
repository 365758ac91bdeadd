/* The classical Runge-Kutta method of order 4: four evaluations a substep, weighted 1 2 2 1. Very accurate for smooth
 * motion; stable while h is under 2.828/omega of the stiffest spring.
 *
 *   k1 at (x, v), k2 and k3 half a substep on, k4 a whole one on:   x' = x + h/6 (k1 + 2 k2 + 2 k3 + k4)
 *
 * The velocities of the stages are summed in one temporary, their forces in another. Contact acts on the force of
 * every stage, and on velocities once, at the end. */
#include "methods/method.h"

static const sk_vector velocities = SK_T0, forces = SK_T1;

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(20)};

/* Finds F at the present stage, and adds it and V to the sums with this weight. */
static void write_derivative(sk_plan_builder *builder, double weight, bool first) {
    sk_write_derivative(builder);
    if (first) {
        sk_write_sum(builder, velocities, weight, SK_V, 0, SK_NONE);
        sk_write_sum(builder, forces, weight, SK_F, 0, SK_NONE);
    } else {
        sk_write_sum(builder, velocities, 1, velocities, weight, SK_V);
        sk_write_sum(builder, forces, 1, forces, weight, SK_F);
    }
}

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    sk_write_steering(builder);
    sk_write_save(builder);
    write_derivative(builder, 1, true);
    sk_write_stage(builder, h / 2, SK_V, SK_F);
    sk_write_stage_time(builder, 0.5);
    write_derivative(builder, 2, false);
    sk_write_stage(builder, h / 2, SK_V, SK_F);
    write_derivative(builder, 2, false);
    sk_write_stage(builder, h, SK_V, SK_F);
    sk_write_stage_time(builder, 1);
    write_derivative(builder, 1, false);
    sk_write_stage(builder, h / 6, velocities, forces);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    sk_amplify_polynomial(z, zeta, (const double[4]){1, 1.0 / 2, 1.0 / 6, 1.0 / 24}, matrix);
}

const sk_method_type sk_rk4 = {
    .kind = {"rk4", "Runge-Kutta of fourth order: four evaluations a substep, very exact on smooth motion",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
