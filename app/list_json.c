/* skein list --json: the tables of fields for programs. */
#include <jansson.h>
#include <math.h>
#include <string.h>

#include "app/command.h"
#include "app/list.h"

/* A bound, which JSON cannot have infinite; NULL where there is none. */
static json_t *bound(double x, bool is_most) {
    const double far = 1e15; // what the library takes for no bound
    if (isinf(x)) return is_most ? json_string("infinite") : json_null();
    return fabs(x) >= far ? json_null() : json_real(x);
}

static json_t *initial_of(const skein_field *field) {
    static const int counts[] = {
        [SKEIN_FIELD_INT2] = 2, [SKEIN_FIELD_INT3] = 3, [SKEIN_FIELD_REAL2] = 2, [SKEIN_FIELD_VEC3] = 3, [SKEIN_FIELD_TEXT] = 0};
    int count = counts[field->type];
    if (strchr(field->name, '*')) return json_null(); // a name that an object gives
    if (field->type == SKEIN_FIELD_TEXT) return json_string(field->text ? field->text : "");
    if (field->type == SKEIN_FIELD_BOOL) return json_boolean(field->initial[0] != 0);
    if (field->type == SKEIN_FIELD_CHOICE) {
        char word[128];
        const skein_value value = {1, {field->initial[0], 0, 0}, NULL};
        skein_value_text(field, &value, word, sizeof word);
        return json_string(word);
    }
    if (!count) return isinf(field->initial[0]) ? json_string("infinite") : json_real(field->initial[0]);
    json_t *list = json_array();
    for (int i = 0; i < count; i++) json_array_append_new(list, json_real(field->initial[i]));
    return list;
}

static json_t *choices_of(const char *choices) {
    json_t *list = json_array();
    for (const char *at = choices; at; at = strchr(at, '|')) {
        at += *at == '|';
        json_array_append_new(list, json_stringn(at, strcspn(at, "|")));
    }
    return list;
}

static json_t *describe_field(const skein_field *field) {
    static const char *const types[] = {
        [SKEIN_FIELD_BOOL] = "bool", [SKEIN_FIELD_INT] = "int",       [SKEIN_FIELD_INT2] = "int2",
        [SKEIN_FIELD_INT3] = "int3", [SKEIN_FIELD_REAL] = "real",     [SKEIN_FIELD_REAL2] = "real2",
        [SKEIN_FIELD_VEC3] = "vec3", [SKEIN_FIELD_CHOICE] = "choice", [SKEIN_FIELD_TEXT] = "text"};
    json_t *json = json_object();
    json_object_set_new(json, "name", json_string(field->name));
    json_object_set_new(json, "type", json_string(types[field->type]));
    json_object_set_new(json, "unit", json_string(field->unit));
    json_object_set_new(json, "default", initial_of(field));
    if (field->type == SKEIN_FIELD_CHOICE) json_object_set_new(json, "choices", choices_of(field->choices));
    else if (field->type != SKEIN_FIELD_BOOL && field->type != SKEIN_FIELD_TEXT) {
        json_object_set_new(json, "least", bound(field->least, false));
        json_object_set_new(json, "most", bound(field->most, true));
    }
    json_object_set_new(json, "help", json_string(field->help));
    return json;
}

json_t *app_kind_json(const skein_kind *kind) {
    size_t common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    json_t *json = json_object(), *fields = json_array();
    json_object_set_new(json, "name", json_string(kind->name));
    json_object_set_new(json, "help", json_string(kind->help));
    for (size_t i = 0; i < kind->field_count; i++) json_array_append_new(fields, describe_field(&kind->fields[i]));
    for (size_t i = 0; i < common_count; i++)
        if (skein_kind_takes(kind, common[i].name)) json_array_append_new(fields, describe_field(&common[i]));
    json_object_set_new(json, "fields", fields);
    return json;
}
