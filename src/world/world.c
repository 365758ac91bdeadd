/* The world's life: made, filled by builders, destroyed. */
#include "world/world.h"
#include "plan/share_part.h"
#include "world/cut.h"
#include "world/record.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"

int skein_version(void) {
    return SKEIN_VERSION_NUMBER;
}

skein_world_desc skein_default_world_desc(void) {
    return (skein_world_desc){.thread_count = 0};
}

/* Of all worlds that live none has the same address, which fills the upper bits; the time keeps a world that comes to
 * lie where another was from answering to its handles. (A counter would have to be global.) */
static uint64_t find_identity(const skein_world *world) {
    uint64_t address = (uintptr_t)world;
    return (address << 16 | address >> 48) ^ (sk_hash_mix((uint64_t)(sk_seconds() * 1e9)) >> 42);
}

/* A step takes as many threads as have proved faster. SKEIN_THREADS=always, for tests and measurements: all that were
 * asked for, and one where none were. */
static void set_pace(skein_world *world, int asked) {
    const char *word = getenv("SKEIN_THREADS");
    bool always = word && !strcmp(word, "always");
    sk_pace_start(&world->pace, world->desc.run_tasks ? 1 : always && !asked ? 1 : sk_tasks_most(world->tasks), always);
}

skein_world *skein_world_create(const skein_world_desc *desc, skein_error *error) {
    skein_world_desc taken = desc ? *desc : skein_default_world_desc();
    if (taken.thread_count < 0 || taken.thread_count > 64) {
        sk_fail(error, SKEIN_ERROR_VALUE, "thread_count", "%d threads: expected 0 to 64", taken.thread_count);
        return NULL;
    }
    if (!taken.allocate != !taken.release) {
        sk_fail(error, SKEIN_ERROR_VALUE, "allocate", "a world takes both allocate and release, or neither");
        return NULL;
    }
    if (!sk_isa_is_there()) {
        sk_fail(error, SKEIN_ERROR_LIMIT, "", "this processor has no SSE 4.1, which Skein needs: take a newer one");
        return NULL;
    }
    sk_allocator allocator = sk_default_allocator();
    if (taken.allocate) allocator = (sk_allocator){taken.allocate, taken.release, taken.memory_user, 0};
    skein_world *world = sk_allocate(&allocator, sizeof *world);
    if (!world) {
        sk_fail_memory(error, "a world");
        return NULL;
    }
    world->allocator = allocator;
    world->identity = find_identity(world);
    world->error = &world->words;
    world->desc = taken;
    world->plan_stale = world->slots_stale = true;
    world->isa = sk_isa_choose();
    world->tasks = sk_tasks_create(&world->allocator, &world->desc);
    if (world->tasks) set_pace(world, taken.thread_count);
    if (!world->tasks || sk_world_set_method(world, &sk_xpbd, NULL)) {
        sk_fail(error, SKEIN_ERROR_MEMORY, "", "no memory or no threads for a world of %d threads", taken.thread_count);
        skein_world_destroy(world);
        return NULL;
    }
    return world;
}

void sk_body_release(skein_world *world, sk_body *body) {
    sk_allocator *allocator = &world->allocator;
    for (size_t i = 0; i < body->batch_count; i++) sk_release(allocator, body->material[i]);
    sk_release(allocator, body->particle_of_vertex);
    sk_release(allocator, body->face_sizes);
    sk_release(allocator, body->face_vertices);
    sk_release(allocator, body->corner_uv);
    sk_release(allocator, body->rest.from);
    sk_release(allocator, body->built_pins);
    sk_release(allocator, body->late_pins);
    sk_cut_release(body->cut, allocator);
    sk_release(allocator, body);
}

/* An object's rules are released with the world's lists. */
static void release_object(skein_world *world, sk_object *object) {
    if (object->category == SKEIN_BODY && object->as.body) sk_body_release(world, object->as.body);
    sk_object_release(&world->allocator, object);
}

