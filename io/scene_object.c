/* Single objects of a scene as JSON, to be put back by a set ("bodies.2={...}"): copies that stand beside the first, and
 * the same under another kind. Called by the window. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"

#include "io/scene_settings.h"

/* The object at a place of a list; a copy of it. NULL where there is none, or no memory. */
static json_t *copy_of(const io_scene *scene, const char *list, size_t index) {
    return json_deep_copy(json_array_get(json_object_get(io_scene_document(scene), list), index));
}

static skein_category category_of(const char *list) {
    for (size_t i = 0; io_scene_section_at(i); i++)
        if (!strcmp(io_scene_section_at(i)->name, list)) return io_scene_section_at(i)->category;
    return SKEIN_CATEGORY_COUNT;
}

static const skein_kind *kind_of(const json_t *object, const char *list) {
    const char *type = json_string_value(json_object_get(object, "type"));
    return type ? io_kind_find(category_of(list), type, NULL) : NULL;
}

static char *text_of(json_t *object) {
    char *text = object ? json_dumps(object, JSON_COMPACT) : NULL;
    json_decref(object);
    return text;
}

char *io_scene_object_text(const io_scene *scene, const char *list, size_t index) {
    return text_of(copy_of(scene, list, index));
}

/* ---- copies ---- */

/* Adds to a place, or to where it is by default. */
static void shift_field(json_t *object, const skein_field *field, const double by[3]) {
    json_t *old = json_object_get(object, field->name), *moved = json_array();
    for (size_t k = 0; moved && k < 3; k++) {
        double x = json_is_array(old) ? json_number_value(json_array_get(old, k)) : field->initial[k];
        json_array_append_new(moved, json_real(x + by[k]));
    }
    if (moved) json_object_set_new(object, field->name, moved);
}

/* Whether a field is where an object, or one of its ends, stands. */
static bool is_place(const skein_field *field) {
    static const char *const names[] = {"position", "centre", "from", "to"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (field->type == SKEIN_FIELD_VEC3 && !strcmp(field->name, names[i])) return true;
    return false;
}

static bool is_taken(const json_t *objects, const char *name) {
    size_t index;
    json_t *item;
    json_array_foreach(objects, index, item) {
        const char *its = json_string_value(json_object_get(item, "name"));
        if (its && !strcmp(its, name)) return true;
    }
    return false;
}

/* "cube 2", or the first number that nobody has. */
static void name_anew(json_t *object, const json_t *objects) {
    const char *old = json_string_value(json_object_get(object, "name"));
    char stem[100], name[128];
    if (!old || !old[0]) return;
    snprintf(stem, sizeof stem, "%.90s", old);
    char *blank = strrchr(stem, ' ');
    if (blank && blank[1] && strspn(blank + 1, "0123456789") == strlen(blank + 1)) *blank = 0;
    int number = 2;
    do snprintf(name, sizeof name, "%s %d", stem, number++);
    while (is_taken(objects, name));
    json_object_set_new(object, "name", json_string(name));
}

char *io_scene_object_beside(const io_scene *scene, const char *list, size_t index, const double by[3]) {
    json_t *object = copy_of(scene, list, index);
    const skein_kind *kind = kind_of(object, list);
    for (size_t f = 0; kind && f < kind->field_count; f++)
        if (is_place(&kind->fields[f])) shift_field(object, &kind->fields[f], by);
    if (object) name_anew(object, json_object_get(io_scene_document(scene), list));
    return text_of(object);
}

/* ---- other members ---- */

/* Whether the kind has a field of that name, or fields in a group of it. */
static bool knows(const skein_kind *kind, const char *member) {
    size_t length = strlen(member), common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t f = 0; f < kind->field_count + common_count; f++) {
        const char *name = f < kind->field_count ? kind->fields[f].name : common[f - kind->field_count].name;
        if (!strncmp(name, member, length) && (name[length] == 0 || name[length] == '.')) return true;
    }
    return !strcmp(member, "type") || !strcmp(member, "particles");
}

char *io_scene_object_with(const io_scene *scene, const char *list, size_t index, const char *members) {
    json_t *object = copy_of(scene, list, index), *more = json_loads(members, 0, NULL), *value;
    const char *name;
    void *next;
    if (object && more) {
        json_object_foreach(more, name, value) {
            if (json_is_null(value)) json_object_del(object, name);
            else json_object_set(object, name, value);
        }
        const skein_kind *kind = kind_of(object, list);
        json_object_foreach_safe(object, next, name, value) if (kind && !knows(kind, name))
            json_object_del(object, name);
    } else {
        json_decref(object);
        object = NULL;
    }
    json_decref(more);
    return text_of(object);
}
