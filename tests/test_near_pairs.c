/* What contact takes for near is all that is near, in every substep: courses, reaches, trees, boxes, cells, calm patches and
 * panels leave nothing out. Held against all pairs of features that there are, one after the other, where vertices were when the last
 * substep began. (What is done to a pair that is near moves it, so it is counts that are compared: lists have been used.) */
#include "irregular.h"
#include "near_pairs.h"

enum { STEPS = SPARING ? 8 : 40, SIDE = 14 };

static bool without_panels; /* so that nothing is spread (contact/spread.h), and patches are all that leaves anything out */

/* How many pairs were near, and how many patches calm, over a run of steps. */
typedef struct tally {
    size_t near, calm, not_calm;
} tally;

static tally run_by(skein_world *world, int count, double dt) {
    tally all = {0, 0, 0};
    (void)statistics_of(world); // makes ready what contact keeps
    touch_of(world)->spread.never = without_panels;
    touch_of(world)->spread.eager = true;
    for (int i = 0; i < count; i++) {
        steps(world, 1, dt);
        sk_touch *touch = touch_of(world);
        assert_non_null(touch);
        if (!touch->loaded) continue;
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
            size_t near = count_near(touch, sort);
            assert_int_equal(touch->near[sort].count, near);
            all.near += near;
        }
        for (size_t p = 0; p < touch->calm.patch_count; p++)
            all.calm += touch->calm.patch[p].calm, all.not_calm += !touch->calm.patch[p].calm;
    }
    assert_int_equal(statistics_of(world).crossings, 0);
    skein_world_destroy(world);
    return all;
}

static tally run(skein_world *world, int count) {
    return run_by(world, count, 1.0 / 60);
}

/* Some patches were calm, and so many were not; where there are patches (calm_absent.c). */
static void assert_patches(const tally *all, size_t not_calm) {
    if (!without_panels || (!all->calm && !all->not_calm)) return;
    assert_true(all->calm > 100);
    assert_true(all->not_calm >= not_calm);
}

static skein_world *world_with(const char *method, int substeps, double thickness) {
    skein_world *world = new_world(method, substeps);
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5)), NULL));
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
    return world;
}

static void add_sheet(skein_world *world, double height, double tilt, const char *pins) {
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_TEXT("pins", pins),
                                            SKEIN_REAL("bend.stiffness", 0), SKEIN_VEC3("position", 0, height, 0),
                                            SKEIN_VEC3("rotation", 90 - tilt, 10, 0)),
                             NULL));
}

static void of_a_heap(void **state) {
    (void)state;
    for (int tilt = 3; tilt <= 19; tilt += 8) {
        skein_world *world = world_with("xpbd", 6, 0.03);
        add_sheet(world, 0.53, tilt, "");
        tally all = run(world, STEPS);
        assert_true(SPARING || all.near > 100);
        assert_patches(&all, SPARING ? 0 : 100);
    }
}

/* Where somebody is pinned, the frame of courses stands, while all others may fall or be carried together. What is looked at is
 * the second of two substeps: vertices that were held back in the first have no course. */
static void of_a_heap_that_is_held(void **state) {
    (void)state;
    for (int tilt = 3; tilt <= 27; tilt += 8) {
        skein_world *world = world_with("xpbd", 2, 0.03);
        add_sheet(world, 0.53, tilt, "");
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("pins", "top edge"),
                                                SKEIN_VEC3("position", 3, 3, 0)),
                                 NULL));
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 30, 0, 12)), NULL));
        tally all = run_by(world, 4 * STEPS, 1.0 / 200);
        assert_true(SPARING || all.near > 100);
    }
}

/* It swings through, and its corners come together. */
static void of_a_sheet_that_swings(void **state) {
    (void)state;
    skein_world *world = world_with("xpbd", 4, 0.03);
    add_sheet(world, 2, 80, "top corners");
    tally all = run(world, STEPS);
    assert_patches(&all, 0);
}

