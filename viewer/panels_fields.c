/* Controls made from the field tables: whatever field there is appears by itself, with its unit, range, default and
 * help. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"
#include "viewer/palette.h"
#include "viewer/stage.h"

/* A range that is wider than so many steps is no use as a slider: it is then measured by the default. */
static const double widest = 1e4, many_times = 100;

/* ---- Sliders ---- */

typedef struct range {
    double least, most;
    bool logarithmic;
} range;

/* What a slider spans: the field's own range if that is narrow enough, else what is sensible around the default and
 * the value that the scene gave. Any other value in range can be typed. */
static range range_of(const viewer_entry *entry) {
    const skein_field *field = entry->field;
    double initial = 0;
    for (int i = 0; i < 3; i++) initial = fmax(initial, isfinite(field->initial[i]) ? fabs(field->initial[i]) : 0);
    double size = fmax(initial, entry->anchor);
    if (!(size > 0)) size = 1;
    range r = {field->least, field->most, false};
    bool whole = field->type == SKEIN_FIELD_INT || field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_INT3;
    if (isfinite(r.least) && isfinite(r.most) && r.most - r.least <= fmax(widest * (whole ? 0.02 : 1e-3), 4 * size))
        return r;
    if (r.least >= 0) {
        r.most = fmin(r.most, size * (whole ? 10 : many_times));
        r.logarithmic = !whole;
        if (r.logarithmic && r.least < size / widest && r.least > 0) r.least = size / widest;
    } else {
        r.least = fmax(r.least, -4 * size);
        r.most = fmin(r.most, 4 * size);
    }
    return r;
}

static void describe(const viewer_entry *entry, char *text, size_t size) {
    const skein_field *field = entry->field;
    skein_value initial = {0, {field->initial[0], field->initial[1], field->initial[2]}, field->text};
    char word[100] = "", limits[100] = "";
    if (field->type != SKEIN_FIELD_TEXT) {
        initial.count = field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_REAL2  ? 2
                        : field->type == SKEIN_FIELD_INT3 || field->type == SKEIN_FIELD_VEC3 ? 3
                                                                                             : 1;
        skein_value_text(field, &initial, word, sizeof word);
    }
    bool number =
        field->type != SKEIN_FIELD_TEXT && field->type != SKEIN_FIELD_BOOL && field->type != SKEIN_FIELD_CHOICE;
    if (number && field->most < 1e14) snprintf(limits, sizeof limits, ", %g to %g", field->least, field->most);
    else if (number && field->least > -1e14) snprintf(limits, sizeof limits, ", at least %g", field->least);
    snprintf(text, size, "%s\n%s%s%s%s%s%s%s", field->help, word[0] ? "default " : "", word, word[0] ? " " : "",
             field->unit, limits,
             entry->shapes ? "\na change builds the scene anew"
             : entry->cut  ? "\ntoo long to be changed here"
                           : "",
             number ? "\nCtrl and click: type a number; right button: more" : "");
}

/* ---- One field ---- */

const double viewer_asked_for_long = 5;

/* The value to show: that which was asked for last, as long as the stage has not got to it. */
static skein_value value_of(viewer_panels *panels, const viewer_object *object, const viewer_entry *entry, int side) {
    viewer_request *asked = &panels->asked;
    bool same = asked->field == entry->field && asked->category == object->category && asked->index == object->index &&
                asked->side == side;
    if (!same || entry->field->type == SKEIN_FIELD_TEXT) return entry->value;
    bool there = !memcmp(asked->value.number, entry->value.number, sizeof entry->value.number) && !asked->down;
    if (there || (!asked->down && viewer_seconds() - panels->asked_at > viewer_asked_for_long)) {
        asked->field = NULL;
        return entry->value;
    }
    return asked->value;
}

/* Notes what is to be shown from now on; `down`: it is not asked for before the control is let go. */
static void keep_asked(viewer_panels *panels, const viewer_request *request, bool down) {
    panels->asked = *request;
    panels->asked.down = down;
    panels->asked_at = viewer_seconds();
}

static viewer_request request_for(const viewer_object *object, const viewer_entry *entry, int side) {
    viewer_request request = {.kind = VIEWER_SET,
                              .category = object->category,
                              .index = object->index,
                              .field = entry->field,
                              .side = side,
                              .value = entry->value};
    return request;
}

