/* What the stage does when it is asked: keys, the pointer, and the panels' requests. */
#include <math.h>
#include <string.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/keys.h"
#include "viewer/make.h"

/* A press that moves less (pixels) is a click; the pointer's reach around a loose particle (pixels). */
static const double click_pixels = 4, reach_pixels = 9;

/* ---- Picking ---- */

size_t viewer_side_at(const viewer_stage *stage, double x, double *inside) {
    for (size_t s = 0; s < stage->side_count; s++) {
        int left, width = viewer_side_width(stage, s, &left);
        *inside = x - left;
        if (x < left + width || s + 1 == stage->side_count) return s;
    }
    return 0;
}

void viewer_ray_at(const viewer_stage *stage, size_t side, double x, double y, double direction[3]) {
    int left, width = viewer_side_width(stage, side, &left);
    viewer_camera_ray(&stage->camera, x - left, y, width, stage->height, direction);
}

/* The particle under the pointer; UINT32_MAX if there is none, or a collider in front of it. */
static uint32_t pick(const viewer_stage *stage, size_t side, double x, double y, double *distance) {
    const skein_world *world = stage->sides[side].world;
    const double *eye = stage->camera.lens.eye;
    const render_view *view = &stage->sides[side].view;
    double direction[3], near_ray, slope = 2 * tan(0.5 * stage->camera.lens.fov * 0.017453292519943295);
    uint32_t loose, picked = UINT32_MAX;
    skein_hit body, wall;
    viewer_ray_at(stage, side, x, y, direction);
    *distance = INFINITY;
    if (skein_ray_cast(world, eye, direction, SKEIN_BODY, &body) ||
        skein_ray_cast(world, eye, direction, SKEIN_COLLIDER, &wall) ||
        skein_particle_near_ray(world, eye, direction, view->particle_radius, slope * reach_pixels / stage->height,
                                &loose, &near_ray))
        return UINT32_MAX;
    if (body.t < INFINITY) picked = body.particle, *distance = body.t;
    else if (near_ray < INFINITY) picked = loose, *distance = near_ray;
    // a little tolerance: cloth lies on colliders
    if (view->colliders && wall.t < 0.99 * *distance) return UINT32_MAX;
    return picked;
}

/* ---- The pointer ---- */

/* Where the pointer has the particle that it holds: in the plane through it that faces the camera. */
static void aim_grab(viewer_stage *stage) {
    double direction[3], right[3], up[3], back[3], t = 0, facing = 0;
    viewer_ray_at(stage, stage->grab.side, stage->x, stage->y, direction);
    render_camera_axes(&stage->camera.lens, right, up, back);
    for (int k = 0; k < 3; k++) {
        t += (stage->grab.depth[k] - stage->camera.lens.eye[k]) * back[k];
        facing += direction[k] * back[k];
    }
    if (!(fabs(facing) > 1e-6)) return;
    for (int k = 0; k < 3; k++) stage->grab.goal[k] = stage->camera.lens.eye[k] + t / facing * direction[k];
}

static void press(viewer_stage *stage, const viewer_request *r) {
    stage->button = r->code;
    stage->button_mods = r->mods;
    stage->pressed_x = r->x, stage->pressed_y = r->y;
    if (viewer_handles_press(stage, r)) return;
    if (r->code != GLFW_MOUSE_BUTTON_LEFT || r->mods & GLFW_MOD_SHIFT || stage->camera.flying) return;
    if (stage->handles.tool >= VIEWER_PINS) return; // beside a body the brush looks around
    double inside, distance;
    size_t side = viewer_side_at(stage, r->x, &inside);
    uint32_t particle = pick(stage, side, r->x, r->y, &distance);
    viewer_event(stage->events, "picked %d distance=%.5g", particle == UINT32_MAX ? -1 : (int)particle, distance);
    if (particle != UINT32_MAX) viewer_grab_take(&stage->grab, stage->sides[side].world, side, particle);
}

