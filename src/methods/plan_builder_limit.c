/* Ops that limit: how far edges may be stretched, how far particles may be from their anchors; and what lies on colliders is held while that
 * is swept. Methods that integrate forces use these, and no other corrections. */
#include <math.h>

#include "constraints/sweep.h"
#include "methods/plan_builder.h"

enum {
    LEAST_LIMIT_SWEEPS = 16,
    MOST_LIMIT_SWEEPS = 64,
    EDGES_A_SWEEP = 3,
    LEAST_HELD = 8,
    LEAST_MORE = 4,
    MOST_MORE = 32,
    EDGES_A_MORE = 6
};

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
static void add_limit_sweep(sk_plan_builder *builder, const sk_batch *batch, const sk_sweep *sweep, sk_vector velocity,
                            double far, const bool *strained) {
    const sk_sweep_kernels *kernels = velocity == SK_NONE ? &batch->type->limit : &batch->type->limit_moving;
    sk_add_sweep(builder, sweep, SK_WHOLE, SK_OP_LIMIT, kernels, SK_X, velocity, far, 0, SK_ALWAYS, strained);
}

/* From here on ops that are swept over and over need not look at what has not moved since (plan/op.h, sk_watch); and here that ends. */
static void begin_watch(sk_plan_builder *builder) {
    builder->since = ++builder->turn;
}
static void end_watch(sk_plan_builder *builder) {
    builder->since = 0;
}

/* Whether it is an edge's strain that a batch bounds, not that of what carries or spans others. */
static bool limits_strain(const sk_batch *batch) {
    return sk_batch_has_bound(batch) && !sk_batch_carries(batch) && !batch->only_bounds;
}

/* Limits of edges along strips and of batches that only bound lengths, once. */
static void write_first_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!sk_batch_has_bound(batch) || sk_batch_carries(batch)) continue;
        if (batch->only_bounds && velocity == SK_NONE) continue; // write_spans() has written them
        for (size_t w = 0; w < batch->sweep_count; w++)
            if (batch->only_bounds || batch->sweeps[w].strips)
                add_limit_sweep(builder, batch, &batch->sweeps[w], velocity, 1, NULL);
    }
}

/* How many sweeps the batch that needs most has. */
static int most_limit_sweeps(const sk_rules *rules) {
    int most = 0;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (limits_strain(rules->batches.data[i])) most = (int)fmax(most, limit_sweeps_of(rules->batches.data[i]));
    return most;
}

/* Adds an op over slots for those of a batch, while its edges are strained: what else there is must not know of that. */
static void add_op_for(sk_plan_builder *builder, const sk_batch *batch, sk_op op) {
    const size_t first = batch->first_slot > op.begin ? batch->first_slot : op.begin,
                 end = batch->end_slot < op.end ? batch->end_slot : op.end;
    op.strained = &batch->strained;
    if (first < end) sk_add_op(builder, first == 0 && end == builder->slot_count ? op : sk_op_for(op, first, end));
}

bool sk_keeps_planes(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool any = false;
    for (size_t i = 0; i < rules->batches.count; i++)
        any |= limits_strain(rules->batches.data[i]) || sk_batch_is_firm(rules->batches.data[i]);
    return any && builder->predicted && sk_writes_contacts(rules) && !sk_writes_meetings(builder);
}

