/* A plan as a list that grows, ops over some slots alone, and the words that `skein explain` shows of an op. */
#include "plan/op.h"

#include <stdio.h>
#include <string.h>

bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_op op) {
    if (!SK_RESERVE(allocator, plan, plan->count + 1)) return false;
    plan->data[plan->count++] = op;
    return true;
}

const char *sk_op_kind_text(sk_op_kind kind) {
    static const char *const names[SK_OP_KIND_COUNT] = {
        [SK_OP_PACK] = "pack",
        [SK_OP_UNPACK] = "unpack",
        [SK_OP_COMBINE] = "combine",
        [SK_OP_GRID] = "grid",
        [SK_OP_FIELD] = "field",
        [SK_OP_NEIGHBOUR] = "neighbour",
        [SK_OP_FORCE] = "force",
        [SK_OP_PROJECT] = "project",
        [SK_OP_MULTIPLIER] = "multiplier",
        [SK_OP_CONTACT_FORCE] = "contact F",
        [SK_OP_CONTACT_VELOCITY] = "contact V",
        [SK_OP_CONTACT_POSITION] = "contact X",
        [SK_OP_CONTACT_UPDATE] = "contact XV",
        [SK_OP_LIMIT] = "limit",
        [SK_OP_APPLY] = "apply",
        [SK_OP_LINEARISE] = "linearise",
        [SK_OP_CONTACT_FILTER] = "contact S",
        [SK_OP_MEET] = "meet",
        [SK_OP_CALL] = "call",
        [SK_OP_SOLVE] = "solve",
        [SK_OP_PART] = "part",
        [SK_OP_REPEAT] = "repeat",
    };
    return names[kind];
}

/* ---- ops over some slots ---- */

sk_op sk_op_for(sk_op op, size_t first_slot, size_t end_slot) {
    enum { BLOCK = 16 };
    op.begin = first_slot / BLOCK * BLOCK;
    op.end = (end_slot + BLOCK - 1) / BLOCK * BLOCK;
    op.first_slot = first_slot, op.end_slot = end_slot;
    op.inner = op.kernel;
    op.kernel = sk_run_partly;
    return op;
}

/* A block of the vectors that an op may write. */
typedef struct kept_block {
    sk_vec4 slots[16];
    sk_vec4 *from;
    bool packed;
} kept_block;

static void keep_block(kept_block *kept, const sk_run *run, const sk_op *op, sk_vector vector, size_t at) {
    kept->from = run->vector[vector];
    kept->packed = at < op->packed && vector != SK_PREVIOUS;
    if (kept->from) memcpy(kept->slots, kept->from + at, sizeof kept->slots);
}

/* Puts back what slots beside the op's had. */
static void put_back(const kept_block *kept, const sk_op *op, size_t at) {
    for (size_t l = 0; l < 16 && kept->from; l++) {
        if (at + l >= op->first_slot && at + l < op->end_slot) continue;
        if (kept->packed) {
            real *to = (real *)(void *)(kept->from + at);
            const real *old = (const real *)(const void *)kept->slots;
            for (size_t k = 0; k < 4; k++) to[16 * k + l] = old[16 * k + l];
        } else {
            kept->from[at + l] = kept->slots[l];
        }
    }
}

void sk_run_partly(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_vector written[] = {op->dst, op->source[0], op->source[1], op->source[2], SK_X, SK_V, SK_X0, SK_V0};
    enum { WRITTEN = sizeof written / sizeof *written };
    for (size_t at = begin, next; at < end; at = next) {
        kept_block kept[WRITTEN];
        next = at + 16;
        if (at >= op->first_slot && next <= op->end_slot) {
            size_t whole = op->end_slot / 16 * 16;
            next = whole < end ? whole : end;
            op->inner(run, op, at, next);
            continue;
        }
        for (int i = 0; i < WRITTEN; i++) keep_block(&kept[i], run, op, written[i], at);
        op->inner(run, op, at, next);
        for (int i = 0; i < WRITTEN; i++) put_back(&kept[i], op, at);
    }
}

/* ---- as text ---- */

static const char *vector_text(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"",   "X",  "V",  "F",  "X0", "V0", "P",  "T0",  "T1",  "T2",
                                                       "T3", "T4", "T5", "T6", "T7", "T8", "T9", "T10", "T11", "S"};
    return names[vector];
}

bool sk_op_is(const sk_op *op, const sk_kernels *kernels) {
    for (int isa = 0; isa < SK_ISA_COUNT; isa++)
        if ((op->inner ? op->inner : op->kernel) == kernels->version[isa]) return true;
    return false;
}

