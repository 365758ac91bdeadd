/* The lines of a grid: its rows and columns of particles, wherever a sheet lies in strips.
 *
 *     o---o---o---o     cells    the faces between four places, some of which may be missing
 *     | A | B |   |     lines    three places in a row that have cells beside them: what bends
 *     o---o---o---o     spans    particles some edges apart along a row or column: what gets no longer
 */
#ifndef SK_BODIES_LINES_H
#define SK_BODIES_LINES_H

#include "bodies/body.h"
#include "bodies/quads.h"

typedef struct sk_lines {
    sk_allocator *allocator;
    const sk_sheet *sheet;
    uint32_t rows, columns;
    uint32_t *particle; /* at each place; UINT32_MAX: nobody */
    double *area;       /* of the cell whose lowest corner is at each place; 0: none */
    bool flat;          /* all of the sheet is rectangles in one plane, in straight lines; */
    bool even;          /* and its triangles cut them all along the same diagonal */
    bool cut[2];        /* some do along this one, and along the other */
} sk_lines;

/* `place` as in sk_quad_grid; NULL: each particle's own number. False when there is no memory. */
bool sk_lines_find(sk_lines *lines, const sk_sheet *sheet, uint32_t rows, uint32_t columns, const uint32_t *place);
void sk_lines_release(sk_lines *lines);

/* Bending of a flat sheet of rigidity B: energy B (a^2 + b^2 + 2 c^2)/2 a square metre, with a and b its curvatures along
 * rows and columns and c its twist, which is B kappa^2/2 whichever way it is rolled up. */
skein_status sk_lines_add_bending(const sk_lines *lines, skein_world *world, sk_body *body, double rigidity,
                                  skein_error *error);
/* Length of the edge from a place to the next one along its row or column; 0 where no cell is beside it. */
double sk_lines_edge(const sk_lines *lines, size_t row, size_t column, bool along_column);
/* Whether edges along rows are, in the mean, about as long as those along columns. */
bool sk_lines_square(const sk_lines *lines);
/* Bounds on how far particles get from others of their row and column, which the body's tether bound holds. */
skein_status sk_lines_add_spans(const sk_lines *lines, skein_world *world, sk_body *body, skein_error *error);

#endif
