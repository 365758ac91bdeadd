/* The pass over a finished plan that fuses ops: patterns of neighbouring ops, and the ops that replace them. */
#include "plan/fuse.h"

#include <string.h>

/* The ops of a substep's prediction, as methods write them:
 *
 *   kicks       V = V + h w F, or V + h (uniform forces): an op for each part of the slots
 *   saves       X0 = X, and perhaps V0 = V
 *   drift       X = X + h V */
typedef struct prediction {
    size_t first, first_save, drift; /* in the repeat's ops; `drift` is the last */
    bool saves_velocity;
} prediction;

static bool is_sum(const sk_op *op, sk_vector dst, sk_vector p, sk_vector q) {
    return op->kind == SK_OP_SUM && !op->inner && op->dst == dst && op->source[0] == p && op->source[1] == q &&
           op->source[2] == SK_NONE && op->coefficient[0] == 1;
}

static bool is_pull(const sk_op *op) {
    return op->kind == SK_OP_PULL;
}

/* V += h w F, h being the substep. */
static bool is_kick(const sk_op *op) {
    return op->kind == SK_OP_KICK && op->dst == SK_V && op->source[0] == SK_V && op->source[1] == SK_F &&
           op->coefficient[0] == op->dt;
}

static size_t first_slot_of(const sk_op *op) {
    return op->inner ? op->first_slot : op->begin;
}

static size_t end_slot_of(const sk_op *op) {
    return op->inner ? op->end_slot : op->end;
}

/* Whether the kicks [first, end), one for each part of the slots, cover all slots together. */
static bool covers(const sk_op *ops, size_t first, size_t end, size_t slot_count) {
    size_t slot = 0;
    for (size_t r = first; r < end; slot = end_slot_of(&ops[r++]))
        if (first_slot_of(&ops[r]) != slot) return false;
    return slot == slot_count && first < end;
}

/* Finds the first prediction in the ops of a repeat. */
static bool find_prediction(const sk_op *ops, size_t count, prediction *found) {
    for (size_t d = 1; d < count; d++) {
        if (!is_sum(&ops[d], SK_X, SK_X, SK_V) || ops[d].coefficient[1] != ops[d].dt) continue;
        found->drift = found->first_save = d;
        found->saves_velocity = is_sum(&ops[d - 1], SK_V0, SK_V, SK_NONE);
        if (found->saves_velocity) found->first_save--;
        if (!found->first_save || !is_sum(&ops[found->first_save - 1], SK_X0, SK_X, SK_NONE)) continue;
        found->first = --found->first_save;
        while (found->first && (is_pull(&ops[found->first - 1]) || is_kick(&ops[found->first - 1]))) found->first--;
        if (covers(ops, found->first, found->first_save, ops[d].end)) return true;
    }
    return false;
}

static bool mentions(const sk_op *op, sk_vector vector) {
    bool any = op->dst == vector;
    for (int i = 0; i < 3; i++) any |= op->source[i] == vector;
    return any;
}

/* V += (X - X0 - h V)/h: adds the velocity of whatever moved X away from X0 + h V. */
static bool is_correction(const sk_op *op) {
    return op->kind == SK_OP_CORRECTION && op->dst == SK_V && op->source[0] == SK_X && op->source[1] == SK_X0 &&
           op->coefficient[1] == op->dt;
}

/* The only op after the prediction that reads X0 or V0, if it is a correction; else SIZE_MAX. Ops that read X0 only to
 * know the predicted position do not count: X0 may hold that position instead (by_goal). */
static size_t find_only_correction(const sk_op *ops, size_t count, const prediction *found) {
    size_t only = SIZE_MAX;
    for (size_t r = 0; r < count; r++) {
        if ((r >= found->first && r <= found->drift) || !(mentions(&ops[r], SK_X0) || mentions(&ops[r], SK_V0)))
            continue;
        if (r > found->drift && ops[r].from_prediction) continue;
        if (only != SIZE_MAX || r < found->drift || !is_correction(&ops[r])) return SIZE_MAX;
        only = r;
    }
    return only;
}

/* ---- writing the ops anew ---- */

typedef struct fuser {
    sk_plan *plan; /* the ops so far */
    sk_allocator *allocator;
    sk_isa isa;
    bool no_memory;
} fuser;

static void add(fuser *f, sk_op op) {
    if (!sk_plan_add(f->plan, f->allocator, op)) f->no_memory = true;
}

static void add_ops(fuser *f, const sk_op *ops, size_t begin, size_t end) {
    for (size_t r = begin; r < end; r++) add(f, ops[r]);
}

