/* Ops of rules that steer: they add to velocities once a substep, the same for every method.
 *
 *   S = 0                       will hold what the rules ask for; in w, how much more speed is allowed
 *   grid (four ops)             sorts particles into cells, for each rule that looks at neighbours
 *   S += neighbours, then all other rules that steer, in the order in which they were made; all read the same X and V
 *   V += S
 *   V bounded                   speed limits and the like
 *
 * Methods that kick and then drift call this between the two, others first in a substep. */
#include "methods/plan_builder.h"
#include "plan/sort.h"

static bool is_on(const sk_force *force, sk_phase phase) {
    return *force->enabled && force->type->phase == phase && force->moved.first < force->moved.end;
}

static bool has(const sk_rules *rules, sk_phase phase) {
    for (size_t i = 0; i < rules->forces.count; i++)
        if (is_on(rules->forces.data[i], phase)) return true;
    return false;
}

bool sk_writes_steering(const sk_rules *rules) {
    return has(rules, SK_STEERS) || has(rules, SK_BOUNDS);
}

void sk_write_cells(sk_plan_builder *builder, const sk_group *group, double radius) {
    for (int i = 0; i < SK_SORT_OPS; i++) {
        const sk_sort_op *part = &sk_sort_ops[i];
        sk_add_op(builder,
                  (sk_op){.kind = i ? SK_OP_SORT_ON : SK_OP_SORT,
                          .order = part->order,
                          .kernel = part->kernels.version[builder->isa],
                          .source = {SK_X, SK_V},
                          .coefficient = {radius},
                          .group = group,
                          .label = part->label,
                          .by_particle = true,
                          .begin = part->by_place ? 0 : group->first_slot / 16 * 16,
                          .end = part->by_place ? group->end - group->first : (group->end_slot + 15) / 16 * 16});
    }
}

/* ---- the rules ---- */

/* An op over the blocks of slots that the rule's particles lie in. */
static sk_op op_of_slots(const sk_plan_builder *builder, const sk_force *force) {
    return (sk_op){.order = SK_FREE,
                   .kernel = force->type->kernel.version[builder->isa],
                   .rule = force,
                   .group = &force->moved,
                   .seen = &force->seen,
                   .label = force->label,
                   .begin = force->moved.first_slot / 16 * 16,
                   .end = (force->moved.end_slot + 15) / 16 * 16};
}

static void write_neighbours(sk_plan_builder *builder, const sk_force *force) {
    double radius = force->type->radius(force->params);
    if (!(radius > 0) || force->seen.first == force->seen.end) return; // there are no neighbours
    bool among = force->moved.first == force->seen.first && force->moved.end == force->seen.end;
    sk_write_cells(builder, &force->seen, radius);
    sk_add_op(builder, (sk_op){.kind = SK_OP_NEIGHBOUR,
                               .order = SK_FREE,
                               .kernel = force->type->kernel.version[builder->isa],
                               .dst = SK_S,
                               .source = {SK_X, SK_V},
                               .rule = force,
                               .group = &force->moved,
                               .seen = &force->seen,
                               .label = force->label,
                               .by_particle = true,
                               .begin = among ? 0 : force->moved.first,
                               .end = among ? force->moved.end - force->moved.first : force->moved.end});
}

static void write_fields(sk_plan_builder *builder, const sk_force *force) {
    sk_op op = op_of_slots(builder, force);
    op.kind = SK_OP_STEERING;
    op.dst = SK_S;
    op.source[0] = SK_X;
    op.source[1] = SK_V;
    op.alone = sk_force_particle(force) >= 0;
    sk_add_op(builder, op);
}

/* An op for each collider that the rule avoids. */
static void write_lookouts(sk_plan_builder *builder, const sk_force *force) {
    for (size_t i = 0; i < builder->rules->colliders.count; i++) {
        const sk_collider *collider = builder->rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        sk_op op = op_of_slots(builder, force);
        op.kind = SK_OP_AVOID;
        op.kernel = sk_avoid.version[builder->isa];
        op.dst = SK_S;
        op.source[0] = SK_X;
        op.source[1] = SK_V;
        op.rule = collider;
        op.seen = NULL;
        op.label = collider->label;
        force->type->look(force->params, op.coefficient);
        sk_add_op_on(builder, op, &collider->only);
    }
}

static void write_bounds(sk_plan_builder *builder, bool again) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!is_on(force, SK_BOUNDS) || (again && force->type->once)) continue;
        sk_op op = op_of_slots(builder, force);
        const sk_shader *shader = &force->type->shader;
        op.kind = shader->shifts && shader->shifts(force->params) ? SK_OP_SHIFT : SK_OP_BOUND;
        op.dst = SK_V;
        op.source[0] = SK_X;
        op.source[1] = SK_V;
        op.source[2] = has(rules, SK_STEERS) ? SK_S : SK_NONE;
        sk_add_op(builder, op);
    }
}

void sk_write_bounds(sk_plan_builder *builder) {
    write_bounds(builder, true);
}

static void write_combine(sk_plan_builder *builder, sk_op_kind kind, sk_vector dst, sk_vector p, sk_vector q) {
    sk_add_op(builder, (sk_op){.kind = kind,
                               .order = SK_FREE,
                               .kernel = sk_op_types[kind].kernels->version[builder->isa],
                               .dst = dst,
                               .source = {p, q},
                               .end = builder->slot_count});
}

void sk_write_steering(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    if (has(rules, SK_STEERS)) {
        write_combine(builder, SK_OP_WIPE, SK_S, SK_NONE, SK_NONE);
        for (int neighbours = 1; neighbours >= 0; neighbours--)
            for (size_t i = 0; i < rules->forces.count; i++) {
                const sk_force *force = rules->forces.data[i];
                if (!is_on(force, SK_STEERS) || (force->type->domain == SK_OVER_NEIGHBOURS) != neighbours) continue;
                if (neighbours) write_neighbours(builder, force);
                else if (force->type->domain == SK_OVER_COLLIDERS) write_lookouts(builder, force);
                else write_fields(builder, force);
            }
        write_combine(builder, SK_OP_STEER, SK_V, SK_V, SK_S);
    }
    write_bounds(builder, false);
}
