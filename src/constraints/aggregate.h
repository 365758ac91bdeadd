/* Aggregates: some vertices of any mesh, the hubs, whose distances along it are projected first in a substep. Their
 * displacements are carried to the vertices between, each of which takes shares of those of the hubs around it:
 *
 *      o . .  . o        o: a hub; each . gets a part of the ways of all that are near, by how near they are
 *     .  .  o .  .
 *      o  . .  o .
 *
 * So a few sweeps over few particles bring a correction across a large cloth, as coarse grids do where vertices lie in rows
 * (constraints/coarse.h). A distance divides its correction by the masses that are carried along, which are summed up with the
 * same shares, so that momentum is conserved.
 *
 * What a hub stands for while distances are projected is the mean of all that it carries, by the same shares and their masses, not
 * its own place: else one light vertex that trembles moves all around it by as much, which then has its mass times more energy.
 * Between means no projection gains any, for what is carried weighs no more than the sum of the masses that it is divided by. A hub
 * that was built pinned, and is, stands for itself; of the finest aggregate all do in part (bodies/aggregate.c). */
#ifndef SK_CONSTRAINTS_AGGREGATE_H
#define SK_CONSTRAINTS_AGGREGATE_H

#include "particles/particles.h"
#include "plan/op.h"

typedef struct sk_aggregate {
    const struct sk_aggregate *finer; /* whose hubs it has its own from, and carries the others; NULL: all vertices */
    bool coarsest;
    size_t hub_count, count, share_count, part_count;
    uint32_t *hub, *particle;           /* user's indices: the hubs, and those that are carried */
    uint32_t *hub_slot, *particle_slot; /* the same as slots */
    uint32_t *start, *of; /* of a carried one its shares, from start[i] to start[i + 1]: of which hubs, as a place, */
    real *share;          /* and how much of each; */
    uint32_t *first_part, *from; /* of a hub the parts of its mean: which carried ones, */
    real *part;                  /* and how much of each (both in pairs, an odd one with one of 0 after it); */
    real *own;                   /* how much of it the hub is itself, */
    bool *pinned;                /* and whether it was built pinned: such a one stands for itself while it is */
    sk_vec4 *mean, *place,
        *move;       /* of hubs, while a step runs: the mean before distances, its own place, what it has moved */
    sk_vec4 *before; /* of carried ones: where they were then */
    int times;       /* how often its distances are swept, forward and backward in turn */
} sk_aggregate;

/* All lists with that room, the numbers 0; NULL when there is no memory. */
sk_aggregate *sk_aggregate_create(sk_allocator *allocator, size_t hubs, size_t carried, size_t shares, size_t parts);
void sk_aggregate_release(sk_aggregate *aggregate, sk_allocator *allocator);
/* Follows particles to their slots. */
void sk_aggregate_arrange(sk_aggregate *aggregate, const sk_particles *particles);
/* X of hubs = the mean of what they carry; finer aggregates first. The rule is an sk_aggregate, and there is one element. */
extern const sk_kernels sk_aggregate_gather;
/* X += the shares of what hubs have moved since then; they are back in their own places, and moved as far. */
extern const sk_kernels sk_aggregate_carry;

#endif
