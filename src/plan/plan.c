/* A plan as a growing list, ops restricted to a range of slots, and an op's text for `skein explain`. */
#include "plan/op.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/printf.h"

bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_op op) {
    if (!SK_RESERVE(allocator, plan, plan->count + 1)) return false;
    plan->data[plan->count++] = op;
    return true;
}

/* ---- ops over a range of slots ---- */

sk_op sk_op_for(sk_op op, size_t first_slot, size_t end_slot) {
    enum { BLOCK = 16 };
    op.begin = first_slot / BLOCK * BLOCK;
    op.end = (end_slot + BLOCK - 1) / BLOCK * BLOCK;
    op.first_slot = first_slot, op.end_slot = end_slot;
    op.inner = op.kernel;
    op.kernel = sk_run_partly;
    return op;
}

/* A copy of one block of a vector that an op may write. */
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

/* Restores the slots outside of the op's range. */
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
    const sk_vector written[] = {op->dst, op->source[0], op->source[1], op->source[2], SK_X,      SK_V,
                                 SK_X0,   SK_V0,         SK_T0,         SK_T1,         SK_SUPPORT};
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
    static const char *const names[SK_VECTOR_COUNT] = {"",   "X",  "V",  "F",   "X0",  "V0", "P",
                                                       "T0", "T1", "T2", "T3",  "T4",  "T5", "T6",
                                                       "T7", "T8", "T9", "T10", "T11", "S",  "SUPPORT"};
    return names[vector];
}

/* A text of at most `size` bytes that grows. */
typedef struct line {
    char *text;
    size_t length, size;
} line;

static void put(line *to, const char *format, ...) SK_PRINTF(2, 3);
static void put(line *to, const char *format, ...) {
    va_list values;
    va_start(values, format);
    int length = vsnprintf(to->text + to->length, to->size - to->length, format, values);
    va_end(values);
    if (length > 0) to->length += (size_t)length < to->size - to->length ? (size_t)length : to->size - to->length - 1;
}

/* The weighted sum of an op's sources. */
static void put_sum(line *to, const sk_op *op) {
    bool any = false;
    for (int i = 0; i < 3; i++) {
        if (op->source[i] == SK_NONE) continue;
        if (any) put(to, " + ");
        if (op->coefficient[i] != 1) put(to, "%g ", op->coefficient[i]);
        put(to, "%s", vector_text(op->source[i]));
        any = true;
    }
    if (!any) put(to, "0");
}

/* The text for a letter in a kind's formula: $d $p $q the op's dst and sources, $1 its first coefficient, $s the
 * weighted sum of its sources, $b a correction's term - b dst, $u the uniform force, $o what is saved. */
static void put_letter(line *to, const sk_op *op, char letter) {
    switch (letter) {
    case 'd': put(to, "%s", vector_text(op->dst)); break;
    case 'p': put(to, "%s", vector_text(op->source[0])); break;
    case 'q': put(to, "%s", vector_text(op->source[1])); break;
    case '1': put(to, "%g", op->coefficient[0]); break;
    case 's': put_sum(to, op); break;
    case 'b':
        if (op->coefficient[1] != 0) put(to, " - %g %s", op->coefficient[1], vector_text(op->dst));
        break;
    case 'u': {
        const char *label = ((const sk_uniform_force *)op->rule)->label;
        put(to, "%s", label[0] ? label : "0");
        break;
    }
    case 'o':
        put(to, op->source[2] == SK_X ? "X0 = X" : op->source[2] == SK_V0 ? "X0 = old X; V0 = V" : "X0 = old X");
        break;
    default: break;
    }
}

static void put_formula(line *to, const sk_op *op) {
    for (const char *at = sk_op_type_of(op)->formula; *at; at++) {
        if (*at == '$') put_letter(to, op, *++at);
        else put(to, "%c", *at);
    }
}

/* What an op reads, and its rule. */
static void put_rule(line *to, const sk_op *op) {
    static const char *const halves[] = {[SK_WHOLE] = "", [SK_EVEN_HALF] = " even", [SK_ODD_HALF] = " odd"};
    put(to, "%s%s,", op->label ? op->label : "", halves[op->half]);
    for (int i = 0; i < 3; i++)
        if (op->source[i] != SK_NONE) put(to, " %s", vector_text(op->source[i]));
}

void sk_op_describe(const sk_op *op, char *text, size_t size) {
    const sk_op_type *type = sk_op_type_of(op);
    if (type->leads) {
        if (op->kind == SK_OP_REPEAT)
            snprintf(text, size, "%-10s %zu times the next %zu ops, %g s each", type->name, op->end, op->length, op->dt);
        else snprintf(text, size, "%-10s %s: the next %zu ops", type->name, op->label, op->length);
        return;
    }
    static const char *const durings[] = {
        [SK_ALWAYS] = "", [SK_WHILE_APART] = " while nothing is near", [SK_WHILE_NEAR] = ", while something is near"};
    char what[160] = "", iterations[40] = "";
    line words = {what, 0, sizeof what};
    if (!type->arithmetic) put_rule(&words, op);
    else if (op->label || !type->formula) put(&words, "%s", op->label ? op->label : "");
    else put_formula(&words, op);
    if (op->every > 1) snprintf(iterations, sizeof iterations, ", every %zu times", op->every);
    snprintf(text, size, "%-10s %-3s = %-44s %zu elements, %s%s%s%s", type->name, vector_text(op->dst), what,
             op->end - op->begin, op->order == SK_FREE ? "free" : "ordered", iterations, durings[op->during],
             op->strained ? ", while edges are strained" : "");
}
