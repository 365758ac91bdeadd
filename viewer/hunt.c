/* Leading predators by the pointer; see hunt.h. */
#include "viewer/hunt.h"

#include <stdlib.h>
#include <string.h>

#include "viewer/stage.h"

static bool can_be_led(const skein_kind *kind) {
    return skein_field_find(kind, "line", NULL) && skein_field_find(kind, "position", NULL);
}

/* Whether it is led already; of another world than there is now it is not. */
static bool is_led(const viewer_stage *stage, size_t side, size_t index) {
    const viewer_hunt *hunt = &stage->hunt;
    for (size_t i = 0; i < hunt->count; i++)
        if (hunt->led[i].side == side && hunt->led[i].index == index && hunt->led[i].opened == stage->sides[side].opened)
            return true;
    return false;
}

/* Keeps what it is; false where that cannot be, and then it is not led. */
static bool keep(viewer_stage *stage, size_t side, size_t index) {
    viewer_hunt *hunt = &stage->hunt;
    const skein_world *world = stage->sides[side].world;
    skein_handle handle = skein_object_at(world, SKEIN_FORCE, index);
    viewer_led led = {.side = side, .index = index, .opened = stage->sides[side].opened};
    if (hunt->count == hunt->room) {
        size_t room = hunt->room ? 2 * hunt->room : 4;
        viewer_led *grown = realloc(hunt->led, room * sizeof *grown);
        if (!grown) return false;
        hunt->led = grown, hunt->room = room;
    }
    if (skein_get(world, handle, "position", &led.position) || skein_get(world, handle, "line", &led.line) ||
        skein_get(world, handle, "enabled", &led.enabled))
        return false;
    hunt->led[hunt->count++] = led;
    return true;
}

void viewer_hunt_lead(viewer_stage *stage) {
    const double *eye = stage->camera.lens.eye;
    bool began = false;
    for (size_t s = 0; s < stage->side_count; s++) {
        skein_world *world = stage->sides[s].world;
        double along[3];
        viewer_ray_at(stage, s, stage->x, stage->y, along);
        for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++) {
            skein_handle handle = skein_object_at(world, SKEIN_FORCE, i);
            if (!can_be_led(skein_object_kind(world, handle))) continue;
            bool led = is_led(stage, s, i);
            if (!led && !keep(stage, s, i)) continue;
            skein_set(world, handle, "position", skein_vector(eye[0], eye[1], eye[2]));
            skein_set(world, handle, "line", skein_vector(along[0], along[1], along[2]));
            if (!led) skein_set(world, handle, "enabled", skein_number(1));
            began |= !led;
        }
    }
    if (began) viewer_event(stage->events, "hunts");
    stage->facts |= began;
}

void viewer_hunt_rest(viewer_stage *stage) {
    viewer_hunt *hunt = &stage->hunt;
    bool rests = false;
    for (size_t i = 0; i < hunt->count; i++) {
        const viewer_led *led = &hunt->led[i];
        if (led->side >= stage->side_count || led->opened != stage->sides[led->side].opened) continue;
        skein_world *world = stage->sides[led->side].world;
        skein_handle handle = skein_object_at(world, SKEIN_FORCE, led->index);
        // a rule that came into its place meanwhile has nothing of it
        if (!skein_object_kind(world, handle) || !can_be_led(skein_object_kind(world, handle))) continue;
        skein_set(world, handle, "position", led->position);
        skein_set(world, handle, "line", led->line);
        skein_set(world, handle, "enabled", led->enabled);
        rests = true;
    }
    hunt->count = 0;
    if (rests) viewer_event(stage->events, "rests");
    stage->facts |= rests;
}

void viewer_hunt_leave(viewer_stage *stage, size_t side, size_t index) {
    if (side < stage->side_count && is_led(stage, side, index)) viewer_hunt_rest(stage);
}

void viewer_hunt_release(viewer_hunt *hunt) {
    free(hunt->led);
    *hunt = (viewer_hunt){NULL, 0, 0};
}
