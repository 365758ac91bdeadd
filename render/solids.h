/* Boxes, rods and bowls on the card, and how they are drawn.
 *
 * Called by draw.c. Colliders are few and finely cut; rods are the many small pieces of ropes, whose light is found by
 * vertex. A bowl's far wall is drawn with all the rest, its near one as glass after everything. */
#ifndef SKEIN_RENDER_SOLIDS_H
#define SKEIN_RENDER_SOLIDS_H

#include "render/instances.h"

typedef struct render_solids {
    unsigned programs[6];
    render_shape block, piece, bowl;
    render_instances solids, rods;
} render_solids;

/* Start from {0}. */
skein_status render_solids_create(render_solids *solids, skein_error *error);
void render_solids_destroy(render_solids *solids);
skein_status render_solids_bring(render_solids *solids, const render_frame *frame, skein_error *error);

/* For a light's map; for the picture; and last of all in the picture. */
void render_solids_draw_depth(const render_solids *solids, const render_frame *frame);
void render_solids_draw(const render_solids *solids, const render_frame *frame);
void render_solids_draw_glass(const render_solids *solids, const render_frame *frame);

#endif
