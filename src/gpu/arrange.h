/* Where particles lie on the card: in the world's slots, or, after a while, in the order of the grid's cells.
 *
 * If neighbours in space are neighbours in memory, sorting and all that a pass in the order of cells loads and stores
 * for its own particle go through memory in order. So every few steps the state is moved into the order that the grid
 * has found. That is possible if all rules act on all particles and particle i is in slot i, for then no rule depends
 * on slots; `home` says which particle lies where. What is read back is in the world's slots again.
 *
 * Called by device.c. Uses the grid's buffers, which hold nothing between steps. */
#ifndef SK_GPU_ARRANGE_H
#define SK_GPU_ARRANGE_H

#include "gpu/compose.h"

typedef struct sk_gpu_device sk_gpu_device;

enum { SK_GPU_ARRANGE_PROGRAMS = 5 };

typedef struct sk_gpu_arrangement {
    unsigned program[SK_GPU_ARRANGE_PROGRAMS];
    unsigned home; /* a buffer: the particle in each slot; 0 if there is none */
    size_t count;  /* the number of particles that it was made for */
    size_t steps;  /* since the state was moved */
    bool possible; /* under the present plan */
    bool moved;    /* particles are not in the world's slots */
} sk_gpu_arrangement;

/* Finds whether the plan allows it, and makes what it needs. A state that has been moved must have been fetched. */
skein_status sk_gpu_arrange_make(sk_gpu_device *device, skein_world *world, skein_error *error);
void sk_gpu_arrange_free(sk_gpu_device *device);
/* To be called when the state has been written, and so is in the world's slots. */
void sk_gpu_arrange_reset(sk_gpu_device *device);
/* Before a step: moves the state if it is time. */
void sk_gpu_arrange_step(sk_gpu_device *device);
/* A buffer with a vector in the world's slots: its own, or one that is filled with a copy. */
unsigned sk_gpu_arrange_back(sk_gpu_device *device, sk_vector vector);

#endif
