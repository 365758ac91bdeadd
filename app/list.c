/* skein list: every kind with its fields, straight from the tables. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/command.h"

/* A number of a range in a few characters. */
static void bound_text(double x, char *text, size_t size) {
    if (isinf(x)) snprintf(text, size, "infinite");
    else snprintf(text, size, "%g", x);
}

static void print_field(const skein_field *field) {
    skein_value initial = {1, {field->initial[0], field->initial[1], field->initial[2]}, NULL};
    if (field->type == SKEIN_FIELD_TEXT) initial = skein_text(field->text ? field->text : "");
    else if (field->type == SKEIN_FIELD_VEC3) initial.count = 3;
    else if (field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_REAL2) initial.count = 2;
    char value[128], range[96] = "", low[32], high[32];
    skein_value_text(field, &initial, value, sizeof value);
    bool numeric = field->type != SKEIN_FIELD_TEXT && field->type != SKEIN_FIELD_BOOL && field->type != SKEIN_FIELD_CHOICE;
    if (numeric && (fabs(field->least) < 1e15 || fabs(field->most) < 1e15)) {
        bound_text(field->least, low, sizeof low);
        bound_text(field->most, high, sizeof high);
        if (field->least <= -1e15) snprintf(range, sizeof range, "up to %s", high);
        else if (field->most >= 1e15) snprintf(range, sizeof range, "from %s%s", low, isinf(field->most) ? " to infinite" : "");
        else snprintf(range, sizeof range, "%s to %s", low, high);
    }
    if (field->type == SKEIN_FIELD_CHOICE) snprintf(range, sizeof range, "%s", field->choices);
    if (field->type == SKEIN_FIELD_TEXT) snprintf(value, sizeof value, "\"%s\"", field->text ? field->text : "");
    printf("    %-20s %-12s %-10s %-20s %s\n", field->name, value, field->unit, range, field->help);
}

static void print_kind(const skein_kind *kind) {
    printf("  %s: %s\n", kind->name, kind->help);
    for (size_t i = 0; i < kind->field_count; i++) print_field(&kind->fields[i]);
    printf("\n");
}

static void print_category(const char *word, skein_category category) {
    printf("%s\n\n", word);
    if (category == SKEIN_SCENE) print_kind(io_scene_kind());
    else if (category == SKEIN_EXPORTER)
        for (const skein_kind *const *kind = app_exporters(); *kind; kind++) print_kind(*kind);
    else
        for (size_t i = 0; skein_kind_at(category, i); i++) print_kind(skein_kind_at(category, i));
    size_t count;
    const skein_field *common = skein_common_fields(category, &count);
    if (!count) return;
    printf("  every one of the %s has these, too\n", word);
    for (size_t i = 0; i < count; i++) print_field(&common[i]);
    printf("\n");
}

static int list(int argc, char **argv) {
    static const struct {
        const char *word;
        skein_category category;
    } lists[] = {{"scene", SKEIN_SCENE},       {"bodies", SKEIN_BODY},       {"constraints", SKEIN_CONSTRAINT}, {"forces", SKEIN_FORCE},
                 {"colliders", SKEIN_COLLIDER}, {"methods", SKEIN_METHOD}, {"exporters", SKEIN_EXPORTER}};
    const char *words[1];
    size_t word_count;
    int status = app_parse(&app_list_command, argc, argv, NULL, 0, words, 1, &word_count);
    if (status >= 0) return status;
    bool found = false;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        if (word_count && strcmp(words[0], lists[i].word)) continue;
        print_category(lists[i].word, lists[i].category);
        found = true;
    }
    if (found) return EXIT_OK;
    fprintf(stderr, "skein list: there is no list '%s'; usage: skein list %s\n", words[0], app_list_command.usage);
    return EXIT_FAULT;
}

const app_command app_list_command = {
    "list", "[scene|bodies|constraints|forces|colliders|methods|exporters]",
    "every kind with its fields: name, default, unit, range and help\n\n"
    "In a scene, dots are groups: stretch.stiffness is { \"stretch\": { \"stiffness\": ... } }.",
    list,
};
