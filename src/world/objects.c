/* Objects: what users hold handles of. Adding, removing and finding them. */
#include <stdio.h>
#include <string.h>

#include "world/record.h"
#include "world/world.h"

/* ---- handles ---- */

sk_object *sk_object_of(const skein_world *world, skein_handle handle) {
    if (handle.world != world->identity || handle.index >= world->places.count) return NULL;
    const sk_entry *entry = &world->places.data[handle.index];
    return entry->generation == handle.generation && handle.generation % 2 ? entry->object : NULL;
}

skein_status sk_fail_handle(const skein_world *world, skein_handle handle, const char *what, const char *where) {
    const sk_object *object = sk_object_of(world, handle);
    skein_error *error = sk_world_error(world);
    if (object || skein_object_kind(world, handle))
        return sk_fail(error, SKEIN_ERROR_HANDLE, where, "there is no such %s: the handle is of a %s", what,
                       skein_category_text(object ? object->category : SKEIN_METHOD));
    bool elsewhere = handle.generation % 2 && handle.world != world->identity;
    return sk_fail(error, SKEIN_ERROR_HANDLE, where, "there is no such %s: its handle is %s", what,
                   elsewhere ? "of another world" : "stale");
}

sk_object *sk_object_find(const skein_world *world, skein_handle handle, skein_category category) {
    sk_object *object = sk_object_of(world, handle);
    if (object && (category == SKEIN_CATEGORY_COUNT || object->category == category)) return object;
    sk_fail_handle(world, handle, category == SKEIN_CATEGORY_COUNT ? "object" : skein_category_text(category), "");
    return NULL;
}

skein_handle sk_handle_at(const skein_world *world, size_t index) {
    const sk_object *object = world->objects.data[index];
    return (skein_handle){object->index, object->generation, world->identity};
}

bool skein_handle_valid(const skein_world *world, skein_handle handle) {
    if (!world) return false;
    return sk_object_of(world, handle) != NULL;
}

skein_status skein_user_set(skein_world *world, skein_handle handle, void *user) {
    SK_NEED(world, world);
    sk_object *object = sk_object_find(world, handle, SKEIN_CATEGORY_COUNT);
    if (!object) return SKEIN_ERROR_HANDLE;
    object->user = user;
    return SKEIN_OK;
}

void *skein_user(const skein_world *world, skein_handle handle) {
    if (!world) return NULL;
    const sk_object *object = sk_object_of(world, handle);
    return object ? object->user : NULL;
}

void sk_object_release(sk_allocator *allocator, sk_object *object) {
    size_t common_count;
    const skein_field *common = sk_common_fields(object->category, &common_count);
    if (object->params) {
        if (object->making) object->making->unmake(object->params, allocator);
        sk_fields_clear(allocator, object->kind->fields, object->kind->field_count, object->params);
        sk_fields_clear(allocator, common, common_count, sk_common_of(object));
    }
    sk_release(allocator, object->params);
    sk_release(allocator, object->own_kind);
    sk_release(allocator, object);
}

/* Its kind, its parameters, and what its type makes from them. */
static skein_status fill_object(sk_allocator *allocator, sk_object *object, const sk_presets *presets,
                                const skein_setting *settings, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (sk_takes_parameters(object->kind)) {
        status = sk_own_kind_create(allocator, object->kind, settings, &object->own_kind, error);
        if (status) return status;
        object->kind = object->own_kind;
    }
    size_t common_count;
    const skein_field *common = sk_common_fields(object->category, &common_count);
    object->params = sk_allocate(allocator, object->kind->params_size);
    if (!object->params) return sk_fail_memory(error, object->kind->name);
    status = sk_settings_apply(allocator, object->kind, presets, object->params, common, common_count,
                               sk_common_of(object), settings, error);
    if (!status && object->making) status = object->making->make(object->params, object->kind, allocator, error);
    return status;
}

