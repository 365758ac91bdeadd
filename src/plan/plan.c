#include "plan/row.h"

#include <stdio.h>

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
        [SK_ROW_DOT] = "dot",
        [SK_ROW_SCALAR] = "scalar",
        [SK_ROW_CALL] = "call",
        [SK_ROW_REPEAT] = "repeat",
    };
    return names[kind];
}

static const char *vector_text(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"",   "X",  "V",  "F",  "X0", "V0", "P",  "T0",  "T1",  "T2",
                                                       "T3", "T4", "T5", "T6", "T7", "T8", "T9", "T10", "T11", "S"};
    return names[vector];
}

bool sk_row_is(const sk_row *row, const sk_kernels *kernels) {
    for (int isa = 0; isa < SK_ISA_COUNT; isa++)
        if (row->kernel == kernels->version[isa]) return true;
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
    if (row->kind == SK_ROW_REPEAT && row->cell) {
        snprintf(text, size, "%-10s %zu times at most the next %zu rows: %s", "repeat", row->end, row->length,
                 row->label);
        return;
    }
    if (row->kind == SK_ROW_REPEAT) {
        snprintf(text, size, "%-10s %zu times the next %zu rows, %g s each", "repeat", row->end, row->length, row->dt);
        return;
    }
    char what[160];
    if (row->label && (row->kind == SK_ROW_COMBINE || row->kind == SK_ROW_SCALAR)) {
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
        snprintf(what, sizeof what, "%s,%s", row->label ? row->label : "", sources);
    }
    snprintf(text, size, "%-10s %-3s = %-44s %zu elements, %s", sk_row_kind_text(row->kind), vector_text(row->dst),
             what, row->end - row->begin, row->order == SK_FREE ? "free" : "ordered");
}
