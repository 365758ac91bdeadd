/* Whether edges are near their bound when a step begins, batch by batch, by the positions alone: then the bound is swept over and over in each
 * of its substeps (methods/plan_builder_correct.c); else once is enough, or not at all, which costs a fifth of that. What hangs by an edge, or
 * by two corners, is held by its tethers, and far from its bound.
 *
 * A sheet's edges that nothing limits are firm all the same, if they are stiff: a substep would undo a stretch of a twentieth at once, did not
 * what hangs from them pull on them again. So sheets lie over the corners of boxes, where a few vertices bear all. What is soft stretches as
 * it is meant to. */
#include "base/kernels.h"
#include "world/world.h"
#define SK_UNIT strained

/* Whether of `count` distances, by the slots of their ends, any may be longer than so many times its rest. */
typedef bool sk_longer_kernel(const sk_vec4 *x, const uint32_t (*slot)[2], const real *rest, size_t count, real times);
SK_KERNELS(sk_longer_kernel, longer);

#ifdef SK_ISA
bool SK_KERNEL(longer)(const sk_vec4 *x, const uint32_t (*slot)[2], const real *rest, size_t count, real times) {
    const real nearly = (real)0.99999, square = nearly * times * times; // for rounding
    for (size_t begin = 0; begin < count; begin += SK_PART) {
        uint32_t from[SK_PART], to[SK_PART];
        sk_wide most;
        for (size_t l = 0; l < SK_PART; l++) {
            const size_t e = begin + l < count ? begin + l : count - 1;
            from[l] = slot[e][0], to[l] = slot[e][1], most[l] = rest[e];
        }
        const sk_wide4 a = sk_gather(x, from), b = sk_gather(x, to);
        const sk_wide3 r = {a.x - b.x, a.y - b.y, a.z - b.z};
        if (sk_any(~sk_at_most(sk_dot_wide(r, r), square * most * most))) return true; // also of what is no number
    }
    return false;
}
#else

extern const sk_constraint_type sk_distance;

static sk_longer_kernel *const longer_kernel[SK_ISA_COUNT] = SK_EACH_ISA(longer);

enum { SOME = 256 };

/* A projection leaves 1 / (1 + K) of a strain, K = k h^2 sum w |grad C|^2: an edge that is stiff has more. */
static const double least_stiff = 30;

/* K of a distance. */
static double stiffness_in_substep(const sk_batch *batch, const sk_vec4 *x, size_t e, double h) {
    const uint32_t *slot = batch->slot + e * batch->arity;
    const double scale = batch->scale ? (double)batch->scale[e] : 1;
    return ((const sk_material *)batch->params)->stiffness * scale * h * h * ((double)x[slot[0]].w + (double)x[slot[1]].w);
}

/* Whether any is beyond half its bound; where nobody has set that, of those that are stiff. Sweeps leave alone what is within, so that who
 * was swept by them in one step is so in the next. (Where they were projections, and had done with what had called for them, sheets shook.) */
static bool is_strained(const sk_batch *batch, sk_isa isa, const sk_vec4 *x, bool limited, double h) {
    const real most = (real)(0.5 * sk_batch_bound(batch));
    const uint32_t(*ends)[2] = (const uint32_t(*)[2])batch->slot;
    if (batch->type == &sk_distance && !longer_kernel[isa](x, ends, batch->rest, batch->count, 1 + most)) return false; // as of most, in a third of the time
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
    const double h = dt / (double)world->method->substeps(world->method_params);
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
#endif
