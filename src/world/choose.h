/* Choosing particles by a text (world/motions.c). */
#ifndef SK_WORLD_CHOOSE_H
#define SK_WORLD_CHOOSE_H

#include "world/world.h"

/* Marks those of the particles [first, first + count) that a text names (particles/selection.h), of a body or, with NULL, of all. */
skein_status sk_world_choose(skein_world *world, const sk_body *body, size_t first, size_t count, const char *text,
                             bool *chosen, skein_error *error);

/* Marks those of a body's particles that words name, "top edge", as they do in its `pins`; `position` is where they were
 * built. Of bodies/words.c, which knows the kinds. */
skein_status sk_body_choose_words(skein_world *world, const sk_body *body, double (*position)[3], const char *words,
                                  bool *chosen, skein_error *error);

#endif
