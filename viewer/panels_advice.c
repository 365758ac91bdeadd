/* What the window offers by one button: substeps that hold the method, and the scenes that were opened last. */
#include <string.h>

#include "viewer/panels.h"

void viewer_show_advice(viewer_panels *panels) {
    const viewer_shown *shown = &panels->exchange->shown;
    const viewer_side *side = &shown->sides[0];
    char words[200], title[60];
    if (!(shown->needed > 0)) return;
    for (size_t o = 0; o < side->object_count; o++) {
        const viewer_object *object = &side->objects[o];
        if (object->category != SKEIN_METHOD) continue;
        const skein_field *field = skein_field_find(object->kind, "substeps", NULL);
        if (!field || shown->needed > field->most) continue;
        snprintf(words, sizeof words, "%s is stable with %.0f substeps or more here", object->kind->name, shown->needed);
        widgets_wrapped(words, true);
        snprintf(title, sizeof title, "take %.0f substeps", shown->needed);
        bool pressed = widgets_button(title);
        viewer_place_control(panels, "take substeps");
        if (!pressed) continue;
        viewer_request request = {
            .kind = VIEWER_SET, .category = SKEIN_METHOD, .field = field, .value = skein_number(shown->needed)};
        viewer_ask(panels->exchange, &request);
    }
}

/* The text that was not taken, marked; and the names in it that one press makes parameters of. */
void viewer_show_offer(viewer_panels *panels, const char *place) {
    const viewer_offer *offer = &panels->exchange->shown.offer;
    char title[200] = "make parameter", name[60];
    viewer_request request = {.kind = VIEWER_PARAMETER};
    if (!offer->any) return;
    widgets_push(place);
    widgets_marked(offer->line, offer->column, offer->width);
    for (size_t i = 0; i < offer->name_count; i++) {
        size_t length = strlen(title);
        snprintf(title + length, sizeof title - length, "%s %.40s",
                 i                       ? ","
                 : offer->name_count > 1 ? "s"
                                         : "",
                 offer->names[i]);
    }
    if (offer->name_count) {
        request.down = widgets_button(title);
        snprintf(name, sizeof name, "%s make parameter", place);
        viewer_place_control(panels, name);
        widgets_help("it begins as 1, with a slider among the object's fields; undo takes it away");
        if (request.down) viewer_ask(panels->exchange, &request);
        widgets_same_line();
    }
    request.down = false;
    if (widgets_button("leave it")) viewer_ask(panels->exchange, &request);
    widgets_help("the text before goes on");
    widgets_pop();
}

void viewer_show_recent(viewer_panels *panels) {
    const viewer_shown *shown = &panels->exchange->shown;
    char name[VIEWER_TEXT + 16];
    if (shown->recent_count) widgets_text("opened last:");
    for (size_t i = 0; i < shown->recent_count; i++) {
        const char *path = shown->recent[i], *slash = strrchr(path, '/');
        widgets_push(shown->recent[i]);
        if (i) widgets_same_line();
        if (widgets_room() < 8 * widgets_line()) widgets_new_line();
        if (widgets_button(slash ? slash + 1 : path)) {
            viewer_request request = {.kind = VIEWER_OPEN};
            snprintf(request.text, sizeof request.text, "%s", path);
            viewer_ask(panels->exchange, &request);
        }
        snprintf(name, sizeof name, "recent %s", slash ? slash + 1 : path);
        viewer_place_control(panels, name);
        widgets_help(path);
        widgets_pop();
    }
}
