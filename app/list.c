/* skein list: every kind with its fields, straight from the tables, in 120 columns. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "io/own_kinds.h"

#include "app/list.h"

/* "    name               default and unit range              help"; what is too long pushes the rest on. */
enum { WIDTH = 120, NAME_AT = 4, DEFAULT_AT = 23, RANGE_AT = 40, HELP_AT = 59 };

static const struct {
    const char *word;
    skein_category category;
} lists[] = {
    {"scene", SKEIN_SCENE},    {"bodies", SKEIN_BODY},        {"constraints", SKEIN_CONSTRAINT},
    {"forces", SKEIN_FORCE},   {"colliders", SKEIN_COLLIDER}, {"motions", SKEIN_MOTION},
    {"methods", SKEIN_METHOD}, {"exporters", SKEIN_EXPORTER}, {"view", SKEIN_VIEW},
};
enum { LIST_COUNT = sizeof lists / sizeof *lists };
static const char scenes[] = "scenes"; // no list of kinds: app/list_scenes.c

/* The kinds of a category, `index` from 0; NULL past the end. */
static const skein_kind *kind_at(skein_category category, size_t index) {
    if (category == SKEIN_SCENE) return index ? NULL : io_scene_kind();
    if (category != SKEIN_EXPORTER && category != SKEIN_VIEW) return io_kind_at(category, index);
    const skein_kind *const *kind = app_exporters();
    for (; *kind; kind++)
        if ((*kind)->category == category && !index--) return *kind;
    return NULL;
}

/* ---- lines ---- */

/* Prints a cell at a column, one blank after the last at least; returns the column after it. */
static int print_cell(int column, int at, const char *text) {
    int gap = at > column ? at - column : text[0] ? 1 : 0;
    printf("%*s%s", gap, "", text);
    return column + gap + (int)strlen(text);
}

/* Prints words from a column on, broken into lines that begin at `at`. */
static void print_words(int column, int at, const char *text) {
    for (;;) {
        text += strspn(text, " ");
        int length = (int)strcspn(text, " ");
        if (!length) break;
        if (column > at && column + 1 + length > WIDTH) {
            printf("\n");
            column = 0;
        }
        int gap = column < at ? at - column : 1;
        printf("%*s%.*s", gap, "", length, text);
        column += gap + length;
        text += length;
    }
    printf("\n");
}

/* A number in as few characters as "%g" with 1e6 for 1e+06. */
static void number_text(double x, char *text, size_t size) {
    if (isinf(x)) {
        snprintf(text, size, "infinite");
        return;
    }
    snprintf(text, size, "%g", x);
    char *digits = strchr(text, 'e');
    if (!digits) return;
    digits += digits[1] == '-' ? 2 : 1;
    size_t skip = strspn(digits, "+0");
    memmove(digits, digits + skip, strlen(digits + skip) + 1);
}

static void range_text(const skein_field *field, char *text, size_t size) {
    const double far = 1e15; // what the library takes for no bound
    char low[32], high[32];
    number_text(field->least, low, sizeof low);
    number_text(field->most, high, sizeof high);
    bool bounded_below = field->least > -far, bounded_above = field->most < far || isinf(field->most);
    text[0] = 0;
    if (field->type == SKEIN_FIELD_CHOICE) snprintf(text, size, "%s", field->choices);
    if (field->type == SKEIN_FIELD_BOOL || field->type == SKEIN_FIELD_TEXT || field->type == SKEIN_FIELD_CHOICE) return;
    if (bounded_below && bounded_above) snprintf(text, size, "%s to %s", low, high);
    else if (bounded_below) snprintf(text, size, "%s or more", low);
    else if (bounded_above) snprintf(text, size, "%s or less", high);
}

