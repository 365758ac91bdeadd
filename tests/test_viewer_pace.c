/* What the window makes of a slow machine: how finely it draws what moves, and which of both it calls slow. */
#include "helpers.h"

#include <string.h>

#include "viewer/pace.h"

/* What a picture takes where `fixed` ms go with none of its pixels. */
static double takes(int level, double whole, double fixed) {
    viewer_detail detail = viewer_detail_at(level);
    return fixed + (whole - fixed) * detail.scale * detail.scale * (detail.sampled ? 1 : 1 / 2.2);
}

/* Each level costs less than the one before; the first is the whole picture. */
static void levels_cost_ever_less(void **state) {
    (void)state;
    assert_true(viewer_detail_at(0).scale == 1 && viewer_detail_at(0).sampled);
    for (int level = 1; level < VIEWER_DETAILS; level++) assert_true(takes(level, 100, 0) < takes(level - 1, 100, 0));
    assert_true(viewer_detail_at(-1).scale == 1);
    assert_true(viewer_detail_at(99).scale == viewer_detail_at(VIEWER_DETAILS - 1).scale);
}

/* However slow the machine is: it comes to a level and stays, and that level is quick enough if any is. */
static void comes_to_rest_at_a_level_that_is_quick(void **state) {
    (void)state;
    for (double whole = 1; whole < 3000; whole *= 1.07) {
        for (double share = 0; share < 0.35; share += 0.05) {
            for (int start = 0; start < VIEWER_DETAILS; start++) {
                int level = start, changes = 0;
                for (int picture = 0; picture < 40; picture++) {
                    int next = viewer_detail_next(level, takes(level, whole, share * whole));
                    assert_in_range(next, 0, VIEWER_DETAILS - 1);
                    if (picture >= 20) changes += next != level;
                    level = next;
                }
                assert_int_equal(changes, 0);
                if (takes(VIEWER_DETAILS - 1, whole, share * whole) <= 50)
                    assert_true(takes(level, whole, share * whole) <= 50);
                else assert_int_equal(level, VIEWER_DETAILS - 1);
                // nor is it coarser than it has to be: no level has more than 2.25 times the pixels of the next
                if (level > 0) assert_true(2.25 * takes(level, whole, share * whole) > 37.9);
            }
        }
    }
}

static void a_quick_machine_draws_all(void **state) {
    (void)state;
    int level = VIEWER_DETAILS - 1;
    for (int picture = 0; picture < VIEWER_DETAILS; picture++) level = viewer_detail_next(level, 4);
    assert_int_equal(level, 0);
}

static void says_which_of_both_is_slow(void **state) {
    char text[300];
    (void)state;
    // a step takes 4 ms of 2.5 that there are
    viewer_pace steps = {.real = 1, .simulated = 0.6, .worked = 0.96, .drawn = 0.9, .steps = 240, .pictures = 20};
    assert_int_equal(viewer_pace_judge(&steps), VIEWER_SLOW_STEPS);
    viewer_slowness_text(VIEWER_SLOW_STEPS, &steps, text, sizeof text);
    assert_non_null(
        strstr(text, "the steps are slow: it goes at 60 % of real time; a step takes 4 ms and may take 2.5"));
    // few pictures, in time
    viewer_pace drawing = {.real = 2, .simulated = 2, .worked = 0.4, .drawn = 1.8, .steps = 800, .pictures = 10};
    assert_int_equal(viewer_pace_judge(&drawing), VIEWER_SLOW_DRAWING);
    viewer_slowness_text(VIEWER_SLOW_DRAWING, &drawing, text, sizeof text);
    assert_non_null(strstr(text, "the drawing is slow: 5 pictures a second, 180 ms each"));
    // behind, though the steps had work for a fifth of the time
    viewer_pace busy = {.real = 1, .simulated = 0.5, .worked = 0.1, .drawn = 0.9, .steps = 200, .pictures = 20};
    assert_int_equal(viewer_pace_judge(&busy), VIEWER_SLOW_ELSEWHERE);
    viewer_pace fine = {.real = 1, .simulated = 1, .worked = 0.3, .drawn = 0.5, .steps = 400, .pictures = 30};
    assert_int_equal(viewer_pace_judge(&fine), VIEWER_IN_TIME);
    drawing.pictures = 0; // none yet: no advice by numbers that are none
    viewer_slowness_text(VIEWER_SLOW_DRAWING, &drawing, text, sizeof text);
    assert_string_equal(text, "");

    viewer_slowness_text(VIEWER_IN_TIME, &fine, text, sizeof text);
    assert_string_equal(text, "");
    assert_string_equal(viewer_slowness_word(VIEWER_IN_TIME), "");
    assert_string_equal(viewer_slowness_word(VIEWER_SLOW_STEPS), "steps");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_cost_ever_less),
        cmocka_unit_test(comes_to_rest_at_a_level_that_is_quick),
        cmocka_unit_test(a_quick_machine_draws_all),
        cmocka_unit_test(says_which_of_both_is_slow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
