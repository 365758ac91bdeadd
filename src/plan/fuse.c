/* The one pass over a finished plan that fuses: patterns of neighbouring rows, each with what takes their place. */
#include "plan/fuse.h"

#include <string.h>

/* Rows of a substep that predicts, as a method writes them:
 *
 *   kicks       V = V + h w F, or V + h (uniform forces): a row for each part of the slots
 *   saves       X0 = X, and perhaps V0 = V
 *   drift       X = X + h V */
typedef struct prediction {
    size_t first, first_save, drift; /* in the repeat's rows; `drift` is the last */
    bool saves_velocity;
} prediction;

static bool is_sum(const sk_row *row, sk_vector dst, sk_vector p, sk_vector q) {
    return sk_row_is(row, &sk_combine_sum) && !row->inner && row->dst == dst && row->source[0] == p &&
           row->source[1] == q && row->source[2] == SK_NONE && row->coefficient[0] == 1;
}

static bool is_pull(const sk_row *row) {
    return sk_row_is(row, &sk_combine_pull);
}

/* V += h w F, h being the substep. */
static bool is_kick(const sk_row *row) {
    return sk_row_is(row, &sk_combine_kick) && row->dst == SK_V && row->source[0] == SK_V && row->source[1] == SK_F &&
           row->coefficient[0] == row->dt;
}

static size_t first_slot_of(const sk_row *row) {
    return row->inner ? row->first_slot : row->begin;
}

static size_t end_slot_of(const sk_row *row) {
    return row->inner ? row->end_slot : row->end;
}

/* Whether kicks [first, end) are of one part each, and of all slots together. */
static bool covers(const sk_row *rows, size_t first, size_t end, size_t slot_count) {
    size_t slot = 0;
    for (size_t r = first; r < end; slot = end_slot_of(&rows[r++]))
        if (first_slot_of(&rows[r]) != slot) return false;
    return slot == slot_count && first < end;
}

/* Finds the first prediction in the rows of a repeat. */
static bool find_prediction(const sk_row *rows, size_t count, prediction *found) {
    for (size_t d = 1; d < count; d++) {
        if (!is_sum(&rows[d], SK_X, SK_X, SK_V) || rows[d].coefficient[1] != rows[d].dt) continue;
        found->drift = found->first_save = d;
        found->saves_velocity = is_sum(&rows[d - 1], SK_V0, SK_V, SK_NONE);
        if (found->saves_velocity) found->first_save--;
        if (!found->first_save || !is_sum(&rows[found->first_save - 1], SK_X0, SK_X, SK_NONE)) continue;
        found->first = --found->first_save;
        while (found->first && (is_pull(&rows[found->first - 1]) || is_kick(&rows[found->first - 1]))) found->first--;
        if (covers(rows, found->first, found->first_save, rows[d].end)) return true;
    }
    return false;
}

static bool mentions(const sk_row *row, sk_vector vector) {
    bool any = row->dst == vector;
    for (int i = 0; i < 3; i++) any |= row->source[i] == vector;
    return any;
}

/* V += (X - X0 - h V)/h: what moved X away from where V alone would have taken it. */
static bool is_correction(const sk_row *row) {
    return sk_row_is(row, &sk_combine_correction) && row->dst == SK_V && row->source[0] == SK_X &&
           row->source[1] == SK_X0 && row->coefficient[1] == row->dt;
}

/* The one row behind the prediction that looks at X0 or V0, if it is a correction; else SIZE_MAX. Rows that only want to
 * know what was predicted do not count: they are as well served where X0 is that. */
static size_t find_only_correction(const sk_row *rows, size_t count, const prediction *found) {
    size_t only = SIZE_MAX;
    for (size_t r = 0; r < count; r++) {
        if ((r >= found->first && r <= found->drift) || !(mentions(&rows[r], SK_X0) || mentions(&rows[r], SK_V0)))
            continue;
        if (r > found->drift && rows[r].from_prediction) continue;
        if (only != SIZE_MAX || r < found->drift || !is_correction(&rows[r])) return SIZE_MAX;
        only = r;
    }
    return only;
}

/* ---- writing the rows anew ---- */

typedef struct fuser {
    sk_plan *plan; /* the rows so far */
    sk_allocator *allocator;
    sk_isa isa;
    bool no_memory;
} fuser;

