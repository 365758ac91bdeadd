/* Ops that correct positions: projections of constraints, bounds on lengths, and limits. Methods that integrate forces
 * use only the limits. */
#include <math.h>

#include "constraints/sweep.h"
#include "methods/plan_builder.h"

/* Undamped batches need no multipliers if there is one pass a substep, where they are zero when they are read, nor if
 * they are rigid, where they have no effect. */
static bool keeps_multiplier(const sk_batch *batch, int passes) {
    bool rigid = ((const sk_material *)batch->params)->stiffness >= SK_UNBOUNDED;
    return (passes > 1 && !rigid) || sk_batch_damping_time(batch) > 0;
}

/* Adds a sweep's op, run in each `every`-th substep; `coefficient` is the number of ops that share the stiffness. */
static void add_sweep(sk_plan_builder *builder, const sk_sweep *sweep, sk_half half, sk_op_kind kind,
                      const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second, double coefficient,
                      size_t every, sk_op_while during, const bool *strained) {
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
        add_sweep(builder, &batch->sweeps[i], SK_WHOLE, kind, kernels, dst, second, 1, 0, SK_ALWAYS, NULL);
}

static bool has_bound(const sk_batch *batch) {
    return sk_batch_is_on(batch) && batch->bound && *batch->bound < SK_UNBOUNDED;
}

static bool is_kept(const sk_limit *limit) {
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

/* Tethers, in every substep: taken in every second one they throw who hangs from them to and fro between both, for ever. A sheet of 20 x 20 that
 * hung still by its corners had 7 cm/s in its velocities so, and a sheet by one point turned around it. */
static void add_limit(sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                               .order = SK_FREE,
                               .kernel = limit->kernel.version[builder->isa],
                               .dst = SK_X,
                               .source = {SK_X, velocity},
                               .rule = limit,
                               .label = limit->label,
                               .begin = limit->first_slot,
                               .end = limit->first_slot + limit->slot_count});
}

/* Sweeps over distances whose corrections are carried on, forward and backward in turn. */
static void add_carried_sweeps(sk_plan_builder *builder, const sk_batch *batch, int times) {
    for (int time = 0; time < times; time++)
        for (size_t i = 0; i < batch->sweep_count; i++)
            add_sweep(builder, &batch->sweeps[time % 2 ? batch->sweep_count - 1 - i : i], SK_WHOLE, SK_OP_LIMIT,
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

/* The distances of a coarse grid or of hubs, and then what these carry. That is known only from a prediction. */
static void write_carriers(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_coarse *coarse = batch->coarse;
    const sk_aggregate *aggregate = batch->aggregate;
    if (!builder->predicted || (coarse && (!batch->sweep_count || !batch->sweeps[0].strips))) return;
    add_carried_sweeps(builder, batch, coarse ? coarse->times : aggregate->times);
    if (aggregate) add_carry(builder, &sk_aggregate_carry, aggregate, (sk_walk){0}, 1);
    if (!coarse || !coarse->carries) return;
    sk_walk walk = batch->sweeps[0].walk;
    walk.reach = sk_coarse_reach(coarse);
    add_carry(builder, &sk_coarse_carry, coarse, walk, walk.rows);
}

/* Whether a cloth has its coarse grids: with methods that predict, and until it is cut. */
static bool has_coarse(const sk_plan_builder *builder, const sk_limit *limit) {
    return builder->predicted && !limit->cut_length;
}

/* Tethers that go with coarse grids, for methods that have these. */
static void write_tethers(sk_plan_builder *builder, sk_limit_order order) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        if (is_kept(limit) && limit->order == order && has_coarse(builder, limit)) add_limit(builder, limit, SK_NONE);
    }
}

/* Batches that only bound lengths come before those that pull: what is swept last is satisfied best, and that should be
 * the edges. */