void skein_world_destroy(skein_world *world) {
    if (!world) return;
    sk_allocator *allocator = &world->allocator;
    sk_rules *rules = &world->rules;
    if (world->recording) skein_record_end(world);
    if (world->device) world->device->release(world->device, world);
    sk_share_destroy(world->share, &world->allocator);
    sk_tasks_destroy(world->tasks);
    for (size_t i = 0; i < rules->batches.count; i++) sk_batch_release(rules->batches.data[i], allocator);
    for (size_t i = 0; i < rules->forces.count; i++) sk_world_end_meeting(world, rules->forces.data[i]);
    for (size_t i = 0; i < rules->forces.count; i++) sk_release(allocator, rules->forces.data[i]->only.data);
    for (size_t i = 0; i < rules->colliders.count; i++) sk_release(allocator, rules->colliders.data[i]->only.data);
    for (size_t i = 0; i < rules->forces.count; i++) sk_release(allocator, rules->forces.data[i]);
    for (size_t i = 0; i < rules->colliders.count; i++) sk_release(allocator, rules->colliders.data[i]);
    for (size_t i = 0; i < rules->limits.count; i++) sk_limit_release(rules->limits.data[i], allocator);
    sk_release(allocator, rules->batches.data);
    sk_release(allocator, rules->forces.data);
    sk_release(allocator, rules->colliders.data);
    sk_release(allocator, rules->limits.data);
    for (size_t i = 0; i < world->motions.count; i++) sk_motion_release(world->motions.data[i], allocator);
    sk_release(allocator, world->motions.data);
    for (size_t i = 0; i < world->objects.count; i++) release_object(world, world->objects.data[i]);
    sk_release(allocator, world->objects.data);
    sk_release(allocator, world->places.data);
    sk_world_forget_names(world);
    sk_release(allocator, world->gone_names.data);
    sk_release(allocator, world->compiled.data);
    sk_release(allocator, world->pins.data);
    sk_release(allocator, world->led.data);
    sk_release(allocator, world->legs.data);
    sk_release(allocator, world->carried.data);
    sk_release(allocator, world->leashes.data);
    sk_release(allocator, world->led_at);
    if (world->method)
        sk_fields_clear(allocator, world->method->kind.fields, world->method->kind.field_count, world->method_params);
    sk_release(allocator, world->method_params);
    sk_release(allocator, world->triangles.corner);
    sk_surface_release(&world->surface, allocator);
    sk_release(allocator, world->plan.data);
    sk_release(allocator, world->live);
    sk_release(allocator, world->watch.moved);
    sk_release(allocator, world->watch.found_held);
    sk_release(allocator, world->plan.parts.data);
    skein_sparse_solver_set(world, NULL);
    sk_matrix_release(&world->matrix, allocator);
    sk_cells_release(&world->cells, allocator);
    sk_particles_release(&world->particles, allocator);
    sk_allocator last = world->allocator;
    sk_release(&last, world);
}

const skein_error *skein_world_error(const skein_world *world) {
    static const skein_error no_world = {SKEIN_ERROR_VALUE, "world", "there is no world: the pointer is NULL"};
    return world ? world->error : &no_world;
}

skein_error *sk_world_error(const skein_world *world) {
    return world ? world->error : NULL;
}

void sk_world_log(skein_world *world, skein_log_level level, const char *format, ...) {
    if (!world->desc.log) return;
    char message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    world->desc.log(world->desc.log_user, level, message);
}

/* ---- what builders call ---- */

/* The largest magnitude that a position or velocity may have, so that squares stay finite. */
static bool is_sane(double x) {
    return x >= -SK_FAR && x <= SK_FAR;
}

skein_status sk_world_add_particles(skein_world *world, size_t count, const double *positions, const double *velocities,
                                    const double *masses, skein_error *error) {
    if (count > (size_t)UINT32_MAX - 64 - world->particles.count)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "%zu more particles: a world holds at most %u", count,
                       UINT32_MAX - 64);
    for (size_t i = 0; i < 3 * count; i++) {
        if (!is_sane(positions[i]) || (velocities && !is_sane(velocities[i])))
            return sk_fail(error, SKEIN_ERROR_VALUE, "",
                           "particle %zu: positions and velocities must be finite, under 1e15", i / 3);
        if (!(masses[i / 3] >= 0) || masses[i / 3] > SK_FAR || (masses[i / 3] > 0 && masses[i / 3] < 1e-15))
            return sk_fail(error, SKEIN_ERROR_VALUE, "",
                           "particle %zu: a mass of %g kg; expected 0 (pinned) or 1e-15 to 1e15", i / 3, masses[i / 3]);
    }
    skein_status status = sk_world_touch(world);
    if (status) return status;
    if (!sk_particles_add(&world->particles, &world->allocator, count, positions, velocities, masses))
        return sk_fail_memory(error, "particles");
    world->plan_stale = world->slots_stale = world->motions_stale = true;
    return SKEIN_OK;
}

