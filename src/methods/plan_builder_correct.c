/* Ops that correct positions: projections of constraints, and before them bounds on lengths. Limits are in plan_builder_limit.c. */
#include "constraints/sweep.h"
#include "methods/plan_builder.h"

/* Undamped batches need no multipliers if there is one pass a substep, where they are zero when they are read, nor if
 * they are rigid, where they have no effect. */
static bool keeps_multiplier(const sk_batch *batch, int passes) {
    bool rigid = ((const sk_material *)batch->params)->stiffness >= SK_UNBOUNDED;
    return (passes > 1 && !rigid) || sk_batch_damping_time(batch) > 0;
}

void sk_add_sweep(sk_plan_builder *builder, const sk_sweep *sweep, sk_half half, sk_op_kind kind,
                  const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second, double coefficient, size_t every,
                  sk_op_while during, const bool *strained) {
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
                               .strained = strained,
                               .end = sk_rows_of_sweep(sweep, sweep->walk.reach)});
}

/* Adds an op for each sweep of a batch from the `first` on. */
static void add_sweeps(sk_plan_builder *builder, const sk_batch *batch, size_t first, sk_op_kind kind,
                       const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second) {
    for (size_t i = first; i < batch->sweep_count; i++)
        sk_add_sweep(builder, &batch->sweeps[i], SK_WHOLE, kind, kernels, dst, second, 1, 0, SK_ALWAYS, NULL);
}

bool sk_batch_has_bound(const sk_batch *batch) {
    return sk_batch_is_on(batch) && batch->bound && *batch->bound < SK_UNBOUNDED;
}

bool sk_limit_is_kept(const sk_limit *limit) {
    return sk_limit_is_on(limit) && limit->count && *limit->bound < SK_UNBOUNDED;
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

/* How often batches that may wait are projected: in every second substep, if the number of substeps is even. Where
 * surfaces meet, only while none is near another: a resting heap oscillated for ever between substeps with the
 * projection and without, at 3 cm/s. */
static size_t seldom_of(const sk_plan_builder *builder) {
    return builder->iterations % 2 == 0 ? 2 : 0;
}

/* How many variants of an op that may wait are written: one for surfaces apart and one for surfaces near, or one. */
static int variants_of(const sk_plan_builder *builder, size_t every) {
    return every && sk_writes_meetings(builder) ? 2 : 1;
}

static sk_op_while during_of(int variants, int variant) {
    return variants == 1 ? SK_ALWAYS : variant ? SK_WHILE_NEAR : SK_WHILE_APART;
}

static sk_op limit_op(const sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity) {
    return (sk_op){.kind = SK_OP_LIMIT,
                   .order = SK_FREE,
                   .kernel = limit->kernel.version[builder->isa],
                   .dst = SK_X,
                   .source = {SK_X, velocity},
                   .rule = limit,
                   .label = limit->label,
                   .begin = limit->first_slot,
                   .end = limit->first_slot + limit->slot_count};
}

/* Tethers, in every substep: taken in every second one they throw who hangs from them to and fro between both, for ever. A sheet of 20 x 20 that
 * hung still by its corners had 7 cm/s in its velocities so, and a sheet by one point turned around it. Where surfaces may meet, grids' wait all
 * the same until some do: with firmer ones a sheet that fell on an edge with 11 m/s went through it for two frames, once in 59 falls. */
void sk_add_limit(sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity) {
    const bool waits = limit->order == SK_LIMIT_AFTER_COARSE || limit->order == SK_LIMIT_SELDOM;
    const size_t every = waits && velocity == SK_NONE && sk_writes_meetings(builder) ? seldom_of(builder) : 0;
    const int variants = variants_of(builder, every);
    for (int i = 0; i < variants; i++) {
        sk_op op = limit_op(builder, limit, velocity);
        op.every = i ? 0 : every;
        op.during = during_of(variants, i);
        sk_add_op(builder, op);
    }
}

/* Sweeps over distances whose corrections are carried on, forward and backward in turn. */
static void add_carried_sweeps(sk_plan_builder *builder, const sk_batch *batch, int times) {
    for (int time = 0; time < times; time++)
        for (size_t i = 0; i < batch->sweep_count; i++)
            sk_add_sweep(builder, &batch->sweeps[time % 2 ? batch->sweep_count - 1 - i : i], SK_WHOLE, SK_OP_LIMIT,
                         &batch->type->limit, SK_X, SK_NONE, 1, 0, SK_ALWAYS, NULL);
}

/* What they have moved since the prediction is carried to the particles between: over `rows`, along the walk if there is one. */
static void add_carry(sk_plan_builder *builder, const sk_kernels *kernels, const void *rule, sk_walk walk, size_t rows) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                               .order = SK_ORDERED,
                               .kernel = kernels->version[builder->isa],
                               .dst = SK_X,
                               .source = {SK_X, SK_X0, SK_V},
                               .coefficient = {0, builder->h},
                               .from_prediction = true,
                               .rule = rule,
                               .label = "carried along",
                               .walk = walk,
                               .end = rows});
}

