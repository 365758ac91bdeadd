/* Ops for a method, one call each: vectors' arithmetic, then what every enabled rule of a sort brings. */
#include "methods/plan_builder.h"

#include <stdio.h>
#include <string.h>

#include "base/status.h"
#include "constraints/sweep.h"
#include "methods/method.h"
#include "particles/surface.h"

void sk_add_op(sk_plan_builder *builder, sk_op op) {
    op.dt = builder->h;
    op.before_end = builder->before_end;
    op.packed = builder->packed;
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

/* Whether contact asks where the substep began. */
static bool any_sweeps(const sk_rules *rules) {
    for (size_t i = 0; i < rules->colliders.count; i++)
        if (rules->colliders.data[i]->common->enabled && rules->colliders.data[i]->type->cross) return true;
    return false;
}

size_t sk_write_repeat(sk_plan_builder *builder, size_t times, double h) {
    builder->h = builder->before_end = h;
    builder->iterations = times;
    sk_add_op(builder, (sk_op){.kind = SK_OP_REPEAT, .end = times, .order = SK_ORDERED, .label = "repeat"});
    size_t repeat = builder->substep = builder->plan->count - 1;
    sk_write_meetings(builder, SK_MEETING_BEGIN, SK_NONE);
    if (any_sweeps(builder->rules)) sk_write_sum(builder, SK_X0, 1, SK_X, 0, SK_NONE); // for methods that do not
    return repeat;
}

void sk_write_end(sk_plan_builder *builder, size_t repeat) {
    if (repeat == builder->substep) sk_write_meetings(builder, SK_MEETING_BOUND, SK_V);
    if (!builder->no_memory) builder->plan->data[repeat].length = builder->plan->count - repeat - 1;
}

void sk_write_stage_time(sk_plan_builder *builder, double part) {
    builder->before_end = (1 - part) * builder->h;
}

static void add_combine(sk_plan_builder *builder, const sk_kernels *kernels, sk_vector dst, double a, sk_vector p,
                        double b, sk_vector q) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_COMBINE,
                               .order = SK_FREE,
                               .kernel = kernels->version[builder->isa],
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
    add_combine(builder, &sk_combine_rest, SK_V, SK_REST_SPEED, SK_V, 0, SK_NONE);
}

void sk_write_sum(sk_plan_builder *builder, sk_vector dst, double a, sk_vector p, double b, sk_vector q) {
    add_combine(builder, &sk_combine_sum, dst, a, p, b, q);
}

void sk_write_clear(sk_plan_builder *builder, sk_vector dst) {
    add_combine(builder, &sk_combine_sum, dst, 0, SK_NONE, 0, SK_NONE);
}

void sk_write_kick(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, sk_vector q) {
    add_combine(builder, &sk_combine_kick, dst, a, p, 0, q);
}

void sk_write_lead(sk_plan_builder *builder, double h) {
    add_combine(builder, &sk_combine_lead, SK_X, h, SK_X, 0, SK_V);
}

static bool pushes(const sk_force *force) {
    return *force->enabled && force->type->phase == SK_PUSHES;
}

/* The widest reach of the enabled neighbour rules; 0 if there is none. */
static double widest_radius(const sk_rules *rules) {
    double widest = 0;
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!pushes(force) || force->type->domain != SK_OVER_NEIGHBOURS || force->only.some) continue;
        double radius = force->type->radius(force->params);
        if (radius > widest) widest = radius;
    }
    return widest;
}

/* Whether a rule acts on the body whose strips these are; nobody else has slots there. */
static bool acts_on_strips(const sk_only *only, const sk_walk *walk) {
    size_t end = walk->first_slot + walk->rows * walk->width * SK_LANES;
    for (size_t i = 0; i < only->count; i++)
        if (only->data[i].first_slot < end && only->data[i].end_slot > walk->first_slot) return true;
    return !only->some;
}

/* An op for the triangles of each patch, and one for the rest, of all bodies or of those that are named. Neighbouring
 * triangles add to the same corners, so the ops are ordered. */
