/* Colliders without a simpler shape, as triangle meshes: those made from a mesh by their own triangles (world_triangles.h), an open
 * mesh has no other; formulas and fields where the distance that contact sees is 0.
 *
 * Called by world_frame.c for every picture. A mesh is made again only when what makes it has changed. A surface that
 * ends is meshed whole; one that goes on (terrain) as far as the box that it is looked for in, which is what else there
 * is, with some room around it. */
#ifndef SKEIN_RENDER_WORLD_IMPLICIT_H
#define SKEIN_RENDER_WORLD_IMPLICIT_H

#include "render/frame.h"
#include "skein/skein.h"

typedef struct render_implicit render_implicit;

/* Start from {0}. */
typedef struct render_world_implicit {
    render_implicit *data;
    size_t count, room;
} render_world_implicit;

/* Brings the meshes up to date; `things` is all else in the picture. */
skein_status render_take_implicit(render_world_implicit *all, const skein_world *world, const render_bounds *things,
                                  skein_error *error);
/* Fills in the surfaces that there are, at most all->count; returns how many. */
size_t render_show_implicit(const render_world_implicit *all, render_surface *surfaces);
void render_world_implicit_release(render_world_implicit *all);

#endif