static void default_text(const skein_field *field, char *text, size_t size) {
    static const int counts[] = {
        [SKEIN_FIELD_INT2] = 2, [SKEIN_FIELD_INT3] = 3, [SKEIN_FIELD_REAL2] = 2, [SKEIN_FIELD_VEC3] = 3, [SKEIN_FIELD_TEXT] = 0};
    int count = counts[field->type];
    skein_value initial = {count ? count : 1, {field->initial[0], field->initial[1], field->initial[2]}, NULL};
    char value[128];
    if (field->type == SKEIN_FIELD_TEXT) snprintf(value, sizeof value, "\"%s\"", field->text ? field->text : "");
    else skein_value_text(field, &initial, value, sizeof value);
    snprintf(text, size, "%s%s%s", value, field->unit[0] ? " " : "", field->unit);
}

/* With what else is to be said of it. */
static void print_field(const skein_field *field, const char *besides) {
    char initial[192], range[96], words[1024];
    default_text(field, initial, sizeof initial);
    if (strchr(field->name, '*')) initial[0] = 0; // a name that an object gives: there is no default
    range_text(field, range, sizeof range);
    int column = print_cell(0, NAME_AT, field->name);
    column = print_cell(column, DEFAULT_AT, initial);
    column = print_cell(column, RANGE_AT, range);
    snprintf(words, sizeof words, "%s%s", field->help, besides);
    print_words(column, HELP_AT, words);
}

static void print_heads(void) {
    int column = print_cell(0, NAME_AT, "field");
    column = print_cell(column, DEFAULT_AT, "default");
    column = print_cell(column, RANGE_AT, "range");
    print_words(column, HELP_AT, "what it is");
}

void app_print_row(const char *name, const char *words) {
    print_words(print_cell(0, 2, name), DEFAULT_AT, words);
}

/* ---- kinds ---- */

static void print_kind(const skein_kind *kind) {
    char words[512];
    snprintf(words, sizeof words, "%s: %s", kind->name, kind->help);
    print_words(0, 2, words);
    for (size_t i = 0; i < kind->field_count; i++) print_field(&kind->fields[i], "");
    printf("\n");
}

/* The kinds of a category that do not take a common field, as " (not in attach)"; "" where all do. Returns `words`. */
static const char *exceptions(skein_category category, const char *field, char words[256]) {
    size_t at = 0;
    words[0] = 0;
    for (size_t i = 0; category < SKEIN_CATEGORY_COUNT && kind_at(category, i); i++)
        if (!skein_kind_takes(kind_at(category, i), field) && at < 200)
            at += (size_t)snprintf(words + at, 256 - at, "%s%s", at ? ", " : " (not in ", kind_at(category, i)->name);
    if (at) snprintf(words + at, 256 - at, ")");
    return words;
}

/* What besides its fields is in a scene, or in every kind of a category; or in one kind of it, but for what that does not take. */
static void print_common(skein_category category, const skein_kind *one, const char *all) {
    char words[256];
    for (size_t i = 0; category == SKEIN_SCENE && io_scene_section_at(i); i++) {
        int column = print_cell(0, NAME_AT, io_scene_section_at(i)->name);
        print_words(column, DEFAULT_AT, io_scene_section_at(i)->help);
    }
    size_t count;
    const skein_field *common = skein_common_fields(category, &count);
    if (count) printf("  %s these, too\n", all);
    for (size_t i = 0; i < count; i++) {
        if (!one) print_field(&common[i], exceptions(category, common[i].name, words));
        else if (skein_kind_takes(one, common[i].name)) print_field(&common[i], "");
    }
    if (count || category == SKEIN_SCENE) printf("\n");
}

static void print_list(size_t list) {
    char all[64];
    snprintf(all, sizeof all, "all %s have", lists[list].word);
    printf("%s\n\n", lists[list].word);
    if (!kind_at(lists[list].category, 0)) { // only what draws can be missing
        print_words(
            0, 2, "this skein was built without pictures: it passes a scene's view over; build it with SKEIN_RENDER=ON");
        printf("\n");
        return;
    }
    print_heads();
    for (size_t i = 0; kind_at(lists[list].category, i); i++) print_kind(kind_at(lists[list].category, i));
    print_common(lists[list].category, NULL, all);
}

