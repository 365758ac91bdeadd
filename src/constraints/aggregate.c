/* What hubs carry to the vertices around them. */
#include "constraints/aggregate.h"

#include "base/quad.h"

sk_aggregate *sk_aggregate_create(sk_allocator *allocator, size_t hubs, size_t carried, size_t shares, size_t parts) {
    sk_aggregate *a = sk_allocate(allocator, sizeof *a);
    if (!a) return NULL;
    *a = (sk_aggregate){.hub_count = hubs, .count = carried, .share_count = shares, .part_count = parts};
    a->hub = sk_allocate(allocator, hubs * sizeof *a->hub);
    a->hub_slot = sk_allocate(allocator, hubs * sizeof *a->hub_slot);
    a->particle = sk_allocate(allocator, carried * sizeof *a->particle);
    a->particle_slot = sk_allocate(allocator, carried * sizeof *a->particle_slot);
    a->start = sk_allocate(allocator, (carried + 1) * sizeof *a->start);
    a->of = sk_allocate(allocator, shares * sizeof *a->of);
    a->share = sk_allocate(allocator, shares * sizeof *a->share);
    a->first_part = sk_allocate(allocator, (hubs + 1) * sizeof *a->first_part);
    a->from = sk_allocate(allocator, parts * sizeof *a->from);
    a->part = sk_allocate(allocator, parts * sizeof *a->part);
    a->own = sk_allocate(allocator, hubs * sizeof *a->own);
    a->pinned = sk_allocate(allocator, hubs * sizeof *a->pinned);
    a->mean = sk_allocate(allocator, hubs * sizeof *a->mean);
    a->place = sk_allocate(allocator, hubs * sizeof *a->place);
    a->move = sk_allocate(allocator, hubs * sizeof *a->move);
    a->before = sk_allocate(allocator, carried * sizeof *a->before);
    const void *const arrays[] = {a->hub,   a->hub_slot,   a->particle, a->particle_slot, a->start, a->of,
                                  a->share, a->first_part, a->from,     a->part,          a->own,   a->pinned,
                                  a->mean,  a->place,      a->move,     a->before};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        if (arrays[i]) continue;
        sk_aggregate_release(a, allocator);
        return NULL;
    }
    return a;
}

void sk_aggregate_release(sk_aggregate *a, sk_allocator *allocator) {
    if (!a) return;
    void *arrays[] = {a->hub,  a->hub_slot, a->particle, a->particle_slot, a->start, a->of,    a->share, a->first_part,
                      a->from, a->part,     a->own,      a->pinned,        a->mean,  a->place, a->move,  a->before};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, a);
}

void sk_aggregate_arrange(sk_aggregate *a, const sk_particles *particles) {
    for (size_t i = 0; i < a->hub_count; i++) a->hub_slot[i] = particles->slot_of[a->hub[i]];
    for (size_t i = 0; i < a->count; i++) a->particle_slot[i] = particles->slot_of[a->particle[i]];
}

/* Hub by hub: added to its means by what is carried, each sum waited for what the one before had stored. */
static void gather(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_aggregate *a = op->rule;
    sk_vec4 *x = run->vector[SK_X];
    for (size_t i = 0; i < a->count; i++) a->before[i] = sk_load(x, op->packed, a->particle_slot[i]);
    for (size_t i = 0; i < a->hub_count; i++) {
        const sk_vec4 at = a->place[i] = sk_load(x, op->packed, a->hub_slot[i]);
        sk_quad sum[2] = {sk_quad_times(a->own[i], sk_quad_at(&at)), {0, 0, 0, 0}};
        size_t k = a->first_part[i];
        const size_t last = a->first_part[i + 1];
        for (; k + 1 < last; k += 2)
            for (size_t j = 0; j < 2; j++)
                sum[j] += sk_quad_times(a->part[k + j], sk_quad_at(&a->before[a->from[k + j]]));
        if (k < last) sum[0] += sk_quad_times(a->part[k], sk_quad_at(&a->before[a->from[k]]));
        const sk_quad mean = sum[0] + sum[1];
        a->mean[i] = a->pinned[i] && !(at.w > 0) ? at : (sk_vec4){mean[0], mean[1], mean[2], 0};
        sk_store_at(x, op->packed, a->hub_slot[i], sk_xyz(a->mean[i]));
    }
}

static void carry(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_aggregate *a = op->rule;
    sk_vec4 *x = run->vector[SK_X];
    for (size_t i = 0; i < a->hub_count; i++) {
        const size_t slot = a->hub_slot[i];
        const sk_vec3 move = sk_sub(sk_xyz(sk_load(x, op->packed, slot)), sk_xyz(a->mean[i]));
        a->move[i] = (sk_vec4){move.x, move.y, move.z, 0};
        sk_store_at(x, op->packed, slot, sk_add(sk_xyz(a->place[i]), move));
    }
    for (size_t i = 0; i < a->count; i++) {
        sk_quad ways[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};
        if (!(a->before[i].w > 0)) continue;
        for (size_t k = a->start[i]; k < a->start[i + 1]; k += 2)
            for (size_t j = 0; j < 2; j++)
                ways[j] += sk_quad_times(a->share[k + j], sk_quad_at(&a->move[a->of[k + j]]));
        const sk_quad way = ways[0] + ways[1];
        sk_add_at(x, op->packed, a->particle_slot[i], (sk_vec3){way[0], way[1], way[2]});
    }
}

const sk_kernels sk_aggregate_gather = {SK_ANY_ISA(gather)}, sk_aggregate_carry = {SK_ANY_ISA(carry)};
