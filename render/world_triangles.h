/* A collider that contact finds by its triangles, as it is drawn: by those, from both sides, wherever it has been moved to.
 *
 * Called by world_implicit.c for every picture. Its triangles and creases are made once, its vertices copied each time. */
#ifndef SKEIN_RENDER_WORLD_TRIANGLES_H
#define SKEIN_RENDER_WORLD_TRIANGLES_H

#include "render/body_mesh.h"
#include "render/frame.h"
#include "skein/skein.h"

/* Start from {0}. */
typedef struct render_world_triangles {
    bool made;
    render_body_mesh mesh;
    double *places;    /* of the collider's vertices */
    double *positions; /* of the mesh's */
    render_bounds box;
} render_world_triangles;

/* Brings a collider's triangles up to date: `any` says whether it has some. False where there is no memory. */
bool render_take_triangles(render_world_triangles *t, const skein_world *world, skein_handle collider, bool *any);
/* Fills in all of a surface but its material. */
void render_show_triangles(const render_world_triangles *t, render_surface *surface);
void render_triangles_release(render_world_triangles *t);

#endif