/* A new object with its parameters set; it lives (its generation turns odd) once its rule is made. */
static skein_status make_with_presets(skein_world *world, const skein_kind *kind, const sk_making *making,
                                      const sk_presets *presets, const skein_setting *settings, sk_object **made,
                                      skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    if (!SK_RESERVE(allocator, &world->objects, world->objects.count + 1) ||
        !SK_RESERVE(allocator, &world->places, world->places.count + 1))
        return sk_fail_memory(error, kind->name);
    sk_object *object = sk_allocate(allocator, sizeof *object);
    if (!object) return sk_fail_memory(error, kind->name);
    object->category = kind->category;
    object->kind = kind;
    object->making = making;
    skein_status status = fill_object(allocator, object, presets, settings, error);
    if (status) {
        sk_object_release(allocator, object);
        return status;
    }
    const char *name = kind->category == SKEIN_COLLIDER ? object->common.collider.name
                       : kind->category == SKEIN_MOTION ? object->common.motion.name
                                                        : object->common.plain.name;
    sk_label_copy(object->label, sizeof object->label, name[0] ? name : kind->name);
    world->objects.data[world->objects.count++] = object;
    *made = object;
    return SKEIN_OK;
}

static skein_status make_object(skein_world *world, const skein_kind *kind, const sk_making *making,
                                const skein_setting *settings, sk_object **made, skein_error *error) {
    return make_with_presets(world, kind, making, NULL, settings, made, error);
}

/* Takes the newest object back. */
static void unmake_object(skein_world *world, sk_object *object) {
    sk_object_release(&world->allocator, object);
    world->objects.count--;
}

/* Gives it a handle, the first whose object is gone; there is room for one more. */
static skein_status finish_object(skein_world *world, sk_object *object, skein_handle *handle) {
    size_t index = 0;
    if (world->objects.count > world->places.count) index = world->places.count; // all others have an object
    while (index < world->places.count && world->places.data[index].object) index++;
    if (index == world->places.count) world->places.data[world->places.count++] = (sk_entry){NULL, 0};
    sk_entry *entry = &world->places.data[index];
    entry->object = object;
    object->index = (uint32_t)index;
    object->generation = ++entry->generation;
    sk_record_stop(world, "an object was added, which a recording cannot hold");
    world->plan_stale = world->motions_stale = true;
    sk_world_rouse(world);
    if (object->category == SKEIN_CONSTRAINT || object->category == SKEIN_BODY) world->slots_stale = true;
    if (handle) *handle = (skein_handle){object->index, object->generation, world->identity};
    return SKEIN_OK;
}

/* ---- adding ---- */

skein_status sk_world_add_force(skein_world *world, const sk_force_type *type, const skein_setting *settings,
                                skein_handle *handle) {
    skein_error *error = sk_world_error(world);
    sk_object *object;
    skein_status status = make_object(world, &type->kind, type->making, settings, &object, error);
    if (status) return status;
    if (type->meeting && (status = type->meeting->check(object->params, error))) {
        unmake_object(world, object);
        return status;
    }
    sk_force *force = SK_RESERVE(&world->allocator, &world->rules.forces, world->rules.forces.count + 1)
                          ? sk_allocate(&world->allocator, sizeof *force)
                          : NULL;
    if (!force) {
        unmake_object(world, object);
        return sk_fail_memory(error, type->kind.name);
    }
    *force = (sk_force){.type = type,
                        .params = object->params,
                        .label = object->label,
                        .enabled = &object->common.plain.enabled,
                        .on = &object->common.plain.on,
                        .easing = {.asks_end = UINT32_MAX}};
    world->rules.forces.data[world->rules.forces.count++] = force;
    object->as.force = force;
    return finish_object(world, object, handle);
}

/* Its mesh, and what is wrong with that. */
static skein_status take_mesh(skein_world *world, const sk_collider_type *type, sk_object *object,
                              const skein_mesh *mesh, skein_error *error) {
    if (!type->take && mesh)
        return sk_fail(error, SKEIN_ERROR_MESH, "", "a %s is made without a mesh", type->kind.name);
    sk_faults_text faults = {""};
    skein_status status = type->take ? type->take(object->params, mesh, &world->allocator, &faults, error) : SKEIN_OK;
    if (status || !faults.text[0]) return status;
    sk_world_log(world, SKEIN_LOG_WARNING, "%s: %s", object->label, faults.text);
    return status;
}

