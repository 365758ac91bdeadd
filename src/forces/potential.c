/* A potential energy by a formula: F = -grad U. */
#include "base/kernels.h"
#include "forces/force.h"
#include "formula/pointwise.h"

#define SK_UNIT potential
SK_KERNELS(sk_op_kernel, kernel);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);

#define SIGN -1
#define TEXT "energy"

#ifndef SK_ISA

static const skein_formula_desc force_desc = {.result = SKEIN_FORMULA_NUMBER};
static const skein_formula_desc slopes_desc = {.result = SKEIN_FORMULA_NUMBER, .second = true};

static size_t choose_force(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    for (int axis = 0; axis < 3; axis++) outputs[axis] = f->by_position[0][axis];
    return 3;
}

static size_t choose_slopes(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    static const int places[6] = {0, 4, 8, 1, 2, 5}; // xx yy zz xy xz yz
    for (int i = 0; i < 6; i++) outputs[i] = f->hessian[places[i]];
    return 6;
}
#endif

#include "forces/by_formula.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_TEXT(by_formula_params, text, TEXT, "0", "a number, as a formula of p and t: the force goes down its slope"),
    SK_CHOICE(by_formula_params, per, "per", PER_MASS, "mass|particle",
              "mass: the formula is J/kg, as g times a height; particle: J for each"),
    SK_PARAMETERS(by_formula_params, parameter, "a number that the formula names: { \"k\": 2 }, say"),
};

static double energy_of(const void *data, const double x[3], double mass, double time) {
    const by_formula_params *params = data;
    double value[3];
    sk_pointwise_value(params->force, params->parameter, time, x, NULL, value, NULL);
    return (params->per == PER_MASS ? mass : 1) * value[0];
}

const sk_force_type sk_potential = {
    .kind = {"potential", "any potential energy of place (and time) that is a formula", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(by_formula_params)},
    .potential = energy_of,
    BY_FORMULA,
};
#endif