static void write_spans(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    write_tethers(builder, SK_LIMIT_BEFORE_COARSE);
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!batch->only_bounds || !has_bound(batch)) continue;
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
        add_sweep(builder, sweep, half, SK_OP_PROJECT, keeps ? &batch->type->project_damped : &batch->type->project,
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

enum { LEAST_LIMIT_SWEEPS = 16, MOST_LIMIT_SWEEPS = 64, EDGES_A_SWEEP = 3, LEAST_HELD = 8, LEAST_MORE = 4, MOST_MORE = 32, EDGES_A_MORE = 6 };

/* From side to side of a sheet: of triangles, it has three edges a vertex. */
static double edges_across(const sk_batch *batch) {
    return sqrt((double)batch->count / 3);
}

/* A sweep carries a correction over a few edges, so that the number of sweeps has to grow with the edges from side to side, and all but
 * the first go too far (successive over-relaxation). What hangs by two corners or an edge needs few, or none; what hangs by one point, where
 * folds run together, needs these. Of 33 x 33 that hangs by two corners below each other with a limit of 2 %, the largest stretch at rest
 * in percent: 11.9 by the one sweep before tethers; after them by sweeps as far as the limit 3.9 (4), 2.9 (12); 1.6 times as far 3.9 (4), 2.4 (8); 1.8
 * times 2.0 (8). With a limit of 1 %, grids and meshes of 16, 33 and 64 a side in four such poses, 5 and 10 substeps: up to 40 % without
 * these, 7.5 with one sweep for six edges and at least 8, 1.5 so. 128 x 128 with 5 substeps keeps 2 to 11. Sweeps forth and back
 * are no better. */
static int limit_sweeps_of(const sk_batch *batch) {
    return (int)fmin(fmax(edges_across(batch) / EDGES_A_SWEEP, LEAST_LIMIT_SWEEPS), MOST_LIMIT_SWEEPS);
}

/* How far beyond its bound a sweep takes what the first one left over it. */
static const double beyond = 1.8;

/* A sweep over a batch's bound. */
static void add_limit_sweep(sk_plan_builder *builder, const sk_batch *batch, const sk_sweep *sweep, sk_vector velocity, double far,
                            const bool *strained) {
    const sk_sweep_kernels *kernels = velocity == SK_NONE ? &batch->type->limit : &batch->type->limit_moving;
    add_sweep(builder, sweep, SK_WHOLE, SK_OP_LIMIT, kernels, SK_X, velocity, far, 0, SK_ALWAYS, strained);
}

/* Whether it is an edge's strain that a batch bounds, not that of what carries or spans others. */
static bool limits_strain(const sk_batch *batch) {
    return has_bound(batch) && !sk_batch_carries(batch) && !batch->only_bounds;
}

/* Limits of edges along strips and of batches that only bound lengths, once. */
static void write_first_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!has_bound(batch) || sk_batch_carries(batch)) continue;
        if (batch->only_bounds && velocity == SK_NONE) continue; // write_spans() has written them
        for (size_t w = 0; w < batch->sweep_count; w++)
            if (batch->only_bounds || batch->sweeps[w].strips) add_limit_sweep(builder, batch, &batch->sweeps[w], velocity, 1, NULL);
    }
}

/* How many sweeps the batch that needs most has. */
static int most_limit_sweeps(const sk_rules *rules) {
    int most = 0;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (limits_strain(rules->batches.data[i])) most = (int)fmax(most, limit_sweeps_of(rules->batches.data[i]));
    return most;
}

/* The slots of a batch's particles, [first, end). */
static void find_slots(const sk_batch *batch, size_t *first, size_t *end) {
    *first = SIZE_MAX, *end = 0;
    for (size_t i = 0; i < batch->count * batch->arity; i++) {
        if (batch->slot[i] < *first) *first = batch->slot[i];
        if (batch->slot[i] >= *end) *end = batch->slot[i] + 1;
    }
}

/* Adds an op over slots for those of a batch, while its edges are strained: what else there is must not know of that. */
static void add_op_for(sk_plan_builder *builder, const sk_batch *batch, sk_op op) {
    size_t first, end;
    find_slots(batch, &first, &end);
    if (first < op.begin) first = op.begin;
    if (end > op.end) end = op.end;
    op.strained = &batch->strained;
    if (first < end) sk_add_op(builder, first == 0 && end == builder->slot_count ? op : sk_op_for(op, first, end));
}

bool sk_keeps_planes(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool any = false;
    for (size_t i = 0; i < rules->batches.count; i++) any |= limits_strain(rules->batches.data[i]) || sk_batch_is_firm(rules->batches.data[i]);
    return any && builder->predicted && sk_writes_contacts(rules) && !sk_writes_meetings(builder);
}