static bool show_number(const viewer_entry *entry, const char *title, skein_value *value) {
    const skein_field *field = entry->field;
    range r = range_of(entry);
    bool whole = field->type == SKEIN_FIELD_INT || field->type == SKEIN_FIELD_INT2 || field->type == SKEIN_FIELD_INT3;
    char format[40] = "%.4g", named[120];
    double given[3];
    memcpy(given, value->number, sizeof given);
    if (field->unit[0] && value->count == 1 && !strchr(field->unit, '%'))
        snprintf(format, sizeof format, "%%.4g %.20s", field->unit);
    // several numbers beside each other have no room for it
    bool tells = field->unit[0] && value->count > 1;
    snprintf(named, sizeof named, "%.60s%s%.20s%s", title, tells ? " (" : "", tells ? field->unit : "",
             tells ? ")" : "");
    if (!widgets_numbers(named, given, value->count, r.least, r.most, r.logarithmic, whole, format)) return false;
    memcpy(value->number, given, sizeof given);
    return true;
}

/* Default and infinity, by the right button. */
static bool show_menu(const viewer_entry *entry, skein_value *value) {
    bool chosen = false;
    if (!widgets_menu("more")) return false;
    if (widgets_menu_row("default")) {
        memcpy(value->number, entry->field->initial, sizeof value->number);
        chosen = true;
    }
    if (entry->field->type == SKEIN_FIELD_REAL && isinf(entry->field->most) && widgets_menu_row("infinite")) {
        value->number[0] = INFINITY;
        chosen = true;
    }
    widgets_menu_end();
    return chosen;
}

/* Where the control is, and the words of a choice while it is unfolded. */
static void place_entry(viewer_panels *panels, const skein_field *field, const char *name) {
    double box[4];
    char word[300];
    if (field->type == SKEIN_FIELD_BOOL) viewer_place_control(panels, name);
    else if (widgets_last_visible()) {
        widgets_last_frame(box);
        viewer_place_box(panels, name, box);
    }
    const char *at = field->choices;
    for (int row = 0; field->type == SKEIN_FIELD_CHOICE && at && widgets_choice_row(row, box); row++) {
        size_t length = strcspn(at, "|");
        snprintf(word, sizeof word, "%s=%.*s", name, (int)length, at);
        viewer_place_box(panels, word, box);
        at = at[length] ? at + length + 1 : NULL;
    }
}

void viewer_show_entry(viewer_panels *panels, const viewer_object *object, const viewer_entry *entry, int side) {
    const skein_field *field = entry->field;
    viewer_request request = request_for(object, entry, side);
    request.value = value_of(panels, object, entry, side);
    char name[200], help[700];
    bool changed = false;
    widgets_push(entry->field);
    switch (field->type) {
    case SKEIN_FIELD_BOOL: {
        bool on = request.value.number[0] != 0;
        changed = widgets_tick(field->name, &on);
        request.value = skein_number(on);
        break;
    }
    case SKEIN_FIELD_CHOICE: {
        int place = (int)request.value.number[0];
        changed = widgets_choice(field->name, field->choices, &place);
        request.value = skein_number(place);
        break;
    }
    case SKEIN_FIELD_TEXT:
        snprintf(request.text, sizeof request.text, "%s", entry->text);
        if (strlen(entry->text) > 30 || strchr(entry->text, '\n'))
            changed = widgets_input_lines(field->name, request.text, sizeof request.text);
        else changed = widgets_input(field->name, request.text, sizeof request.text);
        changed &= !entry->cut; // what does not fit must not replace what does
        request.value = skein_text(NULL);
        break;
    default: changed = show_number(entry, field->name, &request.value); break;
    }
    // what builds the scene anew waits until the slider is let go, and what is typed until it is entered
    bool slider =
        field->type != SKEIN_FIELD_BOOL && field->type != SKEIN_FIELD_CHOICE && field->type != SKEIN_FIELD_TEXT;
    bool released = slider && widgets_released();
    if (changed && slider && (entry->shapes || widgets_typing()) && !released) {
        keep_asked(panels, &request, true);
        changed = false;
    }
    // let go, it is said once more: what comes after that is another change
    changed |= slider && released;
    request.down = slider && !released;
    snprintf(name, sizeof name, "%s%s.%zu.%.60s", side ? "other " : "", skein_category_text(object->category),
             object->index, field->name);
    place_entry(panels, field, name);
    if (widgets_begun()) viewer_event(panels->exchange->events, "takes %s", name);
    if (entry->instead) {
        snprintf(help, sizeof help, "%s counts for nothing: %s is given instead", field->name, entry->instead->name);
        widgets_wrapped(help, true);
        snprintf(help, sizeof help, "%s is ignored", name);
        viewer_place_control(panels, help);
    }
    describe(entry, help, sizeof help);
    widgets_help(help);
    if (slider && show_menu(entry, &request.value)) {
        changed = true;
        request.down = false;
    }
    widgets_pop();
    if (!changed) return;
    keep_asked(panels, &request, false);
    viewer_ask(panels->exchange, &request);
}

