/* Where particles lie on the card: in the world's slots, or, after a while, in the order of the grid's cells.
 *
 * Neighbours in space that are neighbours in memory are read together: sorting, and all that a pass in the order of
 * cells loads and stores for its own particle, then walks through memory instead of jumping about in it. So every some
 * steps the state is moved into the order that the grid has found. It can be where all rules are everybody's and
 * particle i is in slot i, for then no rule knows slots; `home` says which particle lies where. What is read back is
 * in the world's slots again.
 *
 * Called by device.c. Uses the grid's buffers, which hold nothing between steps. */
#ifndef SK_GPU_ARRANGE_H
#define SK_GPU_ARRANGE_H

#include "gpu/compose.h"

typedef struct sk_gpu_device sk_gpu_device;

enum { SK_GPU_ARRANGE_PROGRAMS = 5 };

typedef struct sk_gpu_arrangement {
    unsigned program[SK_GPU_ARRANGE_PROGRAMS];
    unsigned home; /* by slot: the particle there; 0 where none is kept */
    size_t count;  /* for which it was made */
    size_t steps;  /* since the state was moved */
    bool possible; /* under the present plan */
    bool moved;    /* particles are not in the world's slots */
} sk_gpu_arrangement;

/* Looks whether the plan allows it, and makes what it needs. A state that lies elsewhere must have been fetched. */
skein_status sk_gpu_arrange_make(sk_gpu_device *device, skein_world *world, skein_error *error);
void sk_gpu_arrange_free(sk_gpu_device *device);
/* The state has been written: all is in the world's slots. */
void sk_gpu_arrange_reset(sk_gpu_device *device);
/* Before a step: moves the state if it is time. */
void sk_gpu_arrange_step(sk_gpu_device *device);
/* A buffer with a vector in the world's slots: its own, or one that is filled with a copy. */
unsigned sk_gpu_arrange_back(sk_gpu_device *device, sk_vector vector);

#endif
