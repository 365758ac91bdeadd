/* Ten sheets of 50 x 50 fall on a ball, one upon the other: no edge goes through a face in any frame, by the library's count
 * in every one and by ours in every fifth. */
#include "crossings.h"

enum { LAYERS = 10, SIDE = 50, FRAMES = 40 };

static void ten_layers_stay_apart(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
    OK(world, skein_force_add(world, "contact",
                              SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.006), SKEIN_REAL("friction", 0.3)), NULL));
    OK(world, skein_collider_add(world, "plane",
                                 SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.004), SKEIN_REAL("friction", 0.5)), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.3, 0), SKEIN_REAL("radius", 0.25),
                                                SKEIN_REAL("thickness", 0.006), SKEIN_REAL("friction", 0.4)),
                                 NULL));
    for (int i = 0; i < LAYERS; i++)
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_PAIR("size", 1, 1),
                                                SKEIN_VEC3("position", 0.013 * i, 0.6 + 0.03 * i, -0.007 * i),
                                                SKEIN_VEC3("rotation", 0, 9.0 * i, 0)),
                                 NULL));
    crossing_search all = crossing_begin(world);
    for (int f = 1; f <= FRAMES; f++) {
        steps(world, 1, 1.0 / 60);
        size_t theirs = statistics_of(world).crossings, ours = f % 5 ? 0 : crossings_now(&all, world);
        if (ours || theirs) fail_msg("frame %d: %zu crossings by our count, %zu by the library's", f, ours, theirs);
    }
    // all of them are held up by the ball
    for (size_t i = 0; i < LAYERS; i++) {
        double mean = 0;
        for (size_t k = 0; k < SIDE * SIDE; k++) mean += position_of(world, i * SIDE * SIDE + k).y / (SIDE * SIDE);
        assert_true(mean > 0.25);
    }
    crossing_free(&all);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ten_layers_stay_apart)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
