/* Bodies that come and go: taken out of it and back, removed for good, and the indices that are used again; and what cuts
 * leave of constraints.
 *
 * A body that is disabled keeps all it has; its particles lie behind those that take part (particles/particles.h), so
 * that no op of a plan meets them. One that is removed leaves its particles' indices: they are gone, and the next body
 * that fits into a run of them gets it. Constraints of the program's own on such particles are left out one by one. */
#include <string.h>

#include "world/cut.h"

static void mark(skein_world *world) {
    world->plan_stale = world->slots_stale = world->presence_stale = true;
}

skein_status sk_world_enable_body(skein_world *world, sk_body *body, bool enabled) {
    if (body->enabled == enabled) return SKEIN_OK;
    skein_status status = sk_world_touch(world); // the state goes to new slots
    if (status) return status;
    body->enabled = enabled;
    sk_body_forget_rest(world, body);
    sk_particles_set_presence(&world->particles, body->first_particle, body->particle_count,
                              enabled ? SK_HERE : SK_ASIDE);
    if (enabled) sk_world_ease_meetings(world, body);
    mark(world);
    return SKEIN_OK;
}

static bool is_of(const sk_body *body, const sk_batch *batch) {
    for (size_t i = 0; i < body->batch_count; i++)
        if (body->batch[i] == batch) return true;
    return false;
}

/* The body whose cuts count for a batch: that which it is part of, or which its surface is; NULL: nothing is cut there. */
static sk_body *cut_body_of(const skein_world *world, const sk_batch *batch) {
    for (size_t i = 0; i < world->objects.count; i++) {
        if (world->objects.data[i]->category != SKEIN_BODY) continue;
        sk_body *body = world->objects.data[i]->as.body;
        if (!body->cut || !body->cut->count) continue;
        bool surface = batch->enclosure && batch->particle[0] - body->first_particle < body->particle_count;
        if (surface || is_of(body, batch)) return body;
    }
    return NULL;
}

skein_status sk_world_settle_presence(skein_world *world, skein_error *error) {
    bool good = true;
    for (size_t i = 0; i < world->objects.count && world->presence_stale && good; i++)
        if (world->objects.data[i]->category == SKEIN_BODY && world->objects.data[i]->as.body->cut)
            good = sk_cut_tethers(world, world->objects.data[i]->as.body);
    for (size_t i = 0; i < world->rules.batches.count && world->presence_stale && good; i++) {
        sk_batch *batch = world->rules.batches.data[i];
        const sk_body *body = cut_body_of(world, batch);
        const sk_severing severing = {sk_cut_severs, body ? body->cut : NULL};
        if (body) sk_cut_look_at(body->cut, batch);
        good = sk_batch_leave_out_severed(batch, &world->allocator, &world->particles, body ? &severing : NULL);
    }
    if (!good) return sk_fail_memory(error, "what is left of constraints");
    world->presence_stale = false;
    return SKEIN_OK;
}

/* ---- names ---- */

/* Whether a text of pairs that do not meet has a name. */
static bool ignores(const sk_force *force, sk_word name) {
    const char *text = force->type->meeting ? force->type->meeting->ignored(force->params) : "";
    for (sk_word word; (word = sk_names_next(&text, ",:")).length;)
        if (word.length == name.length && !memcmp(word.at, name.at, name.length)) return true;
    return false;
}

/* Whether a rule names a body or a group. */
static bool is_named(const skein_world *world, sk_word name) {
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        const sk_force *force = world->rules.forces.data[i];
        const char *neighbours = force->type->neighbours ? force->type->neighbours(force->params) : "";
        if (sk_names_have(*force->on, name) || sk_names_have(neighbours, name) || ignores(force, name)) return true;
    }
    for (size_t i = 0; i < world->rules.colliders.count; i++)
        if (sk_names_have(world->rules.colliders.data[i]->common->on, name)) return true;
    for (size_t i = 0; i < world->motions.count; i++)
        if (sk_names_have(world->motions.data[i]->common->on, name)) return true;
    return false;
}

static bool is_remembered(const skein_world *world, sk_word name) {
    for (size_t i = 0; i < world->gone_names.count; i++)
        if (sk_word_is(name, world->gone_names.data[i])) return true;
    return false;
}

/* Rules that name a body which is removed, or a group that nobody is in any more, move nobody, until somebody is called
 * so again. */
