#include "plan/row.h"

#include <stdio.h>

bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_row row) {
    if (!SK_RESERVE(allocator, plan, plan->count + 1)) return false;
    plan->data[plan->count++] = row;
    return true;
}

const char *sk_row_kind_text(sk_row_kind kind) {
    static const char *const names[SK_ROW_KIND_COUNT] = {
        [SK_ROW_COMBINE] = "combine",          [SK_ROW_GRID] = "grid",
        [SK_ROW_FIELD] = "field",              [SK_ROW_NEIGHBOUR] = "neighbour",
        [SK_ROW_FORCE] = "force",              [SK_ROW_PROJECT] = "project",
        [SK_ROW_MULTIPLIER] = "multiplier",    [SK_ROW_CONTACT_FORCE] = "contact F",
        [SK_ROW_CONTACT_VELOCITY] = "contact V", [SK_ROW_CONTACT_POSITION] = "contact X",
        [SK_ROW_LIMIT] = "limit",              [SK_ROW_REPEAT] = "repeat",
    };
    return names[kind];
}

static const char *vector_text(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"", "X", "V", "F", "X0", "V0", "P"};
    return names[vector];
}

/* A combine row as the formula that it computes. */
static void describe_combine(const sk_row *row, char *text, size_t size) {
    const char *p = vector_text(row->source[0]), *q = vector_text(row->source[1]);
    if (row->kernel == sk_combine_correction) {
        const char *dst = vector_text(row->dst);
        snprintf(text, size, "%s + %g (%s - %s - %g %s)", dst, row->coefficient[0], p, q, row->coefficient[1], dst);
        return;
    }
    if (row->kernel == sk_combine_kick) {
        snprintf(text, size, "%s + %g w %s", p, row->coefficient[0], q);
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
    if (row->kind == SK_ROW_REPEAT) {
        snprintf(text, size, "%-10s %zu times the next %zu rows, %g s each", "repeat", row->end, row->length, row->dt);
        return;
    }
    char what[160];
    if (row->kind == SK_ROW_COMBINE) {
        describe_combine(row, what, sizeof what);
    } else {
        char sources[64] = "";
        size_t length = 0;
        for (int i = 0; i < 3; i++)
            if (row->source[i] != SK_NONE)
                length += (size_t)snprintf(sources + length, sizeof sources - length, " %s", vector_text(row->source[i]));
        snprintf(what, sizeof what, "%s,%s", row->label ? row->label : "", sources);
    }
    snprintf(text, size, "%-10s %-3s = %-44s %zu elements, %s", sk_row_kind_text(row->kind), vector_text(row->dst),
             what, row->end - row->begin, row->order == SK_FREE ? "free" : "ordered");
}

void sk_combine_sum(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_vec4 *dst = run->vector[row->dst];
    // rare: clearing, and sums of three
    if (row->source[0] == SK_NONE) {
        for (size_t i = begin; i < end; i++) dst[i] = (sk_vec4){0, 0, 0, dst[i].w};
        return;
    }
    const sk_vec4 *p = run->vector[row->source[0]];
    real a = (real)row->coefficient[0], b = (real)row->coefficient[1], c = (real)row->coefficient[2];
    if (row->source[1] == SK_NONE) {
        for (size_t i = begin; i < end; i++) dst[i] = (sk_vec4){a * p[i].x, a * p[i].y, a * p[i].z, dst[i].w};
        return;
    }
    const sk_vec4 *q = run->vector[row->source[1]];
    if (row->source[2] == SK_NONE) {
        for (size_t i = begin; i < end; i++)
            dst[i] = (sk_vec4){a * p[i].x + b * q[i].x, a * p[i].y + b * q[i].y, a * p[i].z + b * q[i].z, dst[i].w};
        return;
    }
    const sk_vec4 *r = run->vector[row->source[2]];
    for (size_t i = begin; i < end; i++)
        dst[i] = (sk_vec4){a * p[i].x + b * q[i].x + c * r[i].x, a * p[i].y + b * q[i].y + c * r[i].y,
                           a * p[i].z + b * q[i].z + c * r[i].z, dst[i].w};
}

void sk_combine_correction(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_vec4 *dst = run->vector[row->dst];
    const sk_vec4 *p = run->vector[row->source[0]], *q = run->vector[row->source[1]];
    real a = (real)row->coefficient[0], b = (real)row->coefficient[1];
    for (size_t i = begin; i < end; i++) {
        // the same operations as the sum that predicted p, so that an untouched p corrects nothing
        sk_vec4 u = dst[i];
        sk_vec3 alone = {q[i].x + b * u.x, q[i].y + b * u.y, q[i].z + b * u.z};
        dst[i] = (sk_vec4){u.x + a * (p[i].x - alone.x), u.y + a * (p[i].y - alone.y), u.z + a * (p[i].z - alone.z), u.w};
    }
}

void sk_combine_kick(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_vec4 *dst = run->vector[row->dst];
    const sk_vec4 *p = run->vector[row->source[0]], *q = run->vector[row->source[1]], *x = run->vector[SK_X];
    real a = (real)row->coefficient[0];
    for (size_t i = begin; i < end; i++) {
        real k = a * x[i].w;
        dst[i] = (sk_vec4){p[i].x + k * q[i].x, p[i].y + k * q[i].y, p[i].z + k * q[i].z, dst[i].w};
    }
}
