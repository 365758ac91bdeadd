/* The brush: pins and frees the particles of a body that it goes over, while the button is down.
 *
 * It is a ball around the place of the body's surface that the pointer is on, so large that it is as wide as the circle on
 * the picture; what lies behind is not painted. What it does is seen at once; at its end the body's `pins` are the list of
 * numbers, and the scene is built anew with them where it stands (tethers hang on pins). A body with a field `pins`
 * can be painted, of whatever kind. Called by handles.c. */
#ifndef SKEIN_VIEWER_BRUSH_H
#define SKEIN_VIEWER_BRUSH_H

#include "skein/skein.h"
#include "viewer/changes.h"

typedef struct viewer_stage viewer_stage;

typedef struct viewer_brush {
    double radius;     /* pixels */
    bool paints, pins; /* pins: it does not free */
    size_t side, body;
    double last[2];      /* where it was */
    unsigned char *held; /* of the body's particles: as it is to be */
    size_t first, count, changed;
} viewer_brush;

/* Begins a stroke on the body under the pointer. False where there is none that has pins. */
bool viewer_brush_begin(viewer_stage *stage, bool pins);
void viewer_brush_go_on(viewer_stage *stage);
/* Keeps it as one change. */
void viewer_brush_end(viewer_stage *stage);
void viewer_brush_forget(viewer_brush *brush);
/* The field by which an object holds particles; NULL. */
const skein_field *viewer_pins_field(const skein_world *world, size_t body);
/* Where a body has other particles once `set` is done as well, its pins by number mean nothing any more: writes
 * "bodies.0.pins=..." as they were before any was numbered by hand. False where they stay. */
bool viewer_pins_lose_meaning(viewer_stage *stage, const char *set, char *out, size_t size);

#endif
