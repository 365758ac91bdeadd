/* Order parameters: how particles fly together. Measured, never used by a step.
 *
 * Sums run in the user's order. Neighbours are found with cells of the measure's own, on the caller's thread. */
#include <string.h>

#include "base/union_find.h"
#include "space/cells.h"
#include "world/world.h"

/* What a measure works with. */
typedef struct search {
    sk_cells cells;
    sk_state state;
    sk_group group;
    double *square;   /* of the distance to the nearest, by particle; negative: not found yet */
    uint32_t *parent; /* of a group's tree, by particle */
} search;

static bool sort_cells(search *s, sk_allocator *allocator, double radius) {
    return sk_cells_sort(&s->cells, allocator, &s->state, &s->group, (real)radius);
}

static sk_vec3 place_of(const sk_cells *cells, size_t place) {
    return sk_v3(cells->x[place], cells->y[place], cells->z[place]);
}

static double square_between(const sk_cells *cells, size_t a, size_t b) {
    double dx = (double)cells->x[a] - (double)cells->x[b], dy = (double)cells->y[a] - (double)cells->y[b],
           dz = (double)cells->z[a] - (double)cells->z[b];
    return dx * dx + dy * dy + dz * dz;
}

/* ---- the nearest ---- */

/* The square of the distance from the particle at a place to its nearest one within the radius; negative: none. */
static double nearest_within(const search *s, size_t place, double radius) {
    const sk_cells *c = &s->cells;
    uint32_t range[9][2];
    double best = -1;
    int ranges = sk_cells_ranges(c, place_of(c, place), (real)radius, range);
    for (int r = 0; r < ranges; r++)
        for (uint32_t k = range[r][0]; k < range[r][1]; k++) {
            double square = square_between(c, k, place);
            if (k != place && square < radius * radius && (best < 0 || square < best)) best = square;
        }
    return best;
}

/* The mean distance to the nearest particle: cells grow until everybody has found one. */
static bool measure_nearest(search *s, sk_allocator *allocator, double extent, skein_order *order) {
    size_t count = s->group.end - s->group.first, waiting = order->count;
    double radius = 2 * extent / (1 + sqrt((double)count)), widest = 4 * extent;
    for (size_t i = 0; i < count; i++) s->square[i] = -1;
    if (!(extent > 0)) return true; // all in one place
    for (; waiting && radius < 2 * widest; radius *= 2) {
        if (!sort_cells(s, allocator, radius)) return false;
        for (size_t place = 0; place < s->cells.count; place++) {
            double *square = &s->square[s->state.particle_of[s->cells.slot[place]] - s->group.first];
            if (*square >= 0) continue;
            *square = nearest_within(s, place, radius);
            waiting -= *square >= 0;
        }
    }
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        if (s->square[i] < 0) continue;
        order->nearest += sqrt(s->square[i]);
        found++;
    }
    if (found) order->nearest /= (double)found;
    return true;
}

/* ---- groups ---- */

/* Particles nearer than `reach` are in one group, and so are their neighbours. */
static bool count_groups(search *s, sk_allocator *allocator, double reach, skein_order *order) {
    if (!(reach > 0)) return true;
    if (!sort_cells(s, allocator, reach)) return false;
    const sk_cells *c = &s->cells;
    order->groups = c->count;
    for (uint32_t i = 0; i < c->count; i++) s->parent[i] = i;
    for (uint32_t i = 0; i < c->count; i++) {
        uint32_t range[9][2];
        int ranges = sk_cells_ranges(c, place_of(c, i), (real)reach, range);
        for (int r = 0; r < ranges; r++)
            for (uint32_t k = range[r][0]; k < range[r][1]; k++) {
                if (k <= i || !(square_between(c, i, k) < reach * reach)) continue;
                if (sk_union_join(s->parent, i, k)) order->groups--;
            }
    }
    return true;
}

/* ---- directions ---- */

/* Polarization, milling, and how far out they are. */
static void measure_directions(const skein_world *world, size_t first, size_t end, const double centre[3],
                               skein_order *order) {
    const sk_particles *all = &world->particles;
    double flight[3] = {0, 0, 0}, turn[3] = {0, 0, 0};
    for (size_t i = first; i < end; i++) {
        sk_vec4 p = all->vector[SK_X][all->slot_of[i]], q = all->vector[SK_V][all->slot_of[i]];
        double r[3] = {(double)p.x - centre[0], (double)p.y - centre[1], (double)p.z - centre[2]};
        double v[3] = {(double)q.x, (double)q.y, (double)q.z};
        double out = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
        double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (!sk_particle_counts(all, i)) continue;
        if (!(out + speed <= (double)SK_REAL_MAX)) continue; // nowhere: counted in the statistics
        order->count++;
        order->radius += out;
        order->speed += speed;
        if (out > order->farthest) order->farthest = out;
        for (int k = 0; k < 3; k++) {
            int next = (k + 1) % 3, last = (k + 2) % 3;
            if (speed > 0) flight[k] += v[k] / speed;
            if (speed > 0 && out > 0) turn[k] += (r[next] * v[last] - r[last] * v[next]) / (out * speed);
        }
    }
    if (!order->count) return;
    double n = (double)order->count;
    order->polarization = sqrt(flight[0] * flight[0] + flight[1] * flight[1] + flight[2] * flight[2]) / n;
    order->milling = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]) / n;
    order->radius /= n;
    order->speed /= n;
}

skein_status skein_order_measure(skein_world *world, size_t first, size_t count, const double centre[3],
                                 double group_reach, skein_order *order) {
    SK_NEED(world, world);
    SK_NEED(world, centre);
    SK_NEED(world, order);
    skein_error *error = sk_world_error(world);
    sk_particles *all = &world->particles;
    memset(order, 0, sizeof *order);
    skein_status status = sk_world_check_range(world, first, count);
    if (!status) status = sk_world_arrange(world, error); // who has just come or gone
    if (!status) status = sk_world_fetch(world);
    if (status) return status;
    measure_directions(world, first, first + count, centre, order);
    if (order->count < 2) {
        order->groups = group_reach > 0 ? order->count : 0;
        return SKEIN_OK;
    }
    sk_allocator *allocator = &world->allocator;
    search s = {.state = {all->vector[SK_X], all->vector[SK_V], 0, all->particle_of},
                .group = {first, first + count, 0, all->slot_count, 0}};
    s.square = sk_allocate(allocator, count * sizeof *s.square);
    s.parent = sk_allocate(allocator, count * sizeof *s.parent);
    bool good = s.square && s.parent && measure_nearest(&s, allocator, order->farthest, order) &&
                count_groups(&s, allocator, group_reach, order);
    sk_release(allocator, s.square);
    sk_release(allocator, s.parent);
    sk_cells_release(&s.cells, allocator);
    return good ? SKEIN_OK : sk_fail_memory(error, "order parameters");
}
