/* A world with a cloth of 1 m and one collider, as a frame of it is drawn, for tests of what colliders look like. */
#ifndef SKEIN_TESTS_FRAMED_H
#define SKEIN_TESTS_FRAMED_H

#include "helpers.h"
#include "render/world_frame.h"

typedef struct scene {
    skein_world *world;
    skein_handle collider; /* for the test to add */
    render_world_frame *frame;
} scene;

/* The cloth lies level at this height (m). */
static inline scene scene_under_cloth(double height) {
    scene s = {.world = new_world("xpbd", 2), .frame = render_world_frame_create(NULL)};
    assert_non_null(s.frame);
    OK(s.world, skein_body_add(s.world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_VEC3("position", 0, height, 0)), NULL));
    return s;
}

/* The collider's surface as it is drawn now; NULL where it has none. */
static inline const render_surface *look(scene *s) {
    assert_int_equal(render_world_frame_update(s->frame, s->world, NULL, NULL), SKEIN_OK);
    const render_frame *frame = render_world_frame_get(s->frame);
    return frame->surface_count > 1 ? &frame->surfaces[1] : NULL;
}

static inline void end(scene *s) {
    render_world_frame_destroy(s->frame);
    skein_world_destroy(s->world);
}

#endif
