/* The default pool: workers wait for a new ticket, first spinning, then asleep.
 *
 *   caller                          worker i
 *   new ticket           ------->   sees it, and runs task(data, i) if the ticket asks for more than i threads
 *   runs task(data, 0)              remaining = remaining - 1
 *   waits until remaining == 0 <----
 *
 * `task` and `data` are written before the ticket and read after it: the ticket publishes them. It holds a counter, and
 * in its lowest bits how many threads it is for. Both are read at once, for a worker that is not asked may wake much
 * later. Workers are started when they are first needed. */
#define _GNU_SOURCE // sched_getaffinity
#include "base/tasks.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <unistd.h>

enum {
    MOST_THREADS = 64,
    SPINS = 4000, /* pauses before a waiter sleeps */
    TICKET = 256, /* a ticket's counter grows by this; the remainder is its number of threads */

};

typedef struct worker {
    sk_tasks *tasks;
    int index;
    pthread_t thread;
    uint32_t seen; /* the newest ticket when it was started, which it ignores */
} worker;

struct sk_tasks {
    sk_allocator *allocator;
    void (*run_tasks)(void *user, void (*task)(void *data, int index), void *data, int task_count);
    void *user;
    int most;    /* threads that may be used */
    int count;   /* threads in use: the pieces that a range is cut into */
    int started; /* workers alive */
    void (*task)(void *data, int index);
    void *data;
    _Atomic uint32_t ticket;
    _Atomic int remaining;
    _Atomic bool stop;
    int sleepers; /* under the mutex */
    pthread_mutex_t mutex;
    pthread_cond_t wake;
    worker workers[MOST_THREADS];
};

static inline void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#elif defined(__wasm__)
    for (volatile int i = 0; i < 16; i++) {} // WebAssembly has no such instruction
#endif
}

/* Waits for a ticket other than `seen`: spins a while, then sleeps. */
static uint32_t wait_for_ticket(sk_tasks *tasks, uint32_t seen) {
    for (int i = 0; i < SPINS; i++) {
        uint32_t now = atomic_load_explicit(&tasks->ticket, memory_order_acquire);
        if (now != seen) return now;
        pause_briefly();
    }
    pthread_mutex_lock(&tasks->mutex);
    tasks->sleepers++;
    uint32_t now;
    while ((now = atomic_load(&tasks->ticket)) == seen) pthread_cond_wait(&tasks->wake, &tasks->mutex);
    tasks->sleepers--;
    pthread_mutex_unlock(&tasks->mutex);
    return now;
}

static void *worker_main(void *argument) {
    worker *self = argument;
    sk_tasks *tasks = self->tasks;
    uint32_t seen = self->seen;
    for (;;) {
        seen = wait_for_ticket(tasks, seen);
        if (atomic_load(&tasks->stop)) return NULL;
        if ((uint32_t)self->index >= seen % TICKET) continue;
        tasks->task(tasks->data, self->index);
        atomic_fetch_sub_explicit(&tasks->remaining, 1, memory_order_release);
    }
}

static void publish(sk_tasks *tasks) {
    pthread_mutex_lock(&tasks->mutex);
    uint32_t last = atomic_load(&tasks->ticket);
    atomic_store(&tasks->ticket, last - last % TICKET + TICKET + (uint32_t)tasks->count);
    if (tasks->sleepers) pthread_cond_broadcast(&tasks->wake);
    pthread_mutex_unlock(&tasks->mutex);
}

/* The number of processors that this process may run on, if the system tells. */
static int count_processors(void) {
#ifdef __linux__
    cpu_set_t set;
    if (!sched_getaffinity(0, sizeof set, &set)) return CPU_COUNT(&set);
#endif
#ifdef _WIN32
    long online = pthread_num_processors_np();
#else
    long online = sysconf(_SC_NPROCESSORS_ONLN);
#endif
    return online < 1 ? 1 : online > MOST_THREADS ? MOST_THREADS : (int)online;
}

sk_tasks *sk_tasks_create(sk_allocator *allocator, const skein_world_desc *desc) {
    sk_tasks *tasks = sk_allocate(allocator, sizeof *tasks);
    if (!tasks) return NULL;
    tasks->allocator = allocator;
    tasks->run_tasks = desc->run_tasks;
    tasks->user = desc->tasks_user;
    tasks->most = desc->thread_count > 0 ? desc->thread_count : count_processors();
    if (tasks->most > MOST_THREADS) tasks->most = MOST_THREADS;
    tasks->count = tasks->run_tasks ? tasks->most : 1;
    pthread_mutex_init(&tasks->mutex, NULL);
    pthread_cond_init(&tasks->wake, NULL);
    return tasks;
}

/* False if the system starts no more threads. */
static bool start_workers(sk_tasks *tasks) {
    while (tasks->started < tasks->count - 1) {
        int i = tasks->started + 1;
        worker *w = &tasks->workers[i];
        *w = (worker){tasks, i, 0, atomic_load(&tasks->ticket)};
        if (pthread_create(&w->thread, NULL, worker_main, w)) return false;
        tasks->started++;
    }
    return true;
}

void sk_tasks_use(sk_tasks *tasks, int count) {
    if (tasks->run_tasks) return;
    tasks->count = count < 1 ? 1 : count > tasks->most ? tasks->most : count;
    if (!start_workers(tasks)) tasks->count = tasks->started + 1;
}

void sk_tasks_destroy(sk_tasks *tasks) {
    if (!tasks) return;
    atomic_store(&tasks->stop, true);
    publish(tasks);
    for (int i = 1; i <= tasks->started; i++) pthread_join(tasks->workers[i].thread, NULL);
    pthread_cond_destroy(&tasks->wake);
    pthread_mutex_destroy(&tasks->mutex);
    sk_release(tasks->allocator, tasks);
}

int sk_tasks_most(const sk_tasks *tasks) {
    return tasks->most;
}

int sk_tasks_count(const sk_tasks *tasks) {
    return tasks->count;
}

void sk_tasks_run(sk_tasks *tasks, void (*task)(void *data, int index), void *data) {
    if (tasks->count == 1) {
        task(data, 0);
        return;
    }
    if (tasks->run_tasks) {
        tasks->run_tasks(tasks->user, task, data, tasks->count);
        return;
    }
    tasks->task = task;
    tasks->data = data;
    atomic_store(&tasks->remaining, tasks->count - 1);
    publish(tasks);
    task(data, 0);
    // with fewer cores than threads, spinning for ever would starve the workers
    for (int spins = 0; atomic_load_explicit(&tasks->remaining, memory_order_acquire) > 0; spins++) {
        if (spins < SPINS) pause_briefly();
        else sched_yield();
    }
}

bool sk_tasks_together(const sk_tasks *tasks) {
    return !tasks->run_tasks;
}

void sk_wait_for(const _Atomic uint32_t *progress, uint32_t wanted) {
    for (int spins = 0; (int32_t)(atomic_load_explicit(progress, memory_order_acquire) - wanted) < 0; spins++) {
        if (spins < SPINS) pause_briefly();
        else sched_yield();
    }
}
