/* Sweeps: how a batch is walked. The order is part of the answer; lanes and threads only keep to it.
 *
 * Strips. Where particles lie in strips (particles/particles.h), the elements that lead from grid place
 * (r, c) to (r + row_step, c + column_step) make one sweep: block (r, k) of sixteen slots meets block
 * (r + row_step, k + column_step), lane by lane, and no index is read. Over the end of a strip it meets
 * the next strip's first blocks, one lane on (a long step may lead over several strips):
 *
 *       strip 0   strip 1 ...  strip 15         lane l owns columns [l w, (l + 1) w)
 *     . a b . . | a b . . . |  ...              a block is one column of every strip
 *
 * Places without an element have zero stiffness. Groups. All other elements go in groups of sixteen that
 * share no particle, such that elements which share one stay in their order: the scalar loop, bit for bit. */
#ifndef SK_CONSTRAINTS_SWEEP_H
#define SK_CONSTRAINTS_SWEEP_H

#include "base/wide_types.h"
#include "constraints/constraint.h"

struct sk_sweep {
    const sk_batch *batch;
    bool strips;          /* else groups */
    size_t element_count; /* real ones */
    size_t first_lane;
    /* strips */
    sk_walk walk;
    int32_t row_step, column_step;
    size_t together;                  /* sweeps from this one on along the same strips */
    real rest, stiffness, compliance; /* what most blocks have in every lane */
    /* groups */
    const uint32_t *slots; /* 32 a group */
    size_t group_count;
    char label[48]; /* the batch's, and the direction */
};

#endif
