#include "limits/limit.h"

#include <string.h>

/* Moves a particle back onto the sphere around its anchor that it has left. The anchor is held, so only
 * the particle moves. A particle with several anchors has an element in several limits (one limit for
 * the nearest anchor, one for the next ...), so that within a limit every element writes its own slot. */
static void keep_tethers(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_limit *limit = row->rule;
    sk_vec4 *x = run->vector[row->dst];
    real factor = (real)(1 + *limit->bound);
    for (size_t e = begin; e < end; e++) {
        uint32_t a = limit->slot[2 * e], b = limit->slot[2 * e + 1];
        real most = limit->length[e] * factor;
        sk_vec3 d = sk_sub(sk_xyz(x[a]), sk_xyz(x[b]));
        real square = sk_dot(d, d);
        if (!(square > most * most) || !(x[a].w > 0) || x[b].w > 0) continue;
        real s = most / sk_sqrt(square) - 1;
        sk_accumulate(&x[a], sk_scale(s, d));
    }
}

sk_limit *sk_tethers_create(sk_allocator *allocator, size_t count, const uint32_t *particles, const real *lengths) {
    sk_limit *limit = sk_allocate(allocator, sizeof *limit);
    if (!limit) return NULL;
    limit->kernel = keep_tethers;
    limit->count = count;
    limit->particle = sk_allocate(allocator, 2 * count * sizeof *limit->particle);
    limit->slot = sk_allocate(allocator, 2 * count * sizeof *limit->slot);
    limit->length = sk_allocate(allocator, count * sizeof *limit->length);
    if (!limit->particle || !limit->slot || !limit->length) {
        sk_limit_release(limit, allocator);
        return NULL;
    }
    if (count) {
        memcpy(limit->particle, particles, 2 * count * sizeof *particles);
        memcpy(limit->length, lengths, count * sizeof *lengths);
    }
    return limit;
}

void sk_limit_release(sk_limit *limit, sk_allocator *allocator) {
    if (!limit) return;
    sk_release(allocator, limit->particle);
    sk_release(allocator, limit->slot);
    sk_release(allocator, limit->length);
    sk_release(allocator, limit);
}

void sk_limit_refresh(sk_limit *limit, const uint32_t *slot_of) {
    for (size_t i = 0; i < 2 * limit->count; i++) limit->slot[i] = slot_of[limit->particle[i]];
}
