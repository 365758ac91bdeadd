/* The coarse grids of a cloth that is a whole grid (constraints/coarse.h says what they do): each has half the rows and
 * columns of the one before it, and holds the distances to the neighbours along both; the coarsest one, which reaches across
 * the sheet, those to the fifth one besides, and its own tethers. */
#ifndef SK_BODIES_COARSE_H
#define SK_BODIES_COARSE_H

#include "bodies/body.h"
#include "bodies/lines.h"

/* Whether a grid would have coarse ones if its rows were columns, and has none as it is. */
bool sk_coarse_fits_across(uint32_t rows, uint32_t columns);
/* Whether there are particles at all places, with cells between all of them, and enough for a coarse grid; and whether it is even: with
 * uneven cells, or triangles that cut them along either diagonal, coarse grids shake what they hold. 61 x 61 by four corners had 45 % with
 * diagonals by chance, 108 with every second one the other way, 38 with uneven cells besides, and has 0.7 to 5 with spans. */
bool sk_coarse_fits(const sk_lines *lines);
/* Bounds that the body's tether bound holds. `mass` of each particle; *coarsest receives the coarsest grid. */
skein_status sk_coarse_add(const sk_lines *lines, const double *mass, skein_world *world, sk_body *body,
                           sk_coarse_grid *coarsest, skein_error *error);
/* Whether a particle, the body's first being 0, is in the grid. */
bool sk_coarse_has(const sk_coarse_grid *grid, const sk_lines *lines, uint32_t particle);

#endif
