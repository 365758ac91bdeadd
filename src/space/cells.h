/* Particles sorted into fine cells, with positions and directions of flight copied in the order of the cells: for
 * rules that read all neighbours, sixteen at a time.
 *
 *     y  +---+---+---+---+---+---+   a cell is as wide as the reach along y and z, and a quarter of it along x;
 *     ^  |   | : | : | : | : |   |   cells along x are consecutive, so that what a particle can reach in a line of
 *     |  |   | : | : o : | : |   |   them is one range of memory, trimmed to the reach: nine ranges in all
 *     z x+---+---+---+---+---+---+
 *
 *   start:                 [0 . . 2 . 5 . . .]     particles of cell c are at places start[c] .. start[c + 1]
 *   slot:                  [3 7 | 1 4 9 | ...]     by place: the particle's slot
 *   x, y, z, ux, uy, uz:   [. . | . . . | ...]     by place: positions, and unit velocities (0 for a particle at rest)
 *
 * Lines are stored in layers of eight along y (one layer if they are few), each layer through all z before the next:
 * a loop over places finds the lines around it in the second-level cache, however many there are.
 *
 * A counting sort over slots; see plan/sort.h for its ops. Within a cell particles are in the user's order, wherever
 * their slots are, so that sums over neighbours have the same bits. Owned by the world, filled by ops of the plan. */
#ifndef SK_SPACE_CELLS_H
#define SK_SPACE_CELLS_H

#include "base/layout.h"
#include "base/memory.h"
#include "base/vector.h"

enum { SK_CELLS_ACROSS = 4 }; /* a cell's width along y over that along x */

/* Particles of one body, or all: the user's indices, and the range of their slots (which in cells may also hold others,
 * which are skipped). */
typedef struct sk_group {
    size_t first, end;           /* particles */
    size_t first_slot, end_slot; /* not always multiples of 16 */
    size_t out;                  /* how many of them take no part, and so are in no cell */
} sk_group;

/* A body that a rule acts on: its particles, their slots (which hold no others), and its triangles among those that
 * take part. */
typedef struct sk_span_of_body {
    size_t first, end, first_slot, end_slot, first_triangle, end_triangle;
} sk_span_of_body;

/* What a rule acts on: all particles, or some bodies (perhaps none that is present), by their slots. */
typedef struct sk_only {
    bool some;
    sk_span_of_body *data;
    size_t count, capacity;
} sk_only;

static inline bool sk_only_has(const sk_only *only, size_t particle) {
    for (size_t i = 0; i < only->count; i++)
        if (particle >= only->data[i].first && particle < only->data[i].end) return true;
    return !only->some;
}

static inline bool sk_only_has_slot(const sk_only *only, size_t slot) {
    for (size_t i = 0; i < only->count; i++)
        if (slot >= only->data[i].first_slot && slot < only->data[i].end_slot) return true;
    return !only->some;
}

typedef struct sk_cells {
    sk_vec3 origin;
    real size;  /* along y and z: at least the radius asked for */
    real per_x; /* cells a metre along x; along y and z 1/size */
    real per_yz;
    real slack; /* rounding of a place in cells, along the longest axis */
    int32_t count_x, count_y, count_z;
    int32_t layer;   /* lines along y in a layer; a power of 2, or count_y or more */
    int32_t layer_y; /* the bits of y that are the line within its layer */
    int32_t shift_y; /* the other bits, shifted by this, are the layer */
    uint32_t *start; /* cells + 1, and one more while sorting */
    real *x, *y, *z, *ux, *uy, *uz;
    uint32_t *slot;
    uint32_t *cell; /* by slot, from the group's first on; SK_NOWHERE if it is empty, not the group's, or not finite */
    size_t start_capacity, copy_capacity[6], slot_capacity, cell_capacity;
    sk_group group; /* the particles that are sorted */
    size_t count;   /* how many of them are in cells */
    bool in_order;  /* slots are in the user's order, so that members of cells need no sorting. False is always safe */
} sk_cells;

#define SK_NOWHERE UINT32_MAX
#define SK_NOBODY UINT32_MAX /* the particle of an empty slot */
/* Particles with a coordinate farther out are in no cell, so that the size of the box of the others is finite. */
#define SK_CELLS_FARTHEST (SK_REAL_MAX / 4)

/* Where the state is; see particles.h. Slots [0, packed) are in packed blocks. */
typedef struct sk_state {
    const sk_vec4 *x, *v;
    size_t packed;
    const uint32_t *particle_of;
} sk_state;

/* Reserves memory for sorting these particles wherever they are, so that a step allocates nothing. False: no memory. */
bool sk_cells_reserve(sk_cells *cells, sk_allocator *allocator, const sk_group *group);
/* Frames cells of at least `radius` around the particles, and reserves their memory. Cells are made larger if there
 * would be many more of them than particles. False when there is no memory: no particle is in a cell then. */
bool sk_cells_frame(sk_cells *cells, sk_allocator *allocator, const sk_state *state, const sk_group *group, real radius);
/* The same for a known box around them; a point if no particle is finite. */
bool sk_cells_frame_box(sk_cells *cells, sk_allocator *allocator, sk_vec3 low, sk_vec3 high, const sk_group *group,
                        real radius);
/* Finds the cells of the particles in slots [begin, end) of the group; any division among threads is allowed. */
void sk_cells_find(sk_cells *cells, const sk_state *state, size_t begin, size_t end);
/* Gives every particle a place in the order of cells. */
void sk_cells_rank(sk_cells *cells);
/* Puts members of the cells that begin at places [begin, end) in the user's order, and returns the places of these
 * cells. Any division of all places among threads is allowed, and leaves none out. */
void sk_cells_settle(sk_cells *cells, const sk_state *state, size_t begin, size_t end, size_t *first, size_t *last);
/* Copies positions and directions of flight to places [begin, end). */
void sk_cells_copy(sk_cells *cells, const sk_state *state, size_t begin, size_t end);
/* All of it, on the caller's thread. */
bool sk_cells_sort(sk_cells *cells, sk_allocator *allocator, const sk_state *state, const sk_group *group, real radius);
void sk_cells_release(sk_cells *cells, sk_allocator *allocator);

/* The first cell of the line at (y, z). */
static inline int32_t sk_cells_line(const sk_cells *cells, int32_t y, int32_t z) {
    return cells->count_x * ((y & cells->layer_y) + cells->layer * (z + cells->count_z * (y >> cells->shift_y)));
}

/* The cell of a coordinate, clamped to [0, count). It grows monotonically with the coordinate. */
static inline int32_t sk_cells_place(real at, real origin, real per, int32_t count) {
    real place = (at - origin) * per;
    return place > 0 ? place < (real)count ? (int32_t)place : count - 1 : 0;
}

/* Finds the ranges of places, each begin and end, that a ball of radius `reach` (at most the cells' radius) around a
 * point may touch, and returns how many. They contain all particles within reach, and perhaps others. */
static inline int sk_cells_ranges(const sk_cells *cells, sk_vec3 p, real reach, uint32_t (*range)[2]) {
    int32_t iy = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
    int32_t iz = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
    // the distances to the walls of the cell, a little less to allow for rounding
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
            const uint32_t *line = cells->start + sk_cells_line(cells, iy + dy, iz + dz);
            range[count][0] = line[x0];
            range[count][1] = line[x1 + 1];
            count += range[count][0] < range[count][1];
        }
    }
    return count;
}

#endif
