/* A frame from a world and a view, through the public API alone.
 *
 *     world, view --update--> frame (its positions lie here) --draw.c--> picture
 *
 * Made once for a world and updated for every picture; called by picture.c, films and the window. What
 * stays (triangles, uv) is worked out once for a body. Invariant: the frame is valid until the next
 * update; bodies and colliders that are not `visible` are not in it. */
#ifndef SKEIN_RENDER_WORLD_FRAME_H
#define SKEIN_RENDER_WORLD_FRAME_H

#include "render/camera.h"
#include "render/frame.h"
#include "render/view.h"
#include "render/world_constraints.h"
#include "skein/skein.h"

typedef struct render_world_frame render_world_frame;

/* NULL where there is no memory. */
render_world_frame *render_world_frame_create(skein_error *error);
void render_world_frame_destroy(render_world_frame *frame); /* NULL is allowed */

/* Takes the world's present state, and of it what the view shows (NULL: the defaults). Where it has no level plane, a
 * ground is put under the first state seen, and stays there. */
skein_status render_world_frame_update(render_world_frame *frame, skein_world *world, const render_view *view,
                                       skein_error *error);
const render_frame *render_world_frame_get(const render_world_frame *frame);

/* From the next update on the zones and neighbours of this bird are drawn (world_flock.h); UINT32_MAX, as at first: of
 * none. */
void render_world_frame_choose_bird(render_world_frame *frame, uint32_t particle);
/* How large the first flock's birds are drawn, from tip to tip (m); 0 where there are none. */
double render_world_frame_span(const render_world_frame *frame);

/* From the next update on particles are drawn between the last two steps: 0 shows the state before the last step, 1
 * the present, as at first. */
void render_world_frame_blend(render_world_frame *frame, double blend);
/* From the next update on this constraint is drawn with its gradient, whatever the view shows. */
void render_world_frame_choose(render_world_frame *frame, const render_chosen *chosen);

/* For a picture that stands alone: brings such a ground close under the present state. (In a film it
 * must stay where things have room to move.) */
void render_world_frame_settle(render_world_frame *frame);

/* The camera and such a ground shall have room for this, too, and the surroundings are measured by it; before
 * the first update. So a film's background stands still. */
void render_world_frame_hold(render_world_frame *frame, const render_subject *subject);

/* The speed (m/s) or strain that the end of the colours stands for now; 0 where colours tell neither. */
double render_world_frame_range(const render_world_frame *frame);

/* What the picture is of; and its surroundings, among them the ground if it is near. */
render_subject render_world_frame_subject(const render_world_frame *frame);
/* The middle of the body that the view's camera follows; false where it follows none. */
bool render_world_frame_followed(const render_world_frame *frame, double middle[3]);
/* The same, or where it follows none the mean place of the particles that are shown; false where there are none. */
bool render_world_frame_middle(const render_world_frame *frame, double middle[3]);
/* The view's camera. One that frames by itself holds all bodies of the present state, and makes them large; one that
 * follows a body is where it sees that one now. */
render_camera render_world_frame_camera(const render_world_frame *frame, double aspect);

#endif