static void add_surface(sk_plan_builder *builder, sk_op op, const sk_force *force) {
    const sk_surface *surface = builder->surface;
    const sk_only *only = &force->only;
    sk_op along = op;
    op.order = along.order = SK_ORDERED;
    along.kernel = force->type->over_patch.version[builder->isa];
    for (size_t i = 0; i < surface->patch_count; i++) {
        const sk_patch *patch = &surface->patches[i];
        if (!patch->has || !acts_on_strips(only, &patch->walk)) continue;
        along.patch = patch;
        along.walk = patch->walk;
        along.end = patch->walk.rows - patch->walk.reach;
        sk_add_op(builder, along);
    }
    for (size_t i = 0; i < (only->some ? only->count : 1); i++) {
        op.begin = only->some ? sk_surface_rest_from(surface, only->data[i].first_triangle) : 0;
        op.end = only->some ? sk_surface_rest_from(surface, only->data[i].end_triangle) : surface->rest.count;
        if (op.begin < op.end) sk_add_op(builder, op);
    }
}

/* A force's op, or those of the bodies that it names. */
static void add_field(sk_plan_builder *builder, sk_op op, const sk_force *force) {
    const sk_only *only = &force->only;
    if (force->type->domain == SK_OVER_TRIANGLES) {
        add_surface(builder, op, force);
    } else if (only->some && force->type->domain == SK_OVER_NEIGHBOURS) {
        // cells of its own, so that what others add up does not depend on its radius; the kernel passes over strangers
        if (only->count) sk_write_cells(builder, builder->everybody, force->type->radius(force->params));
        if (only->count) sk_add_op(builder, op);
    } else {
        sk_add_op_on(builder, op, only);
    }
}

/* Neighbour rules on some bodies only: they sort cells of their own, once all others have used theirs. */
static bool comes_late(const sk_force *force) {
    return force->only.some && force->type->domain == SK_OVER_NEIGHBOURS;
}

void sk_write_fields(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool first = true; // gravity and the like set F when they come first; others add to a cleared one
    double radius = widest_radius(rules);
    if (radius > 0) sk_write_cells(builder, builder->everybody, radius);
    for (size_t n = 0; n < 2 * rules->forces.count; n++) {
        const sk_force *force = rules->forces.data[n % rules->forces.count];
        if (!pushes(force) || comes_late(force) != (n >= rules->forces.count)) continue;
        bool sets = first && force->type->sets && !force->only.some;
        if (first && !sets) sk_write_clear(builder, SK_F);
        first = false;
        sk_op op = {.kind = SK_OP_FIELD,
                    .order = SK_FREE,
                    .kernel = force->type->kernel.version[builder->isa],
                    .dst = SK_F,
                    .source = {SK_X, SK_V},
                    .rule = force,
                    .label = force->label,
                    .end = builder->slot_count};
        if (force->type->domain == SK_OVER_NEIGHBOURS) {
            op.kind = SK_OP_NEIGHBOUR;
            op.by_particle = true;
            op.end = builder->particle_count;
        }
        op.sets = sets;
        add_field(builder, op, force);
    }
    if (first) sk_write_clear(builder, SK_F);
}

static bool is_on(const sk_batch *batch) {
    return sk_batch_pulls(batch);
}

/* Without damping the multiplier is zero whenever it is read in the only pass of a substep, and counts for nothing
 * in a rigid batch. */
static bool keeps_multiplier(const sk_batch *batch, int passes) {
    bool rigid = ((const sk_material *)batch->params)->stiffness >= SK_UNBOUNDED;
    return (passes > 1 && !rigid) || sk_batch_damping_time(batch) > 0;
}

/* ---- predicting ----
 *
 * Slots are cut into parts that the same rules act on. In a part where all forces are uniform, and F is not wanted
 * later on, they change V without it, whatever acts on others: they move to the bit as without it. plan/fuse.c makes
 * one op of a prediction's. */

static bool acts_on(const sk_only *only, size_t slot) {
    return sk_only_has_slot(only, slot);
}

/* Adds up the forces on a part; false where they are not all uniform, or F is wanted later on. */
static bool add_up_uniform_forces(const sk_rules *rules, sk_plan_part *part) {
    size_t length = 0, slot = part->first_slot;
    part->uniform = (sk_uniform_force){.label = ""};
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!pushes(force) || !acts_on(&force->only, slot)) continue;
        if (!sk_force_add_uniform(force, &part->uniform)) return false;
        char *label = part->uniform.label;
        size_t room = sizeof part->uniform.label - length;
        int added = snprintf(label + length, room, "%s%s", length ? ", " : "", force->label);
        if (added > 0 && (size_t)added < room) length += (size_t)added;
    }
    for (size_t i = 0; i < rules->colliders.count; i++) {
        const sk_collider *collider = rules->colliders.data[i];
        if (collider->common->enabled && sk_contact_reads_force(collider) && acts_on(&collider->only, slot))
            return false;
    }
    return true;
}

