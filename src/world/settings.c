/* Fields of objects: the ones that a category shares, applying settings, and reaching one field of a
 * living object by handle or by path. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "world/record.h"
#include "world/world.h"

static const skein_field body_fields[] = {
    SK_TEXT(sk_common, name, "name", "", "for paths, messages and the names of files"),
    SK_BOOL(sk_common, enabled, "enabled", 1, "false: as if it were not there; it stays as it is until it is again"),
    SK_BOOL(sk_common, visible, "visible", 1, "whether it is drawn"),
    SK_TEXT(
        sk_common, groups, "groups", "",
        "the names of groups that it is in, commas between them: where rules name bodies, a group's name means all in it"),
    SK_REAL(
        sk_common, sleep, "sleep", "m/s", 0, 0, 1e6,
        "it falls asleep once it, and all that it may touch, has for half a second not gone farther than that speed would lead: "
        "it then costs nothing, until something comes near or is changed; 0: never"),
};
static const skein_field rule_fields[] = {
    SK_TEXT(sk_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_BOOL(sk_common, visible, "visible", 1, "whether it is drawn"),
};
static const skein_field force_fields[] = {
    SK_TEXT(sk_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_BOOL(sk_common, visible, "visible", 1, "whether it is drawn"),
    SK_TEXT(
        sk_common, on, "on", "",
        "the names of the bodies, or of groups of them, that it acts on, commas between them; empty: every particle"),
};

const skein_field *sk_common_fields(skein_category category, size_t *count) {
    switch (category) {
    case SKEIN_BODY: *count = sizeof body_fields / sizeof *body_fields; return body_fields;
    case SKEIN_CONSTRAINT: *count = sizeof rule_fields / sizeof *rule_fields; return rule_fields;
    case SKEIN_FORCE: *count = sizeof force_fields / sizeof *force_fields; return force_fields;
    case SKEIN_COLLIDER: *count = sk_collider_field_count; return sk_collider_fields;
    case SKEIN_MOTION: *count = sk_motion_field_count; return sk_motion_fields;
    default: *count = 0; return NULL;
    }
}

const skein_field *skein_common_fields(skein_category category, size_t *count) {
    if (!count) return NULL;
    return sk_common_fields(category, count);
}

/* A type begins with its kind. */
bool skein_kind_takes(const skein_kind *kind, const char *field) {
    if (!kind || !field || !sk_kind_field(kind, field, NULL)) return false;
    return kind->category != SKEIN_MOTION || sk_motion_takes((const void *)kind, field);
}

void *sk_common_of(sk_object *object) {
    return &object->common;
}

