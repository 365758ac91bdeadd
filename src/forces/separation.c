/* Separation: particles closer than a radius push each other apart, F = strength (1 - d/radius),
 * equal and opposite. A neighbour rule: each particle sums over its own neighbours. */
#include "forces/force.h"

typedef struct separation_params {
    double radius, strength;
} separation_params;

static const skein_field fields[] = {
    SK_REAL(separation_params, radius, "radius", "m", 0.1, 1e-6, SK_FAR, "how near is too near"),
    SK_REAL(separation_params, strength, "strength", "N", 1, 0, SK_FAR, "the push of two particles in one place"),
};

static double radius(const void *params) {
    return ((const separation_params *)params)->radius;
}

/* The push on the particle at a place. */
static sk_vec3 push_at(const sk_cells *cells, const sk_only *only, size_t place, real reach, real strength) {
    const sk_vec3 here = {cells->x[place], cells->y[place], cells->z[place]};
    sk_vec3 push = {0, 0, 0};
    uint32_t range[9][2];
    int ranges = sk_cells_ranges(cells, here, reach, range);
    for (int r = 0; r < ranges; r++)
        for (uint32_t k = range[r][0]; k < range[r][1]; k++) {
            sk_vec3 d = sk_sub(here, sk_v3(cells->x[k], cells->y[k], cells->z[k]));
            real distance = sk_length(d);
            // at distance 0 there is no direction (and the particle itself is there)
            if (!(distance > 0) || !(distance < reach) || !sk_only_has_slot(only, cells->slot[k])) continue;
            push = sk_add(push, sk_scale(strength * (1 - distance / reach) / distance, d));
        }
    return push;
}

/* Elements are places. */
static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const separation_params *params = force->params;
    const sk_cells *cells = run->cells;
    if (end > cells->count) end = cells->count;
    for (size_t place = begin; place < end; place++)
        if (sk_only_has_slot(&force->only, cells->slot[place]))
            sk_add_at(run->vector[row->dst], row->packed, cells->slot[place],
                      push_at(cells, &force->only, place, (real)params->radius, (real)params->strength));
}

static void pack(const void *data, float (*block)[4]) {
    const separation_params *params = data;
    block[0][0] = (float)params->radius, block[0][1] = (float)params->strength;
}

const sk_force_type sk_separation = {
    .kind = {"separation", "neighbours closer than a radius push each other apart", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(separation_params)},
    .domain = SK_OVER_NEIGHBOURS,
    .kernel = {SK_ANY_ISA(kernel)},
    .radius = radius,
    .shader = {.file = "forces/separation", .size = 1, .pack = pack},
};
