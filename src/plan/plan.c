/* A plan as a list that grows, rows over some slots alone, and the words that `skein explain` shows of a row. */
#include "plan/row.h"

#include <stdio.h>
#include <string.h>

bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_row row) {
    if (!SK_RESERVE(allocator, plan, plan->count + 1)) return false;
    plan->data[plan->count++] = row;
    return true;
}

const char *sk_row_kind_text(sk_row_kind kind) {
    static const char *const names[SK_ROW_KIND_COUNT] = {
        [SK_ROW_PACK] = "pack",
        [SK_ROW_UNPACK] = "unpack",
        [SK_ROW_COMBINE] = "combine",
        [SK_ROW_GRID] = "grid",
        [SK_ROW_FIELD] = "field",
        [SK_ROW_NEIGHBOUR] = "neighbour",
        [SK_ROW_FORCE] = "force",
        [SK_ROW_PROJECT] = "project",
        [SK_ROW_MULTIPLIER] = "multiplier",
        [SK_ROW_CONTACT_FORCE] = "contact F",
        [SK_ROW_CONTACT_VELOCITY] = "contact V",
        [SK_ROW_CONTACT_POSITION] = "contact X",
        [SK_ROW_CONTACT_SETTLE] = "contact XV",
        [SK_ROW_LIMIT] = "limit",
        [SK_ROW_APPLY] = "apply",
        [SK_ROW_LINEARISE] = "linearise",
        [SK_ROW_CONTACT_FILTER] = "contact S",
        [SK_ROW_MEET] = "meet",
        [SK_ROW_CALL] = "call",
        [SK_ROW_SOLVE] = "solve",
        [SK_ROW_PART] = "part",
        [SK_ROW_REPEAT] = "repeat",
    };
    return names[kind];
}

/* ---- rows over some slots ---- */

sk_row sk_row_for(sk_row row, size_t first_slot, size_t end_slot) {
    enum { BLOCK = 16 };
    row.begin = first_slot / BLOCK * BLOCK;
    row.end = (end_slot + BLOCK - 1) / BLOCK * BLOCK;
    row.first_slot = first_slot, row.end_slot = end_slot;
    row.inner = row.kernel;
    row.kernel = sk_run_partly;
    return row;
}

/* A block of the vectors that a row may write. */
typedef struct kept_block {
    sk_vec4 slots[16];
    sk_vec4 *from;
    bool packed;
} kept_block;

static void keep_block(kept_block *kept, const sk_run *run, const sk_row *row, sk_vector vector, size_t at) {
    kept->from = run->vector[vector];
    kept->packed = at < row->packed && vector != SK_PREVIOUS;
    if (kept->from) memcpy(kept->slots, kept->from + at, sizeof kept->slots);
}

/* Puts back what slots beside the row's had. */
static void put_back(const kept_block *kept, const sk_row *row, size_t at) {
    for (size_t l = 0; l < 16 && kept->from; l++) {
        if (at + l >= row->first_slot && at + l < row->end_slot) continue;
        if (kept->packed) {
            real *to = (real *)(void *)(kept->from + at);
            const real *old = (const real *)(const void *)kept->slots;
            for (size_t k = 0; k < 4; k++) to[16 * k + l] = old[16 * k + l];
        } else {
            kept->from[at + l] = kept->slots[l];
        }
    }
}

void sk_run_partly(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_vector written[] = {row->dst, row->source[0], row->source[1], row->source[2], SK_X, SK_V, SK_X0, SK_V0};
    enum { WRITTEN = sizeof written / sizeof *written };
    for (size_t at = begin, next; at < end; at = next) {
        kept_block kept[WRITTEN];
        next = at + 16;
        if (at >= row->first_slot && next <= row->end_slot) {
            size_t whole = row->end_slot / 16 * 16;
            next = whole < end ? whole : end;
            row->inner(run, row, at, next);
            continue;
        }
        for (int i = 0; i < WRITTEN; i++) keep_block(&kept[i], run, row, written[i], at);
        row->inner(run, row, at, next);
        for (int i = 0; i < WRITTEN; i++) put_back(&kept[i], row, at);
    }
}

/* ---- as text ---- */

static const char *vector_text(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"",   "X",  "V",  "F",  "X0", "V0", "P",  "T0",  "T1",  "T2",
                                                       "T3", "T4", "T5", "T6", "T7", "T8", "T9", "T10", "T11", "S"};
    return names[vector];
}

bool sk_row_is(const sk_row *row, const sk_kernels *kernels) {
    for (int isa = 0; isa < SK_ISA_COUNT; isa++)
        if ((row->inner ? row->inner : row->kernel) == kernels->version[isa]) return true;
    return false;
}

