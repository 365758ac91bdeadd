/* Rows of a plan run alone, as a step would run them: in the layout that they expect, repeated as in a frame, by the
 * world's own runner. */
#include <stdlib.h>
#include <string.h>

#include "base/float_mode.h"
#include "bench/worlds.h"
#include "world/world.h"

struct bench_rows {
    skein_world *world;
    sk_row *rows; /* a repeat, and the rows in it */
    size_t count; /* with the repeat */
};

/* Runs the plan's rows that bring X and V into the layout of a step, or back; there need not be any. */
static void run_layout_rows(skein_world *world, sk_row_kind kind) {
    sk_run run = sk_world_run_context(world);
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].kind == kind) sk_run_rows(&run, world->tasks, &world->plan.data[r], 1);
}

bench_rows *bench_rows_create(skein_world *world, sk_row_kind kind) {
    bench_need(world, skein_world_explain(world, 1.0 / 60, NULL, NULL)); // makes the plan
    const sk_plan *plan = &world->plan;
    bench_rows *rows = bench_allocate(1, sizeof *rows);
    rows->rows = bench_allocate(plan->count + 1, sizeof *rows->rows);
    rows->world = world;
    rows->rows[0] = (sk_row){.kind = SK_ROW_REPEAT, .order = SK_ORDERED, .label = "repeat", .end = 1};
    rows->count = 1;
    for (size_t r = 0; r < plan->count; r++) {
        if (plan->data[r].kind == SK_ROW_REPEAT) rows->rows[0] = plan->data[r];
        if (plan->data[r].kind == kind) rows->rows[rows->count++] = plan->data[r];
    }
    rows->rows[0].length = rows->count - 1;
    if (rows->count == 1) {
        bench_say("the plan has no %s rows", sk_row_kind_text(kind));
        free(rows->rows);
        free(rows);
        return NULL;
    }
    run_layout_rows(world, SK_ROW_PACK);
    return rows;
}

void bench_rows_destroy(bench_rows *rows) {
    if (!rows) return;
    run_layout_rows(rows->world, SK_ROW_UNPACK);
    free(rows->rows);
    free(rows);
}

static void run(bench_rows *rows, const sk_row *first, size_t count) {
    sk_run context = sk_world_run_context(rows->world);
    uint64_t mode = sk_float_mode_enter();
    sk_run_rows(&context, rows->world->tasks, first, count);
    sk_float_mode_leave(mode);
}

void bench_rows_run(void *data) {
    bench_rows *rows = data;
    run(rows, rows->rows, rows->count);
}

void bench_rows_run_once(void *data) {
    bench_rows *rows = data;
    run(rows, rows->rows + 1, rows->count - 1);
}

size_t bench_rows_turns(const bench_rows *rows) {
    return rows->rows[0].end;
}

void bench_rows_forces(bench_rows *rows, double *out) {
    sk_particles *particles = &rows->world->particles;
    sk_vec4 *forces = particles->vector[SK_F];
    memset(forces, 0, particles->slot_count * sizeof *forces);
    bench_rows_run_once(rows);
    for (size_t i = 0; i < particles->count; i++) {
        sk_vec4 f = sk_load(forces, rows->rows[1].packed, particles->slot_of[i]);
        out[3 * i] = (double)f.x, out[3 * i + 1] = (double)f.y, out[3 * i + 2] = (double)f.z;
    }
}
