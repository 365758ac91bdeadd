/* The lesson's panel: a constraint's value and derivatives before and after the last step, its text over the picture, and
 * its formula operation by operation. */
#include <math.h>
#include <string.h>

#include "viewer/panels.h"

static void ask(viewer_panels *panels, viewer_request_kind kind, int code, double x, const char *text) {
    viewer_request request = {.kind = kind, .code = code, .x = x};
    if (text) snprintf(request.text, sizeof request.text, "%s", text);
    viewer_ask(panels->exchange, &request);
}

static bool button(viewer_panels *panels, const char *title, const char *place, const char *help) {
    bool pressed = widgets_button(title);
    viewer_place_control(panels, place);
    widgets_help(help);
    return pressed;
}

/* Without a minus at 0. */
static double plain(double x) {
    return x + 0.0;
}

/* ---- Which constraint ---- */

static void show_choice(viewer_panels *panels, const viewer_lesson *lesson) {
    char line[200];
    if (lesson->object_count > 1) {
        if (button(panels, "<##object", "lesson object before", "another object's constraints"))
            ask(panels, VIEWER_LESSON, -1, 0, NULL);
        widgets_same_line();
        if (button(panels, ">##object", "lesson object next", "another object's constraints"))
            ask(panels, VIEWER_LESSON, 1, 0, NULL);
        widgets_same_line();
    }
    bool part = strcmp(lesson->name, lesson->label) != 0;
    snprintf(line, sizeof line, "%s%s%s%s%s", lesson->name, part ? ", " : "", part ? lesson->label : "",
             lesson->is_energy   ? ": an energy"
             : lesson->one_sided ? ": at least 0"
                                 : "",
             lesson->guarded ? " (guarded here)" : "");
    widgets_text(line);
    if (lesson->count < 2) return;
    double number = (double)lesson->index + 1;
    if (widgets_numbers("constraint", &number, 1, 1, (double)lesson->count, false, true, "%.0f"))
        ask(panels, VIEWER_LESSON, 0, number - 1, NULL);
    viewer_place_control(panels, "lesson constraint");
    snprintf(line, sizeof line, "of the %zu that it has", lesson->count);
    widgets_help(line);
}

/* ---- Before and after ---- */

static void show_vector(const double v[3]) {
    char text[80];
    snprintf(text, sizeof text, "%.5g  %.5g  %.5g", plain(v[0]), plain(v[1]), plain(v[2]));
    widgets_text(text);
    widgets_next_column();
}

static void show_look(const viewer_lesson *lesson, const char *when, const viewer_look *look) {
    char text[40] = "-";
    widgets_text(when);
    widgets_next_column();
    if (look->taken) snprintf(text, sizeof text, "%.6g", plain(look->value));
    widgets_text(text);
    widgets_next_column();
    for (size_t p = 0; p < lesson->particle_count; p++) {
        if (look->taken) show_vector(look->gradient[p]);
        else widgets_next_column();
    }
}

/* A column a particle: what is told of its three coordinates. */
static void begin_columns(const viewer_lesson *lesson, const char *first, const char *second) {
    char text[60];
    widgets_columns(2 + (int)lesson->particle_count);
    widgets_text(first);
    widgets_next_column();
    widgets_text(second);
    widgets_next_column();
    for (size_t p = 0; p < lesson->particle_count; p++) {
        snprintf(text, sizeof text, "by p%zu (%u): x y z", p, lesson->particle[p]);
        widgets_text(text);
        widgets_next_column();
    }
}

static void show_looks(const viewer_lesson *lesson) {
    begin_columns(lesson, "", lesson->is_energy ? "E" : "C");
    show_look(lesson, "before the step", &lesson->before);
    show_look(lesson, "after it", &lesson->after);
    show_look(lesson, "now", &lesson->now);
    widgets_columns(1);
    if (lesson->many) widgets_wrapped("It has more particles; these are the first.", false);
}

/* ---- Operation by operation ---- */

static void tell_operation(viewer_panels *panels, const viewer_lesson *lesson, size_t number) {
    char text[240], derivatives[400] = "";
    size_t i = viewer_operation_at(lesson, number), length = 0, coordinates = 3 * lesson->particle_count;
    viewer_operation_text(lesson, i, text, sizeof text);
    for (size_t c = 0; c < coordinates && length < sizeof derivatives; c++)
        length += (size_t)snprintf(derivatives + length, sizeof derivatives - length, " %.6g",
                                   plain(lesson->derivatives[i * coordinates + c]));
    viewer_event(panels->exchange->events, "operation %zu of %zu: %s value=%.6g derivatives%s", number,
                 viewer_operation_last(lesson), text, plain(lesson->operations[i].value), derivatives);
}

