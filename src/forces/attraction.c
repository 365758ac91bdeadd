/* Attraction: every particle is drawn to a centre with the same acceleration, however far it is. Where it is flatter
 * in the vertical, what flies about the centre gathers in a ring round it: of radius v^2/strength at speed v.
 *
 *   d = (centre - x), with d.y flatness times as large:   v += strength dt d/|d| */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct attraction_params {
    double centre[3], strength, flatness;
} attraction_params;

#define SK_UNIT attraction
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const attraction_params *params = force->params;
    sk_vec3 centre = sk_v3_of(params->centre);
    real flatness = (real)params->flatness, dv = (real)(row->dt * params->strength);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 s = sk_load_part(run->vector[row->dst], slot, packed);
        sk_wide3 d = {centre.x - x.x, flatness * (centre.y - x.y), centre.z - x.z};
        sk_wide square = sk_dot_wide(d, d);
        sk_mask moved = sk_positive(square) & sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
        sk_wide k = sk_keep(moved, dv / sk_wide_sqrt(square));
        s.x += k * d.x, s.y += k * d.y, s.z += k * d.z;
        sk_store_part(run->vector[row->dst], slot, packed, s);
    }
}

#else

static const skein_field fields[] = {
    SK_VEC3(attraction_params, centre, "centre", "m", 0, 0, 0, "where everything is drawn to"),
    SK_REAL(attraction_params, strength, "strength", "m/s2", 5, -SK_FAR, SK_FAR, "the acceleration, at any distance"),
    SK_REAL(attraction_params, flatness, "flatness", "", 2.5, 0, 1e6,
            "how many times more the vertical counts: over 1 makes a ring, 1 is the same all round"),
};

static void pack(const void *data, float (*block)[4]) {
    const attraction_params *params = data;
    sk_shader_vector(block[0], params->centre);
    block[0][3] = (float)params->strength, block[1][0] = (float)params->flatness;
}

const sk_force_type sk_attraction = {
    .kind = {"attraction", "draws everything to a centre, equally at any distance; flatter in the vertical",
             SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(attraction_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_STEERS,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.file = "forces/attraction", .size = 2, .pack = pack},
};
#endif