/* Whether a rule that steers, or bounds the velocity, moves particles of a part. */
static bool is_steered(const sk_rules *rules, const sk_plan_part *part) {
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (*force->enabled && force->type->phase != SK_PUSHES && force->moved.first < force->moved.end &&
            acts_on(&force->only, part->first_slot))
            return true;
    }
    return false;
}

/* Cuts the parts at a slot. */
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

/* Finds the parts; once a plan, for ops point to them. */
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

/* An op for a part; for all slots where there is but one. */
static void add_op_of_part(sk_plan_builder *builder, sk_op op, const sk_plan_part *part) {
    bool whole = part->first_slot == 0 && part->end_slot == builder->slot_count;
    sk_add_op(builder, whole ? op : sk_op_for(op, part->first_slot, part->end_slot));
}

/* V += h w F, on a part. */
static void write_kick_of_part(sk_plan_builder *builder, const sk_plan_part *part) {
    add_op_of_part(builder,
                   (sk_op){.kind = SK_OP_COMBINE,
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
                   (sk_op){.kind = SK_OP_COMBINE,
                           .order = SK_FREE,
                           .kernel = sk_combine_pull.version[builder->isa],
                           .dst = SK_V,
                           .source = {SK_V, SK_NONE, SK_NONE},
                           .rule = &part->uniform,
                           .end = builder->slot_count},
                   part);
}

/* Where rules steer, or bound the velocity, they come between kick and drift; what is steered has nothing left to be
 * added then. */
static void write_steered_kicks(sk_plan_builder *builder) {
    sk_plan *plan = builder->plan;
    for (size_t i = 0; i < plan->parts.count && sk_writes_forces(builder); i++)
        if (plan->parts.data[i].steered) write_kick_of_part(builder, &plan->parts.data[i]);
    for (size_t i = 0; i < plan->parts.count; i++)
        if (plan->parts.data[i].steered) plan->parts.data[i].uniform = (sk_uniform_force){.label = ""};
    sk_write_steering(builder);
}

static bool any_collider(const sk_rules *rules) {
    for (size_t i = 0; i < rules->colliders.count; i++)
        if (rules->colliders.data[i]->common->enabled) return true;
    return false;
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
    if (any_collider(builder->rules)) sk_write_sum(builder, SK_V0, 1, SK_V, 0, SK_NONE);
    sk_write_sum(builder, SK_X, 1, SK_X, builder->h, SK_V);
    builder->predicted = true;
    sk_write_stage_time(builder, 1);
}

void sk_write_correction(sk_plan_builder *builder) {
    add_combine(builder, &sk_combine_correction, SK_V, 1 / builder->h, SK_X, builder->h, SK_X0);
}

/* The elements of a sweep's op: strip rows that have a partner, slabs or groups. */
static size_t rows_of(const sk_sweep *sweep, size_t reach) {
    return sweep->strips ? sweep->walk.rows - reach : sweep->slab_start ? sweep->walk.rows : sweep->group_count;
}

/* A sweep's op, in each `every`-th substep; projections share their stiffness among `coefficient` ops. */
static void add_sweep(sk_plan_builder *builder, const sk_sweep *sweep, sk_half half, sk_op_kind kind,
                      const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second, double coefficient,
                      size_t every) {
    const sk_kernels *walk = sweep->strips ? &kernels->strips : &kernels->groups;
    sk_add_op(builder, (sk_op){.kind = kind,
                               .order = SK_ORDERED,
                               .kernel = walk->version[builder->isa],
                               .dst = dst,
                               .source = {SK_X, second},
                               .coefficient = {coefficient},
                               .rule = sweep,
                               .label = sweep->label,
                               .walk = sweep->walk,
                               .half = half,
                               .every = every,
                               .end = rows_of(sweep, sweep->walk.reach)});
}

/* An op for each sweep of a batch from the `first` on. */
static void add_sweeps(sk_plan_builder *builder, const sk_batch *batch, size_t first, sk_op_kind kind,
                       const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second) {
    for (size_t i = first; i < batch->sweep_count; i++)
        add_sweep(builder, &batch->sweeps[i], SK_WHOLE, kind, kernels, dst, second, 1, 0);
}

/* An op for all sweeps of a batch along the same strips: each strip row's sum is worked out whole, so the
 * op is free. `first` is left at the first sweep that is not in strips. */
static void add_strip_sums(sk_plan_builder *builder, const sk_batch *batch, size_t *first, const sk_op *model,
                           const sk_sweep_kernels *kernels) {
    for (; *first < batch->sweep_count && batch->sweeps[*first].strips; *first += batch->sweeps[*first].together) {
        const sk_sweep *sweep = &batch->sweeps[*first];
        sk_op op = *model;
        op.order = SK_FREE;
        op.kernel = kernels->strips.version[builder->isa];
        op.rule = sweep;
        op.label = batch->label;
        op.walk = sweep->walk;
        op.end = sweep->walk.rows;
        for (size_t i = 1; i < sweep->together; i++)
            if (sweep[i].walk.reach > op.walk.reach) op.walk.reach = sweep[i].walk.reach;
        sk_add_op(builder, op);
    }
}

void sk_add_sums(sk_plan_builder *builder, const sk_batch *batch, sk_op op, const sk_sweep_kernels *kernels) {
    size_t first = 0;
    add_strip_sums(builder, batch, &first, &op, kernels);
    op.order = SK_ORDERED;
    op.kernel = kernels->groups.version[builder->isa];
    for (; first < batch->sweep_count; first++) {
        const sk_sweep *sweep = &batch->sweeps[first];
        op.rule = sweep;
        op.label = sweep->label;
        op.walk = sweep->walk;
        op.end = rows_of(sweep, sweep->walk.reach);
        sk_add_op(builder, op);
    }
}

static bool has_bound(const sk_batch *batch) {
    return sk_batch_is_on(batch) && batch->bound && *batch->bound < SK_UNBOUNDED;
}

static bool is_kept(const sk_limit *limit) {
    return *limit->enabled && limit->count && *limit->bound < SK_UNBOUNDED;
}

void sk_write_forces(sk_plan_builder *builder) {
    for (size_t i = 0; i < builder->rules->batches.count; i++) {
        const sk_batch *batch = builder->rules->batches.data[i];
        sk_op op = {.kind = SK_OP_FORCE, .dst = SK_F, .source = {SK_X, SK_V}, .coefficient = {1}};
        if (is_on(batch)) sk_add_sums(builder, batch, op, &batch->type->force);
    }
}

static void write_multipliers(sk_plan_builder *builder, int passes) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!is_on(batch) || !keeps_multiplier(batch, passes)) continue;
        for (size_t w = 0; w < batch->sweep_count; w++) {
            const sk_sweep *sweep = &batch->sweeps[w];
            sk_walk walk = sweep->walk;
            walk.reach = 0;
            sk_add_op(builder, (sk_op){.kind = SK_OP_MULTIPLIER,
                                       .order = SK_ORDERED,
                                       .kernel = sk_sweep_clear_multipliers,
                                       .rule = sweep,
                                       .label = sweep->label,
                                       .walk = walk,
                                       .end = rows_of(sweep, 0)});
        }
    }
}

