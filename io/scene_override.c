/* "path=value": sets one value of a scene's document before it is read as a scene.
 *
 *   bodies.0.stretch.stiffness=2e4     a place in a list, then fields
 *   colliders.ball.centre=[0,1,0]      a name in a list; JSON after the equals sign
 *   forces.0.acceleration=0 -9.81 0    numbers as `skein list` shows them, with blanks or commas and a unit or none
 *   method.type=symplectic_euler       a word needs no quotes; the method keeps what both kinds have
 *   forces.2={"type": "drag"}          one more, where the list has two
 *   forces.0=null                      one less; for a member of an object: its default
 *
 * A member that an object does not have yet is made: whether there is such a field is found out by the
 * reader, as for every other member. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"

#include "io/scene_settings.h"

/* The place in a list of its member `key`: a number, or the "name" of an object in it. The list's size if
 * there is none. */
static size_t place_in_list(const json_t *list, const char *key) {
    size_t size = json_array_size(list);
    if (key[0] && strspn(key, "0123456789") == strlen(key)) {
        unsigned long long index = strtoull(key, NULL, 10);
        return index < size ? (size_t)index : size;
    }
    for (size_t i = 0; i < size; i++) {
        const char *name = json_string_value(json_object_get(json_array_get(list, i), "name"));
        if (name && !strcmp(name, key)) return i;
    }
    return size;
}

static bool is_list_section(const char *name) {
    for (size_t i = 0; io_scene_section_at(i); i++)
        if (!strcmp(io_scene_section_at(i)->name, name)) {
            skein_category category = io_scene_section_at(i)->category;
            return category != SKEIN_METHOD && category != SKEIN_VIEW;
        }
    return false;
}

/* The member `key` of an object or list; an object that lacks it gets it, empty. NULL if there is none. */
static json_t *member_of(json_t *at, const char *key, bool top) {
    if (json_is_array(at)) return json_array_get(at, place_in_list(at, key));
    json_t *next = json_object_get(at, key);
    if (next || !json_is_object(at) || !key[0]) return next;
    json_object_set_new(at, key, top && is_list_section(key) ? json_array() : json_object());
    return json_object_get(at, key);
}

/* The place after the last of a list makes one more; null takes one away. */
static bool set_member(json_t *at, const char *key, json_t *value) {
    if (!json_is_array(at)) {
        if (json_is_null(value) && json_is_object(at) && key[0]) return !json_object_del(at, key);
        return json_is_object(at) && key[0] && !json_object_set(at, key, value);
    }
    size_t place = place_in_list(at, key), size = json_array_size(at);
    bool next = place == size && key[0] && strspn(key, "0123456789") == strlen(key) && strtoull(key, NULL, 10) == size;
    if (json_is_null(value)) return place < size && !json_array_remove(at, place);
    return next ? !json_array_append(at, value) : !json_array_set(at, place, value);
}

/* Says why `key` leads nowhere from `at`, whose own path is `path`. */
static void report_dead_end(io_place place, const char *path, const json_t *at, const char *key) {
    char words[IO_JSON_WORDS_SIZE];
    size_t size = json_array_size(at);
    if (!key[0]) io_fault(place, "", SKEIN_ERROR_SYNTAX, "a name is missing in the path");
    else if (json_is_array(at) && size == 0)
        io_fault(place, "", SKEIN_ERROR_NAME, "there is no '%.100s' in %.100s, which is empty", key, path);
    else if (json_is_array(at))
        io_fault(place, "", SKEIN_ERROR_NAME, "there is no '%.100s' in %.100s: it has %zu, counted from 0", key, path,
                 size);
    else if (json_is_object(at)) io_fault(place, "", SKEIN_ERROR_SYNTAX, "'%.100s' cannot be a name in a scene", key);
    else io_fault(place, "", SKEIN_ERROR_NAME, "%.100s is %s: it has no '%.100s'", path, io_json_words(at, words), key);
}

/* Another kind of method takes over: what it does not know is left out, and said. A kind that does not exist is
 * for the reader to find. */
static void leave_out_strangers(json_t *method, const char *type, json_t *notes) {
    const skein_kind *kind = type ? io_kind_find(SKEIN_METHOD, type, NULL) : NULL;
    const char *name, *old = json_string_value(json_object_get(method, "type"));
    json_t *value;
    void *next;
    if (!kind || (old && !strcmp(old, type))) return;
    json_object_foreach_safe(method, next, name, value) {
        char note[300];
        char whole[200];
        snprintf(whole, sizeof whole, "method.%.150s", name);
        if (!strcmp(name, "type") || skein_field_find(kind, name, NULL) ||
            skein_field_find(io_scene_kind(), whole, NULL))
            continue;
        snprintf(note, sizeof note, "method.%.100s is left out: %s has no such field", name, type);
        json_array_append_new(notes, json_string(note));
        json_object_del(method, name);
    }
}

/* ---- values as texts ---- */

/* The kind of the object that an item of a section is; NULL where it is of none that is known. */
static const skein_kind *kind_of_item(const json_t *item, skein_category category, const skein_kind *const *kinds) {
    const char *type = json_string_value(json_object_get(item, "type"));
    if (category != SKEIN_EXPORTER && category != SKEIN_VIEW) return type ? io_kind_find(category, type, NULL) : NULL;
    for (; kinds && *kinds; kinds++)
        if ((*kinds)->category == category && (category == SKEIN_VIEW || (type && !strcmp((*kinds)->name, type))))
            return *kinds;
    return NULL;
}

