/* Colliders and ropes of a picture: planes, spheres, boxes, rods and bowls, as they stand now.
 *
 * Called by world_frame.c, in the order below, for every picture. Its arrays grow and stay. */
#ifndef SKEIN_RENDER_WORLD_SOLIDS_H
#define SKEIN_RENDER_WORLD_SOLIDS_H

#include "render/frame.h"
#include "render/view.h"
#include "render/world_state.h"

/* Start from {0}. */
typedef struct render_world_solids {
    render_plane *planes;
    render_sphere *spheres;
    render_solid *solids, *rods;
    render_bowl *bowls;
    size_t plane_count, sphere_count, solid_count, bowl_count, rod_count, rod_room;
} render_world_solids;

void render_world_solids_clear(render_world_solids *solids);
/* A rope's particles hang together in their order; `index` is the body's. False where there is no memory. */
bool render_add_rope(render_world_solids *solids, const render_world_state *state, const skein_surface *rope,
                     size_t index, const render_view *view);
/* What is visible of the colliders. */
skein_status render_take_colliders(render_world_solids *solids, const skein_world *world, const render_view *view,
                                   skein_error *error);
void render_world_solids_show(const render_world_solids *solids, render_frame *frame);
/* How thick ropes are, in a scene of that radius. */
void render_world_solids_size(render_world_solids *solids, const render_view *view, double radius);
void render_world_solids_release(render_world_solids *solids);

#endif
