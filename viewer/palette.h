/* The palette of the side panel, and what can be done with each object; see palette.c. Called by the panels, under the
 * exchange's lock. */
#ifndef SKEIN_VIEWER_PALETTE_H
#define SKEIN_VIEWER_PALETTE_H

#include "viewer/panels.h"

void viewer_show_palette(viewer_panels *panels);
/* Duplicate, remove, another kind: under an object's fields. */
void viewer_show_deeds(viewer_panels *panels, const viewer_object *object);

#endif