/* An op of an aggregate, which has one element. */
static void add_aggregate_op(sk_plan_builder *builder, const sk_kernels *kernels, const sk_aggregate *aggregate,
                             const char *label) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                               .order = SK_ORDERED,
                               .kernel = kernels->version[builder->isa],
                               .dst = SK_X,
                               .source = {SK_X, SK_NONE, SK_NONE},
                               .rule = aggregate,
                               .label = label,
                               .end = 1});
}

/* What hubs stand for, from the finest aggregate to this one. */
static void write_gathering(sk_plan_builder *builder, const sk_aggregate *aggregate) {
    if (aggregate->finer) write_gathering(builder, aggregate->finer);
    add_aggregate_op(builder, &sk_aggregate_gather, aggregate, "gathered");
}

/* The distances of a coarse grid or of hubs, and then what these carry. That is known only from a prediction. */
static void write_carriers(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_coarse *coarse = batch->coarse;
    const sk_aggregate *aggregate = batch->aggregate;
    if (!builder->predicted || (coarse && (!batch->sweep_count || !batch->sweeps[0].strips))) return;
    if (aggregate && aggregate->coarsest) write_gathering(builder, aggregate);
    add_carried_sweeps(builder, batch, coarse ? coarse->times : aggregate->times);
    if (aggregate) add_aggregate_op(builder, &sk_aggregate_carry, aggregate, "carried along");
    if (!coarse || !coarse->carries) return;
    sk_walk walk = batch->sweeps[0].walk;
    walk.reach = sk_coarse_reach(coarse);
    add_carry(builder, &sk_coarse_carry, coarse, walk, walk.rows);
}

/* Whether a cloth has its coarse grids: with methods that predict, and until it is cut. */
bool sk_limit_has_coarse(const sk_plan_builder *builder, const sk_limit *limit) {
    return builder->predicted && !limit->cut_length;
}

/* Tethers that go with coarse grids, for methods that have these. */
static void write_tethers(sk_plan_builder *builder, sk_limit_order order) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        if (sk_limit_is_kept(limit) && limit->order == order && sk_limit_has_coarse(builder, limit))
            sk_add_limit(builder, limit, SK_NONE);
    }
}

/* Batches that only bound lengths come before those that pull: what is swept last is satisfied best, and that should be
 * the edges. */
static void write_spans(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    write_tethers(builder, SK_LIMIT_BEFORE_COARSE);
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!batch->only_bounds || !sk_batch_has_bound(batch)) continue;
        if (sk_batch_carries(batch)) write_carriers(builder, batch);
        else add_sweeps(builder, batch, 0, SK_OP_LIMIT, &batch->type->limit, SK_X, SK_NONE);
    }
    write_tethers(builder, SK_LIMIT_AFTER_COARSE);
}

/* Whether a batch may be projected in every second substep: if its elements' own oscillations are slow compared with
 * that. Else it would overshoot by as much as it was off, and oscillate for ever. A multiplier -C/(2 w + 1/(2 k h^2))
 * would come to rest at any stiffness, but in the wrong place: stiff constraints hung 15 % too low. */
static bool may_wait(const sk_batch *batch, double h) {
    static const double most = 0.55;
    return batch->quickness > 0 && ((const sk_material *)batch->params)->stiffness * h * h * batch->quickness <= most;
}

/* A batch's sweeps on the way forward through all batches, or the halves that are left for the way back. In every
 * second substep a projection has twice the stiffness, for it stands for two. */
static void write_batch_every(sk_plan_builder *builder, const sk_batch *batch, bool back, int sharing, bool keeps,
                              size_t every, sk_op_while during) {
    double coefficient = (double)sharing / (every ? (double)every : 1);
    for (size_t i = 0; i < batch->sweep_count; i++) {
        const sk_sweep *sweep = &batch->sweeps[back ? batch->sweep_count - 1 - i : i];
        // batches soft enough to wait gain too little from sweeps both ways
        bool whole = !batch->both_ways || !sweep->strips || every;
        sk_half half = whole ? SK_WHOLE : back ? SK_ODD_HALF : SK_EVEN_HALF;
        if (back && half == SK_WHOLE) continue;
        sk_add_sweep(builder, sweep, half, SK_OP_PROJECT, keeps ? &batch->type->project_damped : &batch->type->project,
                     SK_X, keeps ? SK_X0 : SK_NONE, coefficient, every, during, NULL);
    }
}

static void write_batch(sk_plan_builder *builder, const sk_batch *batch, bool back, int passes, int sharing) {
    bool keeps = keeps_multiplier(batch, passes);
    size_t every = may_wait(batch, builder->h) && !keeps && passes == 1 ? seldom_of(builder) : 0;
    int variants = variants_of(builder, every);
    for (int i = 0; i < variants; i++)
        write_batch_every(builder, batch, back, sharing, keeps, i ? 0 : every, during_of(variants, i));
}

/* A sweep over every batch, with a `sharing`-th of its stiffness and damping.
 *
 * A sequence of projections P1 P2 ... Pn is not a symmetric matrix: the force that it makes of a displacement is not
 * conservative, and can do work round a cycle. With the few directions of a grid that does no harm; a block of rigid
 * springs, with many times as many as degrees of freedom, gained energy until it flew apart or shivered for ever. Half
 * of each direction's springs forward, and the other half in the opposite order back, is nearly P1 P2 ... Pn ... P2 P1,
 * which is symmetric, and costs no more than one sweep. */
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
