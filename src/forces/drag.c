/* Air drag on particles: F = -(linear + rate m + quadratic |v|) v. */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct drag_params {
    double linear, rate, quadratic;
} drag_params;

#define SK_UNIT drag
SK_KERNELS(sk_row_kernel, kernel);
SK_KERNELS(sk_row_kernel, resistance);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const drag_params *params = ((const sk_force *)row->rule)->params;
    sk_wide linear = sk_splat((real)params->linear);
    real rate = (real)params->rate, quadratic = (real)params->quadratic;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide4 f = sk_load_part(run->vector[row->dst], slot, packed);
        sk_wide drag = linear + rate * v.w;
        if (quadratic != 0) drag += quadratic * sk_wide_sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        f.x -= drag * v.x;
        f.y -= drag * v.y;
        f.z -= drag * v.z;
        sk_store_part(run->vector[row->dst], slot, packed, f);
    }
}

/* The quadratic part grows by |v| across the motion and twice that along it: the larger one keeps a solve steady. */
void SK_KERNEL(resistance)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const drag_params *params = ((const sk_force *)row->rule)->params;
    real a = (real)row->coefficient[0], rate = (real)params->rate, quadratic = (real)params->quadratic;
    sk_wide linear = sk_splat((real)params->linear);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide4 d = sk_load_part(run->vector[row->dst], slot, packed);
        sk_wide speed = sk_wide_sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        sk_wide drag = a * ((linear + rate * v.w) + 2 * quadratic * speed);
        // slots without a particle have no mass, and stay without
        drag = sk_keep(sk_positive(v.w), drag);
        d.x += drag, d.y += drag, d.z += drag;
        sk_store_part(run->vector[row->dst], slot, packed, d);
    }
}

#else

static const skein_field fields[] = {
    SK_REAL(drag_params, linear, "linear", "N s/m", 0, 0, SK_FAR, "air damping K of each particle: F = -K v"),
    SK_REAL(drag_params, rate, "rate", "1/s", 0, 0, SK_FAR,
            "the same by mass: speed decays as exp(-rate t) at any resolution"),
    SK_REAL(drag_params, quadratic, "quadratic", "N s2/m2", 0, 0, SK_FAR, "grows with the square of the speed"),
};

static bool plain(const void *data, sk_plain_force *sum) {
    const drag_params *params = data;
    sum->linear += params->linear;
    sum->rate += params->rate;
    return params->quadratic == 0;
}

static void pack(const void *data, float (*block)[4]) {
    const drag_params *params = data;
    block[0][0] = (float)params->linear, block[0][1] = (float)params->rate, block[0][2] = (float)params->quadratic;
}

const sk_force_type sk_drag = {
    .kind = {"drag", "air damping, linear and quadratic in the speed", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(drag_params)},
    .domain = SK_OVER_PARTICLES,
    .on_velocity = true,
    .passive = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .plain = plain,
    .resistance = {SK_EACH_ISA(resistance)},
    .shader = {.file = "forces/drag", .size = 1, .pack = pack},
};
#endif