/* A combine op as the formula that it computes. */
static void describe_combine(const sk_op *op, char *text, size_t size) {
    const char *p = vector_text(op->source[0]), *q = vector_text(op->source[1]);
    const char *kept = op->source[2] == SK_X ? "X0 = X" : op->source[2] == SK_V0 ? "X0 = old X; V0 = V" : "X0 = old X";
    if (sk_op_is(op, &sk_combine_predict)) {
        snprintf(text, size, "X + h V, V + h w F; %s", kept);
        return;
    }
    if (sk_op_is(op, &sk_combine_pull)) {
        const char *label = ((const sk_uniform_force *)op->rule)->label;
        snprintf(text, size, "V + h (%s)", label[0] ? label : "0");
        return;
    }
    if (sk_op_is(op, &sk_combine_predict_uniform)) {
        const char *label = ((const sk_uniform_force *)op->rule)->label;
        snprintf(text, size, "X + h V, V + h (%s); %s", label[0] ? label : "0", kept);
        return;
    }
    if (sk_op_is(op, &sk_combine_correct_and_predict)) {
        const char *label = ((const sk_uniform_force *)op->rule)->label;
        snprintf(text, size, "V + %g (X - X0); X + h V, V + h (%s); X0 = X, but for the last iteration",
                 op->coefficient[0], label[0] ? label : "0");
        return;
    }
    if (sk_op_is(op, &sk_combine_correction)) {
        const char *dst = vector_text(op->dst);
        if (op->coefficient[1] == 0) snprintf(text, size, "%s + %g (%s - %s)", dst, op->coefficient[0], p, q);
        else snprintf(text, size, "%s + %g (%s - %s - %g %s)", dst, op->coefficient[0], p, q, op->coefficient[1], dst);
        return;
    }
    if (sk_op_is(op, &sk_combine_kick)) {
        snprintf(text, size, "%s + %g w %s", p, op->coefficient[0], q);
        return;
    }
    if (sk_op_is(op, &sk_combine_lead)) {
        snprintf(text, size, "%s + %g %s where pinned", p, op->coefficient[0], q);
        return;
    }
    if (sk_op_is(op, &sk_combine_rest)) {
        snprintf(text, size, "%s, 0 where at most %g m/s", p, op->coefficient[0]);
        return;
    }
    size_t length = 0;
    text[0] = 0;
    for (int i = 0; i < 3; i++) {
        if (op->source[i] == SK_NONE) continue;
        const char *plus = length ? " + " : "";
        char factor[32] = "";
        if (op->coefficient[i] != 1) snprintf(factor, sizeof factor, "%g ", op->coefficient[i]);
        length += (size_t)snprintf(text + length, size - length, "%s%s%s", plus, factor, vector_text(op->source[i]));
    }
    if (!length) snprintf(text, size, "0");
}

void sk_op_describe(const sk_op *op, char *text, size_t size) {
    if (op->kind == SK_OP_SOLVE || op->kind == SK_OP_PART) {
        snprintf(text, size, "%-10s %s: the next %zu ops", sk_op_kind_text(op->kind), op->label, op->length);
        return;
    }
    if (op->kind == SK_OP_REPEAT) {
        snprintf(text, size, "%-10s %zu times the next %zu ops, %g s each", "repeat", op->end, op->length, op->dt);
        return;
    }
    char what[160];
    if (op->label && op->kind == SK_OP_COMBINE) {
        snprintf(what, sizeof what, "%s", op->label);
    } else if (op->kind == SK_OP_COMBINE) {
        describe_combine(op, what, sizeof what);
    } else {
        char sources[64] = "";
        size_t length = 0;
        for (int i = 0; i < 3; i++)
            if (op->source[i] != SK_NONE)
                length +=
                    (size_t)snprintf(sources + length, sizeof sources - length, " %s", vector_text(op->source[i]));
        static const char *const halves[] = {[SK_WHOLE] = "", [SK_EVEN_HALF] = " even", [SK_ODD_HALF] = " odd"};
        snprintf(what, sizeof what, "%s%s,%s", op->label ? op->label : "", halves[op->half], sources);
    }
    char iterations[40] = "";
    if (op->every > 1) snprintf(iterations, sizeof iterations, ", every %zu times", op->every);
    snprintf(text, size, "%-10s %-3s = %-44s %zu elements, %s%s", sk_op_kind_text(op->kind), vector_text(op->dst), what,
             op->end - op->begin, op->order == SK_FREE ? "free" : "ordered", iterations);
}
