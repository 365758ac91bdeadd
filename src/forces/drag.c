/* Air drag on particles: F = -(linear + rate m + quadratic |v|) v. */
#include "forces/force.h"

typedef struct drag_params {
    double linear, rate, quadratic;
} drag_params;

static const skein_field fields[] = {
    SK_REAL(drag_params, linear, "linear", "N s/m", 0, 0, SK_FAR, "air damping K of each particle: F = -K v"),
    SK_REAL(drag_params, rate, "rate", "1/s", 0, 0, SK_FAR,
            "the same by mass: speed decays as exp(-rate t) at any resolution"),
    SK_REAL(drag_params, quadratic, "quadratic", "N s2/m2", 0, 0, SK_FAR, "grows with the square of the speed"),
};

static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const drag_params *params = ((const sk_force *)row->rule)->params;
    const sk_vec4 *v = run->vector[SK_V];
    sk_vec4 *f = run->vector[row->dst];
    real linear = (real)params->linear, rate = (real)params->rate, quadratic = (real)params->quadratic;
    for (size_t i = begin; i < end; i++) {
        sk_vec3 u = sk_xyz(v[i]);
        real drag = linear + rate * v[i].w + quadratic * sk_length(u);
        sk_accumulate(&f[i], sk_scale(-drag, u));
    }
}

const sk_force_type sk_drag = {
    .kind = {"drag", "air damping, linear and quadratic in the speed", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(drag_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = kernel,
};