static skein_status remember_name(skein_world *world, sk_word name) {
    if (!is_named(world, name) || is_remembered(world, name)) return SKEIN_OK;
    char *copy = SK_RESERVE(&world->allocator, &world->gone_names, world->gone_names.count + 1)
                     ? sk_allocate(&world->allocator, name.length + 1)
                     : NULL;
    if (!copy) return sk_fail_memory(sk_world_error(world), "the name of a body");
    memcpy(copy, name.at, name.length); // what is allocated is zero
    world->gone_names.data[world->gone_names.count++] = copy;
    return SKEIN_OK;
}

skein_status sk_world_remember_names(skein_world *world, const char *names) {
    skein_status status = SKEIN_OK;
    for (sk_word name; !status && (name = sk_names_next(&names, ",")).length;) status = remember_name(world, name);
    return status;
}

void sk_world_forget_names(skein_world *world) {
    while (world->gone_names.count) sk_release(&world->allocator, world->gone_names.data[--world->gone_names.count]);
}

/* ---- removing ---- */

static void remove_triangles(skein_world *world, const sk_body *body) {
    sk_triangles *all = &world->triangles;
    size_t first = body->first_triangle, end = first + body->triangle_count;
    if (!body->triangle_count) return;
    memmove(all->corner + first, all->corner + end, (all->count - end) * sizeof *all->corner);
    all->count -= body->triangle_count;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category == SKEIN_BODY && object->as.body->first_triangle >= end)
            object->as.body->first_triangle -= body->triangle_count;
    }
}

static void remove_rules(skein_world *world, const sk_body *body) {
    sk_rules *rules = &world->rules;
    size_t kept = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        if (is_of(body, rules->batches.data[i])) sk_batch_release(rules->batches.data[i], &world->allocator);
        else rules->batches.data[kept++] = rules->batches.data[i];
    }
    rules->batches.count = kept;
    sk_world_remove_tethers(world, body, false);
}

/* Nobody who gets the indices is led to where these were to go, or along their tracks. */
static void remove_pins(skein_world *world, const sk_body *body) {
    size_t kept = 0;
    for (size_t i = 0; i < world->motions.count; i++) {
        sk_track *track = &world->motions.data[i]->track;
        for (size_t k = 0; k < track->particle_count; k++)
            if (track->particles[k] - body->first_particle < body->particle_count) track->particles[k] = SK_NOBODY;
    }
    for (size_t i = 0; i < world->pins.count; i++) {
        const sk_pin pin = world->pins.data[i];
        if (pin.particle - body->first_particle >= body->particle_count) world->pins.data[kept++] = pin;
    }
    world->pins.count = kept;
}

skein_status sk_world_remove_body(skein_world *world, sk_body *body, const char *name, const char *groups) {
    skein_status status = sk_world_touch(world);
    if (!status) status = remember_name(world, sk_word_of(name));
    if (!status) status = sk_world_remember_names(world, groups);
    if (status) return status;
    remove_rules(world, body);
    remove_triangles(world, body);
    remove_pins(world, body);
    sk_particles_set_presence(&world->particles, body->first_particle, body->particle_count, SK_GONE);
    sk_body_release(world, body);
    mark(world);
    return SKEIN_OK;
}

/* ---- using indices again ---- */

static void renumber(uint32_t *particles, size_t count, size_t offset) {
    for (size_t i = 0; i < count; i++) particles[i] -= (uint32_t)offset;
}

void sk_world_reuse_indices(skein_world *world, sk_body *body, size_t batches, size_t limits) {
    size_t first = body->first_particle;
    size_t target = sk_particles_find_room(&world->particles, first, body->particle_count), offset = first - target;
    if (!offset) return;
    const sk_rules *rules = &world->rules;
    for (size_t i = batches; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        renumber(batch->particle, batch->count * batch->arity, offset);
        if (!batch->aggregate) continue;
        renumber(batch->aggregate->hub, batch->aggregate->hub_count, offset);
        renumber(batch->aggregate->particle, batch->aggregate->count, offset);
    }
    for (size_t i = limits; i < rules->limits.count; i++)
        renumber(rules->limits.data[i]->particle, rules->limits.data[i]->count * (1 + rules->limits.data[i]->anchors),
                 offset);
    for (size_t t = body->first_triangle; t < world->triangles.count; t++)
        renumber(world->triangles.corner[t], 3, offset);
    renumber(body->particle_of_vertex, body->vertex_count, offset);
    body->first_particle = (uint32_t)target;
    sk_particles_renumber(&world->particles, first, target);
}

bool skein_particle_present(const skein_world *world, size_t particle) {
    return world && particle < world->particles.count && sk_particle_counts(&world->particles, particle);
}
