/* The handles over the picture, as the stage has drawn them in strokes; and the brush's width. */
#include <math.h>
#include <string.h>

#include "viewer/panels.h"

static uint32_t colour_of(const viewer_colours *colours, viewer_paint paint) {
    switch (paint) {
    case VIEWER_PAINT_X:
    case VIEWER_PAINT_Y:
    case VIEWER_PAINT_Z: return colours->axis[paint - VIEWER_PAINT_X];
    case VIEWER_PAINT_HOT: return colours->held;
    default: return colours->handle;
    }
}

static void show_stroke(const viewer_stroke *stroke, const viewer_colours *colours, float left) {
    float at[4][2];
    uint32_t colour = colour_of(colours, stroke->paint);
    for (int i = 0; i < 4; i++) at[i][0] = stroke->at[i][0] + left, at[i][1] = stroke->at[i][1];
    if (stroke->shape == STROKE_LINE) widgets_stroke(at[0], at[1], stroke->width, colour, stroke->opacity);
    else if (stroke->shape != STROKE_CIRCLE)
        widgets_fill(at, stroke->shape == STROKE_TRIANGLE ? 3 : 4, colour, stroke->opacity);
    else widgets_circle(at[0], stroke->at[1][0], stroke->width, colour, stroke->opacity);
}

void viewer_show_handles(viewer_panels *panels, double left, double width, double height) {
    const viewer_shown *shown = &panels->exchange->shown;
    const viewer_colours *colours = viewer_colours_of(shown->light ? VIEWER_LIGHT : VIEWER_DARK);
    for (size_t s = 0; s < shown->side_count && shown->tool; s++) {
        const viewer_side *side = &shown->sides[s];
        double room = width / (double)shown->side_count;
        const double box[4] = {left + room * (double)s, 0, room, height};
        widgets_over_picture(box);
        for (size_t i = 0; i < side->strokes.count; i++) show_stroke(&side->strokes.data[i], colours, (float)left);
        widgets_over_picture_end();
        for (int part = 0; part < GIZMO_PARTS; part++) {
            const viewer_handle_place *place = &side->handles[part];
            const double at[4] = {left + place->at[0] - 1, place->at[1] - 1, 2, 2};
            if (place->name[0]) viewer_place_box(panels, place->name, at);
        }
    }
    double box[4];
    if (shown->tool && shown->tool_words[0])
        widgets_note(shown->tool_words, left + shown->tool_at[0] + 18, shown->tool_at[1] + 18, false, 400, false, box);
}

void viewer_show_brush(viewer_panels *panels) {
    const viewer_shown *shown = &panels->exchange->shown;
    double radius = shown->brush;
    if (shown->tool != VIEWER_PINS) return;
    bool changed = widgets_numbers("brush", &radius, 1, 4, 400, true, false, "%.0f pixels");
    viewer_place_control(panels, "brush");
    widgets_help("its radius: the wheel over the picture changes it, too. Drag pins particles, with Shift frees them");
    if (!changed) return;
    viewer_request request = {.kind = VIEWER_BRUSH, .x = fmin(fmax(radius, 4), 400)};
    viewer_ask(panels->exchange, &request);
}
