/* Separation: particles closer than a radius push each other apart, F = strength (1 - d/radius),
 * equal and opposite. A neighbour rule: each particle sums over its own neighbours. */
#include "base/arithmetic.h"
#include "forces/force.h"

typedef struct separation_params {
    double radius, strength;
} separation_params;

// ---- arithmetic ----
SK_INLINE vec3 separation_push(separation_params p, vec3 apart, num distance) {
    return times(PARAM(p.strength) * (1 - distance / PARAM(p.radius)) / distance, apart);
}
// ---- end of arithmetic ----

static const skein_field fields[] = {
    SK_REAL(separation_params, radius, "radius", "m", 0.1, 1e-6, SK_FAR, "how near is too near"),
    SK_REAL(separation_params, strength, "strength", "N", 1, 0, SK_FAR, "the push of two particles in one place"),
};

static double radius(const void *params) {
    return ((const separation_params *)params)->radius;
}

/* The force on the particle at a place. */
static vec3 push_at(const sk_cells *cells, const sk_only *only, size_t place, const separation_params *params) {
    const vec3 here = {cells->x[place], cells->y[place], cells->z[place]};
    real reach = (real)params->radius;
    vec3 push = {0, 0, 0};
    uint32_t range[9][2];
    int ranges = sk_cells_ranges(cells, sk_v3(here.x, here.y, here.z), reach, range);
    for (int r = 0; r < ranges; r++)
        for (uint32_t k = range[r][0]; k < range[r][1]; k++) {
            vec3 d = minus(here, (vec3){cells->x[k], cells->y[k], cells->z[k]});
            num distance = root(dot(d, d));
            // at distance 0 there is no direction (and the particle itself is there)
            if (!(distance > 0) || !(distance < reach) || !sk_only_has_slot(only, cells->slot[k])) continue;
            push = plus(push, separation_push(*params, d, distance));
        }
    return push;
}

/* Its elements are places in the order of cells. */
static void kernel(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_force *force = op->rule;
    const sk_cells *cells = run->cells;
    if (end > cells->count) end = cells->count;
    for (size_t place = begin; place < end; place++) {
        if (!sk_only_has_slot(&force->only, cells->slot[place])) continue;
        vec3 push = push_at(cells, &force->only, place, force->params);
        sk_add_at(run->vector[op->dst], op->packed, cells->slot[place], sk_v3(push.x, push.y, push.z));
    }
}

const sk_force_type sk_separation = {
    .kind = {"separation", "neighbours closer than a radius push each other apart", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(separation_params)},
    .domain = SK_OVER_NEIGHBOURS,
    .kernel = {SK_ANY_ISA(kernel)},
    .radius = radius,
    .shader = {.arithmetic = "forces/separation"},
};
