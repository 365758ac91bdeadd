/* Tethers to what was pinned after its body was built: grabbed, painted, or held by a program.
 *
 * Those to the pins that a body was built with are as it was built. These are made anew before a step, where other
 * particles are pinned than before, from what there is then: so a world that reads a snapshot has the same. */
#include <string.h>

#include "world/cut.h"
#include "world/world.h"

bool sk_world_note_built_pins(skein_world *world, sk_body *body, bool tethered) {
    const bool *pinned = world->particles.pinned + body->first_particle;
    if (!tethered || !memchr(pinned, true, body->particle_count)) return true;
    body->built_pins = sk_allocate(&world->allocator, body->particle_count * sizeof *body->built_pins);
    if (body->built_pins) memcpy(body->built_pins, pinned, body->particle_count * sizeof *pinned);
    return body->built_pins;
}

/* Whether its surface is what gas is in: a balloon that somebody grabs is to stay as large as it has grown. */
static bool is_blown_up(const skein_world *world, const sk_body *body) {
    bool is = false;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        is |= batch->enclosure && batch->count && batch->particle[0] - body->first_particle < body->particle_count;
    }
    return is;
}

static bool is_late(const skein_world *world, const sk_body *body, size_t i) {
    const sk_particles *all = &world->particles;
    return all->pinned[body->first_particle + i] && all->mass[body->first_particle + i] > 0 &&
           !(body->built_pins && body->built_pins[i]);
}

/* Whether others are pinned than those that it has such tethers to. */
static bool has_others(const skein_world *world, const sk_body *body, bool none) {
    for (size_t i = 0; i < body->particle_count; i++)
        if ((!none && is_late(world, body, i)) != (body->late_pins && body->late_pins[i])) return true;
    return false;
}

void sk_world_remove_tethers(skein_world *world, const sk_body *body, bool late_alone) {
    sk_rules *rules = &world->rules;
    size_t kept = 0;
    for (size_t i = 0; i < rules->limits.count; i++) {
        sk_limit *limit = rules->limits.data[i];
        if (limit->bound == &body->tether_bound && (limit->late || !late_alone))
            sk_limit_release(limit, &world->allocator);
        else rules->limits.data[kept++] = limit;
    }
    rules->limits.count = kept;
}

static void remove_late(skein_world *world, sk_body *body) {
    sk_world_remove_tethers(world, body, true);
    sk_release(&world->allocator, body->late_pins);
    body->late_pins = NULL;
    world->plan_stale = true;
}

/* A new limit is a body's like the others; slots stay, so that it alone is arranged. */
static bool arrange_late(skein_world *world, sk_body *body, size_t first) {
    sk_rules *rules = &world->rules;
    bool good = true;
    for (size_t i = first; i < rules->limits.count; i++) {
        rules->limits.data[i]->late = true;
        if (body->batch_count) rules->limits.data[i]->enabled = body->batch[0]->enabled; // it may be another part's
    }
    if (body->cut) good = sk_cut_tethers(world, body);
    for (size_t i = first; i < rules->limits.count && good && !world->slots_stale; i++)
        if (*rules->limits.data[i]->enabled)
            good = sk_limit_arrange(rules->limits.data[i], &world->allocator, &world->particles);
    return good;
}

/* Instead of those that it has; `none`: and makes no others. */
static skein_status tether(skein_world *world, const sk_object *object, bool none, skein_error *error) {
    sk_body *body = object->as.body;
    const size_t first = world->rules.limits.count;
    const bool stale = world->slots_stale;
    bool *late = sk_allocate(&world->allocator, body->particle_count * sizeof *late), any = false;
    if (!late) return sk_fail_memory(error, "tethers");
    for (size_t i = 0; i < body->particle_count; i++) any |= late[i] = !none && is_late(world, body, i);
    skein_status status = any ? object->body_type->tether(world, body, object->params, late, error) : SKEIN_OK;
    world->slots_stale = stale;
    if (!status && !arrange_late(world, body, first)) status = sk_fail_memory(error, "tethers");
    body->late_pins = late;
    if (status) remove_late(world, body); // and are to be made by the next step
    return status;
}

skein_status sk_world_tether_pins(skein_world *world, skein_error *error) {
    if (!world->pins_stale && !world->slots_stale) return SKEIN_OK; // slots: when gas comes, too
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < world->objects.count && !status; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != SKEIN_BODY || !object->body_type->tether) continue;
        const bool none = world->device || is_blown_up(world, object->as.body); // cards run none
        if (!has_others(world, object->as.body, none)) continue;
        remove_late(world, object->as.body);
        status = tether(world, object, none, error);
    }
    world->pins_stale = status != SKEIN_OK;
    return status;
}
