/* The few functions that we take from stb (public domain), so that its headers stay in stb.c.
 *
 * Called by image.c only. What they return is freed with free(). */
#ifndef SKEIN_RENDER_STB_H
#define SKEIN_RENDER_STB_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A PNG of an RGB image, in memory; NULL when there is too little of it. */
uint8_t *render_stb_encode_png(const uint8_t *pixels, int width, int height, int *length);
/* The size that a picture file says it has, without unpacking it; false and a word on what is wrong with it. Leaves the
 * file where it was. */
bool render_stb_measure(FILE *file, int *width, int *height, const char **problem);
/* An RGB image from a picture file; NULL and a word on what is wrong with it. */
uint8_t *render_stb_decode(FILE *file, int *width, int *height, const char **problem);

#endif
