/* Elements that a cut has severed are left out of their batch, as those of particles that take no part are. */
#ifndef SK_CONSTRAINTS_SEVERED_H
#define SK_CONSTRAINTS_SEVERED_H

#include "constraints/constraint.h"

/* Says of elements whether they are severed: `data` is what knows of the cut. */
typedef struct sk_severing {
    bool (*severs)(const void *data, const sk_batch *batch, const uint32_t *particle);
    const void *data;
} sk_severing;

/* sk_batch_leave_out(), also of elements that are severed (NULL: none is): they come back when they are so no more. */
bool sk_batch_leave_out_severed(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                                const sk_severing *severing);

#endif
