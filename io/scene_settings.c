#include "io/scene_settings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void io_fault(io_place place, const char *member, skein_status status, const char *format, ...) {
    skein_error error = {status, "", ""};
    const char *dot = place.path[0] && member[0] ? "." : "";
    const char *colon = place.path[0] || member[0] ? ": " : "";
    snprintf(error.where, sizeof error.where, "%s%s%s%s%s", place.file, colon, place.path, dot, member);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error.message, sizeof error.message, format, arguments);
    va_end(arguments);
    place.faults->count++;
    if (place.faults->report) place.faults->report(place.faults->user, &error);
}

void io_settings_free(io_settings *settings) {
    for (size_t i = 0; i < settings->text_count; i++) free(settings->texts[i]);
    free(settings->texts);
    free(settings->data);
    memset(settings, 0, sizeof *settings);
}

/* Keeps a text for as long as the settings live; NULL when there is no memory. */
static const char *keep_text(io_settings *settings, const char *text) {
    if (!io_grow(&settings->texts, &settings->text_capacity, settings->text_count + 1, sizeof *settings->texts)) return NULL;
    char *copy = strdup(text);
    if (copy) settings->texts[settings->text_count++] = copy;
    return copy;
}

static bool append(io_settings *settings, const char *name, skein_value value) {
    if (!io_grow(&settings->data, &settings->capacity, settings->count + 2, sizeof *settings->data)) return false;
    settings->data[settings->count++] = (skein_setting){name, value};
    settings->data[settings->count] = (skein_setting){NULL, {0, {0, 0, 0}, NULL}};
    return true;
}

/* A list as one text: numbers parted by blanks, words by commas: [0, 16, "top edge"] is "0 16, top edge". */
static bool join_list(const json_t *list, char **joined, size_t *length, size_t *capacity) {
    size_t index;
    const json_t *item;
    bool after_number = false;
    json_array_foreach(list, index, item) {
        char number[32];
        const char *part = number;
        if (json_is_integer(item)) snprintf(number, sizeof number, "%lld", (long long)json_integer_value(item));
        else if (json_is_real(item)) snprintf(number, sizeof number, "%.17g", json_real_value(item));
        else if (json_is_string(item)) part = json_string_value(item);
        else return false;
        const char *between = !index ? "" : json_is_number(item) && after_number ? " " : ", ";
        size_t need = strlen(between) + strlen(part);
        if (!io_grow(joined, capacity, *length + need + 1, 1)) return false;
        *length += (size_t)sprintf(*joined + *length, "%s%s", between, part);
        after_number = json_is_number(item);
    }
    return true;
}

/* {"box": [6 numbers]} or {"sphere": [4 numbers]} as "box ..." and "sphere ...". */
static bool join_shape(const json_t *object, char **joined, size_t *length, size_t *capacity) {
    const char *key = json_object_iter_key(json_object_iter((json_t *)(uintptr_t)object));
    if (json_object_size(object) != 1 || (strcmp(key, "box") && strcmp(key, "sphere"))) return false;
    const json_t *list = json_object_get(object, key);
    if (!json_is_array(list) || !io_grow(joined, capacity, *length + strlen(key) + 2, 1)) return false;
    *length += (size_t)sprintf(*joined + *length, "%s ", key);
    return join_list(list, joined, length, capacity);
}

/* Turns a JSON value into a field's; false if it is of no use. */
static bool convert(io_settings *settings, const skein_field *field, const json_t *json, skein_value *value) {
    *value = (skein_value){1, {0, 0, 0}, NULL};
    if (json_is_boolean(json) && field->type == SKEIN_FIELD_BOOL) {
        value->number[0] = json_is_true(json);
        return true;
    }
    if (json_is_number(json) && field->type != SKEIN_FIELD_BOOL && field->type != SKEIN_FIELD_TEXT && field->type != SKEIN_FIELD_CHOICE) {
        value->number[0] = json_number_value(json);
        return true;
    }
    if (json_is_string(json) && field->type == SKEIN_FIELD_REAL && isinf(field->most) && !strcmp(json_string_value(json), "infinite")) {
        value->number[0] = INFINITY;
        return true;
    }
    if (field->type == SKEIN_FIELD_TEXT || field->type == SKEIN_FIELD_CHOICE) {
        value->count = 0;
        if (json_is_string(json)) value->text = keep_text(settings, json_string_value(json));
        if (field->type == SKEIN_FIELD_TEXT && (json_is_array(json) || json_is_object(json) || json_is_integer(json))) {
            char *joined = NULL;
            size_t length = 0, capacity = 0;
            json_t *one = json_is_integer(json) ? json_pack("[O]", (json_t *)(uintptr_t)json) : NULL;
            bool good = io_grow(&joined, &capacity, 1, 1);
            if (good) joined[0] = 0;
            good = good && (json_is_object(json) ? join_shape(json, &joined, &length, &capacity)
                                                 : join_list(one ? one : json, &joined, &length, &capacity));
            if (good) value->text = keep_text(settings, joined);
            json_decref(one);
            free(joined);
        }
        return value->text != NULL;
    }
    if (!json_is_array(json) || json_array_size(json) > 3) return false;
    value->count = (int)json_array_size(json);
    for (int i = 0; i < value->count; i++) {
        const json_t *item = json_array_get(json, (size_t)i);
        if (!json_is_number(item)) return false;
        value->number[i] = json_number_value(item);
    }
    return true;
}

