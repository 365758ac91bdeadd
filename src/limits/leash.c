/* The op that applies leashes: pull, largest distance and backstop of each slot. */
#include "limits/leash.h"

static sk_vec3 between(sk_vec3 from, sk_vec3 to, real part) {
    return sk_add(from, sk_scale(part, sk_sub(to, from)));
}

/* The new position of a particle at x, of inverse mass w. */
static sk_vec3 hold_at(const sk_leash *leash, sk_vec3 x, real w, real h, real part) {
    sk_vec3 place = between(leash->from, leash->to, part);
    real pulled = leash->pull * h * h * w;
    x = sk_add(x, sk_scale(pulled / (1 + pulled), sk_sub(place, x)));
    sk_vec3 off = sk_sub(x, place);
    real square = sk_dot(off, off);
    if (square > leash->most * leash->most)
        x = sk_add(place, sk_scale(leash->most / (real)__builtin_sqrt((double)square), off));
    if (!(leash->radius > 0)) return x;
    sk_vec3 middle = between(leash->stop_from, leash->stop_to, part);
    off = sk_sub(x, middle);
    square = sk_dot(off, off);
    if (!(square < leash->radius * leash->radius) || !(square > 0)) return x;
    return sk_add(middle, sk_scale(leash->radius / (real)__builtin_sqrt((double)square), off));
}

static void hold(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_leashes *leashes = op->rule;
    real part = (real)((run->time - op->before_end - leashes->start) / leashes->dt), h = (real)op->dt;
    if (end > leashes->count) end = leashes->count;
    for (size_t slot = begin; slot < end; slot++) {
        const sk_leash *leash = &leashes->data[slot];
        if (!leash->held) continue;
        sk_vec4 now = sk_load(run->vector[SK_X], op->packed, slot);
        if (!(now.w > 0)) continue;
        sk_vec3 x = sk_xyz(now), to = hold_at(leash, x, now.w, h, part), move = sk_sub(to, x);
        if (!(sk_dot(move, move) > 0)) continue;
        sk_store_at(run->vector[SK_X], op->packed, slot, to);
        if (op->source[1] != SK_NONE) sk_add_at(run->vector[op->source[1]], op->packed, slot, sk_scale(1 / h, move));
    }
}

const sk_kernels sk_leash_hold = {SK_ANY_ISA(hold)};
