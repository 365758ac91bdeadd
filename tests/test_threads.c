/* The same bits for any number of threads, for tasks in any order, and in a second run; with enough particles that
 * rows really are cut over threads. */
#include "all_methods.h"
#include "helpers.h"

enum { SIDE = 142, LOOSE = 400 };
#if SPARING // a hundred times as slow: one count is as good as another
static const int some_counts[] = {3};
enum { STEPS = 1, SHORT_SUBSTEPS = 8, TURNS = 6 };
#else
static const int some_counts[] = {1, 2, 3, 8};
enum { STEPS = 4, SHORT_SUBSTEPS = 24, TURNS = 12 };
#endif

typedef struct tally {
    size_t calls, tasks;
} tally;

/* Runs the tasks backwards, one after the other: as good an order as any. */
static void run_backwards(void *user, void (*task)(void *data, int index), void *data, int task_count) {
    tally *t = user;
    t->calls++;
    for (int i = task_count - 1; i >= 0; i--, t->tasks++) task(data, i);
}

/* A large cloth falls on a ball amid loose particles that push each other. */
static uint64_t hash_of_run(const char *method, int side, int substeps, int threads, tally *t) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    if (t) desc.run_tasks = run_backwards, desc.tasks_user = t;
    skein_error error;
    skein_world *world = skein_world_create(&desc, &error);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_VEC3("position", 0, 0.5, 0),
                                            SKEIN_VEC3("velocity", 0.1, -2, 0), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 5), SKEIN_REAL("shear.stiffness", 1),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 0.1),
                                            SKEIN_REAL("stretch.damping", 1e-3), SKEIN_REAL("stretch.limit", 0.01)),
                             NULL));
    uint64_t seed = 17;
    for (int i = 0; i < LOOSE; i++) {
        double r[6]; // one after the other: compilers take arguments in different orders
        for (int k = 0; k < 6; k++) r[k] = random_between(&seed, -1, 1);
        add_moving(world, 0.001, 0.5 * r[0], 0.5 + 0.05 * r[1], 0.5 * r[2], r[3], r[4], r[5]);
    }
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("quadratic", 1e-5)), NULL));
    OK(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 2, 0, 1)), NULL));
    OK(world, skein_force_add(world, "separation",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", 0.008), SKEIN_REAL("strength", 1e-4)), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.1, 0), SKEIN_REAL("radius", 0.39),
                                                SKEIN_REAL("motion.spin", 5)),
                                 NULL));
    OK(world, skein_collider_add(world, "plane",
                                 SKEIN_SETTINGS(SKEIN_REAL("offset", 0.48), SKEIN_REAL("restitution", 0.5)), NULL));
    assert_true(skein_particle_count(world) > (size_t)(side * side));
    steps(world, STEPS, 1.0 / 90);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.nonfinite, 0);
    assert_true(s.contacts > (side == SIDE ? 100 : 5));
    assert_true(s.state_hash == skein_world_hash(world));
    skein_world_destroy(world);
    return s.state_hash;
}

static void the_hash_does_not_depend_on_threads(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        uint64_t one = hash_of_run(method_names[m], SIDE, 2, 1, NULL);
        for (size_t i = 0; i < COUNT(some_counts); i++)
            assert_true(hash_of_run(method_names[m], SIDE, 2, some_counts[i], NULL) == one);
        // through the callback, and it is really used: several rows in each substep, all their tasks
        tally t = {0, 0};
        assert_true(hash_of_run(method_names[m], SIDE, 2, 5, &t) == one);
        assert_true(t.calls > 2 * STEPS && t.tasks == 5 * t.calls);
    }
}

/* The others with fewer particles, though enough to be cut over threads. */
static void no_method_depends_on_threads(void **state) {
    (void)state;
    enum { SMALL = 67 };
    for (size_t m = 0; m < COUNT(all_methods); m++) {
#ifdef SK_ONE_ISA
        if (m % 3) continue; // sanitizers need not see them all
#endif
        int substeps = !strcmp(all_methods[m], "backward_euler") ? 1 : SHORT_SUBSTEPS;
        uint64_t one = hash_of_run(all_methods[m], SMALL, substeps, 1, NULL);
        assert_true(hash_of_run(all_methods[m], SMALL, substeps, 3, NULL) == one);
    }
}

/* Small worlds with pools of their own, at once: starting, sleeping and stopping lose nothing. */
static void worlds_with_threads_come_and_go(void **state) {
    (void)state;
    uint64_t hash = 0;
    for (int turn = 0; turn < TURNS; turn++) {
        skein_world *worlds[2];
        for (int w = 0; w < 2; w++) {
            skein_world_desc desc = skein_default_world_desc();
            desc.thread_count = 1 + turn % 4;
            worlds[w] = skein_world_create(&desc, NULL);
            assert_non_null(worlds[w]);
            OK(worlds[w], skein_body_add(worlds[w], "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 70, 70)), NULL));
            add_gravity(worlds[w]);
        }
        for (int w = 0; w < 2; w++)
            if (turn % 3) steps(worlds[w], 1, 0.01);
        if (turn % 3) {
            assert_true(skein_world_hash(worlds[0]) == skein_world_hash(worlds[1]));
            assert_true(!hash || hash == skein_world_hash(worlds[0]));
            hash = skein_world_hash(worlds[0]);
        }
        for (int w = 0; w < 2; w++) skein_world_destroy(worlds[w]);
    }
}

static void thread_counts_out_of_range_are_refused(void **state) {
    (void)state;
    static const int counts[] = {-1, 65};
    for (size_t i = 0; i < COUNT(counts); i++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.thread_count = counts[i];
        skein_error error = {0};
        assert_null(skein_world_create(&desc, &error));
        assert_int_equal(error.status, SKEIN_ERROR_VALUE);
        assert_string_equal(error.where, "thread_count");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_hash_does_not_depend_on_threads),
        cmocka_unit_test(no_method_depends_on_threads),
        cmocka_unit_test(worlds_with_threads_come_and_go),
        cmocka_unit_test(thread_counts_out_of_range_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
