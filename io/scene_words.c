/* What the files of the scene reader say: faults with their places, hints at a name that was meant, JSON
 * values in words, and the short forms of a text ("pins": [0, 16, "top edge"]) as that text. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/printable.h"
#include "io/scene_settings.h"

/* ---- faults ---- */

static void report(io_place place, const char *member, skein_status status, const char *words, bool lines) {
    char where[4096 + 256];
    const char *dot = place.path[0] && member[0] ? "." : "";
    const char *colon = place.path[0] || member[0] ? ": " : "";
    snprintf(where, sizeof where, "%.4000s%s%.100s%s%.120s", place.file, colon, place.path, dot, member);
    skein_error error;
    io_error_set(&error, status, where, "%s", words);
    io_printable(error.where, false); // names and values come from the file
    io_printable(error.message, lines);
    place.faults->count++;
    if (place.faults->report) place.faults->report(place.faults->user, &error);
}

void io_fault(io_place place, const char *member, skein_status status, const char *format, ...) {
    char words[sizeof(skein_error)];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(words, sizeof words, format, arguments);
    va_end(arguments);
    report(place, member, status, words, false);
}

void io_fault_shown(io_place place, const char *member, skein_status status, const char *words) {
    report(place, member, status, words, true);
}

/* The library knows how to find the nearest name; here the names stand in as the fields of a kind. */
const char *io_hint(const char *name, const char *const *names, size_t count, char hint[IO_HINT_SIZE]) {
    enum { MOST = 64 };
    skein_field fields[MOST] = {{0}};
    if (count > MOST) count = MOST;
    for (size_t i = 0; i < count; i++) fields[i].name = names[i];
    skein_kind kind = {"", "", SKEIN_SCENE, fields, count, 0};
    skein_error error = {SKEIN_OK, "", ""};
    const char *found = skein_field_find(&kind, name, &error) ? NULL : strstr(error.message, "; did you mean '");
    // a name that holds these words itself
    for (const char *next = found; next; next = strstr(next + 1, "; did you mean '")) found = next;
    snprintf(hint, IO_HINT_SIZE, "%s", found ? found : "");
    return hint;
}

const char *io_json_words(const json_t *json, char out[IO_JSON_WORDS_SIZE]) {
    char quote[IO_QUOTE_SIZE];
    snprintf(out, IO_JSON_WORDS_SIZE, "nothing");
    if (!json) return out;
    switch (json_typeof(json)) {
    case JSON_OBJECT: snprintf(out, IO_JSON_WORDS_SIZE, "an object"); break;
    case JSON_ARRAY: snprintf(out, IO_JSON_WORDS_SIZE, "a list of %zu", json_array_size(json)); break;
    case JSON_STRING: {
        const char *text = json_string_value(json);
        snprintf(out, IO_JSON_WORDS_SIZE, "the text %s", io_quote(text, text + strlen(text), quote));
        break;
    }
    case JSON_INTEGER: snprintf(out, IO_JSON_WORDS_SIZE, "the number %lld", (long long)json_integer_value(json)); break;
    case JSON_REAL: snprintf(out, IO_JSON_WORDS_SIZE, "the number %g", json_real_value(json)); break;
    case JSON_TRUE: snprintf(out, IO_JSON_WORDS_SIZE, "true"); break;
    case JSON_FALSE: snprintf(out, IO_JSON_WORDS_SIZE, "false"); break;
    case JSON_NULL: snprintf(out, IO_JSON_WORDS_SIZE, "null"); break;
    }
    return out;
}

const char *io_json_instead(const json_t *json, char out[IO_JSON_WORDS_SIZE]) {
    enum { AHEAD = sizeof ", not " - 1 };
    char words[IO_JSON_WORDS_SIZE];
    if (json)
        snprintf(out, IO_JSON_WORDS_SIZE, ", not %.*s", IO_JSON_WORDS_SIZE - AHEAD - 1, io_json_words(json, words));
    else snprintf(out, IO_JSON_WORDS_SIZE, ": it is missing");
    return out;
}

/* ---- lists and shapes as texts ---- */

typedef struct joiner {
    char *text;
    size_t length, capacity;
    bool after_number;
} joiner;

static bool add_text(joiner *j, const char *between, const char *text) {
    size_t need = strlen(between) + strlen(text);
    if (!io_grow(&j->text, &j->capacity, j->length + need + 1, 1)) return false;
    j->length += (size_t)snprintf(j->text + j->length, need + 1, "%s%s", between, text);
    return true;
}

/* A number with as many digits as it needs to be read back the same; numbers are parted by blanks. */
static bool add_number(joiner *j, const json_t *json) {
    char text[32];
    if (json_is_integer(json)) {
        snprintf(text, sizeof text, "%lld", (long long)json_integer_value(json));
    } else {
        double x = json_real_value(json);
        for (int digits = 15; digits <= 17; digits++) {
            snprintf(text, sizeof text, "%.*g", digits, x);
            if (strtod(text, NULL) == x) break;
        }
        for (char *at = text; *at; at++) // in a program with another locale than the plain one
            if (!strchr("0123456789+-eE", *at)) *at = '.';
    }
    bool added = add_text(j, !j->length ? "" : j->after_number ? " " : ", ", text);
    j->after_number = true;
    return added;
}

/* {"box": [6 numbers]} or {"sphere": [4 numbers]} as "box ..." and "sphere ...". */
static bool add_shape(joiner *j, json_t *object) {
    const char *key = json_object_iter_key(json_object_iter(object));
    if (json_object_size(object) != 1 || (strcmp(key, "box") && strcmp(key, "sphere"))) return false;
    json_t *list = json_object_get(object, key), *number;
    size_t index;
    if (!json_is_array(list) || !add_text(j, j->length ? ", " : "", key)) return false;
    j->after_number = true;
    json_array_foreach(list, index, number) if (!json_is_number(number) || !add_number(j, number)) return false;
    j->after_number = false;
    return true;
}

static bool add_item(joiner *j, json_t *json) {
    if (json_is_number(json)) return add_number(j, json);

    if (json_is_object(json)) return add_shape(j, json);
    j->after_number = false;
    return json_is_string(json) && add_text(j, j->length ? ", " : "", json_string_value(json));
}

char *io_json_join(const json_t *json) {
    joiner j = {0};
    bool good = add_text(&j, "", "");
    size_t index;
    json_t *item, *one = (json_t *)(uintptr_t)json; // jansson's getters take no const
    if (!json_is_array(json)) good = good && add_item(&j, one);
    else json_array_foreach(one, index, item) good = good && add_item(&j, item);
    if (good) return j.text;
    free(j.text);
    return NULL;
}

/* [1, 2, 3] in a list: its numbers, parted from the rows before it by a comma. */
static bool add_row(joiner *j, json_t *list) {
    size_t index;
    json_t *number;
    if (!json_is_array(list) || (j->length && !add_text(j, ",", ""))) return false;
    j->after_number = true;
    json_array_foreach(list, index, number) if (!json_is_number(number) || !add_number(j, number)) return false;
    return json_array_size(list) > 0;
}

char *io_json_join_rows(const json_t *json) {
    joiner j = {0};
    bool good = add_text(&j, "", "") && json_array_size(json) > 0;
    size_t index;
    json_t *item;
    json_array_foreach((json_t *)(uintptr_t)json, index, item) good = good && add_row(&j, item);
    if (good) return j.text;
    free(j.text);
    return NULL;
}
