/* The side panel, the gallery, the keys and the log; see panels.h. */
#include "viewer/panels.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "io/own_kinds.h"
#include "viewer/keys.h"
#include "viewer/palette.h"

static const double about_seconds = 3;

void viewer_place_control(viewer_panels *panels, const char *name) {
    double box[4];
    widgets_last(box);
    if (widgets_last_visible()) viewer_place_box(panels, name, box);
}

void viewer_place_box(viewer_panels *panels, const char *name, const double at[4]) {
    if (!panels->exchange->events->file) return;
    size_t i = 0;
    while (i < panels->place_count && strcmp(panels->places[i].name, name) != 0) i++;
    if (i == VIEWER_PLACES) return;
    viewer_place *place = &panels->places[i];
    if (i < panels->place_count && !memcmp(place->at, at, sizeof place->at)) return;
    if (i == panels->place_count) panels->place_count++;
    snprintf(place->name, sizeof place->name, "%s", name);
    memcpy(place->at, at, sizeof place->at);
    viewer_event(panels->exchange->events, "control %.0f %.0f %.0f %.0f %s", at[0], at[1], at[2], at[3], name);
}

static void ask_keys(viewer_panels *panels, int code, int mods) {
    viewer_request request = {.kind = VIEWER_KEY_DOWN, .code = code, .mods = mods};
    viewer_ask(panels->exchange, &request);
}

static void ask_key(viewer_panels *panels, int code) {
    ask_keys(panels, code, 0);
}

static bool button(viewer_panels *panels, const char *title, const char *help) {
    bool pressed = widgets_button(title);
    viewer_place_control(panels, title);
    widgets_help(help);
    return pressed;
}

/* ---- Time ---- */

/* The same as the keys do. */
enum {
    KEY_SPACE = 32,
    KEY_COMMA = 44,
    KEY_PERIOD = 46,
    KEY_R = 82,
    KEY_S = 83,
    KEY_Y = 89,
    KEY_Z = 90,
    KEY_BACKSPACE = 259,
    KEY_F1 = 290,
    KEY_F2 = 291,
    KEY_F3 = 292,
    KEY_F4 = 293,
    KEY_F6 = 295,
    KEY_F7 = 296,
    WITH_CONTROL = 2
};

/* What was changed: back, forth, to a file, and away. */
static void show_changes(viewer_panels *panels, const viewer_shown *shown) {
    char title[40];
    if (button(panels, "Undo", "the last change: Ctrl Z")) ask_keys(panels, KEY_Z, WITH_CONTROL);
    widgets_same_line();
    if (button(panels, "Redo", "what was undone: Ctrl Y")) ask_keys(panels, KEY_Y, WITH_CONTROL);
    widgets_same_line();
    if (button(panels, "Save", "the scene as tuned, to a file in the working directory: Ctrl S"))
        ask_keys(panels, KEY_S, WITH_CONTROL);
    widgets_same_line();
    if (button(panels, "Revert", "back to the scene's file: Ctrl R; redo brings the changes back"))
        ask_keys(panels, KEY_R, WITH_CONTROL);
    widgets_same_line();
    snprintf(title, sizeof title, shown->changes == 1 ? "%zu change" : "%zu changes", shown->changes);
    widgets_text(title);
}

