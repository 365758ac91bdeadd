/* Cutting by the pointer; see knife.h. */
#include "viewer/knife.h"

#include <math.h>

#include <skein/cut.h>

#include "viewer/stage.h"

/* A shorter way (pixels) waits for more of the stroke: a blade so thin would say little of where it goes. */
static const double least_way = 2;

void viewer_knife_begin(viewer_stage *stage) {
    viewer_knife *knife = &stage->handles.knife;
    double inside;
    *knife = (viewer_knife){true, viewer_side_at(stage, stage->x, &inside), {stage->x, stage->y}, 0};
}

/* From the eye through a place of the picture to beyond all there is. */
static void reach(const viewer_stage *stage, double x, double y, double far, double out[3]) {
    double direction[3];
    viewer_ray_at(stage, stage->handles.knife.side, x, y, direction);
    for (int k = 0; k < 3; k++) out[k] = stage->camera.lens.eye[k] + far * direction[k];
}

/* How far from the eye the farthest particle is. */
static double farthest(const skein_world *world, const double eye[3]) {
    skein_view view = skein_position_view(world);
    double most = 0;
    for (size_t i = 0; i < view.count; i++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[i];
        double away = hypot(hypot((double)p[0] - eye[0], (double)p[1] - eye[1]), (double)p[2] - eye[2]);
        if (isfinite(away)) most = fmax(most, away);
    }
    return most;
}

void viewer_knife_go_on(viewer_stage *stage) {
    viewer_knife *knife = &stage->handles.knife;
    const double *eye = stage->camera.lens.eye;
    if (hypot(stage->x - knife->last[0], stage->y - knife->last[1]) < least_way) return;
    for (size_t s = 0; s < stage->side_count; s++) {
        skein_world *world = stage->sides[s].world;
        // the far side of the triangle is nearer in its middle, by at most a half where the stroke spans 120 degrees
        double far = 2 * farthest(world, eye) + 1, blade[3][3] = {{eye[0], eye[1], eye[2]}};
        reach(stage, knife->last[0], knife->last[1], far, blade[1]);
        reach(stage, stage->x, stage->y, far, blade[2]);
        for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
            size_t count = 0;
            skein_status status =
                skein_cut(world, skein_object_at(world, SKEIN_BODY, b), (const double(*)[3])blade, &count);
            if (status == SKEIN_ERROR_MEMORY)
                viewer_say(stage, SKEIN_LOG_WARNING, "%s", skein_world_error(world)->message);
            if (!status && s == 0) knife->faces += count; // else it is no sheet
        }
    }
    knife->last[0] = stage->x, knife->last[1] = stage->y;
    stage->dirty = true;
}

void viewer_knife_end(viewer_stage *stage) {
    viewer_knife *knife = &stage->handles.knife;
    if (!knife->cuts) return;
    knife->cuts = false;
    if (knife->faces) viewer_note(stage, "cut %zu faces", knife->faces);
    else viewer_note(stage, "nothing is cut: the knife cuts cloth, where its picture is crossed");
    viewer_event(stage->events, "knife %zu", knife->faces);
    stage->facts = stage->dirty = true;
}
