/* The module "film": what needs libav, which takes longer to load than all the rest of the command. */
#include <libavcodec/avcodec.h>

#include "film/maker.h"
#include "io/module.h"

static bool has_encoder(const char *name) {
    return avcodec_find_encoder_by_name(name) != NULL;
}

static const film_libav libav = {&film_video, &film_gif, has_encoder};

IO_MODULE(&libav);