/* In which substeps what may wait is taken: in every second one, if they come in pairs. */
static size_t seldom_of(const sk_plan_builder *builder) {
    return builder->iterations % 2 == 0 ? 2 : 0;
}

static sk_op limit_op(const sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity, size_t every) {
    return (sk_op){.kind = SK_OP_LIMIT,
                   .order = SK_FREE,
                   .kernel = limit->kernel.version[builder->isa],
                   .dst = SK_X,
                   .source = {SK_X, velocity},
                   .rule = limit,
                   .label = limit->label,
                   .every = every,
                   .begin = limit->first_slot,
                   .end = limit->first_slot + limit->slot_count};
}

/* The distances of a coarse grid, forth and back, and what they moved is carried to all between. Only what was
 * predicted says from where they moved. */
static void write_coarse(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_coarse *coarse = batch->coarse;
    if (!builder->predicted || !batch->sweep_count || !batch->sweeps[0].strips) return;
    for (int time = 0; time < coarse->times; time++)
        for (size_t i = 0; i < batch->sweep_count; i++)
            add_sweep(builder, &batch->sweeps[time % 2 ? batch->sweep_count - 1 - i : i], SK_WHOLE, SK_OP_LIMIT,
                      &batch->type->limit, SK_X, SK_NONE, 1, 0);
    if (!coarse->carries) return;
    sk_walk walk = batch->sweeps[0].walk;
    walk.reach = sk_coarse_reach(coarse);
    sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                               .order = SK_ORDERED,
                               .kernel = sk_coarse_carry.version[builder->isa],
                               .dst = SK_X,
                               .source = {SK_X, SK_X0, SK_V},
                               .coefficient = {0, builder->h},
                               .from_prediction = true,
                               .rule = coarse,
                               .label = "carried along",
                               .walk = walk,
                               .end = walk.rows});
}