static void show_time(viewer_panels *panels, const viewer_shown *shown) {
    widgets_heading(shown->title[0] ? shown->title + strlen("Skein: ") : "");
    bool turned = widgets_main_button(shown->paused ? "Play" : "Pause");
    viewer_place_control(panels, shown->paused ? "Play" : "Pause");
    widgets_help("Space");
    if (turned) ask_key(panels, KEY_SPACE);
    widgets_same_line();
    if (button(panels, "<", "one frame back: comma")) ask_key(panels, KEY_COMMA);
    widgets_same_line();
    if (button(panels, ">", "one frame on: period")) ask_key(panels, KEY_PERIOD);
    widgets_same_line();
    if (button(panels, "Reset", "to the start: Backspace")) ask_key(panels, KEY_BACKSPACE);
    widgets_same_line();
    if (button(panels, "Keys", "all keys: F1")) ask_key(panels, KEY_F1);
    if (button(panels, "Scenes", "the gallery: F2")) ask_key(panels, KEY_F2);
    widgets_same_line();
    if (button(panels, "Plots", "energy, stretch, contacts, time: F3")) ask_key(panels, KEY_F3);
    widgets_same_line();
    if (button(panels, "Formulas", "a constraint, looked into: its value, its derivatives, its text step by step: F6"))
        ask_key(panels, KEY_F6);
    widgets_same_line();
    if (button(panels, "Log", "what was said: F4")) ask_key(panels, KEY_F4);
    widgets_same_line();
    if (button(panels, shown->light ? "Dark" : "Light", "the other theme: F7")) ask_key(panels, KEY_F7);
    show_changes(panels, shown);
    double frame = (double)shown->frame;
    if (shown->last_frame > shown->first_frame) {
        bool moved = widgets_numbers("frame", &frame, 1, (double)shown->first_frame, (double)shown->last_frame, false,
                                     true, "%.0f");
        viewer_place_control(panels, "frame");
        widgets_help("the frames that were: drag to go back; playing goes on from there");
        if (moved && frame != (double)shown->frame) {
            viewer_request request = {.kind = VIEWER_SCRUB, .x = frame};
            viewer_ask(panels->exchange, &request);
        }
    }
    char line[160];
    const char *slow = viewer_slowness_word(shown->slow);
    snprintf(line, sizeof line, "%.2f s, %.0f %% of real time%s%s", shown->time, 100 * shown->speed,
             slow[0] ? "; slow: " : "", slow);
    widgets_text(line);
    bool away = shown->play_away;
    if (widgets_tick("play in the background", &away)) {
        viewer_request request = {.kind = VIEWER_PLAY_AWAY, .down = away};
        viewer_ask(panels->exchange, &request);
    }
    widgets_help("go on when another window is typed into (see --unfocused)");
}

/* ---- Side by side ---- */

static void show_compare(viewer_panels *panels, const viewer_shown *shown) {
    if (!widgets_group("Side by side", false)) return;
    viewer_request request = {.kind = VIEWER_COMPARE};
    widgets_wrapped("The same scene beside itself, with another method or value, in step from the start:", false);
    char words[512] = "", path[64];
    int chosen = -1;
    for (size_t k = 0; io_kind_at(SKEIN_METHOD, k); k++) {
        size_t length = strlen(words);
        snprintf(words + length, sizeof words - length, "%s%s", k ? "|" : "", io_kind_at(SKEIN_METHOD, k)->name);
    }
    if (widgets_choice("other method", words, &chosen) && chosen >= 0) {
        snprintf(request.text, sizeof request.text, "method.type=%s", io_kind_at(SKEIN_METHOD, (size_t)chosen)->name);
        viewer_ask(panels->exchange, &request);
    }
    viewer_place_control(panels, "other method");
    if (!panels->compare[0]) snprintf(panels->compare, sizeof panels->compare, "method.substeps=5");
    if (widgets_input("path=value", panels->compare, sizeof panels->compare)) {
        memcpy(request.text, panels->compare, sizeof request.text);
        viewer_ask(panels->exchange, &request);
    }
    snprintf(path, sizeof path, "any value, as after --set; Enter begins");
    widgets_help(path);
    if (shown->side_count > 1 && widgets_button("one scene again")) {
        request.text[0] = 0;
        viewer_ask(panels->exchange, &request);
    }
}

/* ---- The side panel ---- */

static void show_facts(const viewer_shown *shown) {
    const skein_statistics *s = &shown->sides[0].statistics;
    char line[200];
    snprintf(line, sizeof line, "%zu particles, %zu constraints", s->particles, s->constraints);
    widgets_text(line);
    snprintf(line, sizeof line, "energy %.4g J, stretch %.2f %%",
             s->kinetic_energy + s->potential_energy + s->elastic_energy, 100 * s->max_stretch);
    widgets_text(line);
    if (!s->all_unsolved) return;
    snprintf(line, sizeof line, "%" PRIu64 " of %" PRIu64 " substeps left unsolved", s->all_unsolved, s->substeps);
    widgets_text(line);
}

static void show_side(viewer_panels *panels, const viewer_shown *shown, double width, double height) {
    if (widgets_panel("Skein", WIDGETS_FIXED, 0, 0, width, height, NULL) && shown->has_scene) {
        show_time(panels, shown);
        show_facts(shown);
        viewer_show_brush(panels);
        viewer_show_advice(panels);
        viewer_show_offer(panels, "side");
        viewer_show_palette(panels);
        for (size_t s = 0; s < shown->side_count; s++) {
            if (shown->side_count > 1) widgets_wrapped(shown->sides[s].name, false);
            viewer_show_objects(panels, (int)s);
        }
        show_compare(panels, shown);
    }
    widgets_panel_end();
}

