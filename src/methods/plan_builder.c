/* The plan builder's functions for substeps, arithmetic on whole vectors, and contact. Ops for other rules are in
 * plan_builder_*.c. */
#include "methods/plan_builder.h"

void sk_add_op(sk_plan_builder *builder, sk_op op) {
    op.dt = builder->h;
    op.before_end = builder->before_end;
    op.packed = builder->packed;
    if (!op.strained) op.strained = builder->strained;
    if (builder->since) op.turn = ++builder->turn, op.since = builder->since;
    if (!sk_plan_add(builder->plan, builder->allocator, op)) builder->no_memory = true;
}

void sk_add_op_on(sk_plan_builder *builder, sk_op op, const sk_only *only) {
    if (!only->some) sk_add_op(builder, op);
    for (size_t i = 0; i < only->count; i++) {
        size_t first = only->data[i].first_slot, end = only->data[i].end_slot;
        if (first < op.begin) first = op.begin;
        if (end > op.end) end = op.end;
        if (first < end) sk_add_op(builder, sk_op_for(op, first, end));
    }
}

size_t sk_write_repeat(sk_plan_builder *builder, size_t times, double h) {
    builder->h = builder->before_end = h;
    builder->iterations = times;
    sk_add_op(builder, (sk_op){.kind = SK_OP_REPEAT, .end = times, .order = SK_ORDERED, .label = "repeat"});
    size_t repeat = builder->substep = builder->plan->count - 1;
    sk_write_meetings(builder, SK_MEETING_BEGIN, SK_NONE);
    return repeat;
}

void sk_write_end(sk_plan_builder *builder, size_t repeat) {
    if (repeat == builder->substep) sk_write_meetings(builder, SK_MEETING_BOUND, SK_V);
    if (!builder->no_memory) builder->plan->data[repeat].length = builder->plan->count - repeat - 1;
}

void sk_write_stage_time(sk_plan_builder *builder, double part) {
    builder->before_end = (1 - part) * builder->h;
}

static void add_combine(sk_plan_builder *builder, sk_op_kind kind, sk_vector dst, double a, sk_vector p, double b,
                        sk_vector q) {
    sk_add_op(builder, (sk_op){.kind = kind,
                               .order = SK_FREE,
                               .kernel = sk_op_types[kind].kernels->version[builder->isa],
                               .dst = dst,
                               .source = {p, q, SK_NONE},
                               .coefficient = {a, b, 0},
                               .end = builder->slot_count});
}

static void add_layout_ops(sk_plan_builder *builder, sk_op_kind kind, const sk_kernels *kernels) {
    static const sk_vector vectors[] = {SK_X, SK_V};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        sk_add_op(builder, (sk_op){.kind = kind,
                                   .order = SK_FREE,
                                   .kernel = kernels->version[builder->isa],
                                   .dst = vectors[i],
                                   .source = {vectors[i]},
                                   .label = "strips",
                                   .end = builder->strip_slots});
}

void sk_write_pack(sk_plan_builder *builder) {
    if (!builder->strip_slots) return;
    add_layout_ops(builder, SK_OP_PACK, &sk_pack);
    builder->packed = builder->strip_slots;
}

void sk_write_unpack(sk_plan_builder *builder) {
    if (!builder->strip_slots) return;
    add_layout_ops(builder, SK_OP_UNPACK, &sk_unpack);
    builder->packed = 0;
}

void sk_write_rest(sk_plan_builder *builder) {
    add_combine(builder, SK_OP_REST, SK_V, SK_REST_SPEED, SK_V, 0, SK_NONE);
}

void sk_write_sum(sk_plan_builder *builder, sk_vector dst, double a, sk_vector p, double b, sk_vector q) {
    add_combine(builder, SK_OP_SUM, dst, a, p, b, q);
}

void sk_write_clear(sk_plan_builder *builder, sk_vector dst) {
    add_combine(builder, SK_OP_SUM, dst, 0, SK_NONE, 0, SK_NONE);
}

void sk_write_kick(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, sk_vector q) {
    add_combine(builder, SK_OP_KICK, dst, a, p, 0, q);
}

void sk_write_lead(sk_plan_builder *builder, double h) {
    add_combine(builder, SK_OP_LEAD, SK_X, h, SK_X, 0, SK_V);
}