static void add(fuser *f, sk_row row) {
    if (!sk_plan_add(f->plan, f->allocator, row)) f->no_memory = true;
}

static void add_rows(fuser *f, const sk_row *rows, size_t begin, size_t end) {
    for (size_t r = begin; r < end; r++) add(f, rows[r]);
}

/* A row that looks at X0, where that is where X is going. */
static sk_row by_goal(sk_row row) {
    if (row.from_prediction) row.coefficient[1] = 0;
    return row;
}

/* The row that does what a kick, the saves and the drift did; `kept` says what is saved besides X0, see row.h. */
static sk_row predicting(const fuser *f, const sk_row *kick, sk_vector kept) {
    sk_row row = *kick;
    const sk_kernels *kernels = is_pull(kick) ? &sk_combine_fall : &sk_combine_predict;
    row.dst = SK_X;
    row.source[0] = SK_V, row.source[1] = is_pull(kick) ? SK_NONE : SK_F, row.source[2] = kept;
    row.coefficient[0] = 0;
    *(row.inner ? &row.inner : &row.kernel) = kernels->version[f->isa];
    return row;
}

/* The end of one substep, and the prediction of the next. */
static sk_row following(const fuser *f, const sk_row *pull, const sk_row *correction) {
    sk_row row = predicting(f, pull, SK_X);
    row.coefficient[0] = correction->coefficient[0];
    row.before = correction->before;
    *(row.inner ? &row.inner : &row.kernel) = sk_combine_fall_on.version[f->isa];
    return row;
}

static bool all_pull(const sk_row *rows, const prediction *found) {
    for (size_t r = found->first; r < found->first_save; r++)
        if (!is_pull(&rows[r])) return false;
    return true;
}

/* Where a substep begins by predicting and ends by its correction, and nobody else looks at its start: the first
 * prediction comes before the repeat, and each turn's correction is one row with the next turn's prediction. */
static void fuse_across_turns(fuser *f, const sk_row *repeat, const prediction *found) {
    const sk_row *rows = repeat + 1;
    for (size_t r = 0; r < found->first_save; r++) add(f, predicting(f, &rows[r], SK_X));
    sk_row head = *repeat;
    head.length = repeat->length - (found->drift + 1) - 1 + found->first_save;
    add(f, head);
    for (size_t r = found->drift + 1; r + 1 < repeat->length; r++) add(f, by_goal(rows[r]));
    for (size_t r = 0; r < found->first_save; r++) add(f, following(f, &rows[r], &rows[repeat->length - 1]));
}

/* Each kick with the saves and the drift; `correction` is the only row that looks back, or SIZE_MAX. */
static void fuse_prediction(fuser *f, const sk_row *repeat, const prediction *found, size_t correction) {
    const sk_row *rows = repeat + 1;
    bool goal = correction != SIZE_MAX; // then X0 may as well be where X is going: the correction has less to do
    sk_vector kept = goal ? SK_X : found->saves_velocity ? SK_V0 : SK_NONE;
    sk_row head = *repeat;
    head.length -= found->drift + 1 - found->first_save;
    add(f, head);
    add_rows(f, rows, 0, found->first);
    for (size_t r = found->first; r < found->first_save; r++) add(f, predicting(f, &rows[r], kept));
    for (size_t r = found->drift + 1; r < repeat->length; r++) {
        sk_row row = goal ? by_goal(rows[r]) : rows[r];
        if (r == correction) row.coefficient[1] = 0;
        add(f, row);
    }
}

static void fuse_repeat(fuser *f, const sk_row *repeat) {
    const sk_row *rows = repeat + 1;
    prediction found;
    if (!find_prediction(rows, repeat->length, &found)) {
        add_rows(f, repeat, 0, repeat->length + 1);
        return;
    }
    size_t correction = find_only_correction(rows, repeat->length, &found);
    if (correction + 1 == repeat->length && found.first == 0 && all_pull(rows, &found))
        fuse_across_turns(f, repeat, &found);
    else fuse_prediction(f, repeat, &found, correction);
}

bool sk_plan_fuse(sk_plan *plan, sk_allocator *allocator, sk_isa isa) {
    sk_plan fused = {.parts = plan->parts};
    fuser f = {&fused, allocator, isa, false};
    for (size_t r = 0; r < plan->count; r++) {
        if (plan->data[r].kind == SK_ROW_REPEAT) {
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
