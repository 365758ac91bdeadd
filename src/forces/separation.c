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

/* The push on one particle from the cells of one row [first, last] along x. */
static sk_vec3 push_of_range(const sk_grid *grid, uint32_t first, uint32_t last, sk_vec3 p, real reach, real strength) {
    sk_vec3 push = {0, 0, 0};
    for (uint32_t k = grid->cell_start[first]; k < grid->cell_start[last + 1]; k++) {
        sk_vec3 d = sk_sub(p, sk_xyz(grid->position[k]));
        real distance = sk_length(d);
        // at distance 0 there is no direction (and the particle itself is there)
        if (!(distance > 0) || !(distance < reach)) continue;
        push = sk_add(push, sk_scale(strength * (1 - distance / reach) / distance, d));
    }
    return push;
}

static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const separation_params *params = ((const sk_force *)row->rule)->params;
    const sk_grid *grid = run->grid;
    const sk_vec4 *x = run->vector[SK_X];
    sk_vec4 *f = run->vector[row->dst];
    real reach = (real)params->radius, strength = (real)params->strength;
    if (!grid->count) return; // nobody is near, or the grid could not be built
    for (size_t i = begin; i < end; i++) {
        uint32_t cell = grid->cell_of[i];
        if (cell == SK_NO_CELL) continue;
        uint32_t slot = run->slot_of[i];
        int32_t cx = (int32_t)(cell % (uint32_t)grid->cells_x), rest = (int32_t)(cell / (uint32_t)grid->cells_x);
        int32_t cy = rest % grid->cells_y, cz = rest / grid->cells_y;
        int32_t x0 = cx > 0 ? cx - 1 : 0, x1 = cx + 1 < grid->cells_x ? cx + 1 : cx;
        sk_vec3 push = {0, 0, 0}, here = sk_xyz(sk_load(x, row->packed, slot));
        for (int32_t z = cz - 1; z <= cz + 1; z++)
            for (int32_t y = cy - 1; y <= cy + 1; y++) {
                if (y < 0 || z < 0 || y >= grid->cells_y || z >= grid->cells_z) continue;
                int32_t line = grid->cells_x * (y + grid->cells_y * z);
                push = sk_add(push,
                              push_of_range(grid, (uint32_t)(line + x0), (uint32_t)(line + x1), here, reach, strength));
            }
        sk_add_at(f, row->packed, slot, push);
    }
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
