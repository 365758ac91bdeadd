/* Dividing a range of elements among tasks, for both task pools; see tasks.h. */
#include <stdatomic.h>

#include "base/float_mode.h"
#include "base/tasks.h"

enum { SMALLEST_SHARE = 4096 }; /* fewer elements run on the caller alone */

typedef struct range_job {
    sk_range_body *body;
    void *data;
    size_t begin, end, share;
} range_job;

static void run_share(void *data, int index) {
    const range_job *job = data;
    size_t begin = job->begin + job->share * (size_t)index;
    size_t end = begin + job->share < job->end ? begin + job->share : job->end;
    if (begin >= end) return;
    uint64_t mode = sk_float_mode_enter();
    job->body(job->data, begin, end);
    sk_float_mode_leave(mode);
}

void sk_parallel_for(sk_tasks *tasks, size_t begin, size_t end, sk_range_body *body, void *data) {
    if (end <= begin) return;
    int count = sk_tasks_count(tasks);
    if (count == 1 || end - begin < SMALLEST_SHARE) {
        body(data, begin, end);
        return;
    }
    size_t share = (end - begin + (size_t)count - 1) / (size_t)count;
    range_job job = {body, data, begin, end, (share + 15) / 16 * 16};
    sk_tasks_run(tasks, run_share, &job);
}

#ifndef SK_ONE_THREAD
typedef struct pieces_job {
    sk_piece_body *body;
    void *data;
    size_t end, grain;
    _Atomic size_t next;
} pieces_job;

static void run_pieces(void *data, int thread) {
    pieces_job *job = data;
    uint64_t mode = sk_float_mode_enter();
    for (;;) {
        size_t begin = atomic_fetch_add_explicit(&job->next, job->grain, memory_order_relaxed);
        if (begin >= job->end) break;
        job->body(job->data, thread, begin, job->end - begin < job->grain ? job->end : begin + job->grain);
    }
    sk_float_mode_leave(mode);
}

void sk_parallel_pieces(sk_tasks *tasks, size_t begin, size_t end, size_t grain, sk_piece_body *body, void *data) {
    if (end <= begin) return;
    if (!tasks || sk_tasks_count(tasks) == 1 || end - begin <= grain) {
        body(data, 0, begin, end);
        return;
    }
    pieces_job job = {.body = body, .data = data, .end = end, .grain = grain};
    atomic_init(&job.next, begin);
    sk_tasks_run(tasks, run_pieces, &job);
}
#endif
