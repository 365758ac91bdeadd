/* Whom rules act on: the bodies that they name, as ranges of particles, slots and triangles. */
#include <stdio.h>
#include <string.h>

#include "world/world.h"

/* ---- names ---- */

/* The next name of a list, without the blanks around it; *length is 0 at its end. */
static const char *next_name(const char **list, size_t *length) {
    const char *at = *list + strspn(*list, " ,");
    *length = strcspn(at, ",");
    *list = at + *length;
    while (*length && at[*length - 1] == ' ') --*length;
    return at;
}

static bool is_named(const char *name, const char *at, size_t length) {
    return strlen(name) == length && !strncmp(name, at, length);
}

bool sk_names_have(const char *names, const char *name) {
    size_t length;
    if (!name[0]) return false;
    if (!strcmp(names, name)) return true;
    for (const char *at = next_name(&names, &length); length; at = next_name(&names, &length))
        if (is_named(name, at, length)) return true;
    return false;
}

static const sk_object *body_at(const skein_world *world, size_t i) {
    const sk_object *object = world->objects.data[i];
    return object->category == SKEIN_BODY ? object : NULL;
}

/* Whether there is such a body, or was. */
static bool is_known(const skein_world *world, const char *at, size_t length) {
    for (size_t i = 0; i < world->objects.count; i++)
        if (body_at(world, i) && is_named(body_at(world, i)->common.plain.name, at, length)) return true;
    for (size_t i = 0; i < world->gone_names.count; i++)
        if (is_named(world->gone_names.data[i], at, length)) return true;
    return false;
}

static skein_status fail_name(const skein_world *world, const char *label, const char *at, size_t length,
                              skein_error *error) {
    enum { MOST_NAMES = 256 };
    const char *names[MOST_NAMES];
    char name[128];
    size_t count = 0;
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), at);
    for (size_t i = 0; i < world->objects.count && count < MOST_NAMES; i++)
        if (body_at(world, i) && body_at(world, i)->common.plain.name[0])
            names[count++] = body_at(world, i)->common.plain.name;
    const char *nearest = sk_nearest_name(name, names, count);
    return sk_fail(error, SKEIN_ERROR_NAME, label, "there is no body of the name '%s'%s%s%s", name,
                   nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

/* Each name of a list is a body's. */
static skein_status check_names(const skein_world *world, const char *label, const char *names, skein_error *error) {
    size_t length;
    if (is_known(world, names, strlen(names))) return SKEIN_OK;
    for (const char *at = next_name(&names, &length); length; at = next_name(&names, &length))
        if (!is_known(world, at, length)) return fail_name(world, label, at, length, error);
    return SKEIN_OK;
}

skein_status sk_world_check_body_name(const skein_world *world, const char *label, const char *name, size_t length,
                                      skein_error *error) {
    return is_known(world, name, length) ? SKEIN_OK : fail_name(world, label, name, length, error);
}

/* ---- ranges ---- */

static size_t triangles_before(const skein_world *world, const sk_body *body) {
    size_t count = body->first_triangle;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_body *other = body_at(world, i) ? body_at(world, i)->as.body : NULL;
        if (other && !other->enabled && other->first_triangle < body->first_triangle) count -= other->triangle_count;
    }
    return count;
}

/* A body's slots: of a grid its strips, empty places and all; else those that its particles have. */
static void find_slots(const sk_particles *all, sk_span_of_body *span) {
    span->first_slot = SIZE_MAX, span->end_slot = 0;
    for (size_t i = span->first; i < span->end; i++) {
        if (all->slot_of[i] < span->first_slot) span->first_slot = all->slot_of[i];
        if (all->slot_of[i] >= span->end_slot) span->end_slot = (size_t)all->slot_of[i] + 1;
    }
}

static bool add_span(skein_world *world, const sk_body *body, sk_only *only) {
    if (!body->enabled || !body->particle_count) return true;
    if (!SK_RESERVE(&world->allocator, only, only->count + 1)) return false;
    size_t first = body->first_particle, triangle = triangles_before(world, body);
    sk_span_of_body *span = &only->data[only->count++];
    *span = (sk_span_of_body){first, first + body->particle_count, 0, 0, triangle, triangle + body->triangle_count};
    find_slots(&world->particles, span);
    return true;
}

