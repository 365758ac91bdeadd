/* Coarse grids: some rows and columns of a grid of particles in strips, whose distances are held before all else in a
 * substep. What they moved is carried to those between them, as a net that is pulled into shape takes its cloth along:
 *
 *     o . . . o . . . o      o: in the grid; each . gets what the four around it moved, by its place between them
 *     . . . . . . . . .      (beyond the last ones, what the nearest did)
 *     o . . . o . . . o
 *
 * So a few sweeps over few particles bring a correction across a large sheet. Carried linearly, since steps between
 * neighbours would be torn open again; and as a distance shares its correction out by the masses that are carried along
 * (coarse_distance.c), nothing gains momentum by it. */
#ifndef SK_CONSTRAINTS_COARSE_H
#define SK_CONSTRAINTS_COARSE_H

#include "plan/op.h"

/* Rows row_first, row_first + row_step ... and of each strip the columns `first`, first + step ... */
typedef struct sk_coarse_grid {
    uint32_t row_first, row_step, first, step;
} sk_coarse_grid;

typedef struct sk_coarse {
    sk_coarse_grid grid, finer; /* the particles in it, and those who get what they moved */
    uint32_t columns;           /* of all particles */
    bool carries;
    int times; /* its distances are swept, forth and back in turn */
} sk_coarse;

/* How many of a strip's `across` columns are in the grid, and how many of all rows. */
static inline size_t sk_coarse_columns(const sk_coarse_grid *grid, size_t across) {
    return (across - grid->first + grid->step - 1) / grid->step;
}
static inline size_t sk_coarse_rows(const sk_coarse_grid *grid, size_t rows) {
    return (rows - grid->row_first + grid->row_step - 1) / grid->row_step;
}
/* How many strip rows an element of a row that carries takes in, besides its own. */
static inline size_t sk_coarse_reach(const sk_coarse *coarse) {
    return (size_t)coarse->grid.row_first + coarse->grid.row_step;
}

/* X += what the coarse grid's particles around have moved: since they were where they are going, X0; or, with the substep
 * as second coefficient, since X0 + h V. The rule is an sk_coarse, an element a strip row of the walk. */
extern const sk_kernels sk_coarse_carry;

#endif