/* A click on a bird chooses it, and once more lets it go. */
static void choose_bird(viewer_stage *stage, uint32_t particle) {
    bool same = stage->ride.chosen && stage->ride.bird == particle;
    if (stage->ride.rides) return;
    stage->ride.chosen = !same;
    stage->ride.bird = particle;
    if (same) viewer_note(stage, "bird %u is one of many again", particle);
    else viewer_note(stage, "bird %u: its zones, and who counts as a neighbour; B rides on it", particle);
}

static void release(viewer_stage *stage) {
    if (viewer_handles_busy(stage)) viewer_handles_let_go(stage);
    if (stage->grab.holding) {
        skein_world *world = stage->sides[stage->grab.side].world;
        viewer_grab_release(&stage->grab, world);
        if (stage->grab.moved) {
            double x[3] = {0, 0, 0};
            skein_positions_copy(world, stage->grab.particle, 1, x);
            viewer_event(stage->events, "released %u at %.5g %.5g %.5g", stage->grab.particle, x[0], x[1], x[2]);
        } else if (stage->grab.side == 0 && viewer_is_bird(world, stage->grab.particle)) {
            choose_bird(stage, stage->grab.particle);
        } else {
            bool pinned = viewer_toggle_pin(world, stage->grab.particle);
            viewer_note(stage, "%s particle %u", pinned ? "pinned" : "freed", stage->grab.particle);
        }
        stage->dirty = true;
    }
    stage->button = -1;
}

static void drag(viewer_stage *stage, double dx, double dy) {
    if (viewer_handles_busy(stage)) {
        viewer_handles_drag(stage);
        return;
    }
    if (stage->grab.holding) {
        bool far = hypot(stage->x - stage->pressed_x, stage->y - stage->pressed_y) >= click_pixels;
        stage->grab.moved |= far;
        if (!stage->grab.moved) return;
        aim_grab(stage);
        // nothing steps: it goes along at once
        skein_world *world = stage->sides[stage->grab.side].world;
        if (stage->paused || viewer_stage_by_key(stage)) {
            skein_positions_set(world, stage->grab.particle, 1, stage->grab.goal);
            stage->dirty = true;
        }
        return;
    }
    bool pan = stage->button == GLFW_MOUSE_BUTTON_MIDDLE || stage->button_mods & GLFW_MOD_SHIFT;
    if (pan && !stage->camera.flying) viewer_camera_pan(&stage->camera, dx, dy, stage->height);
    else viewer_camera_turn(&stage->camera, dx, dy, stage->height);
    stage->dirty = true;
}

static void point(viewer_stage *stage, const viewer_request *r) {
    double dx = r->x - stage->x, dy = r->y - stage->y;
    stage->x = r->x, stage->y = r->y;
    if (!stage->side_count) return;
    if (stage->button < 0) stage->over = !r->down;
    if (stage->button < 0 && stage->handles.tool) viewer_handles_hover(stage, stage->over);
    if (stage->button < 0 && (r->down || stage->handles.tool))
        viewer_hunt_rest(stage); // a hand with a tool frightens nobody
    else if (stage->button < 0) viewer_hunt_lead(stage);
    if (stage->button >= 0) drag(stage, dx, dy);
}

static void press_or_release(viewer_stage *stage, const viewer_request *r) {
    stage->x = r->x, stage->y = r->y;
    if (!stage->side_count) return;
    if (r->down && stage->button < 0) press(stage, r);
    else if (!r->down && r->code == stage->button) {
        bool turned = !stage->grab.holding && !viewer_handles_busy(stage) && stage->camera.moved;
        release(stage);
        if (turned)
            viewer_event(stage->events, "camera %.5g %.5g %.5g", stage->camera.lens.eye[0], stage->camera.lens.eye[1],
                         stage->camera.lens.eye[2]);
    }
}

/* ---- Focus ---- */

static bool is_flock(const viewer_stage *stage) {
    const skein_world *world = stage->side_count ? stage->sides[0].world : NULL;
    for (size_t i = 0; world && i < skein_object_count(world, SKEIN_FORCE); i++) {
        const skein_kind *kind = skein_object_kind(world, skein_object_at(world, SKEIN_FORCE, i));
        if (skein_field_find(kind, "alignment", NULL)) return true;
    }
    return false;
}

