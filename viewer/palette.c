/* The palette: what can be put into the scene by one click, and what can be done with an object that is there. The stage
 * does it (make.h). */
#include "viewer/palette.h"

#include <string.h>

#include "io/own_kinds.h"
#include "viewer/make.h"

static void ask_piece(viewer_panels *panels, int code, const char *text) {
    viewer_request request = {.kind = VIEWER_MAKE, .code = code};
    snprintf(request.text, sizeof request.text, "%s", text);
    viewer_ask(panels->exchange, &request);
}

/* Goes on in the same line while there is room for one more button. */
static void place_in_line(bool first) {
    if (first) return;
    widgets_same_line();
    if (widgets_room() < 5 * widgets_line()) widgets_new_line();
}

static void show_pieces(viewer_panels *panels, bool grounds) {
    bool first = true;
    char name[64];
    for (size_t i = 0; viewer_piece_at(i); i++) {
        const viewer_piece *piece = viewer_piece_at(i);
        if (piece->ground != grounds || piece->file) continue;
        place_in_line(first);
        first = false;
        if (widgets_button(piece->title)) ask_piece(panels, (int)i, "");
        snprintf(name, sizeof name, "make %s", piece->title);
        viewer_place_control(panels, name);
        widgets_help(piece->help);
    }
}

/* What is made of a file: by its path. */
static void show_files(viewer_panels *panels) {
    double box[4];
    for (size_t i = 0; viewer_piece_at(i); i++) {
        const viewer_piece *piece = viewer_piece_at(i);
        if (!piece->file) continue;
        if (widgets_input(piece->title, panels->file, sizeof panels->file) && panels->file[0])
            ask_piece(panels, (int)i, panels->file);
        if (widgets_begun()) viewer_event(panels->exchange->events, "takes make %s", piece->title);
        widgets_last_frame(box);
        if (widgets_last_visible()) viewer_place_box(panels, "make mesh", box);
        widgets_help(piece->help);
    }
}

void viewer_show_palette(viewer_panels *panels) {
    bool unfolded = widgets_group("Make", false);
    viewer_place_control(panels, "Make");
    if (widgets_begun()) viewer_event(panels->exchange->events, "takes Make");
    if (!unfolded) return;
    widgets_text("a body, over what is there:");
    show_pieces(panels, false);
    show_files(panels);
    widgets_text("ground, under all bodies:");
    show_pieces(panels, true);
}

/* ---- One object ---- */

static void ask_about(viewer_panels *panels, viewer_request_kind kind, const viewer_object *object, const char *text) {
    viewer_request request = {.kind = kind, .category = object->category, .index = object->index};
    snprintf(request.text, sizeof request.text, "%s", text);
    viewer_ask(panels->exchange, &request);
}

static bool button(viewer_panels *panels, const viewer_object *object, const char *title, const char *help) {
    char name[100];
    bool pressed = widgets_button(title);
    snprintf(name, sizeof name, "%s %s.%zu", title, skein_category_text(object->category), object->index);
    viewer_place_control(panels, name);
    widgets_help(help);
    return pressed;
}

/* Another kind of the same category. */
static void show_kinds(viewer_panels *panels, const viewer_object *object) {
    char words[512] = "";
    int place = -1;
    for (size_t k = 0; io_kind_at(object->category, k); k++) {
        size_t length = strlen(words);
        snprintf(words + length, sizeof words - length, "%s%s", k ? "|" : "", io_kind_at(object->category, k)->name);
        if (io_kind_at(object->category, k) == object->kind) place = (int)k;
    }
    if (widgets_choice("kind", words, &place) && place >= 0)
        ask_about(panels, VIEWER_KIND, object, io_kind_at(object->category, (size_t)place)->name);
    widgets_help("another kind: what both have stays as it is");
}

static bool has_field(const viewer_panels *panels, const viewer_object *object, const char *name, double least) {
    const viewer_side *shown = &panels->exchange->shown.sides[0];
    for (size_t e = object->first; e < object->first + object->count; e++)
        if (!strcmp(shown->entries[e].field->name, name)) return shown->entries[e].value.number[0] >= least;
    return false;
}

static bool has_any(const viewer_object *object, const char *const *fields) {
    bool has = false;
    for (int i = 0; i < 6 && fields[i]; i++) has |= skein_field_find(object->kind, fields[i], NULL) != NULL;
    return has;
}

/* Handles in the picture, for those that the object's fields allow. */
static void show_tools(viewer_panels *panels, const viewer_object *object) {
    static const struct {
        const char *title, *fields[6], *help;
        viewer_tool tool;
    } rows[] = {
        {"move", {"position", "centre", "from", "normal"}, "handles in the picture to move it: G", VIEWER_MOVES},
        {"turn", {"rotation", "from", "normal"}, "handles in the picture to turn it: H", VIEWER_TURNS},
        {"size", {"size", "spread", "radius", "scale", "from"}, "handles in the picture to size it: L", VIEWER_SIZES},
        {"pins", {"pins"}, "a brush in the picture that pins its particles, with Shift frees them: P", VIEWER_PINS},
    };
    bool first = true, placed = has_any(object, rows[0].fields);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (!placed && rows[i].tool != VIEWER_PINS) continue; // a radius alone is no place
        if (object->category == SKEIN_MOTION || !has_any(object, rows[i].fields)) continue;
        if (!first) widgets_same_line();
        first = false;
        if (!button(panels, object, rows[i].title, rows[i].help)) continue;
        viewer_request request = {
            .kind = VIEWER_TOOL, .category = object->category, .index = object->index, .code = (int)rows[i].tool};
        viewer_ask(panels->exchange, &request);
    }
}

void viewer_show_deeds(viewer_panels *panels, const viewer_object *object) {
    bool rule = object->category == SKEIN_FORCE || object->category == SKEIN_COLLIDER;
    if (button(panels, object, "duplicate", "one more, beside it")) ask_about(panels, VIEWER_DUPLICATE, object, "");
    widgets_same_line();
    if (button(panels, object, "remove", "undo brings it back")) ask_about(panels, VIEWER_REMOVE, object, object->name);
    bool grid =
        object->category == SKEIN_BODY && has_field(panels, object, "mesh", 0) && has_field(panels, object, "grid", 2);
    if (grid) {
        widgets_same_line();
        if (button(panels, object, "to mesh", "its grid becomes a mesh in a file, to be edited elsewhere"))
            ask_about(panels, VIEWER_TO_MESH, object, "");
    }
    if (object->category == SKEIN_BODY) {
        widgets_same_line();
        if (button(panels, object, "follow", "the camera goes along with it, or stands still again; T for all bodies"))
            ask_about(panels, VIEWER_FOLLOW, object, "");
    }
    if (rule || object->category == SKEIN_BODY) show_tools(panels, object);
    if (rule) show_kinds(panels, object);
}
