/* Motions as moving frames: what lives in one and feels all of it, none or a share; jumps; colliders that go with it. */
#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;
enum { ROWS = 7, COLUMNS = 8, CLOTH = ROWS * COLUMNS };

/* A cloth held by its top edge that swings, beside a ball that it meets: there, what is a millionth of a metre off at first is
 * centimetres off in a second, since cloth that is pushed buckles one way or the other. */
static skein_world *cloth_beside_ball(const char *method) {
    skein_world *world = new_world(method, 20);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "ball"), SKEIN_REAL("radius", 0.12),
                                                SKEIN_VEC3("centre", 0.05, -0.3, 0.1)),
                                 NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "cape"), SKEIN_PAIR("grid", ROWS, COLUMNS),
                                            SKEIN_PAIR("size", 0.5, 0.4), SKEIN_VEC3("rotation", 60, 0, 0),
                                            SKEIN_TEXT("pins", "top edge"), SKEIN_REAL("density", 4),
                                            SKEIN_REAL("stretch.stiffness", 60), SKEIN_REAL("stretch.damping", 0.05),
                                            SKEIN_REAL("shear.stiffness", 20), SKEIN_REAL("shear.damping", 0.02),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 4),
                                            SKEIN_REAL("bend.damping", 0.01)),
                             NULL));
    return world;
}

/* A chain of four that swings from a pin, in the air: it knows no chaos in a second. */
static skein_world *chain_beside_ball(const char *method) {
    skein_world *world = new_world(method, strstr(method, "pbd") ? 10 : 40);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
    OK(world, skein_collider_add(world, "capsule",
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "ball"), SKEIN_REAL("radius", 0.1),
                                                SKEIN_VEC3("from", 2, 0, 0), SKEIN_VEC3("to", 2, 1, 1)),
                                 NULL));
    for (int i = 0; i < 5; i++) add_particle(world, i ? 0.2 : 0, 0.04 * i, -0.12 * i, 0.02 * i * i);
    for (uint32_t i = 0; i < 4; i++) add_spring(world, i, i + 1, 400, 2);
    return world;
}

static void turn_about_y(double angle, double m[9]) {
    const double t[9] = {cos(angle), 0, sin(angle), 0, 1, 0, -sin(angle), 0, cos(angle)};
    memcpy(m, t, sizeof t);
}

static vec3 turned(const double m[9], vec3 p) {
    return (vec3){m[0] * p.x + m[1] * p.y + m[2] * p.z, m[3] * p.x + m[4] * p.y + m[5] * p.z,
                  m[6] * p.x + m[7] * p.y + m[8] * p.z};
}

/* The largest difference from what it would be where nothing moves, taken along. */
static double difference(const skein_world *moved, const skein_world *still, const double turn[9], vec3 shift,
                         double *of_velocities) {
    double most = 0;
    *of_velocities = 0;
    for (size_t p = 0; p < skein_particle_count(moved); p++) {
        vec3 ought = turned(turn, position_of(still, p));
        most = fmax(most, length3(minus(minus(position_of(moved, p), ought), shift)));
        *of_velocities =
            fmax(*of_velocities, length3(minus(velocity_of(moved, p), turned(turn, velocity_of(still, p)))));
    }
    return most;
}

/* Without inertia a chain and a collider go along as if nothing moved: round and round, and away. Rounding is all that differs,
 * and grows a little with what swings. */
static void without_inertia_it_is_carried(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *still = chain_beside_ball(all_methods[m]), *moved = chain_beside_ball(all_methods[m]);
        OK(moved, skein_motion_add(moved, "turn", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("colliders", "ball"), SKEIN_VEC3("centre", 0.3, 0, 0.1),
                                                  SKEIN_VEC3("axis", 0, 2, 0), SKEIN_REAL("speed", 7),
                                                  SKEIN_REAL("inertia", 0)),
                                   NULL));
        OK(moved, skein_motion_add(moved, "translate", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("colliders", "ball"), SKEIN_VEC3("velocity", 3, 0.5, -1),
                                                  SKEIN_REAL("inertia", 0)),
                                   NULL));
        for (int n = 1; n <= 60; n++) {
            steps(still, 1, dt), steps(moved, 1, dt);
            double turn[9], fast;
            turn_about_y(7 * n * dt, turn);
            vec3 c = {0.3, 0, 0.1}, back = turned(turn, c), t = {3 * n * dt, 0.5 * n * dt, -n * dt};
            vec3 shift = {c.x - back.x + t.x, c.y - back.y + t.y, c.z - back.z + t.z};
            // position methods learn velocities from positions, whose rounding is that of 3 m
            double least = strstr(all_methods[m], "pbd") ? 20 : 1;
            assert_under(difference(moved, still, turn, shift, &fast), 200 * least * EPSILON);
            assert_under(fast, 3e3 * least * EPSILON);
            skein_pose ball;
            OK(moved, skein_collider_pose(moved, skein_object_at(moved, SKEIN_COLLIDER, 0), &ball));
            vec3 at = turned(turn, (vec3){2, 0.5, 0.5});
            assert_near(ball.position[0], at.x + shift.x, 500 * EPSILON);
            assert_near(ball.position[2], at.z + shift.z, 500 * EPSILON);
            assert_near(ball.rotation[2], turn[2], 500 * EPSILON);
        }
        skein_world_destroy(still), skein_world_destroy(moved);
    }
}