static bool is_group(const skein_kind *kind, const char *name) {
    size_t length = strlen(name), common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t i = 0; i < kind->field_count; i++)
        if (!strncmp(kind->fields[i].name, name, length) && kind->fields[i].name[length] == '.') return true;
    for (size_t i = 0; i < common_count; i++)
        if (!strncmp(common[i].name, name, length) && common[i].name[length] == '.') return true;
    return false;
}

static const char *json_type_text(const json_t *json) {
    switch (json_typeof(json)) {
    case JSON_OBJECT: return "an object";
    case JSON_ARRAY: return "a list";
    case JSON_STRING: return "a text";
    case JSON_INTEGER:
    case JSON_REAL: return "a number";
    case JSON_TRUE:
    case JSON_FALSE: return "true or false";
    case JSON_NULL: return "null";
    }
    return "a value";
}

/* One member, whose full name is `name`. */
static bool read_member(io_settings *settings, io_place place, const char *name, const json_t *json, const skein_kind *kind) {
    skein_error error = {SKEIN_OK, "", ""};
    const skein_field *field = skein_field_find(kind, name, &error);
    if (!field) {
        io_fault(place, name, error.status, "%s", error.message);
        return false;
    }
    skein_value value;
    if (!convert(settings, field, json, &value)) {
        // ask the field itself what it wants, with a value that fits no field
        skein_value nothing = {4, {0, 0, 0}, NULL};
        skein_field_check(field, &nothing, &error);
        io_fault(place, name, SKEIN_ERROR_VALUE, "%s, not %s", error.message, json_type_text(json));
        return false;
    }
    if (skein_field_check(field, &value, &error)) {
        io_fault(place, name, error.status, "%s", error.message);
        return false;
    }
    if (append(settings, field->name, value)) return true;
    io_fault(place, name, SKEIN_ERROR_MEMORY, "out of memory");
    return false;
}

static bool read_members(io_settings *settings, io_place place, const char *prefix, const json_t *object, const skein_kind *kind,
                         const char *const *skip) {
    bool good = true;
    const char *key;
    json_t *json;
    json_object_foreach((json_t *)(uintptr_t)object, key, json) {
        bool skipped = false;
        for (const char *const *s = skip; s && *s; s++) skipped |= !strcmp(*s, key);
        if (skipped) continue;
        char name[128];
        snprintf(name, sizeof name, "%s%s", prefix, key);
        if (json_is_object(json) && is_group(kind, name)) {
            strncat(name, ".", sizeof name - strlen(name) - 1);
            good &= read_members(settings, place, name, json, kind, NULL);
        } else {
            good &= read_member(settings, place, name, json, kind);
        }
    }
    return good;
}

bool io_settings_read(io_settings *settings, io_place place, const json_t *object, const skein_kind *kind, const char *const *skip) {
    memset(settings, 0, sizeof *settings);
    return read_members(settings, place, "", object, kind, skip);
}

const char *io_settings_text(const io_settings *settings, const char *name) {
    const char *text = NULL;
    for (size_t i = 0; i < settings->count; i++)
        if (!strcmp(settings->data[i].name, name)) text = settings->data[i].value.text;
    return text;
}

/* ---- path=value ---- */

/* The member of a list by place or by the name of an object in it. */
static json_t *list_member(json_t *list, const char *key) {
    char *end;
    unsigned long index = strtoul(key, &end, 10);
    if (end != key && !*end) return json_array_get(list, index);
    size_t i;
    json_t *item;
    json_array_foreach(list, i, item) {
        const char *name = json_string_value(json_object_get(item, "name"));
        if (name && !strcmp(name, key)) return item;
    }
    return NULL;
}

bool io_scene_override(json_t *root, const char *set, io_place place) {
    const char *equals = strchr(set, '=');
    char path[256];
    if (!equals || equals == set || (size_t)(equals - set) >= sizeof path) {
        io_fault(place, "", SKEIN_ERROR_SYNTAX, "--set %s: expected path=value, such as bodies.0.stretch.stiffness=2e4", set);
        return false;
    }
    snprintf(path, sizeof path, "%.*s", (int)(equals - set), set);
    json_t *value = json_loads(equals + 1, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
    if (!value) value = json_string(equals + 1); // a word needs no quotes
    json_t *at = root;
    char *key = path;
    for (char *dot; value && (dot = strchr(key, '.')); key = dot + 1) {
        *dot = 0;
        json_t *next = json_is_array(at) ? list_member(at, key) : json_object_get(at, key);
        if (!next && json_is_object(at)) {
            json_object_set_new(at, key, json_object());
            next = json_object_get(at, key);
        }
        if (!json_is_object(next) && !json_is_array(next)) {
            io_fault(place, "", SKEIN_ERROR_NAME, "--set %s: there is no '%s'", set, key);
            json_decref(value);
            return false;
        }
        at = next;
    }
    bool good = value && json_is_object(at) && *key && !json_object_set(at, key, value);
    if (!good) io_fault(place, "", SKEIN_ERROR_NAME, "--set %s: '%s' cannot be set there", set, key);
    json_decref(value);
    return good;
}
