/* Dividing elements into groups: called by sweep.c for those that are not in strips. */
#ifndef SK_CONSTRAINTS_GROUPS_H
#define SK_CONSTRAINTS_GROUPS_H

#include "constraints/sweep.h"

/* Adds sweeps of groups for the elements whose lane is SIZE_MAX, and gives them lanes. False when there is no
 * memory. */
bool sk_groups_deal(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles, size_t *lane_of);

#endif
