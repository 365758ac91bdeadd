/* Selections: naming particles of a sheet in one line of text.
 *
 *   "top corners"             words: [top | bottom | left | right] corners | edge;  corners;  border;  all
 *   "0 16 288"                vertices by number (negative: from the end)
 *   "box -1 0 -1  1 2 1"      all in a box, two corners
 *   "sphere 0 1 0  0.3"       all within a radius of a centre
 *   "top corners, 144"        several, separated by commas
 *
 * On a grid, "top" is the first row and "left" the first column. On a mesh the border is what has one
 * face only, corners are where the border turns by more than 45 degrees, top is the greatest y and left
 * the least x as placed; a mesh without such a thing is an error that says so. */
#ifndef SK_BODIES_SELECTION_H
#define SK_BODIES_SELECTION_H

#include "bodies/sheet.h"
#include "bodies/springs.h"

/* Sets chosen[particle] for each particle that the text names. `where` is the field's name for errors. */
skein_status sk_selection_apply(const char *text, const sk_sheet *sheet, const sk_springs *springs, const char *where,
                                bool *chosen, skein_error *error);

#endif
