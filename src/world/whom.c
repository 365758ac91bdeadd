/* Whom rules act on: the bodies that they name, by their names or by those of groups, as ranges of particles, slots and
 * triangles. */
#include <stdio.h>
#include <string.h>

#include "world/world.h"

/* ---- names: of bodies, and of groups that they are in ---- */

static const sk_object *body_at(const skein_world *world, size_t i) {
    const sk_object *object = world->objects.data[i];
    return object->category == SKEIN_BODY ? object : NULL;
}

bool sk_world_knows(const skein_world *world, sk_word name) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *body = body_at(world, i);
        if (body && sk_is_called(body->common.plain.name, body->common.plain.groups, name)) return true;
    }
    for (size_t i = 0; i < world->gone_names.count; i++)
        if (sk_word_is(name, world->gone_names.data[i])) return true;
    return false;
}

bool sk_world_has_group(const skein_world *world, sk_word name) {
    for (size_t i = 0; i < world->objects.count; i++)
        if (body_at(world, i) && sk_names_have(body_at(world, i)->common.plain.groups, name)) return true;
    return false;
}

enum { NAME_SIZE = 128 };

static void copy_word(char to[NAME_SIZE], sk_word word) {
    snprintf(to, NAME_SIZE, "%.*s", (int)(word.length < NAME_SIZE ? word.length : NAME_SIZE - 1), word.at);
}

/* Puts a candidate in the place of the nearest name so far, where it is nearer. */
static void take_nearer(char nearest[NAME_SIZE], const char *name, sk_word candidate) {
    char other[NAME_SIZE];
    if (!candidate.length || candidate.length >= NAME_SIZE) return;
    copy_word(other, candidate);
    const char *const both[] = {nearest, other};
    const char *best = sk_nearest_name(name, nearest[0] ? both : both + 1, nearest[0] ? 2 : 1);
    if (best == other) memcpy(nearest, other, NAME_SIZE);
}

static skein_status fail_name(const skein_world *world, const char *label, sk_word word, skein_error *error) {
    char name[NAME_SIZE], nearest[NAME_SIZE] = "";
    copy_word(name, word);
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *body = body_at(world, i);
        if (!body) continue;
        take_nearer(nearest, name, sk_word_of(body->common.plain.name));
        const char *groups = body->common.plain.groups;
        for (sk_word group; (group = sk_names_next(&groups, ",")).length;) take_nearer(nearest, name, group);
    }
    return sk_fail(error, SKEIN_ERROR_NAME, label, "there is no body or group of the name '%s'%s%s%s", name,
                   nearest[0] ? "; did you mean '" : "", nearest, nearest[0] ? "'?" : "");
}

skein_status sk_world_check_name(const skein_world *world, const char *label, sk_word name, skein_error *error) {
    return sk_world_knows(world, name) ? SKEIN_OK : fail_name(world, label, name, error);
}

skein_status sk_world_check_names(const skein_world *world, const char *label, const char *names, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (sk_world_knows(world, sk_word_of(names))) return SKEIN_OK; // a body's name may have commas
    for (sk_word name; !status && (name = sk_names_next(&names, ",")).length;)
        status = sk_world_check_name(world, label, name, error);
    return status;
}

const sk_body *sk_world_next_named(const skein_world *world, const char *names, size_t *cursor) {
    while (*cursor < world->objects.count) {
        const sk_object *body = body_at(world, (*cursor)++);
        if (body && sk_names_mean(names, body->common.plain.name, body->common.plain.groups)) return body->as.body;
    }
    return NULL;
}

/* ---- ranges ---- */

static size_t triangles_before(const skein_world *world, const sk_body *body) {
    size_t count = body->first_triangle;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_body *other = body_at(world, i) ? body_at(world, i)->as.body : NULL;
        if (other && (!other->enabled || other->rest.asleep) && other->first_triangle < body->first_triangle)
            count -= other->triangle_count;
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
    if (!body->enabled || body->rest.asleep || !body->particle_count) return true;
    if (!SK_RESERVE(&world->allocator, only, only->count + 1)) return false;
    size_t first = body->first_particle, triangle = triangles_before(world, body);
    sk_span_of_body *span = &only->data[only->count++];
    *span = (sk_span_of_body){first, first + body->particle_count, 0, 0, triangle, triangle + body->triangle_count};
    find_slots(&world->particles, span);
    return true;
}

bool sk_world_list_sleepers(skein_world *world, const char *names, sk_only *only) {
    size_t cursor = 0;
    only->some = names && names[0];
    for (const sk_body *body; only->some && (body = sk_world_next_named(world, names, &cursor));) {
        if (!body->rest.asleep && !sk_world_stands(world, body)) continue;
        if (!SK_RESERVE(&world->allocator, only, only->count + 1)) return false;
        only->data[only->count++] =
            (sk_span_of_body){body->first_particle, body->first_particle + body->particle_count, 0, 0, 0, 0};
    }
    return true;
}

static skein_status find_only(skein_world *world, const char *label, const char *names, sk_only *only,
                              skein_error *error) {
    only->some = names && names[0];
    only->count = 0;
    if (!only->some) return SKEIN_OK;
    skein_status status = sk_world_check_names(world, label, names, error);
    size_t cursor = 0;
    for (const sk_body *body; !status && (body = sk_world_next_named(world, names, &cursor));)
        if (!add_span(world, body, only)) return sk_fail_memory(error, label);
    return status;
}

/* ---- particles that follow each other ---- */

static sk_group everybody(const skein_world *world) {
    const sk_particles *all = &world->particles;
    return (sk_group){0, all->count, 0, all->slot_count, all->out_count};
}

/* Several bodies as one run, if they lie beside each other; nobody else is in it then. */
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

/* A name that nobody has is a slip in rules that are not enabled, too: it would only be told once they are. */
static skein_status check_disabled(const skein_world *world, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < world->rules.colliders.count && !status; i++) {
        const sk_collider *collider = world->rules.colliders.data[i];
        if (!collider->common->enabled)
            status = sk_world_check_names(world, collider->label, collider->common->on, error);
    }
    for (size_t i = 0; i < world->rules.forces.count && !status; i++) {
        const sk_force *force = world->rules.forces.data[i];
        if (*force->enabled) continue;
        status = sk_world_check_names(world, force->label, *force->on, error);
        if (!status && force->type->neighbours)
            status = sk_world_check_names(world, force->label, force->type->neighbours(force->params), error);
    }
    return status;
}

skein_status sk_world_find_whom(skein_world *world, skein_error *error) {
    skein_status status = check_disabled(world, error);
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
        if (!status && force->type->check) status = force->type->check(force->params, world->particles.count, error);
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
    const sk_body *body;
    do body = sk_world_next_named(world, on, cursor);
    while (body && !body->enabled);
    if (body) *first = body->first_particle, *end = *first + body->particle_count;
    return body != NULL;
}
