/* The catalogue: every kind that ships with the library, by category, and the public calls that take a
 * kind by its name. The build finds them (cmake/kinds.cmake): a new kind is its own file. The roof of the house: it
 * sees all floors, and nothing sees it. */
#include <math.h>
#include <string.h>

#include "bodies/body.h"
#include "catalogue_kinds.h" // made by the build
#include "outside/outside.h"
#include "space/normals.h"
#include "world/record.h"

/* Every type begins with its kind, so the kind's address is the type's. */
static const void *const bodies[] = {SK_BODY_KINDS}, *const constraints[] = {SK_CONSTRAINT_KINDS},
                         *const forces[] = {SK_FORCE_KINDS}, *const colliders[] = {SK_COLLIDER_KINDS},
                         *const motions[] = {SK_MOTION_KINDS}, *const methods[] = {SK_METHOD_KINDS};

#define COUNT(list) (sizeof(list) / sizeof *(list))

static const sk_kind_list kinds_of[SKEIN_CATEGORY_COUNT] = {
    [SKEIN_BODY] = {bodies, COUNT(bodies)},     [SKEIN_CONSTRAINT] = {constraints, COUNT(constraints)},
    [SKEIN_FORCE] = {forces, COUNT(forces)},    [SKEIN_COLLIDER] = {colliders, COUNT(colliders)},
    [SKEIN_MOTION] = {motions, COUNT(motions)}, [SKEIN_METHOD] = {methods, COUNT(methods)},
};

const skein_kind *skein_kind_at(skein_category category, size_t index) {
    return category < SKEIN_CATEGORY_COUNT && index < kinds_of[category].count ? kinds_of[category].data[index] : NULL;
}

const skein_kind *skein_kind_find(skein_category category, const char *name, skein_error *error) {
    return skein_kinds_find(NULL, category, name, error);
}

/* ---- with those of a registry ---- */

const skein_kind *skein_kinds_at(const skein_kinds *kinds, skein_category category, size_t index) {
    const skein_kind *kind = skein_kind_at(category, index);
    size_t own = 0;
    if (kind || !kinds) return kind;
    while (skein_kind_at(category, own)) own++;
    return sk_outside_at(kinds, category, index - own);
}

const skein_kind *skein_kinds_find(const skein_kinds *kinds, skein_category category, const char *name,
                                   skein_error *error) {
    if (!name) {
        sk_fail_null(error, "name");
        return NULL;
    }
    const char *names[128];
    size_t count = 0;
    for (const skein_kind *kind; (kind = skein_kinds_at(kinds, category, count)) && count < COUNT(names); count++) {
        if (!strcmp(kind->name, name)) return kind;
        names[count] = kind->name;
    }
    const char *nearest = sk_nearest_name(name, names, count);
    sk_fail(error, SKEIN_ERROR_NAME, "type", "there is no %s '%s'%s%s%s", skein_category_text(category), name,
            nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
    return NULL;
}

static const void *type_of(const skein_world *world, skein_category category, const char *name) {
    return skein_kinds_find(world->desc.kinds, category, name, sk_world_error(world));
}

skein_status skein_kind_register(skein_kinds *kinds, const skein_kind *kind, skein_error *error) {
    return sk_outside_register(kinds, kind, kinds_of, error);
}

skein_status skein_body_add(skein_world *world, const char *kind, const skein_mesh *mesh, const skein_setting *settings,
                            skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    if (mesh && sk_mesh_check_pointers(mesh, sk_world_error(world))) return SKEIN_ERROR_VALUE;
    const sk_body_type *type = type_of(world, SKEIN_BODY, kind);
    return type ? sk_world_add_body(world, type, mesh, settings, handle) : SKEIN_ERROR_NAME;
}

skein_status skein_constraint_add(skein_world *world, const char *kind, const uint32_t *particles, size_t count,
                                  const skein_setting *settings, skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    if (count) SK_NEED(world, particles);
    const sk_constraint_type *type = type_of(world, SKEIN_CONSTRAINT, kind);
    return type ? sk_world_add_constraint(world, type, particles, count, settings, handle) : SKEIN_ERROR_NAME;
}

skein_status skein_constraint_arity(skein_world *world, const char *kind, const skein_setting *settings, size_t *arity) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    SK_NEED(world, arity);
    const sk_constraint_type *type = type_of(world, SKEIN_CONSTRAINT, kind);
    return type ? sk_world_find_arity(world, type, settings, arity) : SKEIN_ERROR_NAME;
}

skein_status skein_force_add(skein_world *world, const char *kind, const skein_setting *settings, skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    const sk_force_type *type = type_of(world, SKEIN_FORCE, kind);
    return type ? sk_world_add_force(world, type, settings, handle) : SKEIN_ERROR_NAME;
}

skein_status skein_collider_add(skein_world *world, const char *kind, const skein_setting *settings,
                                skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    const sk_collider_type *type = type_of(world, SKEIN_COLLIDER, kind);
    return type ? sk_world_add_collider(world, type, NULL, settings, handle) : SKEIN_ERROR_NAME;
}

skein_status skein_collider_add_mesh(skein_world *world, const char *kind, const skein_mesh *mesh,
                                     const skein_setting *settings, skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    const sk_collider_type *type = type_of(world, SKEIN_COLLIDER, kind);
    return type ? sk_world_add_collider(world, type, mesh, settings, handle) : SKEIN_ERROR_NAME;
}

skein_status skein_motion_add(skein_world *world, const char *kind, const skein_track *track,
                              const skein_setting *settings, skein_handle *handle) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    const sk_motion_type *type = type_of(world, SKEIN_MOTION, kind);
    return type ? sk_world_add_motion(world, type, track, settings, handle) : SKEIN_ERROR_NAME;
}

double skein_kinds_stable_substep(const skein_kinds *kinds, const char *method, const skein_stability *stability) {
    if (!method || !stability) return (double)NAN;
    const sk_method_type *type = (const void *)skein_kinds_find(kinds, SKEIN_METHOD, method, NULL);
    return type ? sk_stable_substep(type, stability) : (double)NAN;
}

double skein_stable_substep(const char *method, const skein_stability *stability) {
    return skein_kinds_stable_substep(NULL, method, stability);
}

skein_status skein_method_set(skein_world *world, const char *kind, const skein_setting *settings) {
    SK_NEED(world, world);
    SK_NEED(world, kind);
    const sk_method_type *type = type_of(world, SKEIN_METHOD, kind);
    return type ? sk_world_set_method(world, type, settings) : SKEIN_ERROR_NAME;
}

/* (A snapshot names its method.) */
skein_status skein_snapshot_read(skein_world *world, const void *bytes, size_t size) {
    SK_NEED(world, world);
    SK_NEED(world, bytes);
    return sk_snapshot_read(world, bytes, size, skein_method_set);
}

skein_status skein_replay(skein_world *world, const void *bytes, size_t size, skein_difference *difference) {
    SK_NEED(world, world);
    SK_NEED(world, bytes);
    SK_NEED(world, difference);
    return sk_replay(world, bytes, size, difference, skein_method_set);
}
