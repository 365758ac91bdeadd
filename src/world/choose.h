/* Choosing particles by a text (world/motions.c). */
#ifndef SK_WORLD_CHOOSE_H
#define SK_WORLD_CHOOSE_H

#include "world/world.h"

/* Marks those of the particles [first, first + count) that a text names (particles/selection.h), of a body or, with NULL, of all. */
skein_status sk_world_choose(skein_world *world, const sk_body *body, size_t first, size_t count, const char *text, bool *chosen,
                             skein_error *error);

#endif
