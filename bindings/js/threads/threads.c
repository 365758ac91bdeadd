/* Threads of workers: each worker of JavaScript (thread.js) has the module once more, over the same memory and with a
 * stack of its own, takes a *seat*, and sleeps there until a world wants a thread. A world has its threads until it is
 * destroyed; then their seats are free for the next one. Waits are those of WebAssembly, on a number in memory.
 *
 * The seats belong to the module, as its memory does: workers come to it by no world.
 *
 * wasi-libc is not made for threads: its heap has no lock, and errno is everybody's. So the heap's entries are wrapped
 * (the linker's --wrap) by a lock; in a task of the library nobody asks for memory, and nothing there sets errno. */
#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { MOST_SEATS = 63 };                               /* the pool's 64 less the caller */
enum { ABSENT, FREE, WORKING, DONE };                   /* of a seat */
static const int64_t FOREVER = -1, A_WHILE = 20 * 1000; /* ns */

typedef struct seat {
    _Atomic int32_t state;
    void *(*start)(void *);
    void *argument, *result;
} seat;

static seat seats[MOST_SEATS];

/* (A function of its own: the first of the two compilers of V8 11, node 20's, calls wrongly through pointers in one that waits.) */
__attribute__((noinline)) static void sleep_while(_Atomic int32_t *number, int32_t is, int64_t most) {
    __builtin_wasm_memory_atomic_wait32((int32_t *)number, is, most);
}

static void wake(_Atomic int32_t *number, unsigned count) {
    __builtin_wasm_memory_atomic_notify((int32_t *)number, count);
}

/* A worker's life. Called once by each, with a seat that is its own; never returns. */
__attribute__((export_name("js_work"))) void js_work(int which) {
    seat *mine = &seats[which];
    atomic_store(&mine->state, FREE);
    for (;;) {
        int32_t state = atomic_load(&mine->state);
        if (state != WORKING) {
            sleep_while(&mine->state, state, FOREVER);
            continue;
        }
        mine->result = mine->start(mine->argument);
        atomic_store(&mine->state, DONE);
        wake(&mine->state, 1);
    }
}

/* Workers that have come, at work or not. */
__attribute__((export_name("js_workers"))) int js_workers(void) {
    int count = 0;
    for (int i = 0; i < MOST_SEATS; i++) count += atomic_load(&seats[i].state) != ABSENT;
    return count;
}

int pthread_create(pthread_t *thread, const void *attributes, void *(*start)(void *), void *argument) {
    (void)attributes;
    for (int i = 0; i < MOST_SEATS; i++) {
        seat *s = &seats[i];
        if (atomic_load(&s->state) != FREE) continue; // (only one thread creates others: where the worlds are)
        s->start = start;
        s->argument = argument;
        atomic_store(&s->state, WORKING);
        wake(&s->state, 1);
        *thread = i;
        return 0;
    }
    return EAGAIN;
}

int pthread_join(pthread_t thread, void **result) {
    seat *s = &seats[thread];
    for (int32_t state; (state = atomic_load(&s->state)) != DONE;) sleep_while(&s->state, state, FOREVER);
    if (result) *result = s->result;
    atomic_store(&s->state, FREE);
    return 0;
}

int pthread_mutex_init(pthread_mutex_t *mutex, const void *attributes) {
    (void)attributes;
    atomic_init(&mutex->taken, 0);
    return 0;
}

int pthread_mutex_destroy(pthread_mutex_t *mutex) {
    (void)mutex;
    return 0;
}

int pthread_mutex_lock(pthread_mutex_t *mutex) {
    int32_t was = 0;
    if (atomic_compare_exchange_strong(&mutex->taken, &was, 1)) return 0;
    while (atomic_exchange(&mutex->taken, 2)) sleep_while(&mutex->taken, 2, FOREVER);
    return 0;
}

int pthread_mutex_unlock(pthread_mutex_t *mutex) {
    if (atomic_exchange(&mutex->taken, 0) == 2) wake(&mutex->taken, 1);
    return 0;
}

int pthread_cond_init(pthread_cond_t *condition, const void *attributes) {
    (void)attributes;
    atomic_init(&condition->told, 0);
    return 0;
}

int pthread_cond_destroy(pthread_cond_t *condition) {
    (void)condition;
    return 0;
}

int pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex) {
    int32_t told = atomic_load(&condition->told);
    pthread_mutex_unlock(mutex);
    sleep_while(&condition->told, told, FOREVER);
    return pthread_mutex_lock(mutex);
}

int pthread_cond_broadcast(pthread_cond_t *condition) {
    atomic_fetch_add(&condition->told, 1);
    wake(&condition->told, UINT32_MAX);
    return 0;
}

/* There is no giving away of a processor; a short sleep does it. */
int sched_yield(void) {
    _Atomic int32_t never = 0;
    sleep_while(&never, 0, A_WHILE);
    return 0;
}

/* ---- the heap, under a lock ---- */

static pthread_mutex_t heap;

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *memory);

#define LOCKED(type_, call_)     \
    pthread_mutex_lock(&heap);   \
    type_ memory_ = (call_);     \
    pthread_mutex_unlock(&heap); \
    return memory_

void *__wrap_malloc(size_t size) {
    LOCKED(void *, __real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size) {
    LOCKED(void *, __real_calloc(count, size));
}

void *__wrap_realloc(void *memory, size_t size) {
    LOCKED(void *, __real_realloc(memory, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    LOCKED(void *, __real_aligned_alloc(alignment, size));
}

void __wrap_free(void *memory) {
    pthread_mutex_lock(&heap);
    __real_free(memory);
    pthread_mutex_unlock(&heap);
}
