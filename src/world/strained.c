/* Whether edges are near their strain bound when a step begins, batch by batch, by the positions alone: then the bound is swept over and
 * over in each of its substeps; else once is enough, which costs a fifth of that. What hangs by an edge, or by two corners, is held by its
 * tethers, and far from its bound. */
#include "world/world.h"

enum { SOME = 256 };

/* Whether any is beyond half its bound. */
static bool is_strained(const sk_batch *batch, const sk_vec4 *x) {
    const real most = (real)(0.5 * *batch->bound);
    for (size_t begin = 0; begin < batch->count; begin += SOME) {
        real strain[SOME], largest = 0;
        const size_t end = begin + SOME < batch->count ? begin + SOME : batch->count;
        batch->type->strain(batch, x, begin, end, strain);
        for (size_t e = begin; e < end; e++) largest = sk_max(largest, strain[e - begin]);
        if (!(largest <= most)) return true;
    }
    return false;
}

void sk_world_note_strained(skein_world *world) {
    world->rules.strained = false;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        sk_batch *batch = world->rules.batches.data[i];
        if (!sk_batch_is_on(batch) || batch->only_bounds || !batch->type->strain || !batch->bound || !(*batch->bound < SK_UNBOUNDED)) continue;
        batch->strained = is_strained(batch, world->particles.vector[SK_X]);
        world->rules.strained |= batch->strained;
    }
}