/* An op that reads the predicted position, in a plan where X0 holds that position itself. */
static sk_op by_goal(sk_op op) {
    if (op.from_prediction) op.coefficient[1] = 0;
    return op;
}

/* Changes an op's kind, and its kernel to that kind's. */
static void become(const fuser *f, sk_op *op, sk_op_kind kind) {
    op->kind = kind;
    *(op->inner ? &op->inner : &op->kernel) = sk_op_types[kind].kernels->version[f->isa];
}

/* One op in place of a kick, the saves and the drift; `kept` becomes the third source of a prediction (see op.h). */
static sk_op predicting(const fuser *f, const sk_op *kick, sk_vector kept) {
    sk_op op = *kick;
    become(f, &op, is_pull(kick) ? SK_OP_PREDICT_UNIFORM : SK_OP_PREDICT);
    op.dst = SK_X;
    op.source[0] = SK_V, op.source[1] = is_pull(kick) ? SK_NONE : SK_F, op.source[2] = kept;
    op.coefficient[0] = 0;
    return op;
}

/* One op for the correction that ends a substep and the prediction that begins the next. */
static sk_op following(const fuser *f, const sk_op *pull, const sk_op *correction) {
    sk_op op = predicting(f, pull, SK_X);
    op.coefficient[0] = correction->coefficient[0];
    op.before_end = correction->before_end;
    become(f, &op, SK_OP_CORRECT_AND_PREDICT);
    return op;
}

static bool all_pull(const sk_op *ops, const prediction *found) {
    for (size_t r = found->first; r < found->first_save; r++)
        if (!is_pull(&ops[r])) return false;
    return true;
}

/* For a substep that begins with its prediction and ends with its correction, while no other op reads its start: moves
 * the first prediction before the repeat, and makes each correction and the prediction after it one op. */
static void fuse_across_iterations(fuser *f, const sk_op *repeat, const prediction *found) {
    const sk_op *ops = repeat + 1;
    for (size_t r = 0; r < found->first_save; r++) add(f, predicting(f, &ops[r], SK_X));
    sk_op head = *repeat;
    head.length = repeat->length - (found->drift + 1) - 1 + found->first_save;
    add(f, head);
    for (size_t r = found->drift + 1; r + 1 < repeat->length; r++) add(f, by_goal(ops[r]));
    for (size_t r = 0; r < found->first_save; r++) add(f, following(f, &ops[r], &ops[repeat->length - 1]));
}

/* Fuses each kick with the saves and the drift. `correction` is the only op that reads X0 or V0, or SIZE_MAX. */
static void fuse_prediction(fuser *f, const sk_op *repeat, const prediction *found, size_t correction) {
    const sk_op *ops = repeat + 1;
    bool goal = correction != SIZE_MAX; // then X0 holds the predicted position, which saves work in the correction
    sk_vector kept = goal ? SK_X : found->saves_velocity ? SK_V0 : SK_NONE;
    sk_op head = *repeat;
    head.length -= found->drift + 1 - found->first_save;
    add(f, head);
    add_ops(f, ops, 0, found->first);
    for (size_t r = found->first; r < found->first_save; r++) add(f, predicting(f, &ops[r], kept));
    for (size_t r = found->drift + 1; r < repeat->length; r++) {
        sk_op op = goal ? by_goal(ops[r]) : ops[r];
        if (r == correction) op.coefficient[1] = 0;
        add(f, op);
    }
}

static void fuse_repeat(fuser *f, const sk_op *repeat) {
    const sk_op *ops = repeat + 1;
    prediction found;
    if (!find_prediction(ops, repeat->length, &found)) {
        add_ops(f, repeat, 0, repeat->length + 1);
        return;
    }
    size_t correction = find_only_correction(ops, repeat->length, &found);
    if (correction + 1 == repeat->length && found.first == 0 && all_pull(ops, &found))
        fuse_across_iterations(f, repeat, &found);
    else fuse_prediction(f, repeat, &found, correction);
}

bool sk_plan_fuse(sk_plan *plan, sk_allocator *allocator, sk_isa isa) {
    sk_plan fused = {.parts = plan->parts};
    fuser f = {&fused, allocator, isa, false};
    for (size_t r = 0; r < plan->count; r++) {
        if (plan->data[r].kind == SK_OP_REPEAT) {
            fuse_repeat(&f, &plan->data[r]);
            r += plan->data[r].length;
        } else {
            add(&f, plan->data[r]);
        }
    }
    if (f.no_memory) {
        sk_release(allocator, fused.data);
        return false;
    }
    sk_release(allocator, plan->data);
    *plan = fused;
    return true;
}
