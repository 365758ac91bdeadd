#include "limits/limit.h"

#include <string.h>

/* Takes p back onto the sphere around its anchor that it has left. */
static inline sk_vec3 pull_in(sk_vec3 p, sk_vec4 anchor, real most) {
    sk_vec3 d = sk_sub(p, sk_xyz(anchor));
    real square = sk_dot(d, d);
    if (!(square > most * most) || anchor.w > 0) return p;
    return sk_add(sk_xyz(anchor), sk_scale(most / sk_sqrt(square), d));
}

/* Several anchors are taken in turn, once forwards and once backwards, and the mean is kept: the last
 * one to pull would win otherwise, and a cloth between two pins would hang askew. Where velocities are
 * not taken from positions (a second source), the velocity away from an anchor ends here too. */
static void keep_tethers(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_limit *limit = row->rule;
    sk_vec4 *x = run->vector[row->dst];
    sk_vec4 *v = row->source[1] == SK_NONE ? NULL : run->vector[row->source[1]];
    real factor = (real)(1 + *limit->bound);
    size_t anchors = limit->anchors;
    for (size_t e = begin; e < end; e++) {
        const uint32_t *slot = limit->slot + e * (1 + anchors);
        const real *length = limit->length + e * anchors;
        sk_vec4 *moved = &x[slot[0]];
        if (!(moved->w > 0)) continue;
        sk_vec3 before = sk_xyz(*moved), forth = before, back = before;
        for (size_t k = 0; k < anchors; k++) forth = pull_in(forth, x[slot[1 + k]], factor * length[k]);
        if (anchors > 1) {
            for (size_t k = anchors; k-- > 0;) back = pull_in(back, x[slot[1 + k]], factor * length[k]);
            forth = sk_scale((real)0.5, sk_add(forth, back));
        }
        sk_vec3 move = sk_sub(forth, before);
        *moved = (sk_vec4){forth.x, forth.y, forth.z, moved->w};
        real square = sk_dot(move, move);
        if (!v || !(square > 0)) continue;
        // what still goes against the move stops
        real against = sk_dot(move, sk_xyz(v[slot[0]]));
        if (against < 0) sk_accumulate(&v[slot[0]], sk_scale(-against / square, move));
    }
}

sk_limit *sk_tethers_create(sk_allocator *allocator, size_t count, size_t anchors, const uint32_t *particles, const real *lengths) {
    sk_limit *limit = sk_allocate(allocator, sizeof *limit);
    if (!limit) return NULL;
    size_t indices = count * (1 + anchors);
    limit->kernel = keep_tethers;
    limit->order = SK_FREE;
    limit->count = count;
    limit->anchors = anchors;
    limit->particle = sk_allocate(allocator, indices * sizeof *limit->particle);
    limit->slot = sk_allocate(allocator, indices * sizeof *limit->slot);
    limit->length = sk_allocate(allocator, count * anchors * sizeof *limit->length);
    if (!limit->particle || !limit->slot || !limit->length) {
        sk_limit_release(limit, allocator);
        return NULL;
    }
    if (count) {
        memcpy(limit->particle, particles, indices * sizeof *particles);
        memcpy(limit->length, lengths, count * anchors * sizeof *lengths);
    }
    return limit;
}