/* Nobody is held; if `first`, where a step begins. */
static void forget_planes(sk_plan_builder *builder, const sk_batch *batch, bool first) {
    add_op_for(builder, batch, (sk_op){.kind = SK_OP_LIMIT,
                                       .order = SK_FREE,
                                       .kernel = sk_contact_let_go,
                                       .dst = SK_SUPPORT,
                                       .coefficient = {first},
                                       .label = "let go",
                                       .end = builder->slot_count});
}

void sk_write_forget_planes(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (limits_strain(rules->batches.data[i]) || sk_batch_is_firm(rules->batches.data[i])) forget_planes(builder, rules->batches.data[i], false);
}

/* Finds who is pushed out by colliders that do not bounce, and where to: then he may be held there while sweeps go on. */
static void write_find_held(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_rules *rules = builder->rules;
    const bool known = sk_keeps_planes(builder); // from the second substep on
    if (!sk_writes_meetings(builder)) forget_planes(builder, batch, known); // else contact of surfaces does
    for (size_t i = 0; i < rules->colliders.count; i++) {
        const sk_collider *collider = rules->colliders.data[i];
        if (!collider->common->enabled || sk_contact_reads_force(collider)) continue;
        const sk_op op = {.kind = SK_OP_CONTACT_SWEEP,
                          .order = SK_FREE,
                          .kernel = sk_contact_find_held.version[builder->isa],
                          .dst = SK_SUPPORT,
                          .source = {SK_X, SK_NONE, SK_X0},
                          .coefficient = {known},
                          .also_writes = 1u << SK_T0 | 1u << SK_T1,
                          .rule = collider,
                          .label = collider->label,
                          .end = builder->slot_count};
        if (!collider->only.some) add_op_for(builder, batch, op);
        for (size_t k = 0; k < collider->only.count; k++) {
            sk_op some = op;
            some.begin = collider->only.data[k].first_slot, some.end = collider->only.data[k].end_slot;
            add_op_for(builder, batch, some);
        }
    }
}

/* With friction, for velocities are made of positions afterwards. */
static void write_hold(sk_plan_builder *builder, const sk_batch *batch) {
    add_op_for(builder, batch, (sk_op){.kind = SK_OP_LIMIT,
                                       .order = SK_FREE,
                                       .kernel = sk_contact_hold.version[builder->isa],
                                       .dst = SK_X,
                                       .source = {SK_SUPPORT, SK_T0, SK_T1},
                                       .also_reads = 1u << SK_X0,
                                       .label = "held by colliders",
                                       .end = builder->slot_count});
}

/* Between the last half of sweeps surfaces push apart what is near, and colliders hold whom they hold up. Where a few vertices lie on a
 * corner, and all around hangs, what comes after all sweeps undoes what they have done: 33 x 33 on a box, with a limit of 2 %, kept 39, 17.5
 * and 5.7 % at rest (5, 10 and 20 substeps), on a jelly cube 38, 13 and 4.7; now 3.4, 2.1 and 2.0, and 2.5, 2.0 and 2.0; 100 x 100 106 (10),
 * now 7, with 8 of 33 sweeps so 23, with all 7. (More sweeps after the colliders, with their planes held: 12, 2.6 and 2.0, for what these had
 * done to velocities was done. Two faces meet at a corner, and who is pulled in there is nearer to the other one: by the face that he has come
 * into now, not by that he lay on, 35 % with 5 substeps. Held from the prediction on: no better.) Methods that solve for velocities have all
 * of this in one system: 0.2 %. */
static void write_pushes(sk_plan_builder *builder, bool (*takes_part)(const sk_batch *batch), bool first, bool last) {
    const sk_rules *rules = builder->rules;
    builder->strained = &rules->strained;
    if (!first && !last) sk_write_meetings(builder, SK_MEETING_PUSH_ON, SK_NONE);
    builder->strained = NULL;
    for (size_t i = 0; i < rules->batches.count && sk_writes_contacts(rules); i++) {
        if (!takes_part(rules->batches.data[i])) continue;
        if (first) write_find_held(builder, rules->batches.data[i]);
        else write_hold(builder, rules->batches.data[i]);
    }
}

