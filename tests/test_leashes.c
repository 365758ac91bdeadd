/* What motions hold that is free: pins that give way, a largest distance from the animated surface, and its backstop. */
#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

static const char *const methods[] = {"symplectic_euler", "leapfrog", "rk4", "xpbd", "pbd"};

/* A soft pin hangs m g/k below its place, whatever the stiffness, and follows where that goes. */
static void a_soft_pin_gives_way_by_its_load(void **state) {
    (void)state;
    static const double pulls[] = {20, 2000, 1e6};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (size_t k = 0; k < COUNT(pulls); k++) {
            skein_world *world = new_world(methods[m], 10);
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 8)), NULL));
            uint32_t p = add_particle(world, 0.5, 0.3, 0, 0), other = add_particle(world, 0.5, 2, 0, 0);
            OK(world, skein_motion_add(world, "translate", NULL,
                                       SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 0, 0), SKEIN_TEXT("pins", "0"),
                                                      SKEIN_REAL("pull", pulls[k])),
                                       NULL));
            steps(world, 360, dt);
            // in others some of the speed that a substep gives is there while drag acts: by rate x h/2 and so on
            bool once = strstr(methods[m], "pbd") || !strcmp(methods[m], "symplectic_euler");
            assert_near(position_of(world, p).y, -0.5 * 9.81 / pulls[k],
                        (once ? 1e-3 : 0.02) * 0.5 * 9.81 / pulls[k] + 2e-7);
            assert_true(position_of(world, other).y < -3); // it is not named
            skein_world_destroy(world);
        }
}

/* Pushed into a box, a pin that is held goes in, and a soft one stays at its surface. */
static void a_soft_pin_is_stopped_by_a_body(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = new_world(methods[m], 20);
        uint32_t held = add_particle(world, 0, 0, 0, 0.2), soft = add_particle(world, 0.1, 0, 0, -0.2);
        OK(world, skein_collider_add(world, "box",
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 1, 0, 0), SKEIN_VEC3("size", 1, 2, 2),
                                                    SKEIN_REAL("thickness", 0.01)),
                                     NULL));
        OK(world, skein_motion_add(world, "keys", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("keys", "0 0 0 0, 1 0.8 0 0"), SKEIN_TEXT("pins", "0 1"),
                                                  SKEIN_REAL("pull", 500)),
                                   NULL));
        steps(world, 120, dt);
        assert_near(position_of(world, held).x, 0.8, 1e-6);
        assert_near(position_of(world, soft).x, 0.49, 2e-3);
        skein_world_destroy(world);
    }
}

enum { SIDE = 6, ALL = SIDE * SIDE };

/* A level cloth, free but for two corners, in a motion that leads it along x. */
static skein_world *led_cloth(const char *method, const skein_setting *more, double down) {
    skein_world *world = new_world(method, 20);
    OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 0, -down, 0)), NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "cloth"), SKEIN_PAIR("grid", SIDE, SIDE),
                                            SKEIN_PAIR("size", 1, 1), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("density", 4), SKEIN_REAL("stretch.stiffness", 20),
                                            SKEIN_REAL("shear.stiffness", 0), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 0)),
                             NULL));
    OK(world, skein_motion_add(world, "translate", NULL, more, NULL));
    return world;
}

static void nobody_is_farther_than_said(void **state) {
    (void)state;
    char map[ALL * 8] = "";
    for (int i = 0; i < ALL; i++) strcat(map, i % 3 == 0 ? " 0" : i % 3 == 1 ? " 0.5" : " 1");
    for (size_t m = 0; m < COUNT(methods); m++)
        for (int mapped = 0; mapped < 2; mapped++) {
            skein_world *world =
                led_cloth(methods[m],
                          SKEIN_SETTINGS(SKEIN_VEC3("velocity", 3, 0, 0), SKEIN_REAL("max_distance", 0.15),
                                         SKEIN_TEXT("map", mapped ? map : "")),
                          9.81);
            double farthest = 0;
            vec3 start[ALL];
            for (size_t p = 0; p < ALL; p++) start[p] = position_of(world, p);
            for (int n = 1; n <= 60; n++) {
                steps(world, 1, dt);
                for (size_t p = 0; p < ALL; p++) {
                    vec3 off = minus(position_of(world, p), start[p]);
                    off.x -= 3 * n * dt;
                    double most = mapped ? (double)(p % 3) * 0.5 * 0.15 : 0.15;
                    assert_true(length3(off) <= most + 2e-5);
                    farthest = fmax(farthest, length3(off));
                }
            }
            assert_near(farthest, 0.15, 1e-3);
            skein_world_destroy(world);
        }
}

