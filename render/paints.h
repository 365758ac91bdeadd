/* What surfaces are painted with: the textures (colour maps, a frame's image) and the materials' uniforms.
 *
 * Called by draw.c. An image goes to the card once, until the frame has another. */
#ifndef SKEIN_RENDER_PAINTS_H
#define SKEIN_RENDER_PAINTS_H

#include "render/frame.h"
#include "skein/skein.h"

/* Start from {0}. */
typedef struct render_paints {
    unsigned maps, image;
    uint64_t image_number; /* of the frame's image that is there */
} render_paints;

void render_paints_create(render_paints *paints);
void render_paints_destroy(render_paints *paints);
/* Brings a new image to the card; fails where it is larger than the driver can have. */
skein_status render_paints_bring(render_paints *paints, const render_frame *frame, skein_error *error);
/* Binds unit 3 to the colour maps, unit 4 to the image. */
void render_paints_bind(const render_paints *paints);
/* Sets the uniforms of surface.frag.glsl that say how a surface is painted. */
void render_set_material(unsigned program, const render_surface *surface);

#endif
