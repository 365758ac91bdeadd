/* The particles of a picture that are drawn as balls: loose ones, or all; and pins.
 *
 * Called by world_frame.c. */
#ifndef SKEIN_RENDER_WORLD_POINTS_H
#define SKEIN_RENDER_WORLD_POINTS_H

#include "render/frame.h"
#include "render/world_state.h"

typedef enum render_point_kind { RENDER_PARTICLES, RENDER_PINS, RENDER_POINT_KIND_COUNT } render_point_kind;

/* Start from {0}. */
typedef struct render_world_points {
    render_points points[RENDER_POINT_KIND_COUNT]; /* what goes into the frame */
    double *positions[RENDER_POINT_KIND_COUNT];
    float *colours; /* of particles */
} render_world_points;

/* Sorts out what a view shows; `where` tells which particles are held. False where there is no memory. */
bool render_world_points_take(render_world_points *points, const render_world_state *state, const skein_view *where,
                              const render_view *view);
/* Gives them radii that suit a scene of that radius, whose particles are `apart` from each other (metres). */
void render_world_points_size(render_world_points *points, const render_view *view, double radius, double apart);
void render_world_points_release(render_world_points *points);

#endif
