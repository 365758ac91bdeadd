/* The graphics card as a device of a world: buffers for the vectors, and the passes that run on them.
 *
 * Owned by its world (world/world.h has the interface). Invariant: outside of its functions an own context is not
 * current. The card computes in float; a library in double turns numbers on the way. */
#ifndef SK_GPU_DEVICE_H
#define SK_GPU_DEVICE_H

#include "gpu/arrange.h"
#include "gpu/compose.h"
#include "gpu/context.h"
#include "gpu/grid.h"

enum { SK_GPU_STAGE = 256 << 10 }; /* bytes of blocks that go to the card at once */

/* A dispatch that waits until its block has been sent to the card. */
typedef struct sk_gpu_call {
    const sk_gpu_pass *pass;
    size_t block;        /* where its block is, in bytes */
    size_t first, count; /* elements */
} sk_gpu_call;

typedef struct sk_gpu_device {
    sk_device base; /* first: the world's pointer is this one's */
    sk_gpu_context context;
    sk_gpu_programs programs;
    sk_gpu_passes passes;
    sk_gpu_grid grid;
    sk_gpu_arrangement arrangement;
    unsigned vector[SK_VECTOR_COUNT]; /* buffers, 0 where there is none */
    size_t slot_count, particle_count;
    bool identity;   /* particle i is in slot i */
    unsigned blocks; /* the buffer that the passes' blocks go to */
    unsigned char *stage;
    size_t staged;      /* bytes */
    sk_gpu_call *calls; /* that wait */
    size_t call_count;
    size_t most_bytes, most_groups, block_alignment; /* the driver's: of a binding, of an axis, of a block's place */
    size_t bytes;                                    /* in use on the card */
} sk_gpu_device;

/* Makes a buffer of so many bytes, all 0. Fails with the size if the card has not enough memory. */
skein_status sk_gpu_buffer(sk_gpu_device *device, size_t bytes, unsigned *buffer, skein_error *error);
void sk_gpu_buffer_free(sk_gpu_device *device, unsigned *buffer, size_t bytes);
/* Dispatches the program in use over so many invocations, with a barrier after it. */
void sk_gpu_dispatch(const sk_gpu_device *device, size_t invocations);
/* Runs the passes, with their repeats. */
void sk_gpu_run(sk_gpu_device *device, sk_run *run);
/* Sends the waiting blocks, and dispatches the waiting calls. */
void sk_gpu_flush(sk_gpu_device *device);

#endif