/* All of its inertia is what a motion that is no frame leaves, to the bit. */
static void with_all_inertia_nothing_is_done(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        double x[2][3 * CLOTH];
        for (int framed = 0; framed < 2; framed++) {
            skein_world *world = cloth_beside_ball(method_names[m]);
            skein_handle motion;
            OK(world, skein_motion_add(world, "turn", NULL,
                                       SKEIN_SETTINGS(SKEIN_TEXT("on", "cape"), SKEIN_REAL("speed", 3)), &motion));
            if (framed) OK(world, skein_set(world, motion, "jump", skein_number(10)));
            steps(world, 40, dt);
            OK(world, skein_positions_copy(world, 0, CLOTH, x[framed]));
            skein_world_destroy(world);
        }
        assert_memory_equal(x[0], x[1], sizeof x[0]);
    }
}

/* What is free and at rest in a frame that turns, or goes, stays behind by the share that it feels. */
static void a_share_is_left_behind(void **state) {
    (void)state;
    static const double shares[] = {0, 0.25, 0.5, 0.9, 1};
    for (size_t s = 0; s < COUNT(shares); s++) {
        skein_world *world = new_world("xpbd", 3);
        add_particle(world, 1, 1, 0, 0);
        add_particle(world, 0, 1, 0, 0);
        OK(world, skein_motion_add(world, "turn", NULL,
                                   SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0, 0), SKEIN_REAL("speed", 2),
                                                  SKEIN_REAL("inertia", shares[s])),
                                   NULL));
        for (int n = 1; n <= 90; n++) {
            steps(world, 1, dt);
            double angle = (1 - shares[s]) * 2 * n * dt;
            vec3 p = position_of(world, 0), pin = position_of(world, 1);
            assert_near(p.x, cos(angle), 1e3 * EPSILON);
            assert_near(p.z, -sin(angle), 1e3 * EPSILON);
            assert_near(pin.x, cos(2 * n * dt), 100 * EPSILON);
            assert_under(length3(velocity_of(world, 0)), 1e3 * EPSILON);
        }
        skein_world_destroy(world);
    }
}

/* A pendulum whose pin gets faster by a (m/s2), straight on, hangs askew by atan(s a/g), and stays so. */
static void a_pendulum_hangs_by_its_share(void **state) {
    (void)state;
    enum { STEPS = 75 };
    static const double shares[] = {0, 0.3, 1};
    double(*places)[3] = calloc(STEPS + 2, sizeof *places), a = 4;
    for (int n = 0; n < STEPS + 2; n++) places[n][0] = 0.5 * a * n * n * dt * dt;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t s = 0; s < COUNT(shares); s++) {
            skein_world *world = new_world(method_names[m], 20);
            add_gravity(world);
            double askew = atan(shares[s] * a / 9.81);
            uint32_t pin = add_particle(world, 0, 0, 0, 0), bob = add_particle(world, 1, -sin(askew), -cos(askew), 0);
            add_spring(world, pin, bob, 3e3, 30);
            const skein_track track = {&pin, places[0], 1, STEPS + 2, dt};
            OK(world, skein_motion_add(world, "cache", &track,
                                       SKEIN_SETTINGS(SKEIN_REAL("inertia", shares[s]), SKEIN_REAL("fps", 60)), NULL));
            for (int n = 0; n < STEPS; n++) {
                steps(world, 1, dt);
                vec3 p = minus(position_of(world, bob), position_of(world, pin));
                assert_near(atan2(-p.x, -p.y), askew, 0.015);
            }
            skein_world_destroy(world);
        }
    free(places);
}

typedef enum jump_sort { BY_WAY, BY_TURN, BY_TIME, BY_PROGRAM, JUMPS } jump_sort;

/* A frame that stands, is elsewhere from one step to the next, and stands there: by any of the ways to say so what hangs in it
 * swings on as if nothing had been, though it feels all of the inertia else. */
