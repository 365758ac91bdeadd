/* Plain wind: one force on every particle, so light particles fly faster. */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct wind_params {
    double force[3];
} wind_params;

#define SK_UNIT wind
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const wind_params *params = ((const sk_force *)row->rule)->params;
    sk_vec3 force = sk_v3_of(params->force);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 f = sk_load_part(run->vector[row->dst], slot, packed);
        f.x += force.x;
        f.y += force.y;
        f.z += force.z;
        sk_store_part(run->vector[row->dst], slot, packed, f);
    }
}

#else

static const skein_field fields[] = {
    SK_VEC3(wind_params, force, "force", "N", 0, 0, 0, "the force on each particle"),
};

static bool plain(const void *params, sk_plain_force *sum) {
    for (int k = 0; k < 3; k++) sum->force[k] += ((const wind_params *)params)->force[k];
    return true;
}

static void pack(const void *params, float (*block)[4]) {
    sk_shader_vector(block[0], ((const wind_params *)params)->force);
}

const sk_force_type sk_wind = {
    .kind = {"wind", "the same force on every particle, whatever its mass", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(wind_params)},
    .domain = SK_OVER_PARTICLES,
    .kernel = {SK_EACH_ISA(kernel)},
    .plain = plain,
    .shader = {.file = "forces/wind", .size = 1, .pack = pack},
};
#endif
