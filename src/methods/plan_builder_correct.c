/* Ops that move positions: projections of constraints, bounds on lengths, and limits, of which methods with forces
 * write the limits alone. */
#include "constraints/sweep.h"
#include "methods/plan_builder.h"

/* Without damping the multiplier is zero whenever it is read in the only pass of a substep, and counts for nothing
 * in a rigid batch. */
static bool keeps_multiplier(const sk_batch *batch, int passes) {
    bool rigid = ((const sk_material *)batch->params)->stiffness >= SK_UNBOUNDED;
    return (passes > 1 && !rigid) || sk_batch_damping_time(batch) > 0;
}

/* A sweep's op, in each `every`-th substep; projections share their stiffness among `coefficient` ops. */
static void add_sweep(sk_plan_builder *builder, const sk_sweep *sweep, sk_half half, sk_op_kind kind,
                      const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second, double coefficient,
                      size_t every, sk_op_while during) {
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
                               .during = during,
                               .end = sk_rows_of_sweep(sweep, sweep->walk.reach)});
}

/* An op for each sweep of a batch from the `first` on. */
static void add_sweeps(sk_plan_builder *builder, const sk_batch *batch, size_t first, sk_op_kind kind,
                       const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second) {
    for (size_t i = first; i < batch->sweep_count; i++)
        add_sweep(builder, &batch->sweeps[i], SK_WHOLE, kind, kernels, dst, second, 1, 0, SK_ALWAYS);
}

static bool has_bound(const sk_batch *batch) {
    return sk_batch_is_on(batch) && batch->bound && *batch->bound < SK_UNBOUNDED;
}

static bool is_kept(const sk_limit *limit) {
    return *limit->enabled && limit->count && *limit->bound < SK_UNBOUNDED;
}

static void write_multipliers(sk_plan_builder *builder, int passes) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!sk_batch_pulls(batch) || !keeps_multiplier(batch, passes)) continue;
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
                                       .end = sk_rows_of_sweep(sweep, 0)});
        }
    }
}

/* In which substeps what may wait is taken: in every second one, if they come in pairs. Where surfaces meet, only while
 * none is near another: a heap, which what it lies on holds where it is, went to and fro between substeps with it and
 * without it for ever, at 3 cm/s. */
static size_t seldom_of(const sk_plan_builder *builder) {
    return builder->iterations % 2 == 0 ? 2 : 0;
}

/* Which variants of what may wait are written. */
static int variants_of(const sk_plan_builder *builder, size_t every) {
    return every && sk_writes_meetings(builder) ? 2 : 1;
}

static sk_op_while during_of(int variants, int variant) {
    return variants == 1 ? SK_ALWAYS : variant ? SK_WHILE_NEAR : SK_WHILE_APART;
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

static void add_limit(sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity, size_t every) {
    int variants = variants_of(builder, every);
    for (int i = 0; i < variants; i++) {
        sk_op op = limit_op(builder, limit, velocity, i ? 0 : every);
        op.during = during_of(variants, i);
        sk_add_op(builder, op);
    }
}

/* The distances of a coarse grid, forth and back, and what they moved is carried to all between. Only what was
 * predicted says from where they moved. */
static void write_coarse(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_coarse *coarse = batch->coarse;
    if (!builder->predicted || !batch->sweep_count || !batch->sweeps[0].strips) return;
    for (int time = 0; time < coarse->times; time++)
        for (size_t i = 0; i < batch->sweep_count; i++)
            add_sweep(builder, &batch->sweeps[time % 2 ? batch->sweep_count - 1 - i : i], SK_WHOLE, SK_OP_LIMIT,
                      &batch->type->limit, SK_X, SK_NONE, 1, 0, SK_ALWAYS);
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

/* Tethers that stand beside coarse grids, for methods that have these. */
static void write_tethers(sk_plan_builder *builder, sk_limit_turn turn, size_t every) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        if (is_kept(limit) && limit->turn == turn && builder->predicted) add_limit(builder, limit, SK_NONE, every);
    }
}

/* Batches that bound and do nothing else come before those that pull: what is swept last is kept best, which are edges.
 */
static void write_spans(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    write_tethers(builder, SK_LIMIT_BEFORE_COARSE, 0);
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!batch->only_bounds || !has_bound(batch)) continue;
        if (batch->coarse) write_coarse(builder, batch);
        else add_sweeps(builder, batch, 0, SK_OP_LIMIT, &batch->type->limit, SK_X, SK_NONE);
    }
    write_tethers(builder, SK_LIMIT_AFTER_COARSE, seldom_of(builder));
}