/* Batches that bound and do nothing else come before those that pull: what is swept last is kept best, which are edges. */
static void write_spans(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        if (is_kept(limit) && limit->early && builder->predicted) sk_add_op(builder, limit_op(builder, limit, SK_NONE, 0));
    }
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!batch->only_bounds || !has_bound(batch)) continue;
        if (batch->coarse) write_coarse(builder, batch);
        else add_sweeps(builder, batch, 0, SK_OP_LIMIT, &batch->type->limit, SK_X, SK_NONE);
    }
}

/* Whether a batch may be taken in every second substep: its elements' own oscillations are slow against that. Else it would
 * be thrown as far beyond its place as it had been before, and shiver for ever. A multiplier -C/(2 w + 1/(2 k h^2)) would
 * come to rest at any stiffness, but not where it ought to: what is stiff hung 15 % too low by it. */
static bool may_wait(const sk_batch *batch, double h) {
    static const double most = 0.55;
    return batch->quickness > 0 && ((const sk_material *)batch->params)->stiffness * h * h * batch->quickness <= most;
}

/* A batch's sweeps on the way through all batches, or those halves that are left for the way back. What
 * is taken in every second substep gets twice the stiffness for it, for it stands for both. */
static void write_batch(sk_plan_builder *builder, const sk_batch *batch, bool back, int passes, int sharing) {
    bool keeps = keeps_multiplier(batch, passes);
    size_t every = may_wait(batch, builder->h) && !keeps && passes == 1 ? seldom_of(builder) : 0;
    double coefficient = (double)sharing / (every ? (double)every : 1);
    for (size_t i = 0; i < batch->sweep_count; i++) {
        const sk_sweep *sweep = &batch->sweeps[back ? batch->sweep_count - 1 - i : i];
        sk_half half = !batch->both_ways || !sweep->strips ? SK_WHOLE : back ? SK_ODD_HALF : SK_EVEN_HALF;
        if (back && half == SK_WHOLE) continue;
        add_sweep(builder, sweep, half, SK_OP_PROJECT, keeps ? &batch->type->project_damped : &batch->type->project,
                  SK_X, keeps ? SK_X0 : SK_NONE, coefficient, every);
    }
}

/* A sweep over every batch, with an n-th of its stiffness and damping for `sharing` n.
 *
 * One projection after the other, P1 P2 ... Pn, is no symmetric matrix: what a displacement calls forth is a force
 * that may do work round a cycle, and does. A grid's few directions bear it; a block of rigid springs, many times as
 * many as it has freedoms, fed on it until it flew apart or shivered for ever. Half of each direction's springs forth,
 * and the other half in the opposite order back, is nearly P1 P2 ... Pn ... P2 P1, which is symmetric, and costs no
 * more than one sweep. */
static void write_pass(sk_plan_builder *builder, int passes, int sharing) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (is_on(rules->batches.data[i])) write_batch(builder, rules->batches.data[i], false, passes, sharing);
    for (size_t i = rules->batches.count; i-- > 0;)
        if (is_on(rules->batches.data[i])) write_batch(builder, rules->batches.data[i], true, passes, sharing);
}

void sk_write_projections(sk_plan_builder *builder, int passes) {
    write_multipliers(builder, passes);
    write_spans(builder);
    for (int pass = 0; pass < passes; pass++) write_pass(builder, passes, 1);
}

void sk_write_shared_projections(sk_plan_builder *builder, int passes) {
    write_spans(builder);
    for (int pass = 0; pass < passes; pass++) {
        write_multipliers(builder, 1);
        write_pass(builder, 1, passes);
    }
}

