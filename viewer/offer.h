/* A formula's text that names what is not there: shown with a mark under the place, and where a parameter of that name would
 * mend it, made by one button; it has a slider then. For any object whose kind takes parameters, by its table of fields.
 * Called by the stage's files, on the stage's thread. */
#ifndef SKEIN_VIEWER_OFFER_H
#define SKEIN_VIEWER_OFFER_H

#include <stdbool.h>
#include <stddef.h>

#include "skein/skein.h"

enum { VIEWER_OFFER_NAMES = 8 };

typedef struct viewer_stage viewer_stage;

typedef struct viewer_offer {
    bool any; /* there is a text that was not taken */
    skein_category category;
    size_t index;
    char field[64], text[1024], line[400]; /* line: that the fault is in */
    size_t column, width;                  /* of the fault, from 1; 0: nobody knows */
    char names[VIEWER_OFFER_NAMES][64];    /* that would have to be parameters */
    size_t name_count;
} viewer_offer;

/* Looks at a text that an object's field did not take. */
void viewer_offer_look(viewer_stage *stage, skein_category category, size_t index, const skein_field *field,
                       const char *text);
/* Makes the parameters, each 1, and the object anew with them and the text, where the scene stands: one change. */
void viewer_offer_take(viewer_stage *stage);
void viewer_offer_forget(viewer_stage *stage);

#endif
