/* Particles sorted into fine cells, with positions and directions of flight copied in the order of the cells: for
 * rules that look at every neighbour sixteen at a time.
 *
 *     y  +---+---+---+---+---+---+   a cell is as wide as the reach along y and z, and a quarter of it along x;
 *     ^  |   | : | : | : | : |   |   cells along x are consecutive, so that what a particle can reach in a row of
 *     |  |   | : | : o : | : |   |   them is one range of memory, trimmed to the reach: nine ranges in all
 *     z x+---+---+---+---+---+---+
 *
 *   start:          [0 . . 2 . 5 . . .]     particles of cell c are at places start[c] .. start[c + 1]
 *   record:         [3 7 | 1 4 9 | ...]     by place: the whole of a particle, in one piece, for it is put there at
 * random x, y, z:        [ . . | . . . | ...]    by place: positions ux, uy, uz:     [ . . | . . . | ...]    unit
 * velocities (0 for one that stands still)
 *
 * A counting sort; see plan/sort.h for its rows. Within a cell particles stand in the user's order, so that sums over
 * neighbours come out the same. Owned by the world, filled by rows of the plan. */
#ifndef SK_SPACE_CELLS_H
#define SK_SPACE_CELLS_H

#include "base/layout.h"
#include "base/memory.h"
#include "base/vector.h"

enum { SK_CELLS_ACROSS = 4 }; /* cells along x in the width of one along y */

/* A particle at its place. */
typedef struct sk_cell_record {
    real x, y, z;
    union {
        real w;
        uint32_t slot;
    };
    real vx, vy, vz;
    union {
        real vw;
        uint32_t particle; /* the user's index */
    };
} sk_cell_record;

typedef struct sk_cells {
    sk_vec3 origin;
    real size;  /* along y and z: at least the radius asked for */
    real per_x; /* cells a metre along x; along y and z 1/size */
    real per_yz;
    real slack; /* rounding of a place in cells, along the longest axis */
    int32_t count_x, count_y, count_z;
    uint32_t *start; /* cells + 1, and one more while sorting */
    real *x, *y, *z, *ux, *uy, *uz;
    sk_cell_record *record;
    uint32_t *place; /* by the user's index from `first` on: the cell, then the place; SK_NOWHERE if not finite */
    size_t start_capacity, copy_capacity[6], record_capacity, place_capacity;
    size_t first, end; /* the user's indices that are sorted */
    size_t count;      /* of them in cells */
} sk_cells;

#define SK_NOWHERE UINT32_MAX
/* Whoever has a coordinate farther out is nowhere: the size of a box of others is finite. */
#define SK_CELLS_FARTHEST (SK_REAL_MAX / 4)

/* Where the state is; see particles.h. Slots [0, packed) are in packed blocks. */
typedef struct sk_state {
    const sk_vec4 *x, *v;
    size_t packed;
    const uint32_t *slot_of;
} sk_state;

/* Memory for sorting so many particles, wherever they are: a step in which they were reserved needs no more. False
 * when there is none. */
bool sk_cells_reserve(sk_cells *cells, sk_allocator *allocator, size_t count);
/* The frame of cells of at least `radius` around particles [first, end), and memory for them. Where they are spread
 * so far that there would be many more cells than particles, the cells are made larger. False when there is no
 * memory: nobody is in a cell then. */
bool sk_cells_frame(sk_cells *cells, sk_allocator *allocator, const sk_state *state, size_t first, size_t end,
                    real radius);
/* The same where the box around them is known; a point where nobody is finite. */
bool sk_cells_frame_box(sk_cells *cells, sk_allocator *allocator, sk_vec3 low, sk_vec3 high, size_t first, size_t end,
                        real radius);
/* Finds the cell of each of the particles [begin, end); any cut over threads will do. */
void sk_cells_find(sk_cells *cells, const sk_state *state, size_t begin, size_t end);
/* Gives each of them its place in the order of cells. */
void sk_cells_rank(sk_cells *cells);
/* Writes the records of [begin, end) to their places; any cut will do. */
void sk_cells_scatter(sk_cells *cells, const sk_state *state, size_t begin, size_t end);
void sk_cells_release(sk_cells *cells, sk_allocator *allocator);

/* A coordinate in cells, clamped into [0, count). It never falls where the coordinate grows. */
static inline int32_t sk_cells_place(real at, real origin, real per, int32_t count) {
    real place = (at - origin) * per;
    return place > 0 ? place < (real)count ? (int32_t)place : count - 1 : 0;
}

/* The ranges of places that a ball of `reach` (at most the radius) around a point may touch; their number comes back.
 * Each is begin, end; there may be strangers in them, and nobody within reach is left out. */
static inline int sk_cells_ranges(const sk_cells *cells, sk_vec3 p, real reach, uint32_t (*range)[2]) {
    int32_t iy = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
    int32_t iz = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
    // how far the walls of the cell are, a little less for rounding
    real fy = (p.y - cells->origin.y) * cells->per_yz - (real)iy,
         fz = (p.z - cells->origin.z) * cells->per_yz - (real)iz;
    real to_y[3] = {fy - cells->slack, 0, 1 - fy - cells->slack},
         to_z[3] = {fz - cells->slack, 0, 1 - fz - cells->slack};
    int count = 0;
    for (int32_t dz = -1; dz <= 1; dz++) {
        if (iz + dz < 0 || iz + dz >= cells->count_z) continue;
        real mz = sk_max(to_z[dz + 1], 0) * cells->size, left_z = reach * reach - mz * mz;
        for (int32_t dy = -1; dy <= 1; dy++) {
            if (iy + dy < 0 || iy + dy >= cells->count_y) continue;
            real my = sk_max(to_y[dy + 1], 0) * cells->size, left = left_z - my * my;
            if (!(left > 0)) continue;
            real half = sk_sqrt(left) * (real)1.00001;
            int32_t x0 = sk_cells_place(p.x - half, cells->origin.x, cells->per_x, cells->count_x);
            int32_t x1 = sk_cells_place(p.x + half, cells->origin.x, cells->per_x, cells->count_x);
            const uint32_t *line = cells->start + (size_t)cells->count_x *
                                                      ((size_t)(iy + dy) + (size_t)cells->count_y * (size_t)(iz + dz));
            range[count][0] = line[x0];
            range[count][1] = line[x1 + 1];
            count += range[count][0] < range[count][1];
        }
    }
    return count;
}

#endif
