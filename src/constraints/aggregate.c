/* What hubs carry to the vertices around them. */
#include "constraints/aggregate.h"

#include "base/quad.h"

/* Its lists, and how long they are. */
#define EACH_LIST(LIST)                \
    LIST(hub, a->hub_count)            \
    LIST(hub_slot, a->hub_count)       \
    LIST(first_part, a->hub_count + 1) \
    LIST(own, a->hub_count)            \
    LIST(pinned, a->hub_count)         \
    LIST(mean, a->hub_count)           \
    LIST(place, a->hub_count)          \
    LIST(move, a->hub_count)           \
    LIST(particle, a->count)           \
    LIST(particle_slot, a->count)      \
    LIST(before, a->count)             \
    LIST(start, a->count + 1)          \
    LIST(of, a->share_count)           \
    LIST(share, a->share_count)        \
    LIST(from, a->part_count)          \
    LIST(part, a->part_count)

sk_aggregate *sk_aggregate_create(sk_allocator *allocator, size_t hubs, size_t carried, size_t shares, size_t parts) {
    sk_aggregate *a = sk_allocate(allocator, sizeof *a);
    if (!a) return NULL;
    *a = (sk_aggregate){.hub_count = hubs, .count = carried, .share_count = shares, .part_count = parts};
    bool good = true;
#define ALLOCATE(list, size) good &= (a->list = sk_allocate(allocator, (size) * sizeof *a->list)) != NULL;
    EACH_LIST(ALLOCATE)
#undef ALLOCATE
    if (good) return a;
    sk_aggregate_release(a, allocator);
    return NULL;
}

void sk_aggregate_release(sk_aggregate *a, sk_allocator *allocator) {
    if (!a) return;
#define RELEASE(list, size) sk_release(allocator, a->list);
    EACH_LIST(RELEASE)
#undef RELEASE
    sk_release(allocator, a);
}

void sk_aggregate_arrange(sk_aggregate *a, const sk_particles *particles) {
    for (size_t i = 0; i < a->hub_count; i++) a->hub_slot[i] = particles->slot_of[a->hub[i]];
    for (size_t i = 0; i < a->count; i++) a->particle_slot[i] = particles->slot_of[a->particle[i]];
}

/* A sum of an even number of terms, in two so that it is not one chain. */
static inline sk_quad sum_of(const real *share, const uint32_t *of, const sk_vec4 *what, size_t first, size_t last) {
    sk_quad sum[2] = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    for (size_t k = first; k < last; k += 2)
        for (size_t j = 0; j < 2; j++) sum[j] += sk_quad_times(share[k + j], sk_quad_at(&what[of[k + j]]));
    return sum[0] + sum[1];
}

/* Hub by hub: added to its means by what is carried, each sum waited for what the one before had stored. */
static void gather(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_aggregate *a = op->rule;
    sk_vec4 *x = run->vector[SK_X];
    for (size_t i = 0; i < a->count; i++) a->before[i] = sk_load(x, op->packed, a->particle_slot[i]);
    for (size_t i = 0; i < a->hub_count; i++) {
        const sk_vec4 at = a->place[i] = sk_load(x, op->packed, a->hub_slot[i]);
        const sk_quad sum = sk_quad_times(a->own[i], sk_quad_at(&at));
        const sk_quad mean = sum + sum_of(a->part, a->from, a->before, a->first_part[i], a->first_part[i + 1]);
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
        if (!(a->before[i].w > 0)) continue;
        const sk_quad way = sum_of(a->share, a->of, a->move, a->start[i], a->start[i + 1]);
        sk_add_at(x, op->packed, a->particle_slot[i], (sk_vec3){way[0], way[1], way[2]});
    }
}

const sk_kernels sk_aggregate_gather = {SK_ANY_ISA(gather)}, sk_aggregate_carry = {SK_ANY_ISA(carry)};
