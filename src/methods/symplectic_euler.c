/* Symplectic Euler: v' = v + h w F(x, v), then x' = x + h v'. First order; keeps the energy of
 * undamped motion bounded while h is under 2/omega of the stiffest spring. */
#include "methods/method.h"

typedef struct symplectic_euler_params {
    int32_t substeps;
} symplectic_euler_params;

static const skein_field fields[] = {
    SK_INT(symplectic_euler_params, substeps, "substeps", "", 20, 1, 100000, "equal parts that a step is cut into"),
};

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    (void)params;
    return sk_refuse_rigid(rules, "symplectic_euler", error);
}

static int substeps(const void *params) {
    return ((const symplectic_euler_params *)params)->substeps;
}

static void write(sk_writer *writer, const void *params, double dt) {
    double h = dt / substeps(params);
    size_t repeat = sk_write_repeat(writer, (size_t)substeps(params), h);
    sk_write_fields(writer);
    sk_write_forces(writer);
    sk_write_contacts(writer, SK_CONTACT_FORCE);
    sk_write_kick(writer, SK_V, SK_V, h, SK_F);
    sk_write_contacts(writer, SK_CONTACT_IMPULSE);
    sk_write_sum(writer, SK_X, 1, SK_X, h, SK_V);
    sk_write_limits(writer, SK_V);
    sk_write_contacts(writer, SK_CONTACT_PUSH);
    sk_write_end(writer, repeat);
}

const sk_method_type sk_symplectic_euler = {
    .kind = {"symplectic_euler", "forces, then velocities, then positions; needs small substeps for stiff springs",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(symplectic_euler_params)},
    .check = check,
    .write = write,
    .substeps = substeps,
};
