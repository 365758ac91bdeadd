/* Tasks in builds without threads (SKEIN_THREADS off: WebAssembly, small machines), in place of tasks.c: they run one
 * after the other on the caller, or by the callback of the world's description, which may use threads. */
#include "base/tasks.h"

struct sk_tasks {
    sk_allocator *allocator;
    void (*run_tasks)(void *user, void (*task)(void *data, int index), void *data, int task_count);
    void *user;
    int count; /* 1 without a callback */
};

sk_tasks *sk_tasks_create(sk_allocator *allocator, const skein_world_desc *desc) {
    sk_tasks *tasks = sk_allocate(allocator, sizeof *tasks);
    if (!tasks) return NULL;
    tasks->allocator = allocator;
    tasks->run_tasks = desc->run_tasks;
    tasks->user = desc->tasks_user;
    tasks->count = desc->run_tasks && desc->thread_count > 1 ? desc->thread_count : 1;
    return tasks;
}

void sk_tasks_destroy(sk_tasks *tasks) {
    if (tasks) sk_release(tasks->allocator, tasks);
}

int sk_tasks_count(const sk_tasks *tasks) {
    return tasks->count;
}

int sk_tasks_most(const sk_tasks *tasks) {
    return tasks->count;
}

void sk_tasks_use(sk_tasks *tasks, int count) {
    (void)tasks, (void)count;
}

void sk_tasks_run(sk_tasks *tasks, void (*task)(void *data, int index), void *data) {
    if (tasks->count > 1) tasks->run_tasks(tasks->user, task, data, tasks->count);
    else task(data, 0);
}

bool sk_tasks_together(const sk_tasks *tasks) {
    return tasks->count == 1;
}

void sk_wait_for(const _Atomic uint32_t *progress, uint32_t wanted) {
    (void)progress, (void)wanted; // tasks run in order, so the progress has been made
}