skein_status sk_world_add_collider(skein_world *world, const sk_collider_type *type, const skein_mesh *mesh,
                                   const skein_setting *settings, skein_handle *handle) {
    skein_error *error = sk_world_error(world);
    sk_object *object;
    skein_status status = make_object(world, &type->kind, type->making, settings, &object, error);
    if (status) return status;
    status = take_mesh(world, type, object, mesh, error);
    if (!status && type->check) status = type->check(object->params, error);
    if (status) {
        unmake_object(world, object);
        return status;
    }
    sk_collider *collider = SK_RESERVE(&world->allocator, &world->rules.colliders, world->rules.colliders.count + 1)
                                ? sk_allocate(&world->allocator, sizeof *collider)
                                : NULL;
    if (!collider) {
        unmake_object(world, object);
        return sk_fail_memory(error, type->kind.name);
    }
    *collider = (sk_collider){
        .type = type, .params = object->params, .common = &object->common.collider, .label = object->label};
    world->rules.colliders.data[world->rules.colliders.count++] = collider;
    object->as.collider = collider;
    return finish_object(world, object, handle);
}

skein_status sk_world_add_motion(skein_world *world, const sk_motion_type *type, const skein_track *track,
                                 const skein_setting *settings, skein_handle *handle) {
    skein_error *error = sk_world_error(world);
    sk_object *object;
    skein_status status = sk_world_check_track(world, type, track);
    if (!status) status = make_object(world, &type->kind, type->making, settings, &object, error);
    if (status) return status;
    status = sk_motion_check_jumps(&object->common.motion, error);
    if (!status && type->check) status = type->check(object->params, error);
    if (status) {
        unmake_object(world, object);
        return status;
    }
    sk_motion *motion = SK_RESERVE(&world->allocator, &world->motions, world->motions.count + 1)
                            ? sk_motion_create(&world->allocator, type, track)
                            : NULL;
    if (!motion) {
        unmake_object(world, object);
        return sk_fail_memory(error, type->kind.name);
    }
    motion->params = object->params;
    motion->common = &object->common.motion;
    motion->label = object->label;
    world->motions.data[world->motions.count++] = motion;
    object->as.motion = motion;
    return finish_object(world, object, handle);
}

/* What is wrong with a constraint's particles; NULL: nothing. */
static skein_status check_particles(const skein_world *world, const sk_object *object, const uint32_t *particles,
                                    size_t count, size_t arity, skein_error *error) {
    for (size_t i = 0; i < count * arity; i++)
        if (particles[i] >= world->particles.count)
            return sk_fail(error, SKEIN_ERROR_VALUE, "", "%s %zu: there is no particle %u (the world has %zu)",
                           object->kind->name, i / arity, particles[i], world->particles.count);
    for (size_t e = 0; e < count; e++)
        for (size_t i = 1; i < arity; i++)
            for (size_t j = 0; j < i; j++)
                if (particles[e * arity + i] == particles[e * arity + j])
                    return sk_fail(error, SKEIN_ERROR_VALUE, "", "%s %zu: particle %u is named twice",
                                   object->kind->name, e, particles[e * arity + i]);
    return SKEIN_OK;
}

/* Rest values from where the particles stand; NULL when there is no memory. */
static real *find_rests(skein_world *world, const sk_constraint_type *type, const void *params,
                        const uint32_t *particles, size_t count) {
    size_t arity = (size_t)sk_constraint_arity(type, params), rests = (size_t)sk_constraint_rest_count(type, params);
    real *rest = sk_allocate(&world->allocator, count * rests * sizeof *rest);
    for (size_t e = 0; e < count && rest && rests; e++) {
        double x[SK_MOST_ARITY][3], values[SKEIN_FORMULA_MOST_RESTS];
        for (size_t k = 0; k < arity; k++) {
            sk_vec4 p = world->particles.vector[SK_X][world->particles.slot_of[particles[e * arity + k]]];
            x[k][0] = (double)p.x, x[k][1] = (double)p.y, x[k][2] = (double)p.z;
        }
        if (!type->rest(params, (const double(*)[3])x, values)) {
            sk_release(&world->allocator, rest);
            return NULL;
        }
        for (size_t r = 0; r < rests; r++) rest[r * count + e] = (real)values[r];
    }
    return rest;
}

