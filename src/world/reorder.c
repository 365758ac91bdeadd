/* Particles move about, and after a while those that are near each other in space are far apart in memory. Where rules
 * look at neighbours, and nothing else is tied to slots, particles are therefore moved into the order of the cells:
 * after the first step, and then every so often. Their slots are all that changes: within a cell neighbours stand in
 * the user's order whatever the slots, so that the bits stay the same.
 *
 * Of a million birds a step took 1.25 times as long as of ten thousand, a bird; now about as long. */
#include <string.h>

#include "world/world.h"

enum {
    EVERY = 64,     /* steps; in so many a bird rarely leaves the cells around its own */
    LEAST = 1 << 15 /* particles of a body: fewer are all in the second cache, however they lie */
};

/* Sums over slots depend on their order, and elements know their particles' slots. */
static bool may_move(const skein_world *world) {
    const sk_rules *rules = &world->rules;
    if (world->particles.strips.count || world->triangles.count) return false;
    if (rules->batches.count || rules->limits.count) return false;
    for (size_t r = 0; r < world->plan.count; r++)
        if (sk_op_decides(&world->plan.data[r])) return false; // by sums
    return true;
}

/* Lists a body's slots by the cells of its particles, and those that are in none behind them. False when there is no
 * memory. */
static bool list_slots(skein_world *world, const sk_group *group, double radius) {
    const sk_particles *all = &world->particles;
    sk_state state = {all->vector[SK_X], all->vector[SK_V], 0, all->particle_of};
    sk_cells *cells = &world->cells;
    cells->in_order = false;
    if (!sk_cells_sort(cells, &world->allocator, &state, group, (real)radius)) return false;
    size_t next = cells->count;
    for (size_t slot = group->first_slot; slot < group->end_slot; slot++)
        if (cells->cell[slot - group->first_slot] == SK_NOWHERE) cells->slot[next++] = (uint32_t)slot;
    return true;
}

/* The body's particles move to its slots in the order of the list. Nothing is allocated: X0 holds nothing between
 * steps, and the cells are found anew in each. */
static void move_to_list(skein_world *world, const sk_group *group, size_t first_rank) {
    sk_particles *all = &world->particles;
    size_t first = group->first_slot, count = group->end_slot - first;
    const uint32_t *list = world->cells.slot;
    uint32_t *particle = world->cells.cell;
    for (int v = SK_X; v < SK_T0; v++) {
        if (v == SK_X0) continue;
        sk_vec4 *vector = all->vector[v], *spare = all->vector[SK_X0];
        for (size_t k = 0; k < count; k++) spare[first + k] = vector[list[k]];
        memcpy(vector + first, spare + first, count * sizeof *vector);
    }
    for (size_t k = 0; k < count; k++) particle[k] = all->particle_of[list[k]];
    for (size_t k = 0; k < count; k++) {
        all->particle_of[first + k] = particle[k];
        all->slot_of[particle[k]] = (uint32_t)(first + k);
        all->rank[particle[k]] = (uint32_t)(first_rank + k);
    }
}

/* The radius of the first cells that all of a group is sorted into; 0: of none. */
static double radius_for(const sk_plan *plan, const sk_group *group) {
    for (size_t r = 0; r < plan->count; r++) {
        const sk_op *op = &plan->data[r];
        if (sk_op_type_of(op)->sorts && op->group->first <= group->first && group->end <= op->group->end)
            return op->coefficient[0];
    }
    return 0;
}

void sk_world_reorder(skein_world *world) {
    if (world->steps % EVERY != 1 || !may_move(world)) return;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY) continue;
        const sk_body *body = object->as.body;
        size_t first = body->first_particle, count = body->particle_count;
        if (count < LEAST || !body->enabled) continue;
        // without strips, slots are ranks but for those who take no part, and a body's are its own: its particles stay
        // among themselves
        size_t slot = world->particles.slot_of[first];
        for (size_t k = 1; k < count; k++)
            if (world->particles.slot_of[first + k] < slot) slot = world->particles.slot_of[first + k];
        const sk_group group = {first, first + count, slot, slot + count, 0};
        double radius = radius_for(&world->plan, &group);
        if (radius > 0 && list_slots(world, &group, radius)) move_to_list(world, &group, first);
    }
}
