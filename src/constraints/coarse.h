/* Coarse grids: some rows and columns of a grid of particles in strips, whose distances are projected first in a
 * substep. The displacements of their particles are interpolated to the particles between:
 *
 *     o . . . o . . . o      o: in the coarse grid; each . gets the bilinear interpolation of the four around it
 *     . . . . . . . . .      (beyond the last ones, the displacement of the nearest)
 *     o . . . o . . . o
 *
 * So a few sweeps over few particles bring a correction across a large sheet. The interpolation is continuous, for
 * jumps between neighbours would be undone by their edges. A distance divides its correction by the masses that are
 * carried along (coarse_distance.c), so that momentum is conserved. */
#ifndef SK_CONSTRAINTS_COARSE_H
#define SK_CONSTRAINTS_COARSE_H

#include "plan/op.h"

/* Rows row_first, row_first + row_step ..., and in each strip the columns `first`, first + step ... */
typedef struct sk_coarse_grid {
    uint32_t row_first, row_step, first, step;
} sk_coarse_grid;

typedef struct sk_coarse {
    sk_coarse_grid grid, finer; /* its particles, and those that their displacements are carried to */
    uint32_t columns;           /* of all particles */
    bool carries;
    int times; /* how often its distances are swept, forward and backward in turn */
} sk_coarse;

/* How many of a strip's `across` columns are in the grid, and how many of all rows. */
static inline size_t sk_coarse_columns(const sk_coarse_grid *grid, size_t across) {
    return (across - grid->first + grid->step - 1) / grid->step;
}
static inline size_t sk_coarse_rows(const sk_coarse_grid *grid, size_t rows) {
    return (rows - grid->row_first + grid->row_step - 1) / grid->row_step;
}
/* How many strip rows an element of the carrying op reaches beyond its own. */
static inline size_t sk_coarse_reach(const sk_coarse *coarse) {
    return (size_t)coarse->grid.row_first + coarse->grid.row_step;
}

/* X += the interpolated displacements of the coarse grid's particles from the prediction: from X0, or from X0 + h V if
 * the second coefficient is h. The rule is an sk_coarse; an element is a strip row of the walk. */
extern const sk_kernels sk_coarse_carry;

#endif