static void a_jump_flings_nobody(void **state) {
    (void)state;
    static const char *const keys = "0 0 0 0, 0.5 0 0 0, 0.5001 12 3 -5 0 140 0, 9 12 3 -5 0 140 0";
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int sort = 0; sort < JUMPS; sort++) {
            skein_world *still = cloth_beside_ball(method_names[m]), *moved = cloth_beside_ball(method_names[m]);
            skein_handle motion, body = skein_object_at(moved, SKEIN_BODY, 0),
                                 ball = skein_object_at(moved, SKEIN_COLLIDER, 0);
            double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, there[9], fast;
            turn_about_y(140 * PI / 180, there);
            if (sort != BY_PROGRAM) {
                OK(moved, skein_motion_add(moved, "keys", NULL,
                                           SKEIN_SETTINGS(SKEIN_TEXT("keys", keys), SKEIN_TEXT("colliders", "ball")),
                                           &motion));
                if (sort == BY_WAY) OK(moved, skein_set(moved, motion, "jump", skein_number(2)));
                if (sort == BY_TURN) OK(moved, skein_set(moved, motion, "jump_turn", skein_number(45)));
                if (sort == BY_TIME) OK(moved, skein_set(moved, motion, "jump_times", skein_text("0.1, 0.5001")));
            }
            double shift[3] = {0, 0, 0};
            for (int n = 1; n <= 60; n++) {
                if (n == 31) {
                    memcpy(turn, there, sizeof turn);
                    memcpy(shift, (const double[]){12, 3, -5}, sizeof shift);
                    if (sort == BY_PROGRAM) {
                        vec3 c = turned(there, (vec3){0.05, -0.3, 0.1});
                        OK(moved, skein_body_teleport(moved, body, there, shift));
                        OK(moved, skein_set(moved, ball, "centre", skein_vector(c.x + 12, c.y + 3, c.z - 5)));
                        OK(moved, skein_collider_teleport(moved, ball));
                    }
                }
                steps(still, 1, dt), steps(moved, 1, dt);
                assert_under(difference(moved, still, turn, (vec3){shift[0], shift[1], shift[2]}, &fast), 0.06);
                assert_under(fast, 1);
            }
            skein_world_destroy(still), skein_world_destroy(moved);
        }
}

/* A collider that a motion leads moves as one does by its own fields, and is felt. */
static void a_collider_goes_with_a_motion(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        skein_handle box;
        OK(world, skein_collider_add(world, "box",
                                     SKEIN_SETTINGS(SKEIN_TEXT("name", "lift"), SKEIN_VEC3("centre", 1, -0.5, 0),
                                                    SKEIN_VEC3("size", 2, 1, 2), SKEIN_REAL("thickness", 0),
                                                    SKEIN_REAL("friction", 10)),
                                     &box));
        OK(world,
           skein_motion_add(world, "translate", NULL,
                            SKEIN_SETTINGS(SKEIN_TEXT("colliders", "lift"), SKEIN_VEC3("velocity", 1, 2, 0)), NULL));
        OK(world, skein_motion_add(world, "turn", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("name", "off"), SKEIN_REAL("enabled", 0),
                                                  SKEIN_TEXT("colliders", "lift")),
                                   NULL));
        uint32_t p = add_particle(world, 1, 1, 0.0005, 0);
        steps(world, 60, dt);
        skein_pose pose;
        OK(world, skein_collider_pose(world, box, &pose));
        assert_near(pose.position[0], 2, 1e-5);
        assert_near(pose.position[1], 1.5, 1e-5);
        assert_near(position_of(world, p).y, 2, 1e-3);
        assert_near(velocity_of(world, p).y, 2, 1e-3);
        assert_near(velocity_of(world, p).x, 1, 1e-3);
        // time that is set, and a reset, put it where the motion does
        OK(world, skein_world_time_set(world, 3));
        OK(world, skein_collider_pose(world, box, &pose));
        assert_near(pose.position[0], 4, 1e-5);
        OK(world, skein_world_reset(world));
        OK(world, skein_collider_pose(world, box, &pose));
        assert_near(pose.position[0], 1, 1e-6);
        skein_world_destroy(world);
    }
}

/* Between two steps pictures show what has gone on from where it was, though it was carried first; after a jump it is there. */
static void pictures_go_on(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 5);
    add_particle(world, 1, 1, 0, 0);
    skein_handle motion;
    OK(world, skein_motion_add(world, "translate", NULL,
                               SKEIN_SETTINGS(SKEIN_VEC3("velocity", 6, 0, 0), SKEIN_REAL("inertia", 0.5)), &motion));
    steps(world, 3, dt);
    vec3 before = position_of(world, 0), shown;
    steps(world, 1, dt);
    OK(world, skein_positions_blend(world, 0, 0, 1, &shown.x));
    assert_near(shown.x, before.x, 4 * EPSILON);
    assert_near(position_of(world, 0).x, 1 + 4 * 3 * dt, 20 * EPSILON);
    OK(world, skein_set(world, motion, "jump", skein_number(0.05)));
    before = position_of(world, 0);
    steps(world, 1, dt);
    OK(world, skein_positions_blend(world, 0, 0, 1, &shown.x));
    assert_near(shown.x, before.x + 6 * dt, 20 * EPSILON);
    skein_world_destroy(world);
}