/* ---- The gallery ---- */

static void close_panel(viewer_panels *panels, viewer_panel panel) {
    viewer_request request = {.kind = VIEWER_PANEL, .code = (int)panel, .down = false};
    viewer_ask(panels->exchange, &request);
}

static void show_card(viewer_panels *panels, const viewer_card *card, double width) {
    char name[100];
    // as high as every other, so that rows stay rows: the picture, the title, and some lines of what it teaches
    double height = width * 9 / 16 + 5.6 * widgets_line();
    widgets_push(card);
    if (!widgets_list("card", width, height)) {
        widgets_pop();
        return;
    }
    bool clicked = widgets_picture(card->broken ? 0 : card->texture, width, width * 9 / 16);
    snprintf(name, sizeof name, "card %.80s", card->title);
    viewer_place_control(panels, name);
    widgets_help(card->about);
    if (card->broken) widgets_wrapped(card->title, true);
    else widgets_heading(card->title);
    widgets_quiet(card->about);
    widgets_list_end();
    widgets_pop();
    if (!clicked) return;
    viewer_request request = {.kind = VIEWER_OPEN};
    memcpy(request.text, card->path, sizeof request.text);
    viewer_ask(panels->exchange, &request);
}

static void show_gallery(viewer_panels *panels, const viewer_shown *shown, double width, double height) {
    bool open = true;
    double edge = 0.04 * width;
    if (widgets_panel("Scenes", WIDGETS_FREE, edge, edge, width - 2 * edge, height - 2 * edge, &open)) {
        double wanted = 250 * widgets_scale();
        int columns = (int)fmax(1, floor(widgets_room() / wanted));
        if (!shown->card_count)
            widgets_wrapped("There are no scenes in the gallery's folder; `skein view --scenes FOLDER` names another. "
                            "Or drop a scene or a mesh on this window.",
                            true);
        viewer_show_recent(panels);
        widgets_columns(columns);
        for (size_t c = 0; c < shown->card_count; c++) {
            show_card(panels, &shown->cards[c], widgets_room() - 4);
            widgets_next_column();
        }
        widgets_columns(1);
    }
    widgets_panel_end();
    if (!open) close_panel(panels, VIEWER_PANEL_GALLERY);
}

/* ---- Keys and log ---- */

static void show_keys(viewer_panels *panels, double width, double height) {
    bool open = true;
    const char *name, *help;
    if (widgets_panel("Keys", WIDGETS_FREE, 0.2 * width, 0.08 * height, 0.7 * width, 0.84 * height, &open)) {
        for (size_t k = 0; (help = viewer_key_help(k, &name)) != NULL; k++) {
            char line[300];
            snprintf(line, sizeof line, "%s:  %s", name, help);
            widgets_wrapped(line, false);
        }
        widgets_line_across();
        widgets_wrapped(
            "Mouse: drag a particle to pull it, click one to pin or free it; drag beside it to look around; "
            "Shift or the middle button moves the view, the wheel comes closer; the right button always "
            "looks around. With handles (G, H, L) drag an arrow, a square, a ring or a box; with Ctrl it goes by whole "
            "steps. Drop a scene or a mesh on the window to open it. Ctrl and a click on a slider "
            "takes any number.",
            false);
    }
    widgets_panel_end();
    if (!open) close_panel(panels, VIEWER_PANEL_KEYS);
}

static void show_log(viewer_panels *panels, const viewer_shown *shown, const double at[4]) {
    bool open = true;
    if (widgets_panel("Log", WIDGETS_DOCKED, at[0], at[1], at[2], at[3], &open)) {
        size_t count = shown->log_count < VIEWER_LOG_LINES ? shown->log_count : VIEWER_LOG_LINES;
        for (size_t i = shown->log_count - count; i < shown->log_count; i++) {
            const viewer_line *line = &shown->log[i % VIEWER_LOG_LINES];
            widgets_wrapped(line->text, line->level == SKEIN_LOG_WARNING);
        }
        widgets_follow();
    }
    widgets_panel_end();
    if (!open) close_panel(panels, VIEWER_PANEL_LOG);
}