/* ---- Objects ---- */

static const viewer_side *side_of(const viewer_panels *panels, int side) {
    return &panels->exchange->shown.sides[side];
}

static void show_fields(viewer_panels *panels, const viewer_object *object, int side) {
    const viewer_side *shown = side_of(panels, side);
    for (size_t e = 0; e < object->count; e++)
        viewer_show_entry(panels, object, &shown->entries[object->first + e], side);
}

/* The kinds of a category as a list of words. */
static void list_kinds(skein_category category, char *words, size_t size) {
    words[0] = 0;
    for (size_t k = 0; io_kind_at(category, k); k++) {
        size_t length = strlen(words);
        snprintf(words + length, size - length, "%s%s", k ? "|" : "", io_kind_at(category, k)->name);
    }
}

static void show_method(viewer_panels *panels, const viewer_object *object, int side) {
    char words[512];
    int place = -1;
    if (!widgets_group("Method", true)) return;
    list_kinds(SKEIN_METHOD, words, sizeof words);
    for (size_t k = 0; io_kind_at(SKEIN_METHOD, k); k++)
        if (io_kind_at(SKEIN_METHOD, k) == object->kind) place = (int)k;
    if (widgets_choice("method", words, &place) && place >= 0) {
        viewer_request request = {.kind = VIEWER_METHOD, .side = side};
        snprintf(request.text, sizeof request.text, "%s", io_kind_at(SKEIN_METHOD, (size_t)place)->name);
        viewer_ask(panels->exchange, &request);
    }
    viewer_place_control(panels, side ? "other method.type" : "method.type");
    widgets_help(object->kind->help);
    show_fields(panels, object, side);
}

/* One more of a kind, at the end of a list of rules. */
static void show_add(viewer_panels *panels, skein_category category) {
    char words[512];
    int place = -1;
    list_kinds(category, words, sizeof words);
    if (!widgets_choice("add", words, &place) || place < 0) return;
    viewer_request request = {.kind = VIEWER_ADD, .category = category};
    snprintf(request.text, sizeof request.text, "%s", io_kind_at(category, (size_t)place)->name);
    viewer_ask(panels->exchange, &request);
}

static void show_list(viewer_panels *panels, skein_category category, const char *title, bool open, int side) {
    const viewer_side *shown = side_of(panels, side);
    bool rules = category == SKEIN_FORCE || category == SKEIN_COLLIDER;
    size_t count = 0;
    for (size_t o = 0; o < shown->object_count; o++) count += shown->objects[o].category == category;
    if (!count && !rules) return;
    bool unfolds = widgets_group(title, open);
    viewer_place_control(panels, title);
    if (widgets_begun()) viewer_event(panels->exchange->events, "takes %s", title);
    if (!unfolds) return;
    for (size_t o = 0; o < shown->object_count; o++) {
        const viewer_object *object = &shown->objects[o];
        if (object->category != category) continue;
        widgets_push((const char *)shown + o);
        bool unfolded = widgets_tree(object->name, open && object->index == 0);
        viewer_place_control(panels, object->name);
        if (widgets_begun()) viewer_event(panels->exchange->events, "takes %s", object->name);
        widgets_help(object->kind->help);
        if (unfolded) {
            if (side == 0) viewer_show_deeds(panels, object);
            show_fields(panels, object, side);
            widgets_tree_end();
        }
        widgets_pop();
    }
    widgets_push(title);
    if (rules && side == 0) show_add(panels, category);
    widgets_pop();
}

void viewer_show_objects(viewer_panels *panels, int side) {
    const viewer_side *shown = side_of(panels, side);
    widgets_push(shown);
    if (viewer_show_search(panels, side)) {
        widgets_pop();
        return;
    }
    for (size_t o = 0; o < shown->object_count; o++)
        if (shown->objects[o].category == SKEIN_METHOD) show_method(panels, &shown->objects[o], side);
    show_list(panels, SKEIN_BODY, "Bodies", true, side);
    show_list(panels, SKEIN_CONSTRAINT, "Constraints", false, side);
    show_list(panels, SKEIN_FORCE, "Forces", false, side);
    show_list(panels, SKEIN_COLLIDER, "Colliders", false, side);
    show_list(panels, SKEIN_MOTION, "Motions", false, side);
    for (size_t o = 0; o < shown->object_count && side == 0; o++) {
        const viewer_object *object = &shown->objects[o];
        bool view = object->category == SKEIN_VIEW;
        if (!view && object->category != SKEIN_SCENE) continue;
        if (widgets_group(view ? "View" : "Scene", false)) show_fields(panels, object, side);
    }
    widgets_pop();
}
