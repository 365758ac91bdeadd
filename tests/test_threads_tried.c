/* How many threads a step takes: with times that are made up, so that nothing here depends on the machine. */
#include "base/pace.h"
#include "helpers.h"

/* What a step takes by so many threads, s. */
typedef double machine(int threads, uint64_t *seed);

static double idle(int threads, uint64_t *seed) {
    (void)seed;
    return 1e-3 / threads;
}
/* Somebody else has one of two processors: measured, two threads took 3.0 ms where one took 0.65. */
static double shared(int threads, uint64_t *seed) {
    (void)seed;
    return threads > 1 ? 3e-3 : 0.65e-3;
}
static double small(int threads, uint64_t *seed) {
    (void)seed;
    return threads > 1 ? 2e-5 : 4e-5;
}
static double with_hitches(int threads, uint64_t *seed) {
    double time = 1e-3 / threads;
    return random_between(seed, 0, 1) < 0.01 ? 4 * time : time;
}
/* Four threads do best, and eight worse than two. */
static double four(int threads, uint64_t *seed) {
    (void)seed;
    return threads == 4 ? 0.4e-3 : threads == 2 ? 0.6e-3 : 1e-3;
}

/* A cloth that falls into a heap and comes to rest: in sixty steps there is twenty times as much to do, and then less. Two
 * threads take two thirds of the time. The seed counts. */
static double heap(int threads, uint64_t *seed) {
    double step = (double)((*seed)++ - 7), share = step < 60 ? step / 60 : step < 180 ? (180 - step) / 120 : 0;
    return 5e-3 * pow(20, share) / (threads > 1 ? 1.5 : 1);
}
/* The same where somebody else has one of two processors. */
static double shared_heap(int threads, uint64_t *seed) {
    return heap(1, seed) * (threads > 1 ? 4.6 : 1);
}

/* A heap that lies still, in which every fourth step searches; two threads gain a quarter. */
static double searching(int threads, uint64_t *seed) {
    return ((*seed)++ % 4 ? 19e-3 : 29e-3) / (threads > 1 ? 1.3 : 1);
}
/* The same, where they gain next to nothing. */
static double searching_alone(int threads, uint64_t *seed) {
    return ((*seed)++ % 4 ? 19e-3 : 29e-3) / (threads > 1 ? 1.05 : 1);
}

/* Steps on a machine; returns the seconds that they took, and how many threads the last one had. */
static double run(sk_pace *pace, machine *takes, int steps, int *threads) {
    uint64_t seed = 7;
    double sum = 0;
    for (int i = 0; i < steps; i++) {
        *threads = sk_pace_threads(pace);
        double seconds = takes(*threads, &seed);
        sk_pace_note(pace, seconds);
        sum += seconds;
    }
    return sum;
}

static void threads_that_pay_are_taken(void **state) {
    (void)state;
    sk_pace pace;
    int threads;
    sk_pace_start(&pace, 2, false);
    assert_int_equal(sk_pace_threads(&pace), 1);
    run(&pace, idle, 20, &threads);
    assert_int_equal(threads, 2);
    assert_under(run(&pace, idle, 1000, &threads), 1000 * 0.52e-3);
    sk_pace_start(&pace, 2, false);
    assert_under(run(&pace, with_hitches, 1000, &threads), 1000 * 0.7e-3); // 0.515 by two alone, 1.03 by one
    sk_pace_start(&pace, 8, false);
    run(&pace, four, 30, &threads);
    assert_under(run(&pace, four, 1000, &threads), 1000 * 0.44e-3);
    sk_pace_start(&pace, 6, false); // no power of two
    run(&pace, idle, 100, &threads);
    assert_int_equal(threads, 6);
}

static void threads_that_cost_are_not(void **state) {
    (void)state;
    sk_pace pace;
    int threads;
    // soon as well as late: never more than 1.2 times what one thread takes
    for (int steps = 40; steps <= 4000; steps *= 10) {
        sk_pace_start(&pace, 2, false);
        assert_under(run(&pace, shared, steps, &threads), 1.2 * steps * 0.65e-3);
        assert_int_equal(threads, 1);
    }
    sk_pace_start(&pace, 2, false);
    run(&pace, small, 1000, &threads);
    assert_int_equal(threads, 1);
    sk_pace_start(&pace, 1, false);
    run(&pace, idle, 100, &threads);
    assert_int_equal(threads, 1);
}

static void it_follows_the_machine(void **state) {
    (void)state;
    sk_pace pace;
    int threads;
    sk_pace_start(&pace, 2, false);
    for (int turn = 0; turn < 3; turn++) {
        run(&pace, idle, 1100, &threads);
        assert_int_equal(threads, 2);
        assert_under(run(&pace, shared, 300, &threads), 1.2 * 300 * 0.65e-3);
        assert_int_equal(threads, 1);
    }
}

static void it_follows_the_work(void **state) {
    (void)state;
    int threads;
    for (int steps = 40; steps <= 240; steps += 40) {
        uint64_t seed = 7;
        double one = 0;
        for (int i = 0; i < steps; i++) one += heap(1, &seed);
        sk_pace pace;
        sk_pace_start(&pace, 2, false);
        assert_under(run(&pace, heap, steps, &threads), 0.74 * one);
        sk_pace_start(&pace, 2, false);
        assert_under(run(&pace, shared_heap, steps, &threads), 1.2 * one);
        assert_int_equal(threads, 1);
    }
}

static void steps_that_search_mislead_nobody(void **state) {
    (void)state;
    sk_pace pace;
    int threads;
    for (int first = 0; first < 4; first++) {
        uint64_t seed = (uint64_t)first; // where among four steps it begins
        sk_pace_start(&pace, 2, false);
        for (int i = 0; i < first; i++) sk_pace_note(&pace, searching(sk_pace_threads(&pace), &seed));
        run(&pace, searching, 20, &threads);
        for (int i = 0; i < 50; i++) {
            const double by_two = 21.5e-3 / 1.3;
            assert_under(run(&pace, searching, 100, &threads), 103 * by_two);
        }
        sk_pace_start(&pace, 2, false);
        for (int i = 0; i < first; i++) sk_pace_note(&pace, searching_alone(sk_pace_threads(&pace), &seed));
        run(&pace, searching_alone, 2000, &threads);
        assert_int_equal(threads, 1);
    }
}

static void all_threads_can_be_had_always(void **state) {
    (void)state;
    sk_pace pace;
    int threads;
    sk_pace_start(&pace, 3, true);
    assert_int_equal(sk_pace_threads(&pace), 3);
    run(&pace, shared, 100, &threads);
    assert_int_equal(threads, 3);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_that_pay_are_taken),       cmocka_unit_test(threads_that_cost_are_not),
        cmocka_unit_test(it_follows_the_machine),           cmocka_unit_test(it_follows_the_work),
        cmocka_unit_test(steps_that_search_mislead_nobody), cmocka_unit_test(all_threads_can_be_had_always),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