/* Pulled one way the cloth is stopped by the ball behind it, at its backstop; pulled the other way by its largest distance. */
static void behind_the_surface_is_a_backstop(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(methods); m++) {
        double lowest[2], highest[2];
        for (int up = 0; up < 2; up++) {
            skein_world *world =
                led_cloth(methods[m],
                          SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 1, 0), SKEIN_REAL("max_distance", 0.3),
                                         SKEIN_REAL("backstop", 0.05), SKEIN_REAL("backstop_radius", 20)),
                          up ? -9.81 : 9.81);
            steps(world, 60, dt);
            lowest[up] = 1, highest[up] = -1;
            for (size_t p = 0; p < ALL; p++) {
                lowest[up] = fmin(lowest[up], position_of(world, p).y - 1);
                highest[up] = fmax(highest[up], position_of(world, p).y - 1);
            }
            skein_world_destroy(world);
        }
        bool normal_up = -lowest[0] < highest[1]; // of the cloth
        double behind = normal_up ? -lowest[0] : highest[1], before = normal_up ? highest[1] : -lowest[0];
        assert_near(behind, 0.05, 2e-3);
        assert_near(before, 0.3, 0.01);
    }
}

/* Carried along with a frame, they stay as they are. */
static void they_are_carried_with_their_frame(void **state) {
    (void)state;
    skein_world *still =
        led_cloth("xpbd", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 0, 0), SKEIN_REAL("max_distance", 0.1)), 9.81);
    skein_world *moved = led_cloth(
        "xpbd",
        SKEIN_SETTINGS(SKEIN_VEC3("velocity", 2, 1, 0), SKEIN_REAL("max_distance", 0.1), SKEIN_REAL("inertia", 0)),
        9.81);
    for (int n = 1; n <= 40; n++) {
        steps(still, 1, dt), steps(moved, 1, dt);
        for (size_t p = 0; p < ALL; p++) {
            vec3 off = minus(position_of(moved, p), position_of(still, p));
            assert_near(off.x, 2 * n * dt, 1e-2); // (rounding of positions over the substep; in double 1e-9)
            assert_near(off.y, n * dt, 1e-2);
        }
    }
    skein_world_destroy(still), skein_world_destroy(moved);
}

static void a_map_has_as_many_numbers_as_particles(void **state) {
    (void)state;
    skein_world *world =
        led_cloth("xpbd", SKEIN_SETTINGS(SKEIN_REAL("max_distance", 0.1), SKEIN_TEXT("map", "1 1 0.5")), 9.81);
    skein_handle motion = skein_object_at(world, SKEIN_MOTION, 0);
    FAILS(world, SKEIN_ERROR_VALUE, "3 numbers, and it leads 36 particles", skein_world_step(world, dt));
    FAILS(world, SKEIN_ERROR_VALUE, "number 2, 'x': expected numbers",
          skein_set(world, motion, "map", skein_text("1 x, 2")));
    OK(world, skein_set(world, motion, "map", skein_text("")));
    steps(world, 1, dt);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_soft_pin_gives_way_by_its_load),  cmocka_unit_test(a_soft_pin_is_stopped_by_a_body),
        cmocka_unit_test(nobody_is_farther_than_said),       cmocka_unit_test(behind_the_surface_is_a_backstop),
        cmocka_unit_test(they_are_carried_with_their_frame), cmocka_unit_test(a_map_has_as_many_numbers_as_particles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
