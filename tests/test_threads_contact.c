/* Contact on several threads: each searches a part of the leaves, and what they find is put together in one order, so the
 * bits are the same for any number of threads, and for tasks in any order. */
#include "helpers.h"

enum { SIDE = SPARING ? 26 : 36, STEPS = SPARING ? 3 : 24 };

typedef struct tally {
    size_t calls;
} tally;

static void run_backwards(void *user, void (*task)(void *data, int index), void *data, int task_count) {
    ((tally *)user)->calls++;
    for (int i = task_count - 1; i >= 0; i--) task(data, i);
}

/* A sheet that lies on another, both folded by the fall on a ball; or goes through it, at the start. */
static uint64_t hash_of_run(int threads, tally *t, bool through) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    if (t) desc.run_tasks = run_backwards, desc.tasks_user = t;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 5))));
    add_gravity(world);
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2)), NULL));
    for (int l = 0; l < 2; l++)
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE),
                                                SKEIN_VEC3("position", 0.02 * l, 0.22 + 0.012 * l, 0),
                                                SKEIN_VEC3("rotation", through ? 9 * l : 0, 20 * l, 0),
                                                SKEIN_VEC3("velocity", 0, -1 - l, 0)),
                                 NULL));
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01)), NULL));
    assert_int_equal(statistics_of(world).crossings > 0, through);
    steps(world, STEPS, 1.0 / 60);
    if (!through) assert_int_equal(statistics_of(world).crossings, 0);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void threads_change_no_bit(void **state) {
    (void)state;
    setenv("SKEIN_THREADS", "always", 1);
    for (int through = 0; through < 2; through++) {
        uint64_t ought = hash_of_run(1, NULL, through);
        for (int threads = 2; threads <= (SPARING ? 2 : 3); threads++)
            assert_true(hash_of_run(threads, NULL, through) == ought);
        tally t = {0};
        assert_true(hash_of_run(4, &t, through) == ought);
        assert_true(t.calls > 10 * STEPS); // the search is cut, or the test would prove nothing
    }
    unsetenv("SKEIN_THREADS");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(threads_change_no_bit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
