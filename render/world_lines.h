/* The lines of a picture: wireframes, springs, normals, velocities, contacts, fields, axes.
 *
 * Called by world_frame.c, which clears all sets, asks for what the view shows, and puts them into the frame. */
#ifndef SKEIN_RENDER_WORLD_LINES_H
#define SKEIN_RENDER_WORLD_LINES_H

#include "render/body_mesh.h"
#include "render/frame.h"
#include "render/world_state.h"

typedef enum render_line_kind {
    RENDER_WIREFRAME,
    RENDER_SPRINGS,
    RENDER_NORMALS,
    RENDER_VELOCITIES,
    RENDER_CONTACTS,
    RENDER_FIELDS,
    RENDER_CONSTRAINTS,
    RENDER_GRADIENTS,
    RENDER_AXES,
    RENDER_ZONES, /* reaches and neighbours: of predators, and of a chosen bird */
    RENDER_LINE_KIND_COUNT
} render_line_kind;

typedef struct render_line_set {
    double *positions; /* count x 6 */
    float *colours;    /* count x 3 */
    size_t count, room;
} render_line_set;

/* Start from {0}. */
typedef struct render_world_lines {
    render_line_set sets[RENDER_LINE_KIND_COUNT];
    render_lines lines[RENDER_LINE_KIND_COUNT]; /* what goes into the frame */
    float *normals;                             /* room for those of a surface */
    size_t normal_room;
    bool no_memory; /* since the last clear */
} render_world_lines;

void render_world_lines_clear(render_world_lines *lines);
void render_world_lines_release(render_world_lines *lines);

/* A line; and an arrow whose barbs are a share of its length, two of them, or four of a gradient. What is not finite has no place in a picture. */
void render_add_line(render_world_lines *lines, render_line_kind kind, const double from[3], const double to[3],
                     const float colour[3]);
void render_add_arrow(render_world_lines *lines, render_line_kind kind, const double from[3], const double along[3],
                      const float colour[3]);
void render_add_wireframe(render_world_lines *lines, const render_body_mesh *mesh, const render_world_state *state);
void render_add_springs(render_world_lines *lines, const render_world_state *state);
/* `length`, here and below, in metres. */
void render_add_normals(render_world_lines *lines, const render_surface *surface, double length);
void render_add_velocities(render_world_lines *lines, const render_world_state *state, double seconds);
void render_add_contacts(render_world_lines *lines, const render_world_state *state, double length);
/* Arrows of a field: `count` points and what is there (count x 3), the strongest `length` long. */
void render_add_field(render_world_lines *lines, size_t count, const double *points, const double *forces,
                      double length);
void render_add_axes(render_world_lines *lines, double length);

/* Puts all sets, `width` pixels wide, into a frame. */
void render_world_lines_show(render_world_lines *lines, double width, render_frame *frame);

#endif
