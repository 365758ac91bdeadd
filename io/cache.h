/* Point caches that lead pins: a PC2 file becomes the places of a motion's track. Called by the scene reader. */
#ifndef SKEIN_IO_CACHE_H
#define SKEIN_IO_CACHE_H

#include "io/scene_settings.h"

typedef struct io_cache {
    skein_track track; /* into what follows */
    uint32_t *particles;
    double *places;
} io_cache;

/* Reads the file that the settings of a motion name ("file", beside the scene; "on", "fps"), for the pins of the body.
 * Its points are the body's vertices, its particles, or its pins in their order. Faults are reported; false then, and
 * nothing is to be freed. */
bool io_cache_read(io_cache *cache, skein_world *world, io_place place, const io_settings *settings);
void io_cache_free(io_cache *cache);

#endif
