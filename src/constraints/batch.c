#include "constraints/constraint.h"

#include <string.h>

sk_batch *sk_batch_create(sk_allocator *allocator, const sk_constraint_type *type, size_t count,
                          const uint32_t *particles, const real *rest, const real *scale) {
    sk_batch *batch = sk_allocate(allocator, sizeof *batch);
    if (!batch) return NULL;
    size_t indices = count * (size_t)type->arity;
    batch->type = type;
    batch->count = count;
    batch->particle = sk_allocate(allocator, indices * sizeof *batch->particle);
    batch->slot = sk_allocate(allocator, indices * sizeof *batch->slot);
    batch->rest = sk_allocate(allocator, count * sizeof *batch->rest);
    batch->scale = scale ? sk_allocate(allocator, count * sizeof *batch->scale) : NULL;
    batch->stiffness = sk_allocate(allocator, count * sizeof *batch->stiffness);
    batch->compliance = sk_allocate(allocator, count * sizeof *batch->compliance);
    batch->multiplier = sk_allocate(allocator, count * sizeof *batch->multiplier);
    if (!batch->particle || !batch->slot || !batch->rest || (scale && !batch->scale) || !batch->stiffness ||
        !batch->compliance || !batch->multiplier) {
        sk_batch_release(batch, allocator);
        return NULL;
    }
    if (count) {
        memcpy(batch->particle, particles, indices * sizeof *particles);
        memcpy(batch->rest, rest, count * sizeof *rest);
        if (scale) memcpy(batch->scale, scale, count * sizeof *scale);
    }
    return batch;
}

void sk_batch_release(sk_batch *batch, sk_allocator *allocator) {
    if (!batch) return;
    sk_release(allocator, batch->particle);
    sk_release(allocator, batch->slot);
    sk_release(allocator, batch->rest);
    sk_release(allocator, batch->scale);
    sk_release(allocator, batch->stiffness);
    sk_release(allocator, batch->compliance);
    sk_release(allocator, batch->multiplier);
    sk_release(allocator, batch);
}

void sk_batch_refresh(sk_batch *batch, const uint32_t *slot_of) {
    const sk_material *material = batch->params;
    size_t indices = batch->count * (size_t)batch->type->arity;
    for (size_t i = 0; i < indices; i++) batch->slot[i] = slot_of[batch->particle[i]];
    for (size_t e = 0; e < batch->count; e++) {
        double k = material->stiffness * (batch->scale ? (double)batch->scale[e] : 1.0);
        batch->stiffness[e] = (real)k;
        batch->compliance[e] = (real)(k > 0 ? 1 / k : SK_FAR);
    }
}

double sk_batch_damping_time(const sk_batch *batch) {
    const sk_material *material = batch->params;
    return material->stiffness > 0 ? material->damping / material->stiffness : 0;
}

void sk_batch_clear_multipliers(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)run;
    const sk_batch *batch = row->rule;
    memset(batch->multiplier + begin, 0, (end - begin) * sizeof *batch->multiplier);
}
