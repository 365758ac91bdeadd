#include "limits/limit.h"

/* Shortens the edges that are longer than the bound allows, sharing the move by inverse mass, so that
 * momentum is kept. Where velocities are not taken from positions (a second source), the ends stop
 * parting, too. */
static void keep_strain(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_limit *limit = row->rule;
    sk_vec4 *x = run->vector[row->dst];
    sk_vec4 *v = row->source[1] == SK_NONE ? NULL : run->vector[row->source[1]];
    real factor = (real)(1 + *limit->bound);
    for (size_t e = begin; e < end; e++) {
        uint32_t a = limit->edges.slot[2 * e], b = limit->edges.slot[2 * e + 1];
        sk_vec3 d = sk_sub(sk_xyz(x[a]), sk_xyz(x[b]));
        real square = sk_dot(d, d), most = factor * limit->edges.rest[e], weight = x[a].w + x[b].w;
        if (!(square > most * most) || !(weight > 0)) continue;
        real s = (most / sk_sqrt(square) - 1) / weight;
        sk_accumulate(&x[a], sk_scale(s * x[a].w, d));
        sk_accumulate(&x[b], sk_scale(-s * x[b].w, d));
        if (!v) continue;
        real parting = sk_dot(d, sk_sub(sk_xyz(v[a]), sk_xyz(v[b]))) / (square * weight);
        if (!(parting > 0)) continue;
        sk_accumulate(&v[a], sk_scale(-parting * x[a].w, d));
        sk_accumulate(&v[b], sk_scale(parting * x[b].w, d));
    }
}

sk_limit *sk_strain_limit_create(sk_allocator *allocator, size_t count, sk_limited_edges edges) {
    sk_limit *limit = sk_allocate(allocator, sizeof *limit);
    if (!limit) return NULL;
    limit->kernel = keep_strain;
    limit->order = SK_ORDERED;
    limit->count = count;
    limit->edges = edges;
    return limit;
}