bool sk_writes_forces(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool any = !sk_writes_steering(rules);
    for (size_t i = 0; i < rules->forces.count; i++) any |= pushes(rules->forces.data[i]);
    for (size_t i = 0; i < rules->batches.count; i++) any |= is_on(rules->batches.data[i]);
    return any || any_collider(rules);
}

bool sk_writes_velocity_forces(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (is_on(rules->batches.data[i]) && sk_batch_damping_time(rules->batches.data[i]) > 0) return true;
    for (size_t i = 0; i < rules->forces.count; i++)
        if (pushes(rules->forces.data[i]) && sk_force_on_velocity(rules->forces.data[i])) return true;
    return false;
}

bool sk_writes_corrections(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    if (sk_writes_meetings(builder) || any_collider(rules)) return true;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (has_bound(rules->batches.data[i])) return true;
    for (size_t i = 0; i < rules->limits.count; i++)
        if (is_kept(rules->limits.data[i])) return true;
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
    bool settles = sort == SK_CONTACT_UPDATE;
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
            sk_op sweep = {.kind = SK_OP_CONTACT_POSITION,
                           .order = SK_FREE,
                           .kernel = sk_contact_sweep.version[builder->isa],
                           .dst = SK_X,
                           .source = {SK_X, SK_X0, settles ? SK_V0 : SK_NONE},
                           .coefficient = {settles},
                           .rule = collider,
                           .label = collider->label,
                           .end = builder->slot_count};
            sk_add_op_on(builder, sweep, &collider->only);
        }
        sk_op op = {.kind = sorts[sort].kind,
                                    .order = SK_FREE,
                                    .kernel = sorts[sort].kernels->version[builder->isa],
                                    .dst = sorts[sort].dst,
                                    .source = {SK_X, settles ? SK_X0 : SK_NONE, settles ? SK_V0 : SK_NONE},
                                    .rule = collider,
                                    .label = collider->label,
                                    .end = builder->slot_count};
        sk_add_op_on(builder, op, &collider->only);
    }
}

/* A sweep hands what is too long on by a few edges. Measured on irregular meshes of 64 x 64 that hang, with a limit of 1 %,
 * largest stretch at rest by sweeps: 1.56 (1), 1.13 (2), 1.02 (4), 1.00 (8). Where all is within, one costs next to nothing. */
enum { LIMIT_SWEEPS = 4 };

/* The limits of edges that go along strips, and bounds that are nothing else; or those of all others. */
static void write_strain_limits(sk_plan_builder *builder, sk_vector velocity, bool first) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!has_bound(batch) || batch->coarse) continue;
        if (batch->only_bounds && velocity == SK_NONE) continue; // they were with the projections
        const sk_sweep_kernels *kernels = velocity == SK_NONE ? &batch->type->limit : &batch->type->limit_moving;
        for (int iteration = 0; iteration < (first ? 1 : LIMIT_SWEEPS); iteration++)
            for (size_t w = 0; w < batch->sweep_count; w++)
                if ((batch->only_bounds || batch->sweeps[w].strips) == first)
                    add_sweep(builder, &batch->sweeps[w], SK_WHOLE, SK_OP_LIMIT, kernels, SK_X, velocity, 1, 0);
    }
}

/* Tethers pull each particle on its own, and leave its neighbours behind. On a grid, whose ways are straight, nothing comes
 * of that, and its edges come before; a mesh of 64 x 64 with a limit of 1 % kept edges of 3 % beside its pins, however often
 * they were swept before its tethers. */
void sk_write_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    write_strain_limits(builder, velocity, true);
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        if (!is_kept(limit) || limit->early) continue;
        size_t every = velocity == SK_NONE && limit->seldom ? seldom_of(builder) : 0;
        sk_add_op(builder, limit_op(builder, limit, velocity, every));
    }
    write_strain_limits(builder, velocity, false);
    sk_write_meetings(builder, SK_MEETING_PUSH, velocity);
}

skein_status sk_refuse_rigid(const sk_rules *rules, const char *method, skein_error *error) {
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        const sk_material *material = batch->params;
        if (sk_batch_is_on(batch) && material->stiffness >= SK_UNBOUNDED)
            return sk_fail(error, SKEIN_ERROR_VALUE, "method.type",
                           "%s needs finite stiffness, but '%s' is rigid: give it a stiffness or use xpbd", method,
                           batch->label);
    }
    return SKEIN_OK;
}
