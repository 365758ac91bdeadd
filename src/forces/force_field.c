/* A force by a formula of place, velocity and time. */
#include "base/kernels.h"
#include "forces/force.h"
#include "formula/pointwise.h"

#define SK_UNIT force_field
SK_KERNELS(sk_op_kernel, kernel);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);

#define SIGN 1
#define TEXT "force"

#ifndef SK_ISA

static const skein_formula_desc force_desc = {.result = SKEIN_FORMULA_VECTOR, .velocities = true};
#define slopes_desc force_desc

static size_t choose_force(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    for (int axis = 0; axis < 3; axis++) outputs[axis] = f->value[axis];
    return 3;
}

/* The symmetric parts of -dF/dp and -dF/dv. */
static size_t choose_slopes(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    static const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int which = 0; which < 2; which++)
        for (int i = 0; i < 6; i++) {
            int row = pairs[i][0], column = pairs[i][1];
            sk_node one = which ? f->by_velocity[row][column] : f->by_position[row][column];
            sk_node two = which ? f->by_velocity[column][row] : f->by_position[column][row];
            sk_node sum = sk_plus(&f->graph, one, two), half = sk_constant(&f->graph, -0.5);
            outputs[6 * which + i] = sk_times(&f->graph, half, sum);
        }
    return 12;
}
#endif

#include "forces/by_formula.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_TEXT(by_formula_params, text, TEXT, "vec3(0, 0, 0)", "a vector, as a formula of p, v and t"),
    SK_CHOICE(by_formula_params, per, "per", PER_MASS, "mass|particle",
              "mass: the formula is an acceleration, m/s2; particle: a force on each, N"),
    SK_PARAMETERS(by_formula_params, parameter, "a number that the formula names: { \"k\": 2 }, say"),
};

static bool uses_velocity(const void *data) {
    return ((const by_formula_params *)data)->force->formula->uses & SK_USES_VELOCITY;
}

const sk_force_type sk_force_field = {
    .kind = {"force_field", "any force that is a formula of place, velocity and time", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(by_formula_params)},
    .uses_velocity = uses_velocity,
    BY_FORMULA,
};
#endif