/* A state that was saved in the midst of it goes on to the same bits. */
static void a_saved_state_goes_on(void **state) {
    (void)state;
    skein_world *world[2];
    double x[2][3 * CLOTH];
    for (int i = 0; i < 2; i++) {
        world[i] = cloth_beside_ball("xpbd");
        OK(world[i], skein_motion_add(world[i], "turn", NULL,
                                      SKEIN_SETTINGS(SKEIN_TEXT("on", "cape"), SKEIN_TEXT("colliders", "ball"),
                                                     SKEIN_REAL("speed", 7), SKEIN_REAL("inertia", 0.4)),
                                      NULL));
    }
    steps(world[0], 20, dt);
    size_t size = skein_snapshot_size(world[0]);
    void *bytes = malloc(size);
    OK(world[0], skein_snapshot_write(world[0], bytes, size, NULL));
    OK(world[1], skein_snapshot_read(world[1], bytes, size));
    skein_pose pose[2];
    for (int i = 0; i < 2; i++)
        OK(world[i], skein_collider_pose(world[i], skein_object_at(world[i], SKEIN_COLLIDER, 0), &pose[i]));
    assert_memory_equal(&pose[0], &pose[1], sizeof pose[0]);
    for (int i = 0; i < 2; i++) {
        steps(world[i], 20, dt);
        OK(world[i], skein_positions_copy(world[i], 0, CLOTH, x[i]));
        skein_world_destroy(world[i]);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    free(bytes);
}

static void what_is_wrong_is_said(void **state) {
    (void)state;
    skein_world *world = cloth_beside_ball("xpbd");
    skein_handle motion, body = skein_object_at(world, SKEIN_BODY, 0);
    FAILS(world, SKEIN_ERROR_VALUE, "jump_times",
          skein_motion_add(world, "turn", NULL, SKEIN_SETTINGS(SKEIN_TEXT("jump_times", "1 soon")), NULL));
    OK(world, skein_motion_add(world, "turn", NULL,
                               SKEIN_SETTINGS(SKEIN_TEXT("colliders", "ball"), SKEIN_TEXT("jump_times", "1, 2.5 3")),
                               &motion));
    FAILS(world, SKEIN_ERROR_NAME, "no collider of the name 'bull'",
          skein_set(world, motion, "colliders", skein_text("ball, bull")));
    FAILS(world, SKEIN_ERROR_VALUE, "-1", skein_set(world, motion, "jump_times", skein_text("-1")));
    FAILS(world, SKEIN_ERROR_VALUE, "1.5 s comes after 4 s",
          skein_set(world, motion, "jump_times", skein_text("1, 4 1.5")));
    OK(world, skein_set(world, motion, "jump_times", skein_text("0 1, 1 4")));
    FAILS(world, SKEIN_ERROR_VALUE, "", skein_set(world, motion, "inertia", skein_number(1.5)));
    const double mirror[9] = {1, 0, 0, 0, 1, 0, 0, 0, -1}, nowhere[3] = {0, NAN, 0};
    FAILS(world, SKEIN_ERROR_VALUE, "rotation", skein_body_teleport(world, body, mirror, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "finite", skein_body_teleport(world, body, NULL, nowhere));
    FAILS(world, SKEIN_ERROR_HANDLE, "", skein_body_teleport(world, motion, NULL, NULL));
    steps(world, 1, dt);
    OK(world, skein_remove(world, skein_object_at(world, SKEIN_COLLIDER, 0))); // one that was there may go
    steps(world, 1, dt);
    OK(world, skein_motion_add(world, "turn", NULL, SKEIN_SETTINGS(SKEIN_TEXT("colliders", "ball")), NULL));
    FAILS(world, SKEIN_ERROR_NAME, "ball", skein_world_step(world, dt));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(without_inertia_it_is_carried),
                                       cmocka_unit_test(with_all_inertia_nothing_is_done),
                                       cmocka_unit_test(a_share_is_left_behind),
                                       cmocka_unit_test(a_pendulum_hangs_by_its_share),
                                       cmocka_unit_test(a_jump_flings_nobody),
                                       cmocka_unit_test(a_collider_goes_with_a_motion),
                                       cmocka_unit_test(pictures_go_on),
                                       cmocka_unit_test(a_saved_state_goes_on),
                                       cmocka_unit_test(what_is_wrong_is_said)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
