/* Ranges that threads take in pieces: each element once, by no more threads than there are, in the same mode of floating point. */
#include <stdatomic.h>

#include "base/float_mode.h"
#include "base/tasks.h"
#include "helpers.h"

enum { MOST = 5000, THREADS = 4 };

typedef struct count {
    _Atomic int times[MOST], at_work[THREADS], faults;
    float tiny, half; /* a product that is no normal number */
} count;

static void look(count *c, int thread, size_t begin, size_t end) {
    if (thread < 0 || thread >= THREADS || atomic_fetch_add(&c->at_work[thread], 1)) c->faults++;
    for (size_t i = begin; i < end; i++) {
        volatile float tiny = c->tiny;
        if (!(tiny * c->half > 0)) c->faults++;
        c->times[i]++;
    }
    atomic_fetch_sub(&c->at_work[thread], 1);
}
static void look_at_piece(void *data, int thread, size_t begin, size_t end) {
    look(data, thread, begin, end);
}
static void look_at_range(void *data, size_t begin, size_t end) {
    count *c = data;
    for (size_t i = begin; i < end; i++) {
        volatile float tiny = c->tiny;
        if (!(tiny * c->half > 0)) c->faults++;
        c->times[i]++;
    }
}

static void assert_once(count *c, size_t begin, size_t end) {
    assert_int_equal(c->faults, 0);
    for (size_t i = 0; i < MOST; i++) assert_int_equal(c->times[i], i >= begin && i < end);
}

static void run_backwards(void *user, void (*task)(void *data, int index), void *data, int task_count) {
    (void)user;
    for (int i = task_count - 1; i >= 0; i--) task(data, i);
}

static count *new_count(void) {
    count *c = calloc(1, sizeof *c);
    c->tiny = 1.2e-38f, c->half = 0.25f;
    return c;
}

static void each_element_is_taken_once(void **state) {
    (void)state;
    sk_allocator allocator = sk_default_allocator();
    for (int backwards = 0; backwards < 2; backwards++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.thread_count = THREADS;
        if (backwards) desc.run_tasks = run_backwards;
        sk_tasks *tasks = sk_tasks_create(&allocator, &desc);
        for (int threads = 1; threads <= THREADS; threads++) {
            sk_tasks_use(tasks, threads);
            for (size_t grain = 1; grain <= 3 * MOST; grain = 3 * grain + 1)
                for (size_t end = 7; end <= MOST; end += 1331) {
                    count *c = new_count();
                    sk_parallel_pieces(tasks, 7, end, grain, look_at_piece, c);
                    assert_once(c, 7, end);
                    free(c);
                }
        }
        sk_tasks_destroy(tasks);
    }
    count *c = new_count();
    sk_parallel_pieces(NULL, 0, MOST, 16, look_at_piece, c); // where there are no tasks
    assert_once(c, 0, MOST);
    free(c);
}

#if defined(__x86_64__)
/* A program may flush what is no normal number to zero: not so a step, on any of its threads. */
static void all_threads_have_the_mode_of_a_step(void **state) {
    (void)state;
    const unsigned flushes = 0x8040;
    unsigned old = _mm_getcsr();
    sk_allocator allocator = sk_default_allocator();
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = THREADS;
    _mm_setcsr(old | flushes);
    sk_tasks *tasks = sk_tasks_create(&allocator, &desc);
    sk_tasks_use(tasks, THREADS); // workers begin in the mode of the program
    uint64_t mode = sk_float_mode_enter();
    for (int i = 0; i < 200; i++) {
        count *c = new_count();
        sk_parallel_pieces(tasks, 0, MOST, 16, look_at_piece, c);
        assert_once(c, 0, MOST);
        free(c);
        c = new_count();
        sk_parallel_for(tasks, 0, MOST, look_at_range, c);
        assert_once(c, 0, MOST);
        free(c);
    }
    sk_float_mode_leave(mode);
    assert_true((_mm_getcsr() & flushes) == flushes);
    _mm_setcsr(old);
    sk_tasks_destroy(tasks);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_element_is_taken_once),
#if defined(__x86_64__)
        cmocka_unit_test(all_threads_have_the_mode_of_a_step),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
