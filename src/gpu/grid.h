/* The grid on the card: particles sorted into cells by counting, without the processor's help.
 *
 *   frame    one invocation: the box of all particles becomes cells, as many as there is room for
 *   count    each particle adds to its cell, and keeps the number that it got there
 *   sum up   cells become places, in three dispatches
 *   scatter  each particle's number goes to its place
 *   settle   within each cell particles are ordered by number, so that results repeat to the bit, and what neighbours
 *            read is copied in that order: the position, and the direction of flight in 32 bits
 *
 * The box is the one found while counting the last time: particles that have left it since are in cells at its sides,
 * where neighbours are still found. Cells are finer along x, where adjacent ones are one range. Particles that are not
 * finite come last, and are not searched. */
#ifndef SK_GPU_GRID_H
#define SK_GPU_GRID_H

#include "gpu/compose.h"

typedef struct sk_gpu_device sk_gpu_device;

enum { SK_GPU_GRID_BLOCK = 2, SK_GPU_GRID_PROGRAMS = 9 };

typedef struct sk_gpu_grid {
    unsigned program[SK_GPU_GRID_PROGRAMS];
    unsigned cells;         /* a head of 32 words, then the cells' counts, and later where they begin */
    unsigned number;        /* of particles: the one they got in their cell; later the particles in order */
    unsigned order;         /* the particles as they were scattered */
    unsigned position;      /* in order: x, y, z and the packed direction */
    unsigned texture;       /* the same, to read from */
    unsigned sums;          /* of 4,096 cells each */
    unsigned slot_of;       /* where particles are not in slots of their own number */
    size_t particles, room; /* for which it was made; cells at most, a multiple of 4,096 */
    size_t begin, end;      /* the particles whose box is known; none where both are 0 */
} sk_gpu_grid;

/* Makes buffers and programs for so many particles. */
skein_status sk_gpu_grid_make(sk_gpu_device *device, skein_world *world, skein_error *error);
void sk_gpu_grid_free(sk_gpu_device *device);
/* Fills the block of the grid's shaders: the particles of the op, and its radius, the least size of cells. */
void sk_gpu_grid_pack(const sk_gpu_grid *grid, const sk_op *op, float (*block)[4]);
/* Sorts `count` particles from `begin` on, with the block at this place of the device's blocks. */
void sk_gpu_grid_build(sk_gpu_device *device, size_t begin, size_t count, size_t block);
/* Binds the buffers that a search of the grid reads. */
void sk_gpu_grid_bind(const sk_gpu_grid *grid);

#endif
