/* How planes, which have no end, are shown: level ones as ground, others as a square slab.
 *
 *            ___________                       middle of the scene
 *           /    slab  /          _____________________________________
 *          /__________/          /      ground: a disc, out to the haze
 *
 * Called by draw.c. A slab lies about the scene's middle and is about as large as the scene. */
#ifndef SKEIN_RENDER_PLANES_H
#define SKEIN_RENDER_PLANES_H

#include "render/frame.h"

/* True where the plane lies level, facing up, so that it is drawn as ground. */
bool render_plane_level(const render_plane *plane);

/* The height of the highest ground, a level plane or the floor; false where there is none. */
bool render_find_ground(const render_frame *frame, double *height);

/* A slab's middle, two half sides, of which the first is level, and its unit normal. */
void render_place_slab(const render_plane *plane, const double middle[3], double radius, double vectors[4][3]);

/* Adds the corners of all slabs. */
void render_bounds_add_slabs(render_bounds *bounds, const render_frame *frame, const double middle[3], double radius);

/* The side of a grid's cells that reads well for a scene of that radius: 1, 2 or 5 times a power of ten. */
double render_grid_cell(double radius);

#endif
