/* What is drawn many times over: spheres, particles, lines. One buffer each, written anew every frame
 * and grown when it must.
 *
 * Called by draw.c. Spheres and particles are the same to the card: balls with a place, a radius, a
 * rotation and two colours. */
#ifndef SKEIN_RENDER_INSTANCES_H
#define SKEIN_RENDER_INSTANCES_H

#include "render/frame.h"
#include "render/meshes.h"

/* Start from {0}. */
typedef struct render_instances {
    unsigned arrays, buffer;
    size_t count;  /* of what the buffer holds now */
    size_t room;   /* in bytes, of the buffer and of `staged` */
    float *staged; /* what goes to the card next */
} render_instances;

/* A vertex array for balls of a shape (ball.vert.glsl), or for lines (line.vert.glsl). */
void render_instances_make_balls(render_instances *instances, const render_shape *shape);
/* Makes balls take another shape from now on. */
void render_instances_take_shape(const render_instances *instances, const render_shape *shape);
void render_instances_make_solids(render_instances *instances, const render_shape *shape);
void render_instances_make_lines(render_instances *instances);
void render_instances_destroy(render_instances *instances);

/* Bring a frame's things to the card, one group after the other. */
skein_status render_instances_bring_spheres(render_instances *instances, const render_frame *frame, skein_error *error);
skein_status render_instances_bring_solids(render_instances *instances, const render_solid *solids, size_t count,
                                           skein_error *error);
/* `rotation` (rows) turns all of them. */
skein_status render_instances_bring_points(render_instances *instances, const render_frame *frame,
                                           const double rotation[9], skein_error *error);
skein_status render_instances_bring_lines(render_instances *instances, const render_frame *frame, skein_error *error);

/* All of a frame's lines, which were brought before, each group in its width: pixels of a picture so
 * large. */
void render_instances_draw_lines(const render_instances *instances, unsigned program, const render_frame *frame,
                                 double width, double height, size_t part);

#endif
