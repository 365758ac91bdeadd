/* The gizmo: arrows, rings and boxes over a picture, by which a thing is moved, turned and sized.
 *
 *     a gizmo in space --viewer_gizmo_draw--> strokes on the picture --viewer_gizmo_pick--> the part under the pointer
 *     a part that is held --viewer_gizmo_follow--> how far the pointer has brought it
 *
 * It knows no world and no window: of space it has a place and three axes, of the picture a lens and a part of it. Drawn
 * as large on the picture wherever it is. Called by handles.c. */
#ifndef SKEIN_VIEWER_GIZMO_H
#define SKEIN_VIEWER_GIZMO_H

#include <stdbool.h>
#include <stddef.h>

#include "render/camera.h"

/* What the pointer does in the picture, besides looking around. */
typedef enum viewer_tool {
    VIEWER_NO_TOOL,
    VIEWER_MOVES,
    VIEWER_TURNS,
    VIEWER_SIZES,
    VIEWER_PINS, /* a brush: brush.h */
    VIEWER_CUTS, /* a knife: knife.h */
    VIEWER_TOOL_COUNT
} viewer_tool;

/* Parts: along an axis; in the plane across an axis; all together. */
enum { GIZMO_AXIS = 0, GIZMO_PLANE = 3, GIZMO_ALL = 6, GIZMO_PARTS = 7, GIZMO_NOTHING = -1 };

/* Colours by meaning; the theme has them. */
typedef enum viewer_paint {
    VIEWER_PAINT_X,
    VIEWER_PAINT_Y,
    VIEWER_PAINT_Z,
    VIEWER_PAINT_ALL,
    VIEWER_PAINT_HOT,
    VIEWER_PAINT_QUIET
} viewer_paint;

/* A line, a filled triangle or square, or a circle on the picture, pixels from its upper left corner. */
typedef struct viewer_stroke {
    enum { STROKE_LINE, STROKE_TRIANGLE, STROKE_SQUARE, STROKE_CIRCLE } shape;
    float at[4][2]; /* of a circle: its middle, and its radius in at[1][0] */
    float width;    /* 0: filled */
    float opacity;
    viewer_paint paint;
    int part; /* that it is of; GIZMO_NOTHING: it is not taken hold of */
} viewer_stroke;

enum { VIEWER_STROKES = 700 };
typedef struct viewer_strokes {
    viewer_stroke data[VIEWER_STROKES];
    size_t count;
} viewer_strokes;

/* A part of a picture, and what it is seen with. */
typedef struct viewer_sight {
    render_camera lens;
    double left, width, height; /* pixels */
} viewer_sight;

typedef struct viewer_gizmo {
    viewer_tool tool;
    double origin[3], axes[3][3]; /* unit vectors */
    bool has[GIZMO_PARTS];        /* which parts there are */
    int hot;                      /* the part that is under the pointer, or held */
    double scale;                 /* of the window: 1 is 96 dots an inch */
} viewer_gizmo;

/* Where a place is on the picture; false behind the eye. */
bool viewer_sight_project(const viewer_sight *sight, const double place[3], double at[2]);
/* From the eye through a place of the picture, of length 1. */
void viewer_sight_ray(const viewer_sight *sight, double x, double y, double direction[3]);
/* How many metres a pixel is, at a place's depth. */
double viewer_sight_metres(const viewer_sight *sight, const double place[3]);

/* The pixels of a ball's radius, as far as it is seen as a circle; 0 from inside. */
double viewer_sight_radius(const viewer_sight *sight, const double middle[3], double radius);

void viewer_stroke_line(viewer_strokes *strokes, const double from[2], const double to[2], viewer_stroke like);
void viewer_stroke_circle(viewer_strokes *strokes, const double middle[2], double radius, viewer_stroke like);
/* A line in space; nothing where an end is behind the eye. */
void viewer_stroke_edge(viewer_strokes *strokes, const viewer_sight *sight, const double from[3], const double to[3],
                        viewer_stroke like);

void viewer_gizmo_draw(const viewer_gizmo *gizmo, const viewer_sight *sight, viewer_strokes *strokes);
/* The part at a place of the picture; GIZMO_NOTHING where there is none. */
int viewer_gizmo_pick(const viewer_gizmo *gizmo, const viewer_sight *sight, double x, double y);
/* Where a part is best taken hold of, on the picture; false where it is not to be seen. */
bool viewer_gizmo_place(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, double at[2]);

/* What a pointer that took hold of a part at `from` and is now at `to` (pixels) has done with it: by how much (m) it is
 * moved, `by`; by which angle (degrees) it is turned about its axis, by[0]; how many times as large it is, `by`. False
 * where that has no sense, as along an axis that is looked at from its end. */
bool viewer_gizmo_follow(const viewer_gizmo *gizmo, const viewer_sight *sight, int part, const double from[2],
                         const double to[2], double by[3]);

/* "x", "yz plane", "all"; "view" for the ring that is all. */
const char *viewer_gizmo_part(int part);

#endif
