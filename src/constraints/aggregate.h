/* Aggregates: some vertices of any mesh, the hubs, whose distances along it are projected first in a substep. Their
 * displacements are carried to the vertices between, each of which takes shares of those of the hubs around it:
 *
 *      o . .  . o        o: a hub; each . gets a part of the ways of all that are near, by how near they are
 *     .  .  o .  .
 *      o  . .  o .
 *
 * So a few sweeps over few particles bring a correction across a large cloth, as coarse grids do where vertices lie in rows
 * (constraints/coarse.h). A distance divides its correction by the masses that are carried along, which are summed up with the
 * same shares, so that momentum is conserved. */
#ifndef SK_CONSTRAINTS_AGGREGATE_H
#define SK_CONSTRAINTS_AGGREGATE_H

#include "particles/particles.h"
#include "plan/op.h"

typedef struct sk_aggregate {
    size_t hub_count, count, share_count;
    uint32_t *hub, *particle;           /* user's indices: the hubs, and those that are carried */
    uint32_t *hub_slot, *particle_slot; /* the same as slots */
    uint32_t *start, *of;               /* of a carried one its shares, from start[i] to start[i + 1]: of which hubs, as a place */
    real *share;
    sk_vec4 *move; /* of hubs: while a step runs */
    int times;     /* how often its distances are swept, forward and backward in turn */
} sk_aggregate;

/* All lists with that room, the numbers 0; NULL when there is no memory. */
sk_aggregate *sk_aggregate_create(sk_allocator *allocator, size_t hubs, size_t carried, size_t shares);
void sk_aggregate_release(sk_aggregate *aggregate, sk_allocator *allocator);
/* Follows particles to their slots. */
void sk_aggregate_arrange(sk_aggregate *aggregate, const sk_particles *particles);
/* X += the shares of the hubs' displacements from the prediction: from X0, or from X0 + h V if the second coefficient is h.
 * The rule is an sk_aggregate, and there is one element. */
extern const sk_kernels sk_aggregate_carry;

#endif
