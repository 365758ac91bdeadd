/* JSON values as settings: each member is looked up among a kind's fields, converted, and refused with its place. */
#include "io/scene_settings.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- the list ---- */

void io_settings_free(io_settings *settings) {
    for (size_t i = 0; i < settings->text_count; i++) free(settings->texts[i]);
    free(settings->texts);
    free(settings->data);
    memset(settings, 0, sizeof *settings);
}

/* Keeps a text, which may be NULL, for as long as the settings live; NULL when there is no memory. */
static const char *keep_text(io_settings *settings, char *text) {
    if (text && io_grow(&settings->texts, &settings->text_capacity, settings->text_count + 1, sizeof *settings->texts))
        return settings->texts[settings->text_count++] = text;
    free(text);
    return NULL;
}

static bool append(io_settings *settings, const char *name, skein_value value) {
    if (!io_grow(&settings->data, &settings->capacity, settings->count + 2, sizeof *settings->data)) return false;
    settings->data[settings->count++] = (skein_setting){name, value};
    settings->data[settings->count] = (skein_setting){NULL, {0, {0, 0, 0}, NULL}};
    return true;
}

static const skein_setting *find_setting(const io_settings *settings, const char *name) {
    for (size_t i = 0; i < settings->count; i++)
        if (!strcmp(settings->data[i].name, name)) return &settings->data[i];
    return NULL;
}

const char *io_settings_text(const io_settings *settings, const char *name) {
    const skein_setting *setting = find_setting(settings, name);
    return setting ? setting->value.text : NULL;
}

/* ---- values ---- */

int io_field_numbers(const skein_field *field) {
    switch (field->type) {
    case SKEIN_FIELD_BOOL:
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_REAL: return 1;
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_REAL2: return 2;
    case SKEIN_FIELD_INT3:
    case SKEIN_FIELD_VEC3: return 3;
    case SKEIN_FIELD_CHOICE:
    case SKEIN_FIELD_TEXT: break;
    }
    return 0;
}

static bool is_own(const skein_kind *kind, const skein_field *field) {
    return field >= kind->fields && field < kind->fields + kind->field_count;
}

/* Texts of a motion's own fields may be tables: a list of rows. */
static bool takes_rows(const skein_kind *kind, const skein_field *field) {
    return field->type == SKEIN_FIELD_TEXT && kind->category == SKEIN_MOTION && is_own(kind, field);
}

/* A rule's `on`, a motion's `colliders` and a body's `groups`: names, which are joined by commas. */
static bool takes_names(const skein_kind *kind, const skein_field *field) {
    if (is_own(kind, field)) return false;
    return !strcmp(field->name, "on") || !strcmp(field->name, "colliders") || !strcmp(field->name, "groups");
}

/* Whether the item of a list is a name: an empty one would mean nobody, and behind a comma another one begins. */
static bool is_name(const json_t *item) {
    const char *text = json_string_value(item);
    return text && text[strspn(text, " ")] && !strchr(text, ',');
}

/* The names of a list; NULL where one is no name, or there is no memory. */
static char *join_names(const json_t *list) {
    size_t length = 1, index;
    json_t *item, *names = (json_t *)(uintptr_t)list; // jansson's getters take no const
    if (!json_is_array(list)) return NULL;
    json_array_foreach(names, index, item) {
        if (!is_name(item)) return NULL;
        length += json_string_length(item) + 2;
    }
    char *text = calloc(length, 1);
    json_array_foreach(names, index, item) {
        if (!text) break;
        if (index) strcat(text, ", ");
        strcat(text, json_string_value(item));
    }
    return text;
}

/* The texts of a body's own fields select parts of it, as a motion's "pins" do, and so have short forms. */
static bool takes_lists(const skein_kind *kind, const skein_field *field) {
    bool selects =
        kind->category == SKEIN_BODY
            ? is_own(kind, field)
            : kind->category == SKEIN_MOTION &&
                  (!strcmp(field->name, "pins") || !strcmp(field->name, "jump_times") || !strcmp(field->name, "map"));
    return field->type == SKEIN_FIELD_TEXT && selects;
}

/* A body by its name or its number. */
static bool takes_body(const skein_field *field) {
    return field->type == SKEIN_FIELD_TEXT && !strcmp(field->unit, "body");
}

static bool may_be_infinite(const skein_field *field) {
    return field->type == SKEIN_FIELD_REAL && isinf(field->most);
}

