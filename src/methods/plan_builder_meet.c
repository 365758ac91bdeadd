/* Ops of contact between surfaces, the same for every method. */
#include "methods/plan_builder.h"

bool sk_meets(const sk_force *force) {
    return *force->enabled && force->type->phase == SK_MEETS;
}

bool sk_writes_meetings(const sk_plan_builder *builder) {
    for (size_t i = 0; i < builder->rules->forces.count; i++)
        if (sk_meets(builder->rules->forces.data[i])) return true;
    return false;
}

/* Whether the method keeps in X0 where the substep begins, from its first op that moves anybody on. */
static bool keeps_start(const sk_plan_builder *builder) {
    bool keeps = false, moved = false;
    for (size_t r = builder->substep + 1; r < builder->plan->count; r++) {
        const sk_op *op = &builder->plan->data[r];
        const uint32_t writes = sk_op_writes(op) | 1u << op->dst;
        bool copies = op->kind == SK_OP_SUM && op->dst == SK_X0 && op->source[0] == SK_X && op->source[1] == SK_NONE &&
                      !(op->coefficient[0] < 1 || op->coefficient[0] > 1) && op->end == builder->slot_count;
        if (writes >> SK_X0 & 1 && (keeps || moved || !copies)) return false;
        keeps |= copies;
        moved |= writes >> SK_X & 1;
    }
    return keeps;
}

void sk_write_meetings(sk_plan_builder *builder, sk_meeting_sort sort, sk_vector velocity) {
    for (size_t i = 0; i < builder->rules->forces.count; i++) {
        const sk_force *force = builder->rules->forces.data[i];
        if (!sk_meets(force)) continue;
        const sk_meeting *meeting = force->type->meeting;
        const bool asks = sort >= SK_MEETING_FACES && keeps_start(builder);
        const sk_kernels *kernels[] = {&meeting->begin, &meeting->hold,  &meeting->push,  &meeting->push_on,
                                       &meeting->lead,  &meeting->faces, &meeting->faces, &meeting->bound};
        sk_add_op(builder, (sk_op){.kind = SK_OP_MEET,
                                   .order = SK_ORDERED,
                                   .kernel = kernels[sort]->version[builder->isa],
                                   .dst = sort == SK_MEETING_BEGIN ? SK_NONE : SK_X,
                                   .source = {SK_X, velocity, asks ? SK_X0 : SK_NONE},
                                   .coefficient = {sort == SK_MEETING_FACES},
                                   .rule = force,
                                   .label = force->label,
                                   .end = builder->slot_count});
    }
}
