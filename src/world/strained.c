/* Whether edges are near their bound when a step begins, batch by batch, by the positions alone: then the bound is swept over and over in each
 * of its substeps (methods/plan_builder_limit.c); else once is enough, or not at all, which costs a fifth of that. What hangs by an edge, or
 * by two corners, is held by its tethers, and far from its bound.
 *
 * A sheet's edges that nothing limits are firm all the same, if they are stiff: a substep would undo a stretch of a twentieth at once, did not
 * what hangs from them pull on them again. So sheets lie over the corners of boxes, where a few vertices bear all. What is soft stretches as
 * it is meant to. */
#include "world/world.h"

enum { SOME = 256 };

/* A projection leaves 1 / (1 + K) of a strain, K = k h^2 sum w |grad C|^2: an edge that is stiff has more. */
static const double least_stiff = 30;

/* K of a distance. */
static double stiffness_in_substep(const sk_batch *batch, const sk_vec4 *x, size_t e, double h) {
    const uint32_t *slot = batch->slot + e * batch->arity;
    const double scale = batch->scale ? (double)batch->scale[e] : 1;
    return ((const sk_material *)batch->params)->stiffness * scale * h * h *
           ((double)x[slot[0]].w + (double)x[slot[1]].w);
}

/* Whether any is beyond half its bound; where nobody has set that, of those that are stiff. Sweeps leave alone what is within, so that who
 * was swept by them in one step is so in the next. (Where they were projections, and had done with what had called for them, sheets shook.) */
static bool is_strained(const sk_batch *batch, sk_isa isa, const sk_vec4 *x, bool limited, double h) {
    const real most = (real)(0.5 * sk_batch_bound(batch));
    sk_any_beyond_kernel *const any_beyond = batch->type->any_beyond[isa];
    if (any_beyond && !any_beyond(batch, x, most)) return false; // as of most, in a third of the time
    for (size_t begin = 0; begin < batch->count; begin += SOME) {
        real strain[SOME], largest = 0;
        const size_t end = begin + SOME < batch->count ? begin + SOME : batch->count;
        batch->type->strain(batch, x, begin, end, strain);
        for (size_t e = begin; e < end; e++) largest = sk_max(largest, strain[e - begin]);
        if (largest <= most) continue;
        if (limited) return true;
        for (size_t e = begin; e < end; e++)
            if (strain[e - begin] > most && stiffness_in_substep(batch, x, e, h) > least_stiff) return true;
    }
    return false;
}

void sk_world_note_strained(skein_world *world, double dt) {
    const double h = dt / world->plan_substeps;
    world->rules.strained = false;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        sk_batch *batch = world->rules.batches.data[i];
        if (!sk_batch_is_on(batch) || batch->only_bounds || !batch->type->strain) continue;
        const bool limited = batch->bound && *batch->bound < SK_UNBOUNDED;
        if (!limited && !(world->sweeps_more && sk_batch_is_firm(batch))) continue;
        batch->strained = is_strained(batch, world->isa, world->particles.vector[SK_X], limited, h);
        world->rules.strained |= batch->strained;
    }
}
