/* Gravity: F = m g on every particle. */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct gravity_params {
    double acceleration[3];
} gravity_params;

#define SK_UNIT gravity
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const gravity_params *params = ((const sk_force *)row->rule)->params;
    sk_vec3 g = sk_v3_of(params->acceleration);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide mass = sk_load_part(run->vector[SK_V], slot, packed).w;
        sk_wide4 f = {0};
        if (!row->sets) f = sk_load_part(run->vector[row->dst], slot, packed);
        f.x += mass * g.x;
        f.y += mass * g.y;
        f.z += mass * g.z;
        sk_store_part(run->vector[row->dst], slot, packed, f);
    }
}

#else

static const skein_field fields[] = {
    SK_VEC3(gravity_params, acceleration, "acceleration", "m/s2", 0, -9.81, 0, "the free fall's acceleration"),
};

static bool plain(const void *params, sk_plain_force *sum) {
    for (int k = 0; k < 3; k++) sum->acceleration[k] += ((const gravity_params *)params)->acceleration[k];
    return true;
}

static double potential(const void *data, const double x[3], double mass, double time) {
    (void)time;
    const double *g = ((const gravity_params *)data)->acceleration;
    return -mass * (g[0] * x[0] + g[1] * x[1] + g[2] * x[2]);
}

static void pack(const void *params, float (*block)[4]) {
    sk_shader_vector(block[0], ((const gravity_params *)params)->acceleration);
}

const sk_force_type sk_gravity = {
    .kind = {"gravity", "weight: the same acceleration for every particle", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(gravity_params)},
    .domain = SK_OVER_PARTICLES,
    .sets = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .plain = plain,
    .potential = potential,
    .shader = {.file = "forces/gravity", .size = 1, .pack = pack},
};
#endif
