/* A uniform grid over particles: who is near whom. One grid serves all neighbour rules.
 *
 *   cell_start:  [0 . . 2 . 5 . . .]      particles of cell c stand at
 *   slot:        [3 7 | 1 4 9 | ...]      slot[cell_start[c] .. cell_start[c + 1])
 *   position:    the same order, copied so that a search reads memory in a row
 *
 * Built by a counting sort: within a cell particles stand in the user's order, whatever their slots,
 * so that sums over neighbours come out the same. Cells along x are consecutive: the three cells
 * beside each other are one range. */
#ifndef SK_SPACE_GRID_H
#define SK_SPACE_GRID_H

#include "base/memory.h"
#include "base/vector.h"

typedef struct sk_grid {
    real cell_size; /* at least the radius asked for */
    sk_vec3 origin;
    int32_t cells_x, cells_y, cells_z;
    uint32_t *cell_start; /* cells + 1 */
    size_t cell_start_capacity;
    uint32_t *slot;
    sk_vec4 *position;
    uint32_t *cell_of; /* of the i-th particle in the user's order; SK_NO_CELL if not finite */
    size_t slot_capacity, position_capacity, cell_of_capacity;
    size_t count; /* particles in the grid */
} sk_grid;

#define SK_NO_CELL UINT32_MAX

/* Memory for sorting so many particles. False when there is none. */
bool sk_grid_reserve(sk_grid *grid, sk_allocator *allocator, size_t count);
/* Sorts `count` particles into cells of at least `radius`. Where the particles are spread so far that
 * the cells would outnumber them fourfold, the cells are made larger. False when there is no memory: the
 * grid is then empty. Slots [0, packed) are in packed blocks. */
bool sk_grid_build(sk_grid *grid, sk_allocator *allocator, const sk_vec4 *positions, size_t packed,
                   const uint32_t *slot_of, size_t count, real radius);
void sk_grid_release(sk_grid *grid, sk_allocator *allocator);

/* The cell's place along an axis, clamped into the grid. */
static inline int32_t sk_grid_place(real x, real origin, real cell_size, int32_t cells) {
    real place = (x - origin) / cell_size;
    return place < 0 ? 0 : place >= (real)cells ? cells - 1 : (int32_t)place;
}

#endif