void sk_write_correction(sk_plan_builder *builder) {
    add_combine(builder, SK_OP_CORRECTION, SK_V, 1 / builder->h, SK_X, builder->h, SK_X0);
}

bool sk_writes_contacts(const sk_rules *rules) {
    for (size_t i = 0; i < rules->colliders.count; i++)
        if (rules->colliders.data[i]->common->enabled) return true;
    return false;
}

void sk_write_contacts(sk_plan_builder *builder, sk_contact_sort sort) {
    static const struct {
        sk_op_kind kind;
        const sk_kernels *kernels;
        sk_vector dst;
    } sorts[] = {
        [SK_CONTACT_FORCE] = {SK_OP_CONTACT_FORCE, &sk_contact_force, SK_F},
        [SK_CONTACT_IMPULSE] = {SK_OP_CONTACT_VELOCITY, &sk_contact_impulse, SK_V},
        [SK_CONTACT_PUSH] = {SK_OP_CONTACT_POSITION, &sk_contact_push, SK_X},
        [SK_CONTACT_UPDATE] = {SK_OP_CONTACT_UPDATE, &sk_contact_update, SK_X},
    };
    bool updates = sort == SK_CONTACT_UPDATE,
         tells = (updates || sort == SK_CONTACT_PUSH) && sk_writes_meetings(builder);
    const bool keeps = updates && sk_keeps_planes(builder);
    if (keeps) sk_write_forget_planes(builder);
    for (size_t i = 0; i < builder->rules->colliders.count; i++) {
        const sk_collider *collider = builder->rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        if (sort != SK_CONTACT_FORCE && collider->type->changes && collider->type->changes(collider->params))
            sk_add_op(builder, (sk_op){.kind = SK_OP_MEET,
                                       .order = SK_ORDERED,
                                       .kernel = sk_contact_follow,
                                       .rule = collider,
                                       .label = collider->label,
                                       .end = 1});
        if (sort != SK_CONTACT_FORCE && collider->type->cross) {
            sk_op sweep = {.kind = SK_OP_CONTACT_SWEEP,
                           .order = SK_FREE,
                           .kernel = sk_contact_sweep.version[builder->isa],
                           .dst = SK_X,
                           .source = {SK_X, SK_X0, updates ? SK_V0 : SK_NONE},
                           .coefficient = {updates},
                           .rule = collider,
                           .label = collider->label,
                           .end = builder->slot_count};
            sk_add_op_on(builder, sweep, &collider->only);
        }
        sk_op op = {.kind = sorts[sort].kind,
                    .order = SK_FREE,
                    .kernel = sorts[sort].kernels->version[builder->isa],
                    .dst = sorts[sort].dst,
                    .source = {SK_X, updates ? SK_X0 : SK_NONE,
                               updates                    ? SK_V0
                               : sort == SK_CONTACT_FORCE ? SK_NONE
                                                          : SK_X0},
                    .rule = collider,
                    .label = collider->label,
                    .also_reads = updates && sk_contact_reads_force(collider) ? 1u << SK_F : 0,
                    .also_writes = (tells || keeps ? 1u << SK_SUPPORT : 0) | (keeps ? 1u << SK_T0 | 1u << SK_T1 : 0),
                    .coefficient = {0, keeps},
                    .end = builder->slot_count};
        sk_add_op_on(builder, op, &collider->only);
    }
}

void sk_write_start(sk_plan_builder *builder) {
    if (sk_writes_contacts(builder->rules)) sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
}

void sk_write_save(sk_plan_builder *builder) {
    sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
    sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
}

void sk_write_derivative(sk_plan_builder *builder) {
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_contacts(builder, SK_CONTACT_FORCE);
}

void sk_write_stage(sk_plan_builder *builder, double a, sk_vector v, sk_vector f) {
    sk_write_sum(builder, SK_X, 1, SK_X0, a, v);
    sk_write_kick(builder, SK_V, SK_V0, a, f);
}

void sk_write_impulses(sk_plan_builder *builder) {
    sk_write_contacts(builder, SK_CONTACT_IMPULSE);
    sk_write_limits(builder, SK_V);
    sk_write_contacts(builder, SK_CONTACT_PUSH);
}
