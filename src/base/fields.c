/* The functions on tables of fields: defaults, ranges, checks with their messages, conversion of values. */
#include "base/fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/status.h"

/* How many numbers a type has; 0 for texts. */
static int number_count(skein_field_type type) {
    switch (type) {
    case SKEIN_FIELD_BOOL:
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_REAL: return 1;
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_REAL2: return 2;
    case SKEIN_FIELD_INT3:
    case SKEIN_FIELD_VEC3: return 3;
    case SKEIN_FIELD_CHOICE:
    case SKEIN_FIELD_TEXT: return 0;
    }
    return 0;
}

static const char *type_text(skein_field_type type) {
    switch (type) {
    case SKEIN_FIELD_BOOL: return "true or false";
    case SKEIN_FIELD_INT: return "a whole number";
    case SKEIN_FIELD_INT2: return "two whole numbers";
    case SKEIN_FIELD_INT3: return "three whole numbers";
    case SKEIN_FIELD_REAL: return "a number";
    case SKEIN_FIELD_REAL2: return "two numbers";
    case SKEIN_FIELD_VEC3: return "three numbers";
    case SKEIN_FIELD_CHOICE: return "a word";
    case SKEIN_FIELD_TEXT: return "a text";
    }
    return "a value";
}

/* The place of `word` in "one|two|three", or -1. */
static int choice_place(const char *choices, const char *word) {
    size_t length = strlen(word);
    int place = 0;
    for (const char *at = choices; at; place++) {
        const char *bar = strchr(at, '|');
        size_t size = bar ? (size_t)(bar - at) : strlen(at);
        if (size == length && !memcmp(at, word, length)) return place;
        at = bar ? bar + 1 : NULL;
    }
    return -1;
}

static int choice_count(const char *choices) {
    int count = 1;
    for (const char *at = choices; *at; at++) count += *at == '|';
    return count;
}

/* The range in words: "from 1 to 64", "at least 0". */
static void range_text(const skein_field *field, char *text, size_t size) {
    bool low = field->least > -SK_FAR, high = field->most < SK_FAR;
    if (low && high) snprintf(text, size, "from %g to %g", field->least, field->most);
    else if (low) snprintf(text, size, "%g or more", field->least);
    else if (high) snprintf(text, size, "%g or less", field->most);
    else snprintf(text, size, "between -1e15 and 1e15");
}

static bool is_whole(skein_field_type type) {
    return type == SKEIN_FIELD_BOOL || type == SKEIN_FIELD_INT || type == SKEIN_FIELD_INT2 || type == SKEIN_FIELD_INT3;
}

skein_status skein_field_check(const skein_field *field, const skein_value *value, skein_error *error) {
    if (!field || !value) return sk_fail_null(error, field ? "value" : "field");
    int need = number_count(field->type);
    char range[96];
    // texts and words; a choice may also be given by its place
    if (field->type == SKEIN_FIELD_CHOICE && value->count == 1 && value->number[0] >= 0 &&
        value->number[0] < choice_count(field->choices) && value->number[0] == floor(value->number[0]))
        return SKEIN_OK;
    if (need == 0) {
        if (value->count != 0 || !value->text)
            return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "expected %s%s%s", type_text(field->type),
                           field->choices ? " of " : "", field->choices ? field->choices : "");
        if (field->type == SKEIN_FIELD_CHOICE && choice_place(field->choices, value->text) < 0)
            return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "'%s' is none of %s", value->text, field->choices);
        return SKEIN_OK;
    }
    // numbers: as many as asked, finite or allowed to be infinite, in range
    if (value->count != need)
        return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "expected %s%s%s", type_text(field->type),
                       field->unit[0] ? " in " : "", field->unit);
    for (int i = 0; i < need; i++) {
        double x = value->number[i];
        if (is_whole(field->type) && x != floor(x))
            return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "expected %s, not %g", type_text(field->type), x);
        if (!(x >= field->least && x <= field->most)) {
            range_text(field, range, sizeof range);
            return sk_fail(error, SKEIN_ERROR_VALUE, field->name, "%g is out of range: expected %s%s%s", x, range,
                           field->unit[0] ? " " : "", field->unit);
        }
    }
    return SKEIN_OK;
}

skein_status sk_field_store(sk_allocator *allocator, const skein_field *field, void *params, const skein_value *value,
                            skein_error *error) {
    skein_status status = skein_field_check(field, value, error);
    if (status) return status;
    char *at = (char *)params + field->offset;
    switch (field->type) {
    case SKEIN_FIELD_BOOL: *(bool *)at = value->number[0] != 0; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_INT3:
        for (int i = 0; i < number_count(field->type); i++) ((int32_t *)(void *)at)[i] = (int32_t)value->number[i];
        break;
    case SKEIN_FIELD_REAL:
    case SKEIN_FIELD_REAL2:
    case SKEIN_FIELD_VEC3: memcpy(at, value->number, (size_t)number_count(field->type) * sizeof(double)); break;
    case SKEIN_FIELD_CHOICE:
        *(int32_t *)(void *)at = value->count ? (int32_t)value->number[0] : choice_place(field->choices, value->text);
        break;
    case SKEIN_FIELD_TEXT: {
        char *copy = sk_copy_text(allocator, value->text);
        if (!copy) return sk_fail_memory(error, field->name);
        sk_release(allocator, *(char **)(void *)at);
        *(char **)(void *)at = copy;
        break;
    }
    }
    return SKEIN_OK;
}