/* Prints the list or the kinds of that name; false if there is none. */
static bool print_named(const char *name) {
    bool found = false;
    for (size_t l = 0; l < LIST_COUNT; l++) {
        if (!strcmp(name, lists[l].word)) {
            print_list(l);
            return true;
        }
        for (size_t i = 0; kind_at(lists[l].category, i); i++) {
            const skein_kind *kind = kind_at(lists[l].category, i);
            if (strcmp(name, kind->name)) continue;
            print_heads();
            print_kind(kind);
            print_common(kind->category, kind, "it has");
            found = true;
        }
    }
    return found;
}

static int report_unknown(const char *name) {
    const char *names[64];
    char hint[IO_HINT_SIZE];
    size_t count = 0;
    names[count++] = scenes;
    for (size_t l = 0; l < LIST_COUNT; l++) {
        names[count++] = lists[l].word;
        for (size_t i = 0; kind_at(lists[l].category, i) && count < 60; i++)
            names[count++] = kind_at(lists[l].category, i)->name;
    }
    io_hint(name, names, count, hint);
    fprintf(stderr, "skein list: there is no list or kind '%s'%s usage: skein list %s\n", name, hint[0] ? hint : ";",
            app_list_command.usage);
    return EXIT_FAULT;
}

const char *app_list_word(size_t index) {
    if (!index--) return scenes;
    for (size_t l = 0; l < LIST_COUNT; l++) {
        if (!index--) return lists[l].word;
        for (size_t i = 0; kind_at(lists[l].category, i); i++) {
            const char *name = kind_at(lists[l].category, i)->name;
            bool again = false; // "formula" is a constraint and a collider, "scene" a list and its kind
            for (size_t o = 0; o <= l; o++) {
                again |= !strcmp(lists[o].word, name);
                for (size_t k = 0; o < l && kind_at(lists[o].category, k); k++)
                    again |= !strcmp(kind_at(lists[o].category, k)->name, name);
            }
            if (!again && !index--) return name;
        }
    }
    return NULL;
}

/* The lists, or the one, or the kinds that have the name, with nothing else in the lists. */
static int print_json(const char *name) {
    json_t *root = json_object();
    bool found = !name;
    for (size_t l = 0; l < LIST_COUNT; l++) {
        bool whole = !name || !strcmp(name, lists[l].word);
        json_t *list = json_array();
        for (size_t i = 0; kind_at(lists[l].category, i); i++) {
            const skein_kind *kind = kind_at(lists[l].category, i);
            if (whole || !strcmp(name, kind->name)) json_array_append_new(list, app_kind_json(kind));
        }
        found |= whole || json_array_size(list);
        if (whole || json_array_size(list)) json_object_set(root, lists[l].word, list);
        json_decref(list);
    }
    bool good = found && !json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
    if (good) printf("\n");
    json_decref(root);
    return good ? EXIT_OK : found ? EXIT_FAILURE_RUN : report_unknown(name);
}

static int list(app_arguments *arguments) {
    const char *name = app_word(arguments);
    if (name && !strcmp(name, scenes)) return app_list_scenes(app_given(arguments, "--json"));
    if (app_given(arguments, "--json")) return print_json(name);
    if (name) return print_named(name) ? EXIT_OK : report_unknown(name);
    for (size_t l = 0; l < LIST_COUNT; l++) print_list(l);
    return EXIT_OK;
}

static const app_option options[] = {{"--json", NULL,
                                      "print it as JSON: of each field its name, type, unit, default, range and help",
                                      false, APP_TAKES_ANY},
                                     APP_END_OF_OPTIONS};

const app_command app_list_command = {
    "list",
    "[scenes|scene|bodies|constraints|forces|colliders|motions|methods|exporters|view|KIND] [--json]",
    "every kind with its fields: name, default, unit, range and help\n\n"
    "In a scene, dots are groups: stretch.stiffness is { \"stretch\": { \"stiffness\": ... } }. A range to\n"
    "infinite takes the word \"infinite\", too. A kind by its name: skein list cloth\n\n"
    "skein list scenes: the scenes that come with skein, and what each shows.",
    options,
    NULL,
    false,
    APP_TAKES_KIND,
    list,
    NULL,
};
