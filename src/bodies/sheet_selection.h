/* The words of a sheet's selection (selection.h):
 *
 *   [top | bottom | left | right] corners | edge;  corners;  border;  all
 *
 * On a grid, "top" is the first row and "left" the first column. On a mesh the border is what has one
 * face only, corners are where the border turns by more than 45 degrees, top is the greatest y and left
 * the least x as placed; a mesh without such a thing is an error that says so. Numbers are vertices. */
#ifndef SK_BODIES_SHEET_SELECTION_H
#define SK_BODIES_SHEET_SELECTION_H

#include "bodies/sheet.h"
#include "bodies/springs.h"

/* Sets chosen[particle] for each particle that the text names. `where` is the field's name for errors. */
skein_status sk_sheet_select(const char *text, const sk_sheet *sheet, const sk_springs *springs, const char *where,
                             bool *chosen, skein_error *error);

/* The words alone, for a sheet of which there are its particles' positions, its faces of particles, and, of a grid, its
 * vertices. */
skein_status sk_sheet_choose_words(const char *words, const sk_sheet *sheet, const sk_springs *springs,
                                   const char *where, bool *chosen, skein_error *error);

#endif
