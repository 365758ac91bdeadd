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

void sk_write_meetings(sk_plan_builder *builder, sk_meeting_sort sort, sk_vector velocity) {
    for (size_t i = 0; i < builder->rules->forces.count; i++) {
        const sk_force *force = builder->rules->forces.data[i];
        if (!sk_meets(force)) continue;
        const sk_meeting *meeting = force->type->meeting;
        const sk_kernels *kernels[] = {&meeting->begin, &meeting->hold, &meeting->push, &meeting->lead, &meeting->bound};
        sk_add_op(builder, (sk_op){.kind = SK_OP_MEET,
                                   .order = SK_ORDERED,
                                   .kernel = kernels[sort]->version[builder->isa],
                                   .dst = sort == SK_MEETING_BEGIN ? SK_NONE : SK_X,
                                   .source = {SK_X, velocity, SK_NONE},
                                   .rule = force,
                                   .label = force->label,
                                   .end = builder->slot_count});
    }
}
