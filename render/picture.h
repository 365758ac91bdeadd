/* One picture of a world, as a PNG: the whole way in one call; and the exporter "png" for it.
 *
 * Called by the command. Each call makes a context of its own and leaves nothing behind. */
#ifndef SKEIN_RENDER_PICTURE_H
#define SKEIN_RENDER_PICTURE_H

#include "render/view.h"
#include "skein/skein.h"

/* The fields of the exporter "png", and the options of a picture. */
typedef struct render_picture_options {
    int32_t size[2]; /* width and height, pixels */
    int32_t samples; /* a pixel; the driver may have fewer */
} render_picture_options;

/* 1280 x 720, 4 samples. */
render_picture_options render_default_picture_options(void);

/* Draws the world as it stands into a PNG at `path`. `options` and `view` NULL mean the
 * defaults. On failure there is no file, or the one that was there before. */
skein_status render_picture(skein_world *world, const char *path, const render_picture_options *options,
                            const render_view *view, skein_error *error);

/* The exporters that draw, `index` from 0; NULL past the end. Their parameters are laid out as
 * render_picture_options. */
const skein_kind *render_exporter_at(size_t index);

#endif