static skein_status find_only(skein_world *world, const char *label, const char *names, sk_only *only,
                              skein_error *error) {
    only->some = names && names[0];
    only->count = 0;
    if (!only->some) return SKEIN_OK;
    skein_status status = check_names(world, label, names, error);
    for (size_t i = 0; i < world->objects.count && !status; i++) {
        const sk_object *object = body_at(world, i);
        if (object && sk_names_have(names, object->common.plain.name) && !add_span(world, object->as.body, only))
            return sk_fail_memory(error, label);
    }
    return status;
}

/* ---- groups: particles that follow each other ---- */

static sk_group everybody(const skein_world *world) {
    const sk_particles *all = &world->particles;
    return (sk_group){0, all->count, 0, all->slot_count, all->out_count};
}

/* Several bodies as one group, if they lie beside each other; nobody else is in it then. */
static skein_status join(const skein_world *world, const char *label, const sk_only *only, sk_group *group,
                         skein_error *error) {
    *group = only->some ? (sk_group){0, 0, 0, 0, 0} : everybody(world);
    if (!only->count) return SKEIN_OK;
    size_t particles = 0;
    *group = (sk_group){SIZE_MAX, 0, SIZE_MAX, 0, 0};
    for (size_t i = 0; i < only->count; i++) {
        const sk_span_of_body *span = &only->data[i];
        if (span->first < group->first) group->first = span->first;
        if (span->end > group->end) group->end = span->end;
        if (span->first_slot < group->first_slot) group->first_slot = span->first_slot;
        if (span->end_slot > group->end_slot) group->end_slot = span->end_slot;
        particles += span->end - span->first;
    }
    bool beside = group->end - group->first == particles;
    for (size_t slot = group->first_slot; slot < group->end_slot && beside; slot++) {
        uint32_t owner = world->particles.particle_of[slot];
        beside = owner == SK_NOBODY || (owner >= group->first && owner < group->end);
    }
    if (beside) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, label,
                   "a rule that steers can be 'on' several bodies only where they were added one after the other: "
                   "give each a rule of its own");
}

static skein_status find_force(skein_world *world, sk_force *force, skein_error *error) {
    skein_status status = find_only(world, force->label, *force->on, &force->only, error);
    if (status || force->type->phase == SK_PUSHES || force->type->phase == SK_MEETS) return status;
    status = join(world, force->label, &force->only, &force->moved, error);
    const char *neighbours = force->type->neighbours ? force->type->neighbours(force->params) : "";
    force->seen = force->moved;
    if (!status && neighbours[0]) {
        sk_only seen = {false, NULL, 0, 0};
        status = find_only(world, force->label, neighbours, &seen, error);
        if (!status) status = join(world, force->label, &seen, &force->seen, error);
        sk_release(&world->allocator, seen.data);
    }
    return status;
}

skein_status sk_world_find_groups(skein_world *world, skein_error *error) {
    skein_status status = SKEIN_OK;
    world->everybody = everybody(world);
    for (size_t i = 0; i < world->rules.colliders.count && !status; i++) {
        sk_collider *collider = world->rules.colliders.data[i];
        if (collider->common->enabled)
            status = find_only(world, collider->label, collider->common->on, &collider->only, error);
    }
    for (size_t i = 0; i < world->rules.forces.count && !status; i++) {
        sk_force *force = world->rules.forces.data[i];
        if (!*force->enabled) continue;
        status = find_force(world, force, error);
        int32_t particle = sk_force_particle(force); // that it looks at: without it there is nothing to be done
        if (particle >= 0 && (size_t)particle < world->particles.count &&
            !sk_particle_is_here(&world->particles, (size_t)particle))
            force->moved = (sk_group){0, 0, 0, 0, 0};
        if (!status && force->type->check)
            status = force->type->check(force->params, world->particles.count, error);
    }
    return status;
}

bool sk_world_next_run(const skein_world *world, const char *on, size_t *cursor, size_t *first, size_t *end) {
    if (!on || !on[0]) {
        *first = *cursor;
        bool more = sk_particles_next_run(&world->particles, first, end);
        *cursor = *end;
        return more;
    }
    for (; *cursor < world->objects.count; ++*cursor) {
        const sk_object *object = body_at(world, *cursor);
        if (!object || !object->as.body->enabled || !sk_names_have(on, object->common.plain.name)) continue;
        *first = object->as.body->first_particle, *end = *first + object->as.body->particle_count;
        ++*cursor;
        return true;
    }
    return false;
}
