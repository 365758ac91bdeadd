/* Leapfrog, kick-drift-kick (velocity Verlet): half a kick, a whole drift, half a kick at the new place.
 *
 *   v* = v + h/2 w F(x, v),   x' = x + h v*,   v' = v* + h/2 w F(x', v')
 *
 * Second order, and the energy of undamped motion stays bounded while h is under 2/omega. Where forces depend on
 * velocities, the closing kick is implicit: it is predicted with v* and corrected once with the predicted v', which
 * keeps the second order. Where none does, and no contact or limit interferes, the closing force is also the opening
 * one of the next substep, and is computed once. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(20)};

static void write_closing_kick(sk_plan_builder *builder, double h) {
    sk_write_derivative(builder);
    if (!sk_writes_velocity_forces(builder)) {
        sk_write_kick(builder, SK_V, SK_V, h / 2, SK_F);
        return;
    }
    sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    sk_write_kick(builder, SK_V, SK_V0, h / 2, SK_F);
    sk_write_derivative(builder);
    sk_write_kick(builder, SK_V, SK_V0, h / 2, SK_F);
}

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    bool force_stays = !sk_writes_velocity_forces(builder) && !sk_writes_corrections(builder);
    if (force_stays) sk_write_derivative(builder);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    if (!force_stays) sk_write_derivative(builder);
    sk_write_kick(builder, SK_V, SK_V, h / 2, SK_F);
    sk_write_steering(builder);
    sk_write_start(builder);
    sk_write_sum(builder, SK_X, 1, SK_X, h, SK_V);
    sk_write_stage_time(builder, 1);
    write_closing_kick(builder, h);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    // half a kick, a drift: rows of v* and x' in terms of x and v
    double k[2] = {-z / 2, 1 - z * zeta}, x[2] = {1 + z * k[0], z * k[1]};
    double predicted[2] = {k[0] - z / 2 * x[0] - z * zeta * k[0], k[1] - z / 2 * x[1] - z * zeta * k[1]};
    matrix[0] = x[0], matrix[1] = x[1];
    matrix[2] = k[0] - z / 2 * x[0] - z * zeta * predicted[0];
    matrix[3] = k[1] - z / 2 * x[1] - z * zeta * predicted[1];
}

const sk_method_type sk_leapfrog = {
    .kind = {"leapfrog", "half a kick, a drift, half a kick: second order, keeps energy; the choice for undamped motion",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