/* How many more sweeps the largest batch of firm edges has. */
static int more_sweeps_of(const sk_rules *rules) {
    double most = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (sk_batch_is_firm(batch)) most = fmax(most, fmin(fmax(edges_across(batch) / EDGES_A_MORE, LEAST_MORE), MOST_MORE));
    }
    return (int)most;
}

/* The same where nobody has set a limit, for edges that are firm all the same (world/strained.c). The largest stretch of a sheet that lies on a
 * box in percent, with 5, 10 and 20 substeps: 33 x 33 50, 24 and 6 before, 12, 5 and 5 now; irregular 57, 22 and 14, now 13, 5 and 5; 64 x 64
 * 120, 48 and 21, now 26, 8 and 5; 100 x 100 207, 104 and 43, now 34, 11 and 6. Its frames take 1.4 to 2.3 times as long. Where surfaces meet
 * there is none of this: a heap of 100 x 100 that lies had 6 % instead of 16, and took twice as long. */
static void write_more_sweeps(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    const int most = more_sweeps_of(rules);
    if (!most || !sk_writes_contacts(rules) || sk_writes_meetings(builder)) return;
    builder->sweeps_more = true;
    write_pushes(builder, sk_batch_is_firm, true, false);
    for (int turn = 0; turn < most; turn++) {
        for (size_t i = 0; i < rules->batches.count; i++) {
            const sk_batch *batch = rules->batches.data[i];
            for (size_t w = 0; sk_batch_is_firm(batch) && w < batch->sweep_count; w++)
                add_limit_sweep(builder, batch, &batch->sweeps[w], SK_NONE, turn ? beyond : 1, &batch->strained);
        }
        write_pushes(builder, sk_batch_is_firm, false, turn + 1 == most);
    }
}

/* Limits of all edges, again and again. */
static void write_strain_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    const int most = most_limit_sweeps(rules), held = most / 2 > LEAST_HELD ? most / 2 : LEAST_HELD;
    const int alone = velocity == SK_NONE ? most - held : most; // sweeps
    for (int turn = 0; turn < most; turn++) {
        if (turn == alone) write_pushes(builder, limits_strain, true, false);
        for (size_t i = 0; i < rules->batches.count; i++) {
            const sk_batch *batch = rules->batches.data[i];
            const int own = limits_strain(batch) ? turn - most + limit_sweeps_of(batch) : -1;
            for (size_t w = 0; own >= 0 && w < batch->sweep_count; w++) {
                const bool always = own == 0 && !batch->sweeps[w].strips;
                add_limit_sweep(builder, batch, &batch->sweeps[w], velocity, own ? beyond : 1, always ? NULL : &batch->strained);
            }
        }
        if (turn >= alone) write_pushes(builder, limits_strain, false, turn + 1 == most);
    }
}

/* Tethers pull each particle by itself, not its neighbours. On a grid, where paths are straight, that mostly does no harm, and its edges
 * come first, once. Edges that are near their bound come after them, and those of other meshes always: in one of 64 x 64 with a limit of
 * 1 %, edges beside pins kept a stretch of 3 %, however often they were swept before the tethers. */
void sk_write_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    write_first_limits(builder, velocity);
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        const bool last = limit->order == SK_LIMIT_LAST || (limit->order == SK_LIMIT_WITHOUT_COARSE && !has_coarse(builder, limit));
        if (is_kept(limit) && last) add_limit(builder, limit, velocity);
    }
    write_strain_limits(builder, velocity);
    if (velocity == SK_NONE) write_more_sweeps(builder);
    if (rules->leashes)
        sk_add_op(builder, (sk_op){.kind = SK_OP_LIMIT,
                                   .order = SK_FREE,
                                   .kernel = sk_leash_hold.version[builder->isa],
                                   .dst = SK_X,
                                   .source = {SK_X, velocity},
                                   .rule = rules->leashes,
                                   .label = "leashes",
                                   .end = builder->slot_count});
    sk_write_meetings(builder, builder->presses ? SK_MEETING_LEAD : SK_MEETING_PUSH, velocity);
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