/* Turns a JSON value into a field's; false where it is of another type. Ranges are not looked at. */
static bool convert(io_settings *settings, const skein_kind *kind, const skein_field *field, const json_t *json,
                    skein_value *value) {
    int count = io_field_numbers(field);
    *value = (skein_value){count, {0, 0, 0}, NULL};
    if (count == 0) {
        if (json_is_string(json)) value->text = keep_text(settings, strdup(json_string_value(json)));
        else if (takes_names(kind, field)) value->text = keep_text(settings, join_names(json));
        else if (takes_body(field) && json_is_integer(json))
            value->text = keep_text(settings, json_dumps(json, JSON_ENCODE_ANY));
        else if (takes_lists(kind, field)) value->text = keep_text(settings, io_json_join(json));
        else if (takes_rows(kind, field)) value->text = keep_text(settings, io_json_join_rows(json));
        return value->text != NULL;
    }
    if (field->type == SKEIN_FIELD_BOOL) {
        value->number[0] = json_is_true(json);
        return json_is_boolean(json);
    }
    if (may_be_infinite(field) && json_is_string(json) && !strcmp(json_string_value(json), "infinite")) {
        value->number[0] = INFINITY;
        return true;
    }
    if (count == 1) {
        value->number[0] = json_number_value(json);
        return json_is_number(json);
    }
    if (!json_is_array(json) || json_array_size(json) != (size_t)count) return false;
    for (int i = 0; i < count; i++) {
        const json_t *item = json_array_get(json, (size_t)i);
        if (!json_is_number(item)) return false;
        value->number[i] = json_number_value(item);
    }
    return true;
}

/* Whether the item of a list is no use in this field, while the list is. */
static bool is_bad_item(const skein_kind *kind, const skein_field *field, const json_t *list, const json_t *item) {
    size_t count = (size_t)io_field_numbers(field);
    if (count > 1 && json_array_size(list) == count) return !json_is_number(item);
    if (takes_names(kind, field)) return !is_name(item);
    if (!takes_lists(kind, field)) return false;
    char *joined = json_is_array(item) ? NULL : io_json_join(item);
    free(joined);
    return !joined;
}

/* Says what an item of a list ought to be. */
static void report_item(io_place place, const char *name, const skein_kind *kind, const skein_field *field,
                        const json_t *item) {
    char words[IO_JSON_WORDS_SIZE];
    bool names = takes_names(kind, field),
         comma = names && json_is_string(item) && strchr(json_string_value(item), ',');
    io_fault(place, name, SKEIN_ERROR_VALUE, "expected a %s, not %s%s",
             names                      ? "name"
             : takes_lists(kind, field) ? "number or a text"
                                        : "number",
             io_json_words(item, words), comma ? ": in a list each name is a text of its own, without commas" : "");
}

/* Says what the field wants and what it got instead. */
static void report_type(io_place place, const char *name, const skein_kind *kind, const skein_field *field,
                        const json_t *json) {
    char words[IO_JSON_WORDS_SIZE], item[160];
    for (size_t i = 0; i < json_array_size(json); i++) {
        if (!is_bad_item(kind, field, json, json_array_get(json, i))) continue;
        snprintf(item, sizeof item, "%s.%zu", name, i);
        report_item(place, item, kind, field, json_array_get(json, i));
        return;
    }
    // the field itself knows what it wants: show it a value that fits none
    skein_error error = {SKEIN_OK, "", ""};
    skein_value nothing = {4, {0, 0, 0}, NULL};
    skein_field_check(field, &nothing, &error);
    io_fault(place, name, SKEIN_ERROR_VALUE, "%s%s, not %s", error.message,
             takes_names(kind, field)   ? " or a list of names"
             : takes_lists(kind, field) ? ", a list of numbers and words, {\"box\": [...]} or {\"sphere\": [...]}"
             : takes_rows(kind, field)  ? " or a list of rows, [[0, 0, 0, 0], [1, 0, 0.5, 0]], say"
             : takes_body(field)        ? " or its number"
             : may_be_infinite(field)   ? " or \"infinite\""
                                        : "",
             io_json_words(json, words));
}

/* ---- names ---- */

typedef struct name_list {
    const char *names[64];
    char groups[16][32];
    size_t count, group_count;
} name_list;

static void add_name(name_list *list, const char *name) {
    if (list->count < sizeof list->names / sizeof *list->names) list->names[list->count++] = name;
}

/* A field's group, "stretch" of "stretch.stiffness", if it is in one that is not yet in the list. */
static void add_group(name_list *list, const char *field) {
    size_t length = strcspn(field, "."), most = sizeof list->groups / sizeof *list->groups;
    if (!field[length] || length >= sizeof list->groups[0] || list->group_count == most) return;
    char *group = list->groups[list->group_count];
    snprintf(group, sizeof list->groups[0], "%.*s", (int)length, field);
    for (size_t i = 0; i < list->group_count; i++)
        if (!strcmp(list->groups[i], group)) return;
    list->group_count++;
    add_name(list, group);
}