skein_status sk_presets_apply(sk_allocator *allocator, const sk_presets *presets, const skein_field *fields,
                              size_t count, void *params, skein_error *error) {
    const skein_field *choice = sk_field_named(fields, count, presets->field);
    int32_t word = *(const int32_t *)(const void *)((const char *)params + choice->offset);
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < presets->count && word && !status; i++) {
        skein_value value = skein_number(presets->values[(size_t)(word - 1) * presets->count + i]);
        if (!isnan(value.number[0]))
            status = sk_field_store(allocator, sk_field_named(fields, count, presets->names[i]), params, &value, error);
    }
    return status;
}

bool sk_values_are_same(const skein_value *a, const skein_value *b) {
    if (a->count != b->count) return false;
    if (!a->count) return !strcmp(a->text ? a->text : "", b->text ? b->text : "");
    for (int k = 0; k < a->count; k++)
        if (a->number[k] < b->number[k] || a->number[k] > b->number[k]) return false;
    return true;
}

skein_value sk_field_load(const skein_field *field, const void *params) {
    const char *at = (const char *)params + field->offset;
    skein_value value = {number_count(field->type), {0, 0, 0}, NULL};
    switch (field->type) {
    case SKEIN_FIELD_BOOL: value.number[0] = *(const bool *)at; break;
    case SKEIN_FIELD_INT:
    case SKEIN_FIELD_INT2:
    case SKEIN_FIELD_INT3:
        for (int i = 0; i < value.count; i++) value.number[i] = ((const int32_t *)(const void *)at)[i];
        break;
    case SKEIN_FIELD_REAL:
    case SKEIN_FIELD_REAL2:
    case SKEIN_FIELD_VEC3: memcpy(value.number, at, (size_t)value.count * sizeof(double)); break;
    case SKEIN_FIELD_CHOICE:
        value.count = 1;
        value.number[0] = *(const int32_t *)(const void *)at;
        break;
    case SKEIN_FIELD_TEXT: value.text = *(char *const *)(const void *)at; break;
    }
    return value;
}

size_t skein_value_text(const skein_field *field, const skein_value *value, char *text, size_t size) {
    if (!text) size = 0;
    if (!field || !value) return (size_t)snprintf(text, size, "%s", "");
    if (field->type == SKEIN_FIELD_BOOL)
        return (size_t)snprintf(text, size, "%s", value->number[0] != 0 ? "true" : "false");
    if (field->type == SKEIN_FIELD_TEXT || (field->type == SKEIN_FIELD_CHOICE && !value->count))
        return (size_t)snprintf(text, size, "%s", value->text ? value->text : "");
    if (field->type == SKEIN_FIELD_CHOICE) {
        const char *word = field->choices;
        for (int place = 0; place < (int)value->number[0] && strchr(word, '|'); place++) word = strchr(word, '|') + 1;
        return (size_t)snprintf(text, size, "%.*s", (int)strcspn(word, "|"), word);
    }
    size_t length = 0;
    for (int i = 0; i < value->count; i++)
        length += (size_t)snprintf(text + (length < size ? length : size), length < size ? size - length : 0, "%s%.9g",
                                   i ? " " : "", value->number[i]);
    return length;
}

bool sk_fields_default(sk_allocator *allocator, const skein_field *fields, size_t count, void *params) {
    for (size_t i = 0; i < count; i++) {
        const skein_field *field = &fields[i];
        char *at = (char *)params + field->offset;
        if (field->type == SKEIN_FIELD_CHOICE) {
            *(int32_t *)(void *)at = (int32_t)field->initial[0];
            continue;
        }
        skein_value value = {number_count(field->type), {0, 0, 0}, field->text ? field->text : ""};
        memcpy(value.number, field->initial, sizeof value.number);
        if (sk_field_store(allocator, field, params, &value, NULL)) return false;
    }
    return true;
}

void sk_fields_clear(sk_allocator *allocator, const skein_field *fields, size_t count, void *params) {
    for (size_t i = 0; i < count; i++) {
        if (fields[i].type != SKEIN_FIELD_TEXT) continue;
        char **text = (char **)(void *)((char *)params + fields[i].offset);
        sk_release(allocator, *text);
        *text = NULL;
    }
}

const skein_field *sk_field_named(const skein_field *fields, size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(fields[i].name, name)) return &fields[i];
    return NULL;
}
