/* The names by which rules and motions of a scene say whom they mean: each that nobody has is a fault, so that one look at a scene
 * tells of all. (The library finds the first of them when a step is planned.) Between the files of the scene reader only. */
#ifndef SKEIN_IO_SCENE_NAMES_H
#define SKEIN_IO_SCENE_NAMES_H

#include "io/scene_settings.h"

/* Whether all of a category are in the world. Where one had a fault of its own, a name that nobody has may be that one's, and is none. */
typedef struct io_names_whole {
    bool bodies, colliders;
} io_names_whole;
/* Of an object of a kind, whose settings have been read: whom it names is in the world before it. */
void io_names_check(io_place place, const skein_world *world, const skein_kind *kind, const io_settings *settings,
                    io_names_whole whole);

#endif