/* What could have been meant: a group where an object was given, else a field; or one of `others`. */
static const char *hint_for(const skein_kind *kind, const char *name, bool object, const char *const *others,
                            char hint[IO_HINT_SIZE]) {
    name_list list = {{0}, {{0}}, 0, 0};
    size_t common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t i = 0; i < kind->field_count + common_count; i++) {
        const char *field = i < kind->field_count ? kind->fields[i].name : common[i - kind->field_count].name;
        if (object) add_group(&list, field);
        else add_name(&list, field);
    }
    for (; others && *others; others++) add_name(&list, *others);
    return io_hint(name, list.names, list.count, hint);
}

/* A field of the group `name`; NULL if there is no such group. */
static const skein_field *field_of_group(const skein_kind *kind, const char *name) {
    size_t length = strlen(name), common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t i = 0; i < kind->field_count + common_count; i++) {
        const skein_field *field = i < kind->field_count ? &kind->fields[i] : &common[i - kind->field_count];
        if (!strncmp(field->name, name, length) && field->name[length] == '.') return field;
    }
    return NULL;
}

static void report_unknown(io_place place, const char *name, const json_t *json, const skein_kind *kind,
                           const char *const *others) {
    char hint[IO_HINT_SIZE], words[IO_JSON_WORDS_SIZE];
    const skein_field *member = field_of_group(kind, name);
    if (member && strchr(member->name, '*'))
        io_fault(place, name, SKEIN_ERROR_VALUE, "expected an object of numbers, { \"R\": 0.5 }, say, not %s",
                 io_json_words(json, words));
    else if (member)
        io_fault(place, name, SKEIN_ERROR_VALUE, "expected an object with fields such as '%s', not %s",
                 member->name + strlen(name) + 1, io_json_words(json, words));
    else if (hint_for(kind, name, json_is_object(json), others, hint)[0])
        io_fault(place, name, SKEIN_ERROR_NAME, "%s has no field '%.100s'%s", kind->name, name, hint);
    else
        io_fault(place, name, SKEIN_ERROR_NAME, "%s has no field '%.100s'; `skein list %s` shows all", kind->name, name,
                 kind->name);
}

/* ---- objects ---- */

/* The name that a setting of the field goes by: the field's, or one that the scene gives a parameter. NULL when there
 * is no memory. */
static const char *name_of(io_settings *settings, const skein_field *field, const char *name) {
    return strcmp(field->name, name) ? keep_text(settings, strdup(name)) : field->name;
}

/* One member, whose full name is `name`. */
static bool read_member(io_settings *settings, io_place place, const char *name, const json_t *json,
                        const skein_kind *kind, const char *const *others) {
    const skein_field *field = skein_field_find(kind, name, NULL);
    skein_error error = {SKEIN_OK, "", ""};
    skein_value value;
    const char *kept = NULL;
    if (!field) report_unknown(place, name, json, kind, others);
    else if (find_setting(settings, name))
        io_fault(place, name, SKEIN_ERROR_VALUE, "is there twice, once in a group and once with a dot");
    else if (!convert(settings, kind, field, json, &value)) report_type(place, name, kind, field, json);
    else if (skein_field_check(field, &value, &error)) io_fault(place, name, error.status, "%s", error.message);
    else if (!(kept = name_of(settings, field, name)) || !append(settings, kept, value))
        io_fault(place, name, SKEIN_ERROR_MEMORY, "out of memory");
    else return true;
    return false;
}

static bool read_members(io_settings *settings, io_place place, const char *prefix, const json_t *object,
                         const skein_kind *kind, const char *const *skip) {
    bool good = true;
    const char *key;
    json_t *json;
    json_object_foreach((json_t *)(uintptr_t)object, key, json) {
        bool skipped = false;
        for (const char *const *s = skip; s && *s; s++) skipped |= !strcmp(*s, key);
        if (skipped) continue;
        char name[128];
        snprintf(name, sizeof name, "%s%s", prefix, key);
        if (json_is_object(json) && field_of_group(kind, name)) {
            strncat(name, ".", sizeof name - strlen(name) - 1);
            good &= read_members(settings, place, name, json, kind, NULL);
        } else {
            good &= read_member(settings, place, name, json, kind, skip);
        }
    }
    return good;
}

bool io_settings_read(io_settings *settings, io_place place, const json_t *object, const skein_kind *kind,
                      const char *const *skip) {
    memset(settings, 0, sizeof *settings);
    return read_members(settings, place, "", object, kind, skip);
}

bool io_settings_read_one(io_settings *settings, io_place place, const char *name, const json_t *json,
                          const skein_kind *kind) {
    return !json || read_member(settings, place, name, json, kind, NULL);
}