/* The field that a path leads to; NULL where it leads to an object, or nowhere. */
static const skein_field *field_at(const json_t *root, const char *path, const skein_kind *const *kinds) {
    const char *dot = strchr(path, '.');
    const skein_field *own = skein_field_find(io_scene_kind(), path, NULL); // method.budget_ms is one
    if (!dot || own) return own;
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)(dot - path < 63 ? dot - path : 63), path);
    const io_scene_section *section = NULL;
    for (size_t i = 0; io_scene_section_at(i) && !section; i++)
        if (!strcmp(io_scene_section_at(i)->name, name)) section = io_scene_section_at(i);
    const json_t *item = json_object_get(root, name);
    if (!section || !item) return NULL;
    if (json_is_array(item)) { // its place, or its name, comes first
        const char *next = strchr(dot + 1, '.');
        if (!next) return NULL;
        snprintf(name, sizeof name, "%.*s", (int)(next - dot - 1 < 63 ? next - dot - 1 : 63), dot + 1);
        item = json_array_get(item, place_in_list(item, name));
        dot = next;
    }
    const skein_kind *kind = kind_of_item(item, section->category, kinds);
    return kind ? skein_field_find(kind, dot + 1, NULL) : NULL;
}

/* Whether there is nothing but the field's unit, or nothing at all. */
static bool is_unit(const skein_field *field, const char *text) {
    text += strspn(text, " ");
    size_t length = strlen(field->unit);
    if (length && !strncmp(text, field->unit, length)) text += length;
    return !text[strspn(text, " ")];
}

/* "0 -9.81 0", "(0, -9.81, 0)" or "0 -9.81 0 m/s2" for a field of three numbers; NULL where it is no such thing. */
static json_t *read_numbers(const skein_field *field, const char *text) {
    int count = io_field_numbers(field);
    json_t *list = json_array();
    text += strspn(text, " ");
    const char *closing = *text == '(' ? ")" : *text == '[' ? "]" : "";
    text += closing[0] != 0;
    for (int i = 0; i < count && list; i++) {
        char *end;
        double x = strtod(text, &end);
        if (end == text || !isfinite(x)) break;
        json_array_append_new(list, x == floor(x) && fabs(x) < 1e9 ? json_integer((json_int_t)x) : json_real(x));
        text = end + strspn(end, i + 1 < count ? " ," : " ");
    }
    bool closed = !closing[0] || *text == closing[0];
    if (closed) text += closing[0] != 0;
    if (list && (int)json_array_size(list) == count && closed && is_unit(field, text)) {
        if (count > 1) return list;
        json_t *one = json_incref(json_array_get(list, 0));
        json_decref(list);
        return one;
    }
    json_decref(list);
    return NULL;
}

/* What stands behind the equals sign: JSON, or what the field's type makes of the text, or a text. */
static json_t *read_value(const skein_field *field, const char *text) {
    static const char infinite[] = "infinite";
    json_t *value = json_loads(text, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL), *numbers = NULL;
    if (value && field && field->type == SKEIN_FIELD_TEXT && !strcmp(field->name, "name") && json_is_number(value)) {
        json_decref(value); // "--set name=5": a title like any other
        value = NULL;
    }
    if (value) return value;
    bool takes_numbers = field && io_field_numbers(field) > 0 && field->type != SKEIN_FIELD_BOOL;
    if (takes_numbers) numbers = read_numbers(field, text);
    if (numbers) return numbers;
    if (takes_numbers && !strncmp(text, infinite, strlen(infinite)) && is_unit(field, text + strlen(infinite)))
        return json_string(infinite);
    return json_string(text);
}

/* A scene that says nothing of its method has the world's own; its name, for one that says a part. */
static void name_default_method(json_t *root) {
    skein_world_desc desc = skein_default_world_desc();
    skein_world *world = skein_world_create(&desc, NULL);
    if (!world) return;
    json_t *method = json_object();
    const char *name = skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name;
    json_object_set_new(method, "type", json_string(name));
    json_object_set_new(root, "method", method);
    skein_world_destroy(world);
}

bool io_scene_override(json_t *root, const char *set, const skein_kind *const *kinds, io_faults *faults, json_t *notes) {
    char option[200];
    snprintf(option, sizeof option, "--set %s", set);
    io_place place = {option, "", faults};
    const char *equals = strchr(set, '=');
    if (!equals || equals == set) {
        io_fault(place, "", SKEIN_ERROR_SYNTAX, "expected path=value, such as bodies.0.stretch.stiffness=2e4");
        return false;
    }
    if (!strncmp(set, "method.", 7) && !json_object_get(root, "method")) name_default_method(root);
    char *path = strndup(set, (size_t)(equals - set)), *key = path;
    json_t *value = path ? read_value(field_at(root, path, kinds), equals + 1) : NULL;
    if (!value || !path) io_fault(place, "", SKEIN_ERROR_SYNTAX, "the value is not UTF-8, or there is no memory");
    bool good = value && path;
    // down to the object or list that holds the last name
    json_t *at = root;
    for (char *dot; good && (dot = strchr(key, '.')) != NULL; key = dot + 1) {
        *dot = 0;
        json_t *next = member_of(at, key, at == root);
        good = next != NULL;
        if (!good) {
            if (key > path) key[-1] = 0;
            report_dead_end(place, path, at, key);
        } else {
            *dot = '.';
            at = next;
        }
    }
    if (good && !strncmp(set, "method.type=", 12)) leave_out_strangers(at, json_string_value(value), notes);
    if (good && !set_member(at, key, value)) {
        if (key > path) key[-1] = 0;
        report_dead_end(place, path, at, key);
        good = false;
    }
    free(path);
    json_decref(value);
    return good;
}
