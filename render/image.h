/* Pictures in memory and as PNG files.
 *
 * Filled by target.c, written by picture.c, read back by tests. Invariant: a file that was asked for
 * either holds the whole picture afterwards, or is as it was before. */
#ifndef SKEIN_RENDER_IMAGE_H
#define SKEIN_RENDER_IMAGE_H

#include "skein/skein.h"

/* Eight-bit sRGB, rows from the top, three bytes a pixel without gaps. */
typedef struct render_image {
    int width, height;
    uint8_t *pixels;
} render_image;

/* Gives the image room for width x height pixels; what it held is gone. Start from {0}. */
skein_status render_image_resize(render_image *image, int width, int height, skein_error *error);
void render_image_release(render_image *image);
/* The three bytes of a pixel; x from the left, y from the top. */
const uint8_t *render_image_pixel(const render_image *image, int x, int y);

/* Writes a PNG: into a new file beside `path`, renamed when all is on the disk. A path that names a
 * device or a pipe is written straight. */
skein_status render_image_write_png(const render_image *image, const char *path, skein_error *error);
/* Reads a PNG or JPEG (as colours, without its alpha) into an image. What is no file is refused, and so is a picture of
 * more pixels: a small file can hold a very large one, and unpacking takes up to nine bytes for each. */
enum { RENDER_IMAGE_MOST_PIXELS = 1 << 25 }; /* 8192 x 4096 */
skein_status render_image_read(render_image *image, const char *path, skein_error *error);

#endif
