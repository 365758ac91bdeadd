/* Particles move about, and after a while those that are near each other in space are far apart in memory. Where rules
 * look at neighbours, and nothing else is tied to slots, particles are therefore moved into the order of the cells:
 * after the first step, and then every so often. Their slots are all that changes: within a cell neighbours stand in
 * the user's order whatever the slots, so that the bits stay the same.
 *
 * Of a million birds a step took 1.25 times as long as of ten thousand, a bird; now about as long. */
#include "plan/sort.h"
#include "world/world.h"

enum {
    EVERY = 64,     /* steps; in so many a bird rarely leaves the cells around its own */
    LEAST = 1 << 15 /* particles: fewer are all in the second cache, however they lie */
};

/* Sums over slots depend on their order, and elements know their particles' slots. */
static bool may_move(const skein_world *world) {
    const sk_rules *rules = &world->rules;
    if (world->particles.count < LEAST || world->particles.strips.count || world->triangles.count) return false;
    if (rules->batches.count || rules->limits.count) return false;
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].kind == SK_ROW_DOT) return false;
    return true;
}

/* Ranks a group's particles by their cells, and those that are in none behind them. */
static void rank_by_cells(skein_world *world, const sk_group *group, double radius) {
    sk_particles *all = &world->particles;
    sk_state state = {all->vector[SK_X], all->vector[SK_V], 0, all->particle_of};
    sk_cells *cells = &world->cells;
    size_t next = group->first_slot; // without strips, a group's slots follow each other, and a slot is a rank
    if (!sk_cells_sort(cells, &world->allocator, &state, group, (real)radius)) return;
    for (size_t k = 0; k < cells->count; k++) all->rank[all->particle_of[cells->slot[k]]] = (uint32_t)next++;
    for (size_t slot = group->first_slot; slot < group->end_slot; slot++)
        if (cells->cell[slot - group->first_slot] == SK_NOWHERE && all->particle_of[slot] != SK_NOBODY)
            all->rank[all->particle_of[slot]] = (uint32_t)next++;
    all->arranged = false;
}

static bool begins_sort(const sk_row *row) {
    return sk_row_is(row, &sk_sort_rows[0].kernels);
}

/* Whether a row before this one sorts some of the same particles. */
static bool is_sorted_already(const sk_plan *plan, size_t r) {
    const sk_group *group = plan->data[r].group;
    for (size_t q = 0; q < r; q++) {
        const sk_group *other = plan->data[q].group;
        if (begins_sort(&plan->data[q]) && other->first < group->end && group->first < other->end) return true;
    }
    return false;
}

void sk_world_tidy(skein_world *world) {
    if (world->steps % EVERY != 1 || !may_move(world)) return;
    const sk_plan *plan = &world->plan;
    for (size_t r = 0; r < plan->count; r++)
        if (begins_sort(&plan->data[r]) && !is_sorted_already(plan, r))
            rank_by_cells(world, plan->data[r].group, plan->data[r].coefficient[0]);
    if (world->particles.arranged) return;
    // without the memory for it they stay where they are
    if (sk_particles_arrange(&world->particles, &world->allocator)) world->plan_stale = true;
    else world->particles.arranged = true;
}
