/* Contact between surfaces where memory is wanting: whichever allocation fails, the step says so, nothing leaks, and what goes on
 * afterwards is sound. What falls lands on pins, goes on folding on ground, and begins partly in itself, so that every list is in use. */
#include "purse.h"

enum { FRAMES = 12 };

static bool add_sheet(skein_world *world, int side, const char *pins, const double at[3], const double turned[3],
                      double down) {
    return !skein_body_add(world, "cloth", NULL,
                           SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_PAIR("size", 0.4, 0.4),
                                          SKEIN_TEXT("pins", pins), SKEIN_VEC3("position", at[0], at[1], at[2]),
                                          SKEIN_VEC3("rotation", turned[0], turned[1], turned[2]),
                                          SKEIN_VEC3("velocity", 0, -down, 0)),
                           NULL);
}

/* Returns how many steps failed. A world that could not be set up is none. */
static int play(purse *p, uint64_t *hash) {
    skein_world_desc desc = purse_world(p);
    skein_world *world = skein_world_create(&desc, NULL);
    int failed = -1;
    if (world && !skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 3))) &&
        !skein_force_add(world, "gravity", NULL, NULL) &&
        !skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01)), NULL) &&
        !skein_collider_add(world, "plane", NULL, NULL) &&
        add_sheet(world, 9, "top edge", (double[]){0, 0.4, 0}, (double[]){90, 0, 0}, 0) &&
        add_sheet(world, 14, "", (double[]){0, 0.7, 0}, (double[]){2, 20, 0}, 8) &&
        add_sheet(world, 5, "", (double[]){0.5, 0.05, 0}, (double[]){20, 0, 5}, 0) &&
        add_sheet(world, 5, "", (double[]){0.6, 0.06, 0.1}, (double[]){-15, 40, 0}, 0)) {
        failed = 0;
        for (int f = 0; f < FRAMES; f++) {
            const skein_status status = skein_world_step(world, 1.0 / 60);
            if (!status) continue;
            assert_int_equal(status, SKEIN_ERROR_MEMORY);
            assert_true(skein_world_error(world)->message[0]);
            failed++;
        }
        skein_statistics s;
        if (!p->forever) {
            const skein_status status = skein_world_statistics(world, &s);
            failed += status != 0;
            if (status) assert_int_equal(status, SKEIN_ERROR_MEMORY);
            if (status) OK(world, skein_world_statistics(world, &s));
            assert_int_equal(s.nonfinite, 0);
            *hash = s.state_hash;
        }
    }
    skein_world_destroy(world);
    assert_int_equal(p->blocks, 0);
    assert_int_equal(p->in_use, 0);
    return failed;
}

enum { STRIDE = SPARING ? 29 : 7 };

static void what_fails_is_said_and_the_world_goes_on(void **state) {
    (void)state;
    uint64_t hash = 0, again = 0;
    purse p = {.fail_at = SIZE_MAX};
    assert_int_equal(play(&p, &hash), 0);
    const size_t calls = p.calls;
    size_t told = 0;
    for (size_t n = 0; n < calls; n += STRIDE) {
        p = (purse){.fail_at = n};
        const int failed = play(&p, &again);
        assert_true(failed <= 1);
        told += failed == 1;
        // an allocation that failed was that of a step, or the world could not be set up, or somebody did without
        if (failed == 0) assert_true(again == hash);
    }
    assert_true(told > calls / STRIDE / 8);
}

static void memory_may_end_at_any_point(void **state) {
    (void)state;
    uint64_t hash;
    purse all = {.fail_at = SIZE_MAX};
    play(&all, &hash);
    for (size_t n = 0; n < all.calls; n += 3 * STRIDE) {
        purse p = {.fail_at = n, .forever = true};
        play(&p, &hash);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_fails_is_said_and_the_world_goes_on),
        cmocka_unit_test(memory_may_end_at_any_point),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