static void focus(viewer_stage *stage, bool has_it) {
    bool pauses =
        stage->options->unfocused == VIEWER_PAUSE || (stage->options->unfocused == VIEWER_BY_SCENE && is_flock(stage));
    memset(stage->camera.down, 0, sizeof stage->camera.down);
    if (!has_it && !stage->play_away && pauses && !stage->paused && stage->side_count) {
        viewer_stage_pause(stage, true);
        stage->paused_by_focus = true;
    } else if (has_it && stage->paused_by_focus) {
        viewer_stage_pause(stage, false);
    }
}

/* ---- All requests ---- */

static void answer_key(viewer_stage *stage, const viewer_request *r) {
    // keys may be faster than the first picture, which places the camera that they move
    if (stage->side_count && !stage->camera.placed) viewer_take_frames(stage);
    bool meant = viewer_key_down(stage, r->code, r->mods);
    viewer_event(stage->events, "key %d %s", r->code, meant ? "done" : "without a meaning");
    viewer_tell_state(stage);
}

void viewer_stage_answer(viewer_stage *stage, const viewer_request *r) {
    switch (r->kind) {
    case VIEWER_KEY_DOWN: answer_key(stage, r); break;
    case VIEWER_KEY_UP: viewer_key_up(stage, r->code); break;
    case VIEWER_BUTTON: press_or_release(stage, r); break;
    case VIEWER_MOVE: point(stage, r); break;
    case VIEWER_SCROLL:
        if (stage->side_count && !viewer_handles_scroll(stage, r->y)) viewer_camera_zoom(&stage->camera, r->y);
        stage->dirty = true;
        break;
    case VIEWER_RESIZE:
        stage->wide = (int)r->x, stage->tall = (int)r->y;
        stage->dirty = true;
        if (stage->film) viewer_film_toggle(stage);                                      // its pictures have one size
        if (!stage->camera.moved && !stage->camera.flying) stage->camera.placed = false; // it frames anew
        viewer_event(stage->events, "size %d %d", stage->wide, stage->tall);
        break;
    case VIEWER_FOCUS: focus(stage, r->down); break;
    case VIEWER_SET: viewer_stage_set(stage, r); break;
    case VIEWER_METHOD: viewer_stage_method(stage, (size_t)r->side, r->text); break;
    case VIEWER_ADD:
    case VIEWER_REMOVE: viewer_stage_add_or_remove(stage, r); break;
    case VIEWER_MAKE: viewer_make(stage, r); break;
    case VIEWER_DUPLICATE: viewer_duplicate(stage, r); break;
    case VIEWER_KIND: viewer_other_kind(stage, r); break;
    case VIEWER_TOOL: viewer_handles_request(stage, r); break;
    case VIEWER_BRUSH: stage->handles.brush.radius = r->x; break;
    case VIEWER_TO_MESH: viewer_to_mesh(stage, r); break;
    case VIEWER_FOLLOW: viewer_stage_follow_body(stage, r->index); break;
    case VIEWER_OPEN: viewer_stage_open(stage, r->text, NULL); break;
    case VIEWER_SCRUB:
        viewer_stage_pause(stage, true);
        viewer_stage_go_to(stage, (uint64_t)r->x);
        break;
    case VIEWER_COMPARE: viewer_stage_compare(stage, r->text); break;
    case VIEWER_PLAY_AWAY: stage->play_away = r->down; break;
    case VIEWER_PANEL:
        stage->panel[r->code] = r->down;
        stage->dirty = true;
        viewer_event(stage->events, "panel %d %s", r->code, r->down ? "open" : "closed");
        break;
    case VIEWER_LESSON: viewer_lesson_choose(stage, r); break;
    case VIEWER_FORMULA: viewer_lesson_write(stage, r->text); break;
    case VIEWER_PARAMETER:
        if (r->down) viewer_offer_take(stage);
        else viewer_offer_forget(stage);
        break;
    case VIEWER_SAVED: viewer_note(stage, "saved %s", r->text); break;
    case VIEWER_FAULT: viewer_say(stage, SKEIN_LOG_WARNING, "%s", r->text); break;
    case VIEWER_CLOSE: stage->closing = true; break;
    }
}