skein_status sk_world_add_body_batch(skein_world *world, sk_body *body, const sk_constraint_type *type,
                                     const char *label, sk_material material, bool measured, size_t count,
                                     const uint32_t *particles, const real *rest, const real *scale,
                                     skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    if (body->batch_count == SK_MOST_BODY_BATCHES)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "a body has at most %d batches", SK_MOST_BODY_BATCHES);
    if (!SK_RESERVE(allocator, &world->rules.batches, world->rules.batches.count + 1))
        return sk_fail_memory(error, label);
    sk_material *own = sk_allocate(allocator, sizeof *own);
    sk_batch *batch = own ? sk_batch_create(allocator, type, own, count, particles, rest, scale) : NULL;
    if (!batch) {
        sk_release(allocator, own);
        return sk_fail_memory(error, label);
    }
    *own = material;
    batch->params = own;
    batch->label = label;
    batch->enabled = &body->enabled;
    batch->measured = measured;
    body->batch[body->batch_count] = batch;
    body->material[body->batch_count++] = own;
    world->rules.batches.data[world->rules.batches.count++] = batch;
    world->plan_stale = world->slots_stale = true;
    return SKEIN_OK;
}

skein_status sk_world_add_tethers(skein_world *world, sk_body *body, sk_limit_order order, size_t count, size_t anchors,
                                  const uint32_t *particles, const real *lengths, skein_error *error) {
    if (!SK_RESERVE(&world->allocator, &world->rules.limits, world->rules.limits.count + 1))
        return sk_fail_memory(error, "tethers");
    sk_limit *limit = sk_tethers_create(&world->allocator, count, anchors, particles, lengths);
    if (!limit) return sk_fail_memory(error, "tethers");
    limit->label = "tethers";
    limit->order = order;
    limit->bound = &body->tether_bound;
    limit->enabled = &body->enabled;
    world->rules.limits.data[world->rules.limits.count++] = limit;
    world->plan_stale = world->slots_stale = true;
    return SKEIN_OK;
}

void sk_world_sweep_both_ways(sk_body *body) {
    body->batch[body->batch_count - 1]->both_ways = true;
}

void sk_world_take_seldom(sk_body *body, double quickness) {
    body->batch[body->batch_count - 1]->quickness = quickness;
}

bool sk_world_bound_coarse(skein_world *world, sk_body *body, const double *bound, const sk_coarse *coarse) {
    sk_batch *batch = body->batch[body->batch_count - 1];
    sk_world_only_bound(body, bound);
    batch->coarse = sk_allocate(&world->allocator, sizeof *batch->coarse);
    if (batch->coarse) *batch->coarse = *coarse;
    return batch->coarse;
}

void sk_world_bound_aggregate(sk_body *body, const double *bound, sk_aggregate *aggregate) {
    sk_world_only_bound(body, bound);
    body->batch[body->batch_count - 1]->aggregate = aggregate;
}

void sk_world_only_bound(sk_body *body, const double *bound) {
    sk_batch *batch = body->batch[body->batch_count - 1];
    batch->bound = bound;
    batch->only_bounds = true;
}

void sk_world_add_strain_limit(sk_body *body) {
    body->batch[body->batch_count - 1]->bound = &body->strain_bound;
}

void sk_world_keep_firm(sk_body *body) {
    body->batch[body->batch_count - 1]->tether = &body->tether_bound;
}

skein_status sk_world_add_strips(skein_world *world, const sk_body *body, uint32_t rows, uint32_t columns,
                                 uint32_t count, const uint32_t *place, skein_error *error) {
    if (!sk_particles_add_strips(&world->particles, &world->allocator,
                                 (sk_strips){body->first_particle, count, rows, columns, 0, 0}, place))
        return sk_fail_memory(error, "strips");
    world->plan_stale = world->slots_stale = true;
    return SKEIN_OK;
}

void sk_world_rank_particles(skein_world *world, const sk_body *body, const uint32_t *rank, size_t count) {
    for (size_t i = 0; i < count; i++) world->particles.rank[body->first_particle + i] = body->first_particle + rank[i];
    world->plan_stale = world->slots_stale = true;
}

skein_status sk_world_add_triangles(skein_world *world, size_t count, const uint32_t (*corners)[3], skein_error *error) {
    sk_triangles *all = &world->triangles;
    size_t need = all->count + count;
    if (!sk_reserve(&world->allocator, (void **)&all->corner, &all->capacity, need, sizeof *all->corner))
        return sk_fail_memory(error, "triangles");
    if (count) memcpy(all->corner + all->count, corners, count * sizeof *corners);
    all->count = need;
    world->plan_stale = world->slots_stale = true;
    return SKEIN_OK;
}

skein_status skein_particles_add(skein_world *world, size_t count, const double *positions, const double *velocities,
                                 const double *masses, uint32_t *first) {
    SK_NEED(world, world);
    if (count) SK_NEED(world, positions);
    if (count) SK_NEED(world, masses);
    uint32_t place = (uint32_t)skein_particle_count(world);
    skein_status status = sk_world_add_particles(world, count, positions, velocities, masses, sk_world_error(world));
    if (!status && count) sk_record_stop(world, "particles were added, which a recording cannot hold");
    if (!status && first) *first = place;
    return status;
}