skein_status sk_world_add_constraint(skein_world *world, const sk_constraint_type *type, const uint32_t *particles,
                                     size_t count, const skein_setting *settings, skein_handle *handle) {
    skein_error *error = sk_world_error(world);
    sk_allocator *allocator = &world->allocator;
    if (count > SIZE_MAX / 1024) return sk_fail(error, SKEIN_ERROR_LIMIT, "", "%zu constraints are too many", count);
    sk_object *object;
    skein_status status = make_object(world, &type->kind, type->making, settings, &object, error);
    if (status) return status;
    status = check_particles(world, object, particles, count, (size_t)sk_constraint_arity(type, object->params), error);
    if (status) {
        unmake_object(world, object);
        return status;
    }
    status = sk_world_fetch(world);
    if (status) {
        unmake_object(world, object);
        return status;
    }
    real *rest = find_rests(world, type, object->params, particles, count);
    sk_batch *batch = rest && SK_RESERVE(allocator, &world->rules.batches, world->rules.batches.count + 1)
                          ? sk_batch_create(allocator, type, object->params, count, particles, rest, NULL)
                          : NULL;
    sk_release(allocator, rest);
    if (!batch) {
        unmake_object(world, object);
        return sk_fail_memory(error, type->kind.name);
    }
    batch->params = object->params;
    batch->label = object->label;
    batch->enabled = &object->common.plain.enabled;
    if (type->enclose && (status = type->enclose(batch, allocator, &world->particles, error))) {
        sk_batch_release(batch, allocator);
        unmake_object(world, object);
        return status;
    }
    batch->measured = type->strain != NULL;
    world->rules.batches.data[world->rules.batches.count++] = batch;
    object->as.batch = batch;
    return finish_object(world, object, handle);
}

skein_status sk_world_find_arity(skein_world *world, const sk_constraint_type *type, const skein_setting *settings,
                                 size_t *arity) {
    sk_object *object = NULL;
    skein_status status = make_object(world, &type->kind, type->making, settings, &object, sk_world_error(world));
    if (status) return status;
    *arity = (size_t)sk_constraint_arity(type, object->params);
    unmake_object(world, object);
    return SKEIN_OK;
}

/* Takes back what a builder that failed has added since the marks. */
static void undo_body(skein_world *world, sk_object *object, size_t particles, size_t triangles, size_t batches,
                      size_t limits) {
    sk_allocator *allocator = &world->allocator;
    sk_body *body = object->as.body;
    sk_rules *rules = &world->rules;
    while (rules->batches.count > batches) sk_batch_release(rules->batches.data[--rules->batches.count], allocator);
    while (rules->limits.count > limits) sk_limit_release(rules->limits.data[--rules->limits.count], allocator);
    sk_particles_truncate(&world->particles, particles);
    world->triangles.count = triangles;
    sk_body_release(world, body);
    unmake_object(world, object);
}

skein_status sk_world_add_body(skein_world *world, const sk_body_type *type, const skein_mesh *mesh,
                               const skein_setting *settings, skein_handle *handle) {
    skein_error *error = sk_world_error(world);
    sk_object *object;
    skein_status status = sk_world_settle_presence(world, error); // before indices are used again
    if (!status) status = make_with_presets(world, &type->kind, type->making, type->presets, settings, &object, error);
    if (status) return status;
    sk_body *body = sk_allocate(&world->allocator, sizeof *body);
    if (!body) {
        unmake_object(world, object);
        return sk_fail_memory(error, type->kind.name);
    }
    object->as.body = body;
    object->body_type = type;
    body->label = object->label;
    body->enabled = true;
    body->first_particle = (uint32_t)world->particles.count;
    size_t particles = world->particles.count, triangles = world->triangles.count;
    size_t batches = world->rules.batches.count, limits = world->rules.limits.count;
    status = type->build(world, body, object->params, mesh, error);
    if (status) {
        undo_body(world, object, particles, triangles, batches, limits);
        return status;
    }
    body->particle_count = (uint32_t)(world->particles.count - particles);
    if (!sk_world_note_built_pins(world, body, type->tether != NULL)) {
        undo_body(world, object, particles, triangles, batches, limits);
        return sk_fail_memory(error, "pins");
    }
    body->first_triangle = triangles;
    body->triangle_count = world->triangles.count - triangles;
    sk_world_reuse_indices(world, body, batches, limits);
    sk_world_ease_meetings(world, body);
    if (!object->common.plain.enabled) sk_world_enable_body(world, body, false);
    return finish_object(world, object, handle);
}

