/* Symplectic Euler: v' = v + h w F(x, v), then x' = x + h v'. First order; keeps the energy of
 * undamped motion bounded while h is under 2/omega of the stiffest spring. */
#include "methods/method.h"

static const skein_field fields[] = {SK_SUBSTEPS_FIELD(20)};

static void write(sk_plan_builder *builder, const void *params, double dt) {
    double h = dt / sk_substeps_of(params);
    size_t repeat = sk_write_repeat(builder, (size_t)sk_substeps_of(params), h);
    if (sk_writes_forces(builder)) {
        sk_write_derivative(builder);
        sk_write_kick(builder, SK_V, SK_V, h, SK_F);
    }
    sk_write_steering(builder);
    sk_write_start(builder);
    sk_write_sum(builder, SK_X, 1, SK_X, h, SK_V);
    sk_write_stage_time(builder, 1);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

static void amplify(double z, double zeta, double matrix[4]) {
    double kicked[2] = {-z, 1 - 2 * z * zeta};
    matrix[0] = 1 + z * kicked[0], matrix[1] = z * kicked[1];
    matrix[2] = kicked[0], matrix[3] = kicked[1];
}

const sk_method_type sk_symplectic_euler = {
    .kind = {"symplectic_euler", "forces, then velocities, then positions; needs small substeps for stiff springs",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(sk_substeps)},
    .write = write,
    .substeps = sk_substeps_of,
    .amplify = amplify,
};
