/* Ops that predict: the start of a position method's substep.
 *
 * Slots are divided into parts that the same rules act on. In a part where all forces are uniform and F is not read
 * later, they change V without F. Which forces act on other parts does not change its bits. plan/fuse.c fuses the ops
 * of a prediction. */
#include <stdio.h>
#include <string.h>

#include "methods/plan_builder.h"

/* Adds up the forces on a part; false if they are not all uniform, or F is read later. */
static bool add_up_uniform_forces(const sk_rules *rules, sk_plan_part *part) {
    size_t length = 0, slot = part->first_slot;
    part->uniform = (sk_uniform_force){.label = ""};
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!sk_pushes(force) || !sk_only_has_slot(&force->only, slot)) continue;
        if (!sk_force_add_uniform(force, &part->uniform)) return false;
        char *label = part->uniform.label;
        size_t room = sizeof part->uniform.label - length;
        int added = snprintf(label + length, room, "%s%s", length ? ", " : "", force->label);
        if (added > 0 && (size_t)added < room) length += (size_t)added;
    }
    for (size_t i = 0; i < rules->colliders.count; i++) {
        const sk_collider *collider = rules->colliders.data[i];
        if (collider->common->enabled && sk_contact_reads_force(collider) && sk_only_has_slot(&collider->only, slot))
            return false;
    }
    return true;
}

/* Whether a rule that steers or bounds velocities acts on particles of a part. */
static bool is_steered(const sk_rules *rules, const sk_plan_part *part) {
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (*force->enabled && force->type->phase != SK_PUSHES && force->moved.first < force->moved.end &&
            sk_only_has_slot(&force->only, part->first_slot))
            return true;
    }
    return false;
}

/* Divides the part that a slot lies within, at that slot. */
static bool cut_parts(sk_plan_builder *builder, size_t slot) {
    sk_plan *plan = builder->plan;
    if (!SK_RESERVE(builder->allocator, &plan->parts, plan->parts.count + 1)) return false;
    for (size_t i = 0; i < plan->parts.count; i++) {
        sk_plan_part *part = &plan->parts.data[i];
        if (slot <= part->first_slot || slot >= part->end_slot) continue;
        memmove(part + 1, part, (plan->parts.count - i) * sizeof *part);
        plan->parts.count++;
        part[0].end_slot = part[1].first_slot = slot;
        break;
    }
    return true;
}

static void cut_at_bodies(sk_plan_builder *builder, const sk_only *only) {
    for (size_t i = 0; i < only->count && !builder->no_memory; i++)
        if (!cut_parts(builder, only->data[i].first_slot) || !cut_parts(builder, only->data[i].end_slot))
            builder->no_memory = true;
}

/* Finds the parts; only once in a plan, since ops point to them. */
static void find_parts(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    sk_plan *plan = builder->plan;
    if (!SK_RESERVE(builder->allocator, &plan->parts, 1)) {
        builder->no_memory = true;
        return;
    }
    plan->parts.count = 1;
    plan->parts.data[0] = (sk_plan_part){.end_slot = builder->slot_count};
    for (size_t i = 0; i < rules->forces.count; i++)
        if (*rules->forces.data[i]->enabled) cut_at_bodies(builder, &rules->forces.data[i]->only);
    for (size_t i = 0; i < rules->colliders.count; i++)
        if (rules->colliders.data[i]->common->enabled) cut_at_bodies(builder, &rules->colliders.data[i]->only);
    for (size_t i = 0; i < plan->parts.count; i++) {
        sk_plan_part *part = &plan->parts.data[i];
        part->steered = is_steered(rules, part);
        part->is_uniform = add_up_uniform_forces(rules, part);
    }
}

/* Adds an op for a part; a plain one where the part is all slots. */
static void add_op_of_part(sk_plan_builder *builder, sk_op op, const sk_plan_part *part) {
    bool whole = part->first_slot == 0 && part->end_slot == builder->slot_count;
    sk_add_op(builder, whole ? op : sk_op_for(op, part->first_slot, part->end_slot));
}

/* V += h w F on a part. */
static void write_kick_of_part(sk_plan_builder *builder, const sk_plan_part *part) {
    add_op_of_part(builder,
                   (sk_op){.kind = SK_OP_KICK,
                           .order = SK_FREE,
                           .kernel = sk_combine_kick.version[builder->isa],
                           .dst = SK_V,
                           .source = {SK_V, SK_F, SK_NONE},
                           .coefficient = {builder->h},
                           .end = builder->slot_count},
                   part);
}

/* V += h (the uniform forces on a part). */
static void write_pull_of_part(sk_plan_builder *builder, const sk_plan_part *part) {
    add_op_of_part(builder,
                   (sk_op){.kind = SK_OP_PULL,
                           .order = SK_FREE,
                           .kernel = sk_combine_pull.version[builder->isa],
                           .dst = SK_V,
                           .source = {SK_V, SK_NONE, SK_NONE},
                           .rule = &part->uniform,
                           .end = builder->slot_count},
                   part);
}

/* Rules that steer or bound velocities come between kick and drift. So forces on steered parts are applied here, and
 * their prediction has none left to add. */
static void write_steered_kicks(sk_plan_builder *builder) {
    sk_plan *plan = builder->plan;
    for (size_t i = 0; i < plan->parts.count && sk_writes_forces(builder); i++)
        if (plan->parts.data[i].steered) write_kick_of_part(builder, &plan->parts.data[i]);
    for (size_t i = 0; i < plan->parts.count; i++)
        if (plan->parts.data[i].steered) plan->parts.data[i].uniform = (sk_uniform_force){.label = ""};
    sk_write_steering(builder);
}

void sk_write_prediction(sk_plan_builder *builder) {
    find_parts(builder);
    const sk_plan *plan = builder->plan;
    bool wants_force = false;
    for (size_t i = 0; i < plan->parts.count; i++)
        wants_force |= plan->parts.data[i].steered ? sk_writes_forces(builder) : !plan->parts.data[i].is_uniform;
    if (wants_force) sk_write_fields(builder);
    if (sk_writes_steering(builder->rules)) write_steered_kicks(builder);
    for (size_t i = 0; i < plan->parts.count; i++) {
        const sk_plan_part *part = &plan->parts.data[i];
        if (part->steered || part->is_uniform) write_pull_of_part(builder, part);
        else write_kick_of_part(builder, part);
    }
    sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE);
    if (sk_writes_contacts(builder->rules)) sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    sk_write_sum(builder, SK_X, 1, SK_X, builder->h, SK_V);
    builder->predicted = true;
    sk_write_stage_time(builder, 1);
}
