/* Ops to shaders: a plan is cut into *passes*, and the ops of a pass become one compute shader.
 *
 *   plan    clear F | gravity | kick | drift           four ops, each of which reads and writes whole vectors
 *   pass    load X, V; the four in registers; store    one shader, written from the ops' own texts
 *
 * Called by device.c when there is a new plan; run.c dispatches the passes. Free ops whose elements are slots can share
 * a pass. An op over the neighbours of all particles makes the pass run in the order of the grid's cells; one over
 * those of some is a pass of its own. Ops that write neither X nor V move past a grid, into the pass behind it. If the
 * iterations of a repeat are one pass that reads nothing but its own slot, the shader loops over them too. Values that
 * are used only within a pass are never stored, and need no buffer. */
#ifndef SK_GPU_COMPOSE_H
#define SK_GPU_COMPOSE_H

#include "gpu/program.h"
#include "world/world.h"

enum {
    SK_GPU_GROUP = 128,      /* invocations of a work group */
    SK_GPU_MOST_VECTORS = 8, /* in a pass; OpenGL promises eight buffers */
    SK_GPU_MOST_BLOCK = 768, /* vectors of four floats in the blocks of a pass's ops; OpenGL promises 1,024 */
    SK_GPU_POSE = 8,         /* vectors of a collider's pose */
    SK_GPU_OP = 2,           /* vectors that every op has: coefficients and the substep; flags */
    SK_GPU_HEAD = 2,         /* vectors before those of the ops */
};

typedef enum sk_gpu_pass_kind {
    SK_GPU_SLOTS,      /* over slots */
    SK_GPU_NEIGHBOURS, /* over particles, in the order of the grid */
    SK_GPU_GRID,
    SK_GPU_REPEAT
} sk_gpu_pass_kind;

typedef struct sk_gpu_pass {
    sk_gpu_pass_kind kind;
    size_t first, count; /* of the list of ops; a repeat, how many passes after it are repeated */
    const sk_op *op;     /* of a grid, of a repeat, or the one that looks at neighbours */
    bool by_place;       /* walks in the order of the grid; else over the particles that the op moves */
    size_t begin, end;   /* elements, where it walks */
    unsigned program;
    sk_vector vector[SK_GPU_MOST_VECTORS]; /* which buffers it binds, in this order */
    size_t vector_count, block;            /* the block's size, in vectors of four floats */
    bool looped;                           /* its shader takes the iterations of the repeat that it is in */
    bool looks;                            /* some op reads the position of one particle */
} sk_gpu_pass;

typedef struct sk_gpu_passes {
    sk_gpu_pass *data;
    size_t count, capacity;
    struct {
        const sk_op **data;
        size_t count, capacity;
    } ops;            /* of all passes, one pass after the other; they belong to the plan */
    uint32_t vectors; /* those that need a buffer (bit v: vector v) */
} sk_gpu_passes;

/* Cuts the plan into passes and compiles them; fails with the name of a rule that cannot run on a card. `identity`:
 * particle i is in slot i. */
skein_status sk_gpu_compose(sk_gpu_passes *passes, sk_gpu_programs *programs, skein_world *world, bool identity,
                            skein_error *error);
/* Fills a pass's block, except its head, with its ops' values at this time. */
void sk_gpu_pack(const sk_gpu_passes *passes, const sk_gpu_pass *pass, const sk_run *run, float (*block)[4]);

#endif