/* Nobody is held; if `first`, where a step begins. */
static void forget_planes(sk_plan_builder *builder, const sk_batch *batch, bool first) {
    add_op_for(builder, batch,
               (sk_op){.kind = SK_OP_LIMIT,
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
        if (limits_strain(rules->batches.data[i]) || sk_batch_is_firm(rules->batches.data[i]))
            forget_planes(builder, rules->batches.data[i], false);
}

/* Finds who is pushed out by colliders, but does not bounce, and where to: then he may be held there while sweeps go on. */
static void write_find_held(sk_plan_builder *builder, const sk_batch *batch) {
    const sk_rules *rules = builder->rules;
    const bool known = sk_keeps_planes(builder);                            // from the second substep on
    if (!sk_writes_meetings(builder)) forget_planes(builder, batch, known); // else contact of surfaces does
    for (size_t i = 0; i < rules->colliders.count; i++) {
        const sk_collider *collider = rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        const sk_op op = {.kind = SK_OP_CONTACT_SWEEP,
                          .order = SK_FREE,
                          .kernel = sk_contact_find_held.version[builder->isa],
                          .dst = SK_SUPPORT,
                          .source = {SK_X, SK_NONE, SK_X0},
                          .coefficient = {known},
                          .also_writes = 1u << SK_T0 | 1u << SK_T1,
                          .also_reads = sk_contact_reads_force(collider) ? 1u << SK_F : 0,
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
    add_op_for(builder, batch,
               (sk_op){.kind = SK_OP_LIMIT,
                       .order = SK_FREE,
                       .kernel = sk_contact_hold.version[builder->isa],
                       .dst = SK_X,
                       .source = {SK_SUPPORT, SK_T0, SK_T1},
                       .also_reads = 1u << SK_X0,
                       .label = "held by colliders",
                       .end = builder->slot_count});
}

/* Between sweeps colliders hold whom they hold up, and now and then surfaces push apart what is near. Where a few vertices lie on a
 * corner, and all around hangs, what comes after all sweeps undoes what they have done: 33 x 33 on a box, with a limit of 2 %, kept 39, 17.5
 * and 5.7 % at rest (5, 10 and 20 substeps), on a jelly cube 38, 13 and 4.7; now 3.4, 2.1 and 2.0, and 2.5, 2.0 and 2.0; 100 x 100 106 (10),
 * now 7, with 8 of 33 sweeps so 23, with all 7. (More sweeps after the colliders, with their planes held: 12, 2.6 and 2.0, for what these had
 * done to velocities was done. Two faces meet at a corner, and who is pulled in there is nearer to the other one: by the face that he has come
 * into now, not by that he lay on, 35 % with 5 substeps. Held from the prediction on: no better. Surfaces that push after every sweep: as firm, and
 * heaps of 64 x 64 with a limit take 1.5 times as long at rest.) Methods that solve for velocities have all
 * of this in one system: 0.2 %. */
static void write_pushes(sk_plan_builder *builder, bool (*takes_part)(const sk_batch *batch), bool first, bool apart) {
    const sk_rules *rules = builder->rules;
    builder->strained = &rules->strained;
    if (apart) sk_write_meetings(builder, SK_MEETING_PUSH_ON, SK_NONE);
    builder->strained = NULL;
    for (size_t i = 0; i < rules->batches.count && sk_writes_contacts(rules); i++) {
        if (!takes_part(rules->batches.data[i])) continue;
        if (first) write_find_held(builder, rules->batches.data[i]);
        else write_hold(builder, rules->batches.data[i]);
    }
    builder->strained = &rules->strained;
    if (sk_writes_contacts(rules)) sk_write_meetings(builder, SK_MEETING_FACES_AGAIN, SK_NONE);
    builder->strained = NULL;
}

/* How many more sweeps the largest batch of firm edges has. */
static int more_sweeps_of(const sk_rules *rules) {
    double most = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (sk_batch_is_firm(batch))
            most = fmax(most, fmin(fmax(edges_across(batch) / EDGES_A_MORE, LEAST_MORE), MOST_MORE));
    }
    return (int)most;
}

/* The same where nobody has set a limit, for edges that are firm all the same (world/strained.c). The largest stretch of a sheet that lies on a
 * box in percent, with 5, 10 and 20 substeps: 33 x 33 50, 24 and 6 before, 12, 5 and 5 now; irregular 57, 22 and 14, now 13, 5 and 5; 64 x 64
 * 120, 48 and 21, now 26, 8 and 5; 100 x 100 207, 104 and 43, now 34, 11 and 6. Its frames take 1.4 to 2.3 times as long.
 *
 * Where surfaces meet they push once, halfway: 33 x 33 on a box had 22 % at rest and 36 at most, and has 6 and 12; 64 x 64 44 and 106, now 8 and 19.
 * Heaps of 64 x 64 and 100 x 100 that had 7 to 15 % at rest and 58 to 85 at the impact have 5 to 9 and 12 to 35, their worst frames are as long or
 * shorter, and their mean takes 0.95 to 1.5 times as long, for there is always an edge at its bound, and a push is most of it. Not at all: 30 % at the
 * impact of 64 x 64; in every fourth turn: 10 to 15, and heaps of 100 x 100 take 1.2 to 1.7 times as long at rest. */
static void write_more_sweeps(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    const int most = more_sweeps_of(rules);
    if (!most || !(sk_writes_contacts(rules) || sk_writes_meetings(builder))) return;
    builder->sweeps_more = true;
    begin_watch(builder);
    write_pushes(builder, sk_batch_is_firm, true, false);
    for (int turn = 0; turn < most; turn++) {
        for (size_t i = 0; i < rules->batches.count; i++) {
            const sk_batch *batch = rules->batches.data[i];
            for (size_t w = 0; sk_batch_is_firm(batch) && w < batch->sweep_count; w++)
                add_limit_sweep(builder, batch, &batch->sweeps[w], SK_NONE, turn ? beyond : 1, &batch->strained);
        }
        write_pushes(builder, sk_batch_is_firm, false, turn == most / 2);
    }
    end_watch(builder);
}

/* How many sweeps over limits there are to a push of surfaces. */
enum { SWEEPS_A_PUSH = 3 };

/* Limits of all edges, again and again. */
static void write_strain_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    const int most = most_limit_sweeps(rules), held = most / 2 > LEAST_HELD ? most / 2 : LEAST_HELD;
    const int alone = velocity == SK_NONE ? most - held : most; // sweeps
    if (velocity == SK_NONE) begin_watch(builder); // else sweeps change velocities, too, and nobody pushes in between
    for (int turn = 0; turn < most; turn++) {
        if (turn == alone) write_pushes(builder, limits_strain, true, false);
        for (size_t i = 0; i < rules->batches.count; i++) {
            const sk_batch *batch = rules->batches.data[i];
            const int own = limits_strain(batch) ? turn - most + limit_sweeps_of(batch) : -1;
            for (size_t w = 0; own >= 0 && w < batch->sweep_count; w++) {
                const bool always = own == 0 && !batch->sweeps[w].strips;
                add_limit_sweep(builder, batch, &batch->sweeps[w], velocity, own ? beyond : 1,
                                always ? NULL : &batch->strained);
            }
        }
        if (turn >= alone)
            write_pushes(builder, limits_strain, false, turn + 1 < most && (most - turn) % SWEEPS_A_PUSH == 0);
    }
    end_watch(builder);
}

/* Tethers pull each particle by itself, not its neighbours. On a grid, where paths are straight, that mostly does no harm, and its edges
 * come first, once. Edges that are near their bound come after them, and those of other meshes always: in one of 64 x 64 with a limit of
 * 1 %, edges beside pins kept a stretch of 3 %, however often they were swept before the tethers. */
void sk_write_limits(sk_plan_builder *builder, sk_vector velocity) {
    const sk_rules *rules = builder->rules;
    write_first_limits(builder, velocity);
    for (size_t i = 0; i < rules->limits.count; i++) {
        const sk_limit *limit = rules->limits.data[i];
        const bool last = limit->order == SK_LIMIT_LAST || limit->order == SK_LIMIT_SELDOM ||
                          (limit->order == SK_LIMIT_WITHOUT_COARSE && !sk_limit_has_coarse(builder, limit));
        if (sk_limit_is_kept(limit) && last) sk_add_limit(builder, limit, velocity);
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
    if (sk_writes_contacts(rules)) sk_write_meetings(builder, SK_MEETING_FACES, velocity);
    sk_write_meetings(builder, builder->presses ? SK_MEETING_LEAD : SK_MEETING_PUSH, velocity);
}

bool sk_writes_corrections(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    if (sk_writes_meetings(builder) || sk_writes_contacts(rules) || rules->leashes) return true;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (sk_batch_has_bound(rules->batches.data[i])) return true;
    for (size_t i = 0; i < rules->limits.count; i++)
        if (sk_limit_is_kept(rules->limits.data[i])) return true;
    return false;
}
