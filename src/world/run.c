/* The runner: one loop over rows, whatever the rules and the method.
 *
 * Free rows are cut over the threads; ordered rows run on the caller, in their order. A repeat runs the
 * rows after it again and again, moving the time on by its substep each turn. */
#include "world/world.h"

typedef struct row_job {
    sk_run *run;
    const sk_row *row;
} row_job;

static void run_range(void *data, size_t begin, size_t end) {
    const row_job *job = data;
    job->row->kernel(job->run, job->row, begin, end);
}

static void run_rows(sk_run *run, sk_tasks *tasks, const sk_row *rows, size_t count, double start) {
    for (size_t r = 0; r < count; r++) {
        const sk_row *row = &rows[r];
        if (row->kind == SK_ROW_REPEAT) {
            for (size_t turn = 0; turn < row->end; turn++) {
                run->time = start + (double)(turn + 1) * row->dt;
                run_rows(run, tasks, row + 1, row->length, run->time - row->dt);
            }
            r += row->length;
        } else if (row->order == SK_FREE) {
            row_job job = {run, row};
            sk_parallel_for(tasks, row->begin, row->end, run_range, &job);
        } else {
            row->kernel(run, row, row->begin, row->end);
        }
    }
}

void sk_run_plan(sk_run *run, sk_tasks *tasks, const sk_plan *plan) {
    run_rows(run, tasks, plan->data, plan->count, run->time);
}
