/* On a graphics card, as on the processor: pins that are led, and colliders that travel. */
#include "gpu.h"

static skein_world *field_of(const char *method) {
    skein_world *world = new_world(method, 8);
    scatter(world, 400, 2, 5);
    add_gravity(world);
    return world;
}

/* What is held goes where it is told, exactly; all else is where the processor has it. */
static void pins_go_where_they_are_told(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        for (int inertia = 1; inertia >= !!strcmp(explicit_methods[m], "pbd"); inertia--) {
            skein_world *world[2];
            for (int w = 0; w < 2; w++) {
                world[w] = field_of(explicit_methods[m]);
                if (!inertia) OK(world[w], skein_set_path(world[w], "method.inertia", skein_number(0)));
            }
            to_card(world[1]);
            for (int step = 1; step <= 5; step++)
                for (int w = 0; w < 2; w++) {
                    const double places[] = {0.1 * step, 1, 2, 3, 0.2 * step, 4};
                    OK(world[w], skein_pins_move(world[w], (uint32_t[]){5, 22}, 2, places));
                    steps(world[w], 1, dt);
                    assert_true(position_of(world[w], 22).y == (double)(skein_real)(0.2 * step));
                    assert_true(velocity_of(world[w], 22).y == 0);
                }
            double off = difference(world[0], world[1]);
            assert_true(off <= 2e-5 * FLOAT_OFF);
            for (int w = 0; w < 2; w++) skein_world_destroy(world[w]);
        }
}

/* A ball and a box are moved by where they are set, and throw what is in their way. */
static void colliders_travel(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++) {
        skein_world *world[2];
        skein_handle ball[2], box[2];
        for (int w = 0; w < 2; w++) {
            world[w] = field_of(explicit_methods[m]);
            OK(world[w],
               skein_collider_add(world[w], "sphere",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3), SKEIN_VEC3("centre", -3, 0, 0)), &ball[w]));
            OK(world[w], skein_collider_add(world[w], "box",
                                            SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, -2, 0), SKEIN_VEC3("size", 4, 1, 4)),
                                            &box[w]));
        }
        to_card(world[1]);
        double slow = difference(world[0], world[1]);
        assert_true(slow == 0);
        for (int step = 1; step <= 12; step++)
            for (int w = 0; w < 2; w++) {
                if (step > 3)
                    OK(world[w], skein_set(world[w], ball[w], "centre", skein_vector(-3 + 0.4 * (step - 3), 0, 0)));
                if (step > 6) OK(world[w], skein_set(world[w], box[w], "rotation", skein_vector(0, 3 * step, 0)));
                steps(world[w], 1, dt);
            }
        double off = difference(world[0], world[1]);
        if (!(off <= 2e-3)) fprintf(stderr, "%s is off by %g\n", explicit_methods[m], off);
        assert_true(off <= 2e-3);                                   // an impact makes much of a rounding
        assert_true(statistics_of(world[0]).kinetic_energy > 1000); // some are 24 m/s fast
        for (int w = 0; w < 2; w++) skein_world_destroy(world[w]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pins_go_where_they_are_told),
        cmocka_unit_test(colliders_travel),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