skein_status sk_world_set_method(skein_world *world, const sk_method_type *type, const skein_setting *settings) {
    skein_error *error = sk_world_error(world);
    void *params = sk_allocate(&world->allocator, type->kind.params_size);
    if (!params) return sk_fail_memory(error, type->kind.name);
    skein_status status =
        sk_settings_apply(&world->allocator, &type->kind, NULL, params, NULL, 0, NULL, settings, error);
    if (status) {
        sk_release(&world->allocator, params);
        return status;
    }
    if (type->begin) type->begin(params, type);
    if (world->method)
        sk_fields_clear(&world->allocator, world->method->kind.fields, world->method->kind.field_count,
                        world->method_params);
    sk_release(&world->allocator, world->method_params);
    world->method = type;
    world->method_params = params;
    world->plan_stale = true;
    sk_world_rouse(world);
    sk_record_state(world);
    return SKEIN_OK;
}

/* ---- removing ---- */

static void drop_pointer(void **data, size_t *count, const void *pointer) {
    for (size_t i = 0; i < *count; i++)
        if (data[i] == pointer) {
            memmove(data + i, data + i + 1, (*count - i - 1) * sizeof *data);
            --*count;
            return;
        }
}

/* The object goes; its handle is stale, and its place free. */
static void drop_object(skein_world *world, sk_object *object) {
    sk_record_stop(world, "an object was removed, which a recording cannot hold");
    sk_entry *entry = &world->places.data[object->index];
    entry->object = NULL;
    entry->generation++;
    drop_pointer((void **)world->objects.data, &world->objects.count, object);
    sk_object_release(&world->allocator, object);
    world->plan_stale = true;
    sk_world_rouse(world);
}

skein_status skein_remove(skein_world *world, skein_handle handle) {
    SK_NEED(world, world);
    sk_object *object = sk_object_find(world, handle, SKEIN_CATEGORY_COUNT);
    if (!object) return SKEIN_ERROR_HANDLE;
    sk_rules *rules = &world->rules;
    switch (object->category) {
    case SKEIN_BODY: {
        const sk_common *common = &object->common.plain;
        skein_status status = sk_world_remove_body(world, object->as.body, common->name, common->groups);
        if (status) return status;
        break;
    }
    case SKEIN_CONSTRAINT:
        drop_pointer((void **)rules->batches.data, &rules->batches.count, object->as.batch);
        sk_batch_release(object->as.batch, &world->allocator);
        break;
    case SKEIN_FORCE:
        drop_pointer((void **)rules->forces.data, &rules->forces.count, object->as.force);
        sk_world_end_meeting(world, object->as.force);
        sk_release(&world->allocator, object->as.force->only.data);
        sk_release(&world->allocator, object->as.force);
        break;
    case SKEIN_COLLIDER:
        drop_pointer((void **)rules->colliders.data, &rules->colliders.count, object->as.collider);
        sk_release(&world->allocator, object->as.collider->only.data);
        sk_release(&world->allocator, object->as.collider);
        break;
    case SKEIN_MOTION:
        drop_pointer((void **)world->motions.data, &world->motions.count, object->as.motion);
        sk_motion_release(object->as.motion, &world->allocator);
        break;
    default:
        return sk_fail(sk_world_error(world), SKEIN_ERROR_HANDLE, "", "a %s cannot be removed",
                       skein_category_text(object->category));
    }
    world->motions_stale = true;
    drop_object(world, object);
    return SKEIN_OK;
}

/* ---- looking up ---- */

/* The method's handle: no object has this index. */
static const uint32_t method_index = UINT32_MAX - 1;

static bool is_method(const skein_world *world, skein_handle handle) {
    return handle.index == method_index && handle.world == world->identity;
}

size_t skein_object_count(const skein_world *world, skein_category category) {
    if (!world) return 0;
    if (category == SKEIN_METHOD) return 1;
    size_t count = 0;
    for (size_t i = 0; i < world->objects.count; i++) count += world->objects.data[i]->category == category;
    return count;
}

skein_handle skein_object_at(const skein_world *world, skein_category category, size_t index) {
    if (!world) return (skein_handle){UINT32_MAX, 0, 0};
    if (category == SKEIN_METHOD && index == 0) return (skein_handle){method_index, 1, world->identity};
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != category) continue;
        if (index-- == 0) return sk_handle_at(world, i);
    }
    return (skein_handle){UINT32_MAX, 0, 0};
}

const skein_kind *skein_object_kind(const skein_world *world, skein_handle handle) {
    if (!world) return NULL;
    if (is_method(world, handle)) return &world->method->kind;
    const sk_object *object = sk_object_of(world, handle);
    return object ? object->kind : NULL;
}
