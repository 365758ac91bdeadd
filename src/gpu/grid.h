/* The grid on the card: particles sorted into cells by counting, without the processor's help.
 *
 *   frame    one invocation: the box of all particles becomes cells, as many as there is room for
 *   count    each particle adds to its cell, and keeps the number that it got there
 *   sum up   cells become places, in three dispatches
 *   scatter  each particle's number goes to its place
 *   settle   within each cell the places are given by the particles' numbers, so that the bits repeat, and what
 *            neighbours look at is copied in that order: the position, and the direction of flight in 32
 *            bits
 *
 * The box is the one that was found while counting the last time: who has left it since is in a cell at its side,
 * and still no farther in cells from its neighbours. Cells are finer along x, where those beside each other are one
 * range. Particles that are not finite come last, where nobody looks. */
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
/* What the grid's shaders are told: the particles of the op, and cells of at least its radius. */
void sk_gpu_grid_pack(const sk_gpu_grid *grid, const sk_op *op, float (*block)[4]);
/* Sorts so many particles, with the block at this place of the device's blocks. */
void sk_gpu_grid_build(sk_gpu_device *device, size_t begin, size_t count, size_t block);
/* Binds what a walk along the grid reads. */
void sk_gpu_grid_bind(const sk_gpu_grid *grid);

#endif