static void of_an_irregular_mesh(void **state) {
    (void)state;
    skein_world *world = world_with("xpbd", 5, 0.02);
    add_irregular(world, SIDE, SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_VEC3("rotation", 84, 10, 0)));
    tally all = run(world, STEPS);
    assert_true(SPARING || all.near > 100);
    assert_patches(&all, 0);
}

/* Two sheets, one of them flung at the other, under a method that adds forces up. */
static void of_two_that_meet_fast(void **state) {
    (void)state;
    skein_world *world = world_with("symplectic_euler", 40, 0.02);
    for (int l = 0; l < 2; l++)
        OK(world,
           skein_body_add(world, "cloth", NULL,
                          SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_VEC3("position", 0, 0.4 + 0.2 * l, 0),
                                         SKEIN_VEC3("rotation", 5 * l, 20 * l, 0), SKEIN_VEC3("velocity", l, -6 * l, 0),
                                         SKEIN_REAL("stretch.stiffness", 500)),
                          NULL));
    tally all = run(world, STEPS / 2);
    assert_true(SPARING || all.near > 100);
}

/* What a program changes between steps is seen. */
static void of_what_is_moved_by_hand(void **state) {
    (void)state;
    skein_world *world = world_with("xpbd", 5, 0.03);
    add_sheet(world, 0.53, 12, "");
    steps(world, STEPS / 2, 1.0 / 60);
    double x[3 * SIDE * SIDE];
    OK(world, skein_positions_copy(world, 0, SIDE * SIDE, x));
    for (size_t i = 0; i < SIDE * SIDE; i++) { // elsewhere, turned about a quarter, and narrower
        double y = x[3 * i + 1];
        x[3 * i + 1] = 0.3 - x[3 * i], x[3 * i] = 1 + y, x[3 * i + 2] *= 0.9;
    }
    OK(world, skein_positions_set(world, 0, SIDE * SIDE, x));
    tally all = run(world, 6);
    assert_true(all.near > 0);
}

/* A sheet that flies edge on at another one, by nearly the width of a cell in a substep: of those that stop, some stop at once, and who
 * comes behind them all but reaches them. Whether patches are calm and panels spread changes no bit. */
static uint64_t hash_of_who_is_stopped(double speed, double tilt, bool all_are_looked_for) {
    skein_world *world = new_world("xpbd", 10);
    OK(world, skein_force_add(world, "contact",
                              SKEIN_SETTINGS(SKEIN_REAL("thickness", 5e-4), SKEIN_REAL("more_substeps", 1)), NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 12, 12), SKEIN_PAIR("size", 0.5, 0.5),
                                            SKEIN_TEXT("pins", "border")),
                             NULL));
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", 20, 20), SKEIN_PAIR("size", 0.152, 0.152),
                                     SKEIN_VEC3("position", 0.003, 0.12, 0.007),
                                     SKEIN_VEC3("rotation", 90 - tilt, 20, 0), SKEIN_VEC3("velocity", 0, -speed, 0)),
                      NULL));
    (void)statistics_of(world);
    touch_of(world)->calm.never = all_are_looked_for;
    touch_of(world)->spread.never = all_are_looked_for || without_panels;
    steps(world, 8, 1.0 / 60);
    const uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void of_who_is_stopped(void **state) {
    (void)state;
    const double speeds[] = {4.2, 4.5, 4.6};
    for (size_t i = 0; i < COUNT(speeds); i++)
        for (int tilt = 0; tilt < 3; tilt++)
            assert_true(hash_of_who_is_stopped(speeds[i], tilt, true) == hash_of_who_is_stopped(speeds[i], tilt, false));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_a_heap),
                                       cmocka_unit_test(of_a_heap_that_is_held),
                                       cmocka_unit_test(of_a_sheet_that_swings),
                                       cmocka_unit_test(of_an_irregular_mesh),
                                       cmocka_unit_test(of_two_that_meet_fast),
                                       cmocka_unit_test(of_what_is_moved_by_hand),
                                       cmocka_unit_test(of_who_is_stopped)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    without_panels = true;
    return failed + cmocka_run_group_tests(tests, NULL, NULL);
}
