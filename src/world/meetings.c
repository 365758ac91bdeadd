/* What surfaces meet: the parts of bodies that rules of contact are shown. */
#include "world/world.h"

/* The edges of bodies that have no triangles: ropes. */
static bool list_edges(const skein_world *world, sk_allocator *allocator, uint32_t (**edges)[2], size_t *count) {
    size_t most = 0;
    *count = 0;
    *edges = NULL;
    for (int pass = 0; pass < 2; pass++) {
        if (pass && !(*edges = sk_allocate(allocator, (most + 1) * sizeof **edges))) return false;
        for (size_t i = 0; i < world->objects.count; i++) {
            const sk_object *object = world->objects.data[i];
            if (object->category != SKEIN_BODY || object->as.body->triangle_count) continue;
            for (size_t b = 0; b < object->as.body->batch_count; b++) {
                const sk_batch *batch = object->as.body->batch[b];
                if (!batch->measured || batch->arity != 2) continue;
                most += batch->count;
                for (size_t e = 0; pass && e < batch->count; e++, ++*count)
                    for (int k = 0; k < 2; k++) (*edges)[*count][k] = batch->particle[2 * e + (size_t)k];
            }
        }
    }
    return true;
}

static size_t count_those_that_meet(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < world->rules.forces.count; i++)
        count += *world->rules.forces.data[i]->enabled && world->rules.forces.data[i]->type->meeting;
    return count;
}

skein_status sk_world_prepare_meetings(skein_world *world, skein_error *error) {
    size_t rules = count_those_that_meet(world);
    if (!rules) return SKEIN_OK;
    sk_allocator *allocator = &world->allocator;
    uint32_t(*edges)[2];
    size_t edge_count;
    bool good = list_edges(world, allocator, &edges, &edge_count);
    sk_meeting_parts parts = {.triangle = (const uint32_t(*)[3])world->triangles.corner,
                              .triangle_count = world->triangles.count,
                              .edge = (const uint32_t(*)[2])edges,
                              .edge_count = edge_count,
                              .arrangement = world->arrangement,
                              .rule_count = rules};
    for (size_t i = 0; i < world->rules.forces.count && good; i++) {
        sk_force *force = world->rules.forces.data[i];
        if (*force->enabled && force->type->meeting)
            good = force->type->meeting->prepare(force, allocator, &world->particles, &parts, world->isa);
    }
    sk_release(allocator, edges);
    return good ? SKEIN_OK : sk_fail_memory(error, "contact");
}

skein_status sk_world_count_crossings(skein_world *world, size_t *count, skein_error *error) {
    *count = 0;
    skein_status status = sk_world_prepare_meetings(world, error);
    for (size_t i = 0; i < world->rules.forces.count && !status; i++) {
        sk_force *force = world->rules.forces.data[i];
        size_t own = 0;
        if (!*force->enabled || !force->type->meeting) continue;
        if (!force->type->meeting->crossings(force, &world->allocator, world->particles.vector[SK_X],
                                             world->particles.slot_of, &own))
            return sk_fail_memory(error, "contact");
        *count += own;
    }
    return status;
}

void sk_world_tell_of_meetings(skein_world *world) {
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        sk_force *force = world->rules.forces.data[i];
        if (*force->enabled && force->type->meeting && force->type->meeting->gave_up(force))
            sk_world_log(world, SKEIN_LOG_WARNING,
                         "%s: more pairs were near each other than there is room for, and nothing touched for a substep "
                         "or more: the thickness is too large for the bodies, or they have blown up",
                         force->label);
    }
}

void sk_world_end_meeting(skein_world *world, sk_force *force) {
    if (force->type->meeting) force->type->meeting->release(force, &world->allocator);
}
