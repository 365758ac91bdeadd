/* Finding the grid in a mesh of quads, however its vertices are numbered and whatever is missing of it. */
#ifndef SK_BODIES_QUADS_H
#define SK_BODIES_QUADS_H

#include "bodies/sheet.h"
#include "bodies/springs.h"

/* A grid's rows and columns, and each particle's place in it: row x columns + column. */
typedef struct sk_quad_grid {
    uint32_t rows, columns; /* 0: the mesh is no grid */
    uint32_t *place;        /* of each particle; the caller releases it */
} sk_quad_grid;

/* Walks from quad to quad. The mesh is a grid if all faces are quads, hang together, close to no ring and fill
 * at least half of their rows and columns; pinned particles come to lie in the first rows. False when there is
 * no memory. */
bool sk_quads_find(const sk_sheet *sheet, const sk_springs *springs, const bool *pinned, sk_quad_grid *grid);

#endif
