/* Selections: naming particles of a body in one line of text.
 *
 *   "0 16 288"                by number (negative: from the end)
 *   "box -1 0 -1  1 2 1"      all in a box, two corners
 *   "sphere 0 1 0  0.3"       all within a radius of a centre
 *   "top corners"             words: what they mean is the body's matter (bodies/)
 *   "top corners, 144"        several, separated by commas */
#ifndef SK_PARTICLES_SELECTION_H
#define SK_PARTICLES_SELECTION_H

#include "base/memory.h"

/* What can be selected from. */
typedef struct sk_selectable {
    sk_allocator *allocator;
    double (*position)[3]; /* of particles */
    size_t particle_count;
    const uint32_t *particle_of_number; /* what a number means; NULL: the particle itself */
    size_t number_count;
    const char *number_means, *whole; /* "vertex" of "the mesh", for messages */
    /* Chooses all that the words name. */
    skein_status (*choose_words)(void *data, const char *words);
    void *data;
} sk_selectable;

/* Sets chosen[particle] for each particle that the text names. `where` is the field's name for errors. */
skein_status sk_selection_apply(const char *text, const sk_selectable *of, const char *where, bool *chosen,
                                skein_error *error);

#endif
