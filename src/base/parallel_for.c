/* Dividing a range of elements among tasks, for both task pools; see tasks.h. */
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
    if (begin < end) job->body(job->data, begin, end);
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
