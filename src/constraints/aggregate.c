/* What hubs carry to the vertices around them. */
#include "constraints/aggregate.h"

#include "base/quad.h"

sk_aggregate *sk_aggregate_create(sk_allocator *allocator, size_t hubs, size_t carried, size_t shares) {
    sk_aggregate *a = sk_allocate(allocator, sizeof *a);
    if (!a) return NULL;
    *a = (sk_aggregate){.hub_count = hubs, .count = carried, .share_count = shares};
    a->hub = sk_allocate(allocator, hubs * sizeof *a->hub);
    a->hub_slot = sk_allocate(allocator, hubs * sizeof *a->hub_slot);
    a->particle = sk_allocate(allocator, carried * sizeof *a->particle);
    a->particle_slot = sk_allocate(allocator, carried * sizeof *a->particle_slot);
    a->start = sk_allocate(allocator, (carried + 1) * sizeof *a->start);
    a->of = sk_allocate(allocator, shares * sizeof *a->of);
    a->share = sk_allocate(allocator, shares * sizeof *a->share);
    a->move = sk_allocate(allocator, hubs * sizeof *a->move);
    if (a->hub && a->hub_slot && a->particle && a->particle_slot && a->start && a->of && a->share && a->move) return a;
    sk_aggregate_release(a, allocator);
    return NULL;
}

void sk_aggregate_release(sk_aggregate *a, sk_allocator *allocator) {
    if (!a) return;
    void *arrays[] = {a->hub, a->hub_slot, a->particle, a->particle_slot, a->start, a->of, a->share, a->move};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, a);
}

void sk_aggregate_arrange(sk_aggregate *a, const sk_particles *particles) {
    for (size_t i = 0; i < a->hub_count; i++) a->hub_slot[i] = particles->slot_of[a->hub[i]];
    for (size_t i = 0; i < a->count; i++) a->particle_slot[i] = particles->slot_of[a->particle[i]];
}

static void carry(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_aggregate *a = op->rule;
    const real h = (real)op->coefficient[1];
    for (size_t i = 0; i < a->hub_count; i++) {
        const size_t slot = a->hub_slot[i];
        sk_vec3 from = sk_xyz(sk_load(run->vector[SK_X0], op->packed, slot));
        if (h != 0) from = sk_add(from, sk_scale(h, sk_xyz(sk_load(run->vector[SK_V], op->packed, slot))));
        const sk_vec3 move = sk_sub(sk_xyz(sk_load(run->vector[SK_X], op->packed, slot)), from);
        a->move[i] = (sk_vec4){move.x, move.y, move.z, 0};
    }
    for (size_t i = 0; i < a->count; i++) {
        sk_quad way = {0, 0, 0, 0};
        if (!(sk_load(run->vector[SK_X], op->packed, a->particle_slot[i]).w > 0)) continue;
        for (size_t k = a->start[i]; k < a->start[i + 1]; k++) way += sk_quad_times(a->share[k], sk_quad_at(&a->move[a->of[k]]));
        sk_add_at(run->vector[SK_X], op->packed, a->particle_slot[i], (sk_vec3){way[0], way[1], way[2]});
    }
}

const sk_kernels sk_aggregate_carry = {SK_ANY_ISA(carry)};
