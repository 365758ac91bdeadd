/* Finding names that are missing; see offer.h. */
#include "viewer/offer.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"
#include "skein/formula.h"
#include "viewer/stage.h"

/* The name at a mark; empty where it is none, or is called as a function. */
static void name_at(const char *text, const skein_formula_mark *mark, char name[64]) {
    const char *at = text;
    name[0] = 0;
    for (size_t line = 1; line < mark->line && at; line++) at = strchr(at, '\n') ? strchr(at, '\n') + 1 : NULL;
    if (!at || !mark->column || strlen(at) < mark->column) return;
    at += mark->column - 1;
    size_t length = 0;
    while (isalnum((unsigned char)at[length]) || at[length] == '_') length++;
    if (!length || length > 63 || isdigit((unsigned char)at[0]) || at[length + strspn(at + length, " ")] == '(') return;
    memcpy(name, at, length);
    name[length] = 0;
}

/* The parameters that the object has. */
static size_t names_of(const skein_kind *kind, const char **names, size_t most) {
    size_t count = 0;
    for (size_t f = 0; f < kind->field_count && count < most; f++)
        if (!strncmp(kind->fields[f].name, "parameters.", 11) && strcmp(kind->fields[f].name, "parameters.*") != 0)
            names[count++] = kind->fields[f].name + 11;
    return count;
}

/* Adds names until the text can be read, and keeps the first fault's place; false where names do not mend it. */
static bool find_names(viewer_offer *offer, const skein_kind *kind) {
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1] = {NULL};
    size_t count = names_of(kind, names, SKEIN_FORMULA_MOST_PARAMETERS);
    for (;;) {
        skein_error error = {SKEIN_OK, "", ""};
        skein_formula_mark mark = {0, 0, 0};
        // whatever a kind of formula may be
        skein_formula_desc desc = {.text = offer->text, .parameters = names, .velocities = true, .comparison = true};
        skein_formula *formula = skein_formula_create(&desc, &mark, &error);
        skein_formula_destroy(formula);
        if (formula) return offer->name_count > 0;
        if (!offer->width && mark.column) {
            char both[900] = "";
            skein_formula_show(offer->text, &mark, both, sizeof both);
            snprintf(offer->line, sizeof offer->line, "%.*s", (int)strcspn(both, "\n"), both);
            const char *under = strchr(both, '\n'), *caret = under ? strchr(under, '^') : NULL;
            offer->column = caret ? (size_t)(caret - under) : 0;
            offer->width = caret ? strspn(caret, "^") : 0;
        }
        bool room = offer->name_count < VIEWER_OFFER_NAMES && count < SKEIN_FORMULA_MOST_PARAMETERS;
        char *name = offer->names[room ? offer->name_count : 0], found[64];
        name_at(offer->text, &mark, found);
        if (error.status != SKEIN_ERROR_NAME || !room || !found[0]) return false;
        for (size_t i = 0; i < count; i++)
            if (!strcmp(names[i], found)) return false;
        memcpy(name, found, sizeof found);
        names[count++] = name;
        offer->name_count++;
    }
}

void viewer_offer_forget(viewer_stage *stage) {
    stage->news |= stage->offer.any;
    stage->offer.any = false;
}

void viewer_offer_look(viewer_stage *stage, skein_category category, size_t index, const skein_field *field,
                       const char *text) {
    viewer_offer *offer = &stage->offer;
    const skein_world *world = stage->side_count ? stage->sides[0].world : NULL;
    const skein_kind *kind = world ? skein_object_kind(world, skein_object_at(world, category, index)) : NULL;
    const skein_kind *listed = kind ? io_kind_find(category, kind->name, NULL) : NULL;
    viewer_offer_forget(stage);
    bool takes =
        listed && skein_field_find(listed, "parameters.*", NULL) && skein_field_find(listed, field->name, NULL);
    if (!takes || strlen(text) >= sizeof offer->text) return;
    *offer = (viewer_offer){.category = category, .index = index};
    snprintf(offer->field, sizeof offer->field, "%s", field->name);
    snprintf(offer->text, sizeof offer->text, "%s", text);
    if (!find_names(offer, kind)) offer->name_count = 0;
    offer->any = offer->width > 0;
    for (size_t i = 0; i < offer->name_count && offer->any; i++)
        viewer_event(stage->events, "offers parameter %s", offer->names[i]);
    stage->news = true;
}

void viewer_offer_take(viewer_stage *stage) {
    viewer_offer offer = stage->offer;
    char *sets[VIEWER_OFFER_NAMES + 1] = {NULL};
    const char *list = viewer_list_of(offer.category);
    const skein_world *world = stage->side_count ? stage->sides[0].world : NULL;
    const skein_kind *kind =
        world ? skein_object_kind(world, skein_object_at(world, offer.category, offer.index)) : NULL;
    const skein_field *field = kind && offer.any ? skein_field_find(kind, offer.field, NULL) : NULL;
    if (!field || !offer.name_count) return;
    skein_value value = skein_text(offer.text);
    char *json = io_value_json(field, &value);
    size_t size = json ? strlen(json) + 200 : 0, count = 0;
    bool good = json != NULL;
    for (size_t i = 0; i <= offer.name_count && good; i++) {
        char *set = malloc(size);
        good = set != NULL;
        if (good && !i) snprintf(set, size, "%s.%zu.%s=%s", list, offer.index, offer.field, json);
        else if (good) snprintf(set, size, "%s.%zu.parameters.%s=1", list, offer.index, offer.names[i - 1]);
        sets[count++] = set;
    }
    good = good && viewer_stage_build_on_all(stage, (const char *const *)sets, count);
    for (size_t i = 0; i < count; i++) free(sets[i]);
    free(json);
    if (good) viewer_note(stage, "%s is a parameter now, 1: its slider is among the object's fields", offer.names[0]);
    viewer_event(stage->events, "%s parameter %s", good ? "made" : "not made", offer.names[0]);
    viewer_offer_forget(stage);
    stage->lesson.fault[0] = 0;
    stage->facts = stage->dirty = true;
}
