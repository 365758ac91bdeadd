/* A picture on the card to draw into: multisampled, with depth, and resolved for reading.
 *
 * Made by picture.c, by films and by the window, which copies from it. Invariant: colours are kept
 * as sRGB, so that samples are averaged as light. */
#ifndef SKEIN_RENDER_TARGET_H
#define SKEIN_RENDER_TARGET_H

#include "render/image.h"

typedef struct render_target {
    int width, height;
    int samples;                         /* as the driver gave them */
    unsigned framebuffer, colour, depth; /* drawn into */
    unsigned plain_framebuffer, plain;   /* one sample a pixel */
} render_target;

/* As many samples a pixel as asked for, or the most the driver has below that. Start from {0}. */
skein_status render_target_create(render_target *target, int width, int height, int samples, skein_error *error);
void render_target_destroy(render_target *target); /* one that was never created is allowed */

/* Averages the samples, then brings the picture into memory. */
skein_status render_target_read(const render_target *target, render_image *image, skein_error *error);

#endif