/* Plots and log, beside each other where both are there. */
static void show_dock(viewer_panels *panels, const viewer_shown *shown, double left, double width, double height) {
    bool plots = shown->panel[VIEWER_PANEL_PLOTS] && shown->has_scene, log = shown->panel[VIEWER_PANEL_LOG];
    double tall = viewer_dock_height(shown, (int)height), room = width - left, part = plots && log ? 0.62 * room : room;
    const double first[4] = {left, height - tall, part, tall},
                 second[4] = {left + part, height - tall, room - part, tall};
    if (plots) viewer_show_plots(panels, first);
    if (log) show_log(panels, shown, plots ? second : first);
}

int viewer_dock_height(const viewer_shown *shown, int height) {
    bool docked = (shown->panel[VIEWER_PANEL_PLOTS] && shown->has_scene) || shown->panel[VIEWER_PANEL_LOG];
    return docked ? (int)fmin(fmax(0.27 * height, 180 * widgets_scale()), 0.45 * height) : 0;
}

int viewer_docked_height(const viewer_shown *shown, int height) {
    int dock = viewer_dock_height(shown, height);
    return dock + (int)viewer_lesson_height(shown, height - dock);
}

static void show_message(viewer_panels *panels, double left, double width, double height) {
    const viewer_shown *shown = &panels->exchange->shown;
    char text[sizeof shown->message + 16];
    double box[4];
    const char *records = shown->recording ? "recording   " : "";
    bool waits = shown->newest < 0 && !shown->message[0]; // the first picture of a scene takes seconds in software
    snprintf(text, sizeof text, "%s%s", records, waits ? "drawing the picture" : shown->message);
    if (!text[0]) return;
    widgets_note(text, left + 8, height - 8, true, width - left - 16, shown->alarm, box);
    viewer_place_box(panels, "note", box);
}

/* Which world is which, over each of two. */
static void show_labels(viewer_panels *panels, double left, double width) {
    const viewer_shown *shown = &panels->exchange->shown;
    char name[200];
    double box[4];
    double room = (width - left) / (double)shown->side_count;
    for (size_t s = 0; s < shown->side_count && shown->side_count > 1; s++) {
        widgets_note(shown->sides[s].name, left + (double)s * room + 8, 8, false, room - 16, false, box);
        snprintf(name, sizeof name, "label %zu %s", s, shown->sides[s].name);
        viewer_place_box(panels, name, box);
    }
}

/* What the scene shows, in its own words, while it begins: over the picture's top, where mostly sky is. */
static void show_about(const viewer_shown *shown, double left, double width) {
    double box[4];
    bool begins = shown->newest < 0 || shown->time < about_seconds;
    if (begins && shown->about[0] && shown->side_count == 1)
        widgets_note(shown->about, left + 8, 8, false, fmin(width - left - 16, 520 * widgets_scale()), false, box);
}

int viewer_side_panel_width(int width) {
    return (int)fmin(fmax(0.3 * width, 230 * widgets_scale()), 0.6 * width);
}

void viewer_panels_show(viewer_panels *panels, int width, int height) {
    const viewer_shown *shown = &panels->exchange->shown;
    double w = width, h = height, side = viewer_side_panel_width(width);
    bool has_side = shown->panel[VIEWER_PANEL_SIDE] && shown->has_scene;
    double left = has_side ? side : 0, above = h - viewer_dock_height(shown, height);
    if (shown->has_scene) viewer_show_handles(panels, left, w - left, above);
    if (has_side) show_side(panels, shown, side, h);
    if (shown->panel[VIEWER_PANEL_LESSON] && shown->has_scene) viewer_show_lesson(panels, left, w, above);
    show_dock(panels, shown, left, w, h);
    if (shown->panel[VIEWER_PANEL_GALLERY]) show_gallery(panels, shown, w, h);
    if (shown->panel[VIEWER_PANEL_KEYS]) show_keys(panels, w, h);
    // a picture without panels is a picture: no note in it, unless something is wrong
    if (shown->has_scene && !shown->panel[VIEWER_PANEL_GALLERY]) show_labels(panels, left, w);
    if (has_side && !shown->panel[VIEWER_PANEL_GALLERY] && !shown->panel[VIEWER_PANEL_LESSON])
        show_about(shown, left, w);
    if (has_side || shown->recording || shown->alarm)
        show_message(panels, left, w, above - viewer_lesson_height(shown, above));
}