/* Whether a batch may be taken in every second substep: its elements' own oscillations are slow against that. Else it
 * would be thrown as far beyond its place as it had been before, and shiver for ever. A multiplier -C/(2 w + 1/(2 k
 * h^2)) would come to rest at any stiffness, but not where it ought to: what is stiff hung 15 % too low by it. */
static bool may_wait(const sk_batch *batch, double h) {
    static const double most = 0.55;
    return batch->quickness > 0 && ((const sk_material *)batch->params)->stiffness * h * h * batch->quickness <= most;
}

/* A batch's sweeps on the way through all batches, or those halves that are left for the way back. What
 * is taken in every second substep gets twice the stiffness for it, for it stands for both. */
static void write_batch_every(sk_plan_builder *builder, const sk_batch *batch, bool back, int sharing, bool keeps,
                              size_t every, sk_op_while during) {
    double coefficient = (double)sharing / (every ? (double)every : 1);
    for (size_t i = 0; i < batch->sweep_count; i++) {
        const sk_sweep *sweep = &batch->sweeps[back ? batch->sweep_count - 1 - i : i];
        // what is soft enough to wait gains too little to need both ways
        bool whole = !batch->both_ways || !sweep->strips || every;
        sk_half half = whole ? SK_WHOLE : back ? SK_ODD_HALF : SK_EVEN_HALF;
        if (back && half == SK_WHOLE) continue;
        add_sweep(builder, sweep, half, SK_OP_PROJECT, keeps ? &batch->type->project_damped : &batch->type->project,
                  SK_X, keeps ? SK_X0 : SK_NONE, coefficient, every, during);
    }
}

static void write_batch(sk_plan_builder *builder, const sk_batch *batch, bool back, int passes, int sharing) {
    bool keeps = keeps_multiplier(batch, passes);
    size_t every = may_wait(batch, builder->h) && !keeps && passes == 1 ? seldom_of(builder) : 0;
    int variants = variants_of(builder, every);
    for (int i = 0; i < variants; i++)
        write_batch_every(builder, batch, back, sharing, keeps, i ? 0 : every, during_of(variants, i));
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
        if (sk_batch_pulls(rules->batches.data[i]))
            write_batch(builder, rules->batches.data[i], false, passes, sharing);
    for (size_t i = rules->batches.count; i-- > 0;)
        if (sk_batch_pulls(rules->batches.data[i])) write_batch(builder, rules->batches.data[i], true, passes, sharing);
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

/* A sweep hands what is too long on by a few edges. Measured on irregular meshes of 64 x 64 that hang, with a limit of
 * 1 %, largest stretch at rest by sweeps: 1.56 (1), 1.13 (2), 1.02 (4), 1.00 (8). Where all is within, one costs next
 * to nothing. */
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
                    add_sweep(builder, &batch->sweeps[w], SK_WHOLE, SK_OP_LIMIT, kernels, SK_X, velocity, 1, 0, SK_ALWAYS);
    }
}

/* Tethers pull each particle on its own, and leave its neighbours behind. On a grid, whose ways are straight, nothing
 * comes of that, and its edges come before; a mesh of 64 x 64 with a limit of 1 % kept edges of 3 % beside its pins,
 * however often they were swept before its tethers. */
void sk_write_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    write_strain_limits(builder, velocity, true);
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        bool last = limit->turn == SK_LIMIT_LAST || limit->turn == SK_LIMIT_SELDOM ||
                    (limit->turn == SK_LIMIT_WITHOUT_COARSE && !builder->predicted);
        if (!is_kept(limit) || !last) continue;
        size_t every = velocity == SK_NONE && limit->turn == SK_LIMIT_SELDOM ? seldom_of(builder) : 0;
        add_limit(builder, limit, velocity, every);
    }
    write_strain_limits(builder, velocity, false);
    if (rules->leashes)
        sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                                   .order = SK_FREE,
                                   .kernel = sk_leash_hold.version[builder->isa],
                                   .dst = SK_X,
                                   .source = {SK_X, velocity},
                                   .rule = rules->leashes,
                                   .label = "leashes",
                                   .end = builder->slot_count});
    sk_write_meetings(builder, SK_MEETING_PUSH, velocity);
}

bool sk_writes_corrections(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    if (sk_writes_meetings(builder) || sk_writes_contacts(rules) || rules->leashes) return true;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (has_bound(rules->batches.data[i])) return true;
    for (size_t i = 0; i < rules->limits.count; i++)
        if (is_kept(rules->limits.data[i])) return true;
    return false;
}
