/* "path=value": sets one value of a scene's document before it is read as a scene.
 *
 *   bodies.0.stretch.stiffness=2e4     a place in a list, then fields
 *   colliders.ball.centre=[0,1,0]      a name in a list; JSON after the equals sign
 *   method.type=symplectic_euler       a word needs no quotes; the method keeps what both kinds have
 *   forces.2={"type": "drag"}          one more, where the list has two
 *   forces.0=null                      one less; for a member of an object: its default
 *
 * A member that an object does not have yet is made: whether there is such a field is found out by the
 * reader, as for every other member. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    const skein_kind *kind = type ? skein_kind_find(SKEIN_METHOD, type, NULL) : NULL;
    const char *name, *old = json_string_value(json_object_get(method, "type"));
    json_t *value;
    void *next;
    if (!kind || (old && !strcmp(old, type))) return;
    json_object_foreach_safe(method, next, name, value) {
        char note[300];
        if (!strcmp(name, "type") || skein_field_find(kind, name, NULL)) continue;
        snprintf(note, sizeof note, "method.%.100s is left out: %s has no such field", name, type);
        json_array_append_new(notes, json_string(note));
        json_object_del(method, name);
    }
}

bool io_scene_override(json_t *root, const char *set, io_faults *faults, json_t *notes) {
    char option[200];
    snprintf(option, sizeof option, "--set %s", set);
    io_place place = {option, "", faults};
    const char *equals = strchr(set, '=');
    if (!equals || equals == set) {
        io_fault(place, "", SKEIN_ERROR_SYNTAX, "expected path=value, such as bodies.0.stretch.stiffness=2e4");
        return false;
    }
    json_t *value = json_loads(equals + 1, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
    if (!value) value = json_string(equals + 1);
    char *path = strndup(set, (size_t)(equals - set)), *key = path;
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