const skein_field *sk_kind_field(const skein_kind *kind, const char *name, skein_error *error) {
    size_t common_count;
    const skein_field *common = sk_common_fields(kind->category, &common_count);
    const skein_field *field = sk_field_named(kind->fields, kind->field_count, name);
    if (!field) field = sk_field_named(common, common_count, name);
    if (!field && !strncmp(name, "parameters.", 11) && name[11])
        field = sk_field_named(kind->fields, kind->field_count, "parameters.*");
    if (field) return field;

    const char *names[64];
    size_t count = 0;
    for (size_t i = 0; i < kind->field_count && count < 64; i++) names[count++] = kind->fields[i].name;
    for (size_t i = 0; i < common_count && count < 64; i++) names[count++] = common[i].name;
    const char *nearest = sk_nearest_name(name, names, count);
    sk_fail(error, SKEIN_ERROR_NAME, name, "%s has no field '%s'%s%s%s", kind->name, name,
            nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
    return NULL;
}

const skein_field *skein_field_find(const skein_kind *kind, const char *name, skein_error *error) {
    if (!kind || !name) {
        sk_fail_null(error, kind ? "name" : "kind");
        return NULL;
    }
    return sk_kind_field(kind, name, error);
}

/* What a choice of the settings stands for comes before all that they say themselves, wherever it is among them. */
static skein_status apply_presets(sk_allocator *allocator, const skein_kind *kind, const sk_presets *presets,
                                  void *params, const skein_setting *settings, skein_error *error) {
    const skein_field *choice = sk_field_named(kind->fields, kind->field_count, presets->field);
    skein_status status = SKEIN_OK;
    for (; !status && settings && settings->name; settings++)
        if (!strcmp(settings->name, presets->field))
            status = sk_field_store(allocator, choice, params, &settings->value, error);
    return status ? status : sk_presets_apply(allocator, presets, kind->fields, kind->field_count, params, error);
}

skein_status sk_settings_apply(sk_allocator *allocator, const skein_kind *kind, const sk_presets *presets, void *params,
                               const skein_field *common, size_t common_count, void *common_params,
                               const skein_setting *settings, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (!sk_fields_default(allocator, kind->fields, kind->field_count, params) ||
        !sk_fields_default(allocator, common, common_count, common_params))
        status = sk_fail_memory(error, kind->name);
    if (!status && presets) status = apply_presets(allocator, kind, presets, params, settings, error);
    for (; !status && settings && settings->name; settings++) {
        const skein_field *field = sk_kind_field(kind, settings->name, error);
        if (!field) {
            status = SKEIN_ERROR_NAME;
            break;
        }
        bool own = field >= kind->fields && field < kind->fields + kind->field_count;
        status = sk_field_store(allocator, field, own ? params : common_params, &settings->value, error);
    }
    if (status) {
        sk_fields_clear(allocator, kind->fields, kind->field_count, params);
        sk_fields_clear(allocator, common, common_count, common_params);
    }
    return status;
}

/* ---- one field of a living object ---- */

/* Where a field of an object is stored; NULL with an error if the handle or the name is wrong. */
static const skein_field *locate(const skein_world *world, skein_handle handle, const char *name, void **params,
                                 sk_object **object, skein_error *error) {
    const skein_kind *kind = skein_object_kind(world, handle);
    if (!kind) {
        sk_fail_handle(world, handle, "object", name);
        return NULL;
    }
    const skein_field *field = sk_kind_field(kind, name, error);
    if (!field) return NULL;
    *object = sk_object_of(world, handle); // NULL: the method
    bool own = field >= kind->fields && field < kind->fields + kind->field_count;
    *params = !*object ? world->method_params : own ? (*object)->params : sk_common_of(*object);
    return field;
}

/* What the object's type says to its parameters as they are; `field` has changed. */
static skein_status accept(skein_world *world, sk_object *object, const skein_field *field, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (object->category == SKEIN_FORCE && object->as.force->type->meeting)
        status = object->as.force->type->meeting->check(object->params, error);
    if (object->category == SKEIN_COLLIDER && object->as.collider->type->check)
        status = object->as.collider->type->check(object->params, error);
    if (object->category == SKEIN_MOTION && object->as.motion->type->check)
        status = object->as.motion->type->check(object->params, error);
    bool own = sk_field_named(object->kind->fields, object->kind->field_count, field->name) == field;
    // of its common texts: a name or pins that are not there would only be missed by the next step
    bool selects = field->type == SKEIN_FIELD_TEXT && !own && strcmp(field->name, "name") != 0;
    selects |= object->category == SKEIN_MOTION && object->as.motion->type->carrier;
    if (!status && object->category == SKEIN_MOTION && selects)
        status = sk_world_check_motion(world, object->as.motion, error);
    if (!status && object->making && own && field->type == SKEIN_FIELD_TEXT)
        status = object->making->make(object->params, object->kind, &world->allocator, error);
    return status;
}

/* Stores a value, or leaves the old one where the new one is no good. */
static skein_status replace(skein_world *world, sk_object *object, const skein_field *field, void *params,
                            skein_value value, skein_error *error) {
    skein_value old = sk_field_load(field, params);
    char **text = field->type == SKEIN_FIELD_TEXT ? (char **)(void *)((char *)params + field->offset) : NULL;
    char *kept = text ? *text : NULL;
    if (text) *text = NULL; // it stays until the new one is known to be good
    skein_status status = sk_field_store(&world->allocator, field, params, &value, error);
    bool stored = !status;
    if (!status && object) status = accept(world, object, field, error);
    if (text) {
        sk_release(&world->allocator, status ? *text : kept);
        if (status) *text = kept;
    } else if (status && stored) {
        sk_field_store(&world->allocator, field, params, &old, NULL);
    }
    return status;
}

/* What shaped a body that stands cannot change any more. */
static bool shapes(const sk_object *object, const void *params, const char *name) {
    if (object && object->category == SKEIN_MOTION && object->as.motion->type->given)
        return !strcmp(name, object->as.motion->type->given);
    if (object && object->category == SKEIN_COLLIDER && params == object->params)
        return object->as.collider->type->is_shaped_by && object->as.collider->type->is_shaped_by(name);
    bool body = object && object->category == SKEIN_BODY && params == object->params;
    return body && !object->body_type->live(params, name);
}

/* Passes a body's changed parameters on to its rules, and marks the batches that look at them. */
static skein_status change_body(skein_world *world, sk_object *object) {
    sk_body *body = object->as.body;
    sk_material before[SK_MOST_BODY_BATCHES];
    for (size_t i = 0; i < body->batch_count; i++) before[i] = *body->material[i];
    object->body_type->change(body, object->params);
    for (size_t i = 0; i < body->batch_count; i++) {
        const sk_material *now = body->material[i];
        body->batch[i]->stale |= now->stiffness != before[i].stiffness || now->damping != before[i].damping;
    }
    return sk_world_enable_body(world, body, object->common.plain.enabled);
}

/* A body that is given other groups may be the last one in those that it is in: rules that name them go on, on nobody. */
static skein_status leave_groups(skein_world *world, const sk_object *object, const skein_field *field) {
    bool leaves = object && object->category == SKEIN_BODY && !strcmp(field->name, "groups");
    return leaves ? sk_world_remember_names(world, object->common.plain.groups) : SKEIN_OK;
}

/* A body that sleeps wakes where a field of it is set; and all do where something else is, or whether a body is there, but for a
 * collider that is only put elsewhere: that wakes whom it comes near. */
static void rouse(skein_world *world, const sk_object *object, const char *name, const double place[15]) {
    const sk_body *body = object && object->category == SKEIN_BODY && strcmp(name, "enabled") ? object->as.body : NULL;
    double now[15];
    if (body) {
        sk_world_rouse_at(world, body->first_particle, body->particle_count);
        return;
    }
    if (object && object->category == SKEIN_COLLIDER) {
        sk_collider_own_place(object->as.collider, now);
        if (memcmp(now, place, sizeof now) != 0) return;
    }
    sk_world_rouse(world);
}

bool skein_field_is_live(const skein_world *world, skein_handle handle, const char *name) {
    if (!world || !name) return false;
    sk_object *object;
    void *params;
    skein_error ignored;
    return locate(world, handle, name, &params, &object, &ignored) && !shapes(object, params, name);
}

skein_status skein_set(skein_world *world, skein_handle handle, const char *name, skein_value value) {
    SK_NEED(world, world);
    SK_NEED(world, name);
    skein_error *error = sk_world_error(world);
    sk_object *object;
    void *params;
    const skein_field *field = locate(world, handle, name, &params, &object, error);
    if (!field) return error->status;
    if (shapes(object, params, name))
        return sk_fail(error, SKEIN_ERROR_VALUE, name, "%s shapes what is already built: set it when the %s is added",
                       name, skein_category_text(object->category));
    sk_collider *collider = object && object->category == SKEIN_COLLIDER ? object->as.collider : NULL;
    double place[15];
    const skein_value before = sk_field_load(field, params);
    const bool same = sk_values_are_same(&value, &before); // programs set much of what they show in each frame
    if (collider) sk_collider_own_place(collider, place);
    if (collider && !same) sk_world_seat_all(world);
    if (collider) sk_collider_note(collider, world->time);
    skein_status status = leave_groups(world, object, field);
    if (!status) status = replace(world, object, field, params, value, error);
    if (status) return status;
    if (collider && sk_collider_changed(collider)) world->plan_stale = true; // a card's passes differ
    if (object && object->category == SKEIN_BODY && (status = change_body(world, object))) return status;
    if (object && object->category == SKEIN_CONSTRAINT) object->as.batch->stale |= params == object->params;
    if (object && !strcmp(name, "name")) {
        const char *given = sk_field_load(field, params).text;
        sk_label_copy(object->label, sizeof object->label, given[0] ? given : object->kind->name);
    }
    if (!same && object) sk_world_ease_changed(world, object, name);
    if (!same) rouse(world, object, name, place);
    else if (object && object->category == SKEIN_BODY)
        sk_world_rouse_at(world, object->as.body->first_particle, object->as.body->particle_count);
    world->plan_stale = true;
    world->motions_stale = true;
    const skein_value now = sk_field_load(field, params); // the text given may have been the one that is gone
    sk_record_field(world, object, name, &now);
    return SKEIN_OK;
}

skein_status skein_get(const skein_world *world, skein_handle handle, const char *name, skein_value *value) {
    SK_NEED(world, world);
    SK_NEED(world, name);
    SK_NEED(world, value);
    skein_error *error = sk_world_error(world);
    sk_object *object;
    void *params;
    const skein_field *field = locate(world, handle, name, &params, &object, error);
    if (!field) return error->status;
    *value = sk_field_load(field, params);
    return SKEIN_OK;
}

/* ---- paths ---- */

static const struct {
    const char *word;
    skein_category category;
} lists[] = {
    {"bodies", SKEIN_BODY},        {"constraints", SKEIN_CONSTRAINT}, {"forces", SKEIN_FORCE},
    {"colliders", SKEIN_COLLIDER}, {"motions", SKEIN_MOTION},
};

/* Splits "colliders.ball.radius" into an object and "radius". */
static skein_status resolve(const skein_world *world, const char *path, skein_handle *handle, const char **field,
                            skein_error *error) {
    if (!strncmp(path, "method.", 7)) {
        *handle = skein_object_at(world, SKEIN_METHOD, 0);
        *field = path + 7;
        return SKEIN_OK;
    }
    for (size_t l = 0; l < sizeof lists / sizeof *lists; l++) {
        size_t length = strlen(lists[l].word);
        if (strncmp(path, lists[l].word, length) || path[length] != '.') continue;
        const char *which = path + length + 1, *dot = strchr(which, '.');
        if (!dot) break;
        char *end;
        unsigned long index = strtoul(which, &end, 10);
        size_t count = skein_object_count(world, lists[l].category);
        for (size_t i = 0; i < count; i++) {
            *handle = skein_object_at(world, lists[l].category, i);
            sk_object *object = sk_object_of(world, *handle);
            const char *name = lists[l].category == SKEIN_COLLIDER ? object->common.collider.name
                               : lists[l].category == SKEIN_MOTION ? object->common.motion.name
                                                                   : object->common.plain.name;
            bool by_number = end == dot && end != which && i == index;
            bool by_name = strlen(name) == (size_t)(dot - which) && !strncmp(name, which, (size_t)(dot - which));
            if (!by_number && !by_name) continue;
            *field = dot + 1;
            return SKEIN_OK;
        }
        return sk_fail(error, SKEIN_ERROR_NAME, path, "there is no %.*s among the %zu %s", (int)(dot - which), which,
                       count, lists[l].word);
    }
    return sk_fail(
        error, SKEIN_ERROR_NAME, path,
        "expected bodies, constraints, forces, colliders or motions, then a number or name and a field, or method and a field");
}

skein_status skein_set_path(skein_world *world, const char *path, skein_value value) {
    SK_NEED(world, world);
    SK_NEED(world, path);
    skein_handle handle;
    const char *field;
    skein_status status = resolve(world, path, &handle, &field, sk_world_error(world));
    return status ? status : skein_set(world, handle, field, value);
}

skein_status skein_get_path(const skein_world *world, const char *path, skein_value *value) {
    SK_NEED(world, world);
    SK_NEED(world, path);
    SK_NEED(world, value);
    skein_handle handle;
    const char *field;
    skein_status status = resolve(world, path, &handle, &field, sk_world_error(world));
    return status ? status : skein_get(world, handle, field, value);
}
