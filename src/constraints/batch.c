#include <string.h>

#include "constraints/enclosure.h"

int sk_constraint_arity(const sk_constraint_type *type, const void *params) {
    return type->arity_of ? type->arity_of(params) : type->arity;
}

int sk_constraint_rest_count(const sk_constraint_type *type, const void *params) {
    return type->rest_count_of ? type->rest_count_of(params) : type->rest_count;
}

sk_batch *sk_batch_create(sk_allocator *allocator, const sk_constraint_type *type, const void *params, size_t count,
                          const uint32_t *particles, const real *rest, const real *scale) {
    sk_batch *batch = sk_allocate(allocator, sizeof *batch);
    if (!batch) return NULL;
    batch->type = type;
    batch->count = count;
    batch->arity = (size_t)sk_constraint_arity(type, params);
    batch->rest_count = (size_t)sk_constraint_rest_count(type, params);
    size_t indices = count * batch->arity, rests = count * batch->rest_count;
    batch->particle = sk_allocate(allocator, indices * sizeof *batch->particle);
    batch->slot = sk_allocate(allocator, indices * sizeof *batch->slot);
    batch->rest = sk_allocate(allocator, rests * sizeof *batch->rest);
    batch->scale = scale ? sk_allocate(allocator, count * sizeof *batch->scale) : NULL;
    if (!batch->particle || !batch->slot || !batch->rest || (scale && !batch->scale)) {
        sk_batch_release(batch, allocator);
        return NULL;
    }
    if (count) {
        memcpy(batch->particle, particles, indices * sizeof *particles);
        if (rests) memcpy(batch->rest, rest, rests * sizeof *rest);
        if (scale) memcpy(batch->scale, scale, count * sizeof *scale);
    }
    return batch;
}

void sk_batch_release(sk_batch *batch, sk_allocator *allocator) {
    if (!batch) return;
    sk_batch_forget_sweeps(batch, allocator);
    sk_enclosure_release(batch->enclosure, allocator);
    void *arrays[] = {batch->particle,        batch->slot,           batch->rest,
                      batch->scale,           batch->sweeps,         batch->lane,
                      batch->lane_rest,       batch->lane_stiffness, batch->lane_compliance,
                      batch->lane_multiplier, batch->special,        batch->pair};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, batch);
}

double sk_batch_damping_time(const sk_batch *batch) {
    const sk_material *material = batch->params;
    return material->stiffness > 0 ? material->damping / material->stiffness : 0;
}

void sk_sweep_clear_multipliers(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)run;
    const sk_sweep *sweep = row->rule;
    // an element of the row is a strip row, a slab or a group
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    size_t lanes = (sweep->strips ? sweep->walk.width : 1) * SK_LANES;
    memset(sweep->batch->lane_multiplier + sweep->first_lane + begin * lanes, 0, (end - begin) * lanes * sizeof(real));
}