static void show_operation(const viewer_lesson *lesson, size_t i, bool newest) {
    char text[240], line[300];
    viewer_operation_text(lesson, i, text, sizeof text);
    const char *word = lesson->operations[i].label;
    snprintf(line, sizeof line, "%s%s%s%s", text, word[0] ? "   (" : "", word, word[0] ? ")" : "");
    if (newest) widgets_wrapped(line, true);
    else widgets_text(line);
    widgets_next_column();
    snprintf(text, sizeof text, "%.6g", plain(lesson->operations[i].value));
    widgets_text(text);
    widgets_next_column();
    for (size_t p = 0; p < lesson->particle_count; p++)
        show_vector(lesson->derivatives + 3 * (i * lesson->particle_count + p));
}

static void show_tape(viewer_panels *panels, const viewer_lesson *lesson) {
    size_t last = viewer_operation_last(lesson), before = panels->lesson_step;
    char line[160];
    if (!lesson->operation_count) {
        if (lesson->many)
            widgets_wrapped("A whole surface is a sum over its triangles: there is no one formula.", false);
        return;
    }
    if (button(panels, "start##tape", "lesson start", "before the first operation")) panels->lesson_step = 0;
    widgets_same_line();
    if (button(panels, "<##tape", "lesson back", "one operation back")) panels->lesson_step -= panels->lesson_step > 0;
    widgets_same_line();
    if (button(panels, ">##tape", "lesson on", "the next operation, with its value and its derivatives"))
        panels->lesson_step++;
    widgets_same_line();
    if (button(panels, "all##tape", "lesson all", "to the value")) panels->lesson_step = last;
    if (panels->lesson_step > last) panels->lesson_step = last;
    widgets_same_line();
    snprintf(line, sizeof line, "operation %zu of %zu%s", panels->lesson_step, last,
             lesson->too_long ? ", and more that are not shown" : "");
    widgets_text(line);
    if (panels->lesson_step != before && panels->lesson_step) tell_operation(panels, lesson, panels->lesson_step);
    if (!panels->lesson_step) return;
    begin_columns(lesson, "operation", "value");
    for (size_t number = 1; number <= panels->lesson_step; number++)
        show_operation(lesson, viewer_operation_at(lesson, number), number == panels->lesson_step);
    widgets_columns(1);
    widgets_follow();
}

/* ---- Its text, over it ---- */

static void show_text(viewer_panels *panels, const viewer_lesson *lesson, double left, double width, double height) {
    char line[80];
    // what is typed stays, until the stage has another text
    if (strcmp(panels->lesson_seen, lesson->text) != 0) {
        memcpy(panels->lesson_seen, lesson->text, sizeof panels->lesson_seen);
        memcpy(panels->lesson_text, lesson->text, sizeof panels->lesson_text);
    }
    double x = left + (lesson->in_view ? fmin(fmax(lesson->x, 0.1), 0.9) : 0.5) * width;
    double y = (lesson->in_view ? fmin(fmax(lesson->y, 0.12), 0.95) : 0.12) * height;
    bool seen = widgets_over("lesson text", x, y, left, left + width);
    if (lesson->field) {
        if (widgets_input_fitting("##formula", panels->lesson_text, sizeof panels->lesson_text))
            ask(panels, VIEWER_FORMULA, 0, 0, panels->lesson_text);
        if (seen) viewer_place_control(panels, "lesson text");
        widgets_help("the constraint: another text, and Enter, makes it anew");
    } else {
        widgets_text(lesson->text[0] ? lesson->text : lesson->name);
    }
    snprintf(line, sizeof line, "%s = %.6g", lesson->is_energy ? "E" : "C", plain(lesson->now.value));
    widgets_text(line);
    if (lesson->fault[0]) widgets_wrapped(lesson->fault, true);
    if (lesson->fault[0]) viewer_show_offer(panels, "lesson");
    widgets_panel_end();
}

/* ---- All of it ---- */

double viewer_lesson_height(const viewer_shown *shown, double height) {
    bool there = shown->panel[VIEWER_PANEL_LESSON] && shown->has_scene;
    return there ? round(fmin(0.4 * height, 300 * widgets_scale())) : 0;
}

void viewer_show_lesson(viewer_panels *panels, double left, double wide, double tall) {
    const viewer_shown *shown = &panels->exchange->shown;
    const viewer_lesson *lesson = &shown->lesson;
    double height = viewer_lesson_height(shown, tall), room = (wide - left) / (shown->side_count > 1 ? 2 : 1);
    bool open = true;
    if (widgets_panel("Lesson", WIDGETS_DOCKED, left, tall - height, wide - left, height, &open)) {
        if (!lesson->any) {
            widgets_wrapped("There is no constraint here: no formula, no spring, no part of a body that has one.",
                            false);
        } else {
            show_choice(panels, lesson);
            show_looks(lesson);
            show_tape(panels, lesson);
        }
    }
    widgets_panel_end();
    if (lesson->any) show_text(panels, lesson, left, room, tall - height);
    if (open) return;
    viewer_request request = {.kind = VIEWER_PANEL, .code = VIEWER_PANEL_LESSON, .down = false};
    viewer_ask(panels->exchange, &request);
}