/* A combine row as the formula that it computes. */
static void describe_combine(const sk_row *row, char *text, size_t size) {
    const char *p = vector_text(row->source[0]), *q = vector_text(row->source[1]);
    const char *kept = row->source[2] == SK_X    ? "X0 = X"
                       : row->source[2] == SK_V0 ? "X0 = old X; V0 = V"
                                                 : "X0 = old X";
    if (sk_row_is(row, &sk_combine_predict)) {
        snprintf(text, size, "X + h V, V + h w F; %s", kept);
        return;
    }
    if (sk_row_is(row, &sk_combine_pull)) {
        const char *label = ((const sk_plain_force *)row->rule)->label;
        snprintf(text, size, "V + h (%s)", label[0] ? label : "0");
        return;
    }
    if (sk_row_is(row, &sk_combine_fall)) {
        const char *label = ((const sk_plain_force *)row->rule)->label;
        snprintf(text, size, "X + h V, V + h (%s); %s", label[0] ? label : "0", kept);
        return;
    }
    if (sk_row_is(row, &sk_combine_fall_on)) {
        const char *label = ((const sk_plain_force *)row->rule)->label;
        snprintf(text, size, "V + %g (X - X0); X + h V, V + h (%s); X0 = X, but for the last turn", row->coefficient[0],
                 label[0] ? label : "0");
        return;
    }
    if (sk_row_is(row, &sk_combine_correction)) {
        const char *dst = vector_text(row->dst);
        if (row->coefficient[1] == 0) snprintf(text, size, "%s + %g (%s - %s)", dst, row->coefficient[0], p, q);
        else
            snprintf(text, size, "%s + %g (%s - %s - %g %s)", dst, row->coefficient[0], p, q, row->coefficient[1], dst);
        return;
    }
    if (sk_row_is(row, &sk_combine_kick)) {
        snprintf(text, size, "%s + %g w %s", p, row->coefficient[0], q);
        return;
    }
    if (sk_row_is(row, &sk_combine_lead)) {
        snprintf(text, size, "%s + %g %s where pinned", p, row->coefficient[0], q);
        return;
    }
    if (sk_row_is(row, &sk_combine_rest)) {
        snprintf(text, size, "%s, 0 where at most %g m/s", p, row->coefficient[0]);
        return;
    }
    size_t length = 0;
    text[0] = 0;
    for (int i = 0; i < 3; i++) {
        if (row->source[i] == SK_NONE) continue;
        const char *plus = length ? " + " : "";
        char factor[32] = "";
        if (row->coefficient[i] != 1) snprintf(factor, sizeof factor, "%g ", row->coefficient[i]);
        length += (size_t)snprintf(text + length, size - length, "%s%s%s", plus, factor, vector_text(row->source[i]));
    }
    if (!length) snprintf(text, size, "0");
}

void sk_row_describe(const sk_row *row, char *text, size_t size) {
    if (row->kind == SK_ROW_SOLVE || row->kind == SK_ROW_PART) {
        snprintf(text, size, "%-10s %s: the next %zu rows", sk_row_kind_text(row->kind), row->label, row->length);
        return;
    }
    if (row->kind == SK_ROW_REPEAT) {
        snprintf(text, size, "%-10s %zu times the next %zu rows, %g s each", "repeat", row->end, row->length, row->dt);
        return;
    }
    char what[160];
    if (row->label && row->kind == SK_ROW_COMBINE) {
        snprintf(what, sizeof what, "%s", row->label);
    } else if (row->kind == SK_ROW_COMBINE) {
        describe_combine(row, what, sizeof what);
    } else {
        char sources[64] = "";
        size_t length = 0;
        for (int i = 0; i < 3; i++)
            if (row->source[i] != SK_NONE)
                length +=
                    (size_t)snprintf(sources + length, sizeof sources - length, " %s", vector_text(row->source[i]));
        static const char *const halves[] = {[SK_WHOLE] = "", [SK_EVEN_HALF] = " even", [SK_ODD_HALF] = " odd"};
        snprintf(what, sizeof what, "%s%s,%s", row->label ? row->label : "", halves[row->half], sources);
    }
    char turns[40] = "";
    if (row->every > 1) snprintf(turns, sizeof turns, ", every %zu times", row->every);
    snprintf(text, size, "%-10s %-3s = %-44s %zu elements, %s%s", sk_row_kind_text(row->kind), vector_text(row->dst),
             what, row->end - row->begin, row->order == SK_FREE ? "free" : "ordered", turns);
}
