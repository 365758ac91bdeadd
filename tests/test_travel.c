/* Colliders that are moved by setting where they are: they travel there in the next step, and have the velocity of it.
 */
#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

static skein_handle add_collider(skein_world *world, const char *kind, const skein_setting *settings) {
    skein_handle handle;
    OK(world, skein_collider_add(world, kind, settings, &handle));
    return handle;
}

static void set_vector(skein_world *world, skein_handle handle, const char *field, double x, double y, double z) {
    OK(world, skein_set(world, handle, field, skein_vector(x, y, z)));
}

static int substeps_of(const char *method) {
    return !strcmp(method, "backward_euler") ? 8 : 20;
}

/* ---- what it touches ---- */

/* A box that slides under a particle at 2 m/s: friction takes it along, mu g t until they are of one speed. */
static void friction_takes_along(void **state) {
    (void)state;
    const double mu = 0.5, g = 9.81, speed = 2;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], substeps_of(all_methods[m]));
        uint32_t rider = add_particle(world, 1, 0, 0.002, 0);
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 0, -g, 0)), NULL));
        skein_handle box = add_collider(
            world, "box",
            SKEIN_SETTINGS(SKEIN_VEC3("size", 4, 1, 4), SKEIN_VEC3("centre", 0, -0.5, 0), SKEIN_REAL("friction", mu)));
        for (int step = 1; step <= 60; step++) {
            set_vector(world, box, "centre", speed * step * dt, -0.5, 0);
            steps(world, 1, dt);
            double t = step * dt, v = fmin(mu * g * t, speed);
            assert_near(velocity_of(world, rider).x, v, 0.03);
            assert_near(position_of(world, rider).y, 0.002, 1e-4);
        }
        // it rests: what lay on it slides on, and stops after v^2/(2 mu g)
        double x = position_of(world, rider).x;
        steps(world, 60, dt);
        assert_near(velocity_of(world, rider).x, 0, 0.005); // a substep's friction
        assert_near(position_of(world, rider).x - x, speed * speed / (2 * mu * g), 0.03);
        skein_world_destroy(world);
    }
}

/* A ball that is moved into a particle at 3 m/s throws it off with (1 + e) times that. */
static void impacts_have_its_velocity(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], substeps_of(all_methods[m]));
        uint32_t hit = add_particle(world, 1, 0.52, 0, 0);
        skein_handle ball =
            add_collider(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3), SKEIN_REAL("restitution", 0.5)));
        for (int step = 1; step <= 10; step++) {
            set_vector(world, ball, "centre", 3 * step * dt, 0, 0);
            steps(world, 1, dt);
        }
        assert_near(velocity_of(world, hit).x, 4.5, 0.01);
        skein_world_destroy(world);
    }
}

/* Half a metre a step is farther than the ball is wide, and it meets what is in its way all the same; unless it is said
 * that it made no way. */
static void fast_ones_do_not_tunnel(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int teleports = 0; teleports < 2; teleports++) {
            skein_world *world = new_world(all_methods[m], 20);
            uint32_t hit = add_particle(world, 1, 0.25, 0.02, 0);
            skein_handle ball = add_collider(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.1)));
            set_vector(world, ball, "centre", 0.5, 0, 0);
            if (teleports) OK(world, skein_collider_teleport(world, ball));
            steps(world, 1, dt);
            vec3 p = position_of(world, hit), v = velocity_of(world, hit);
            if (teleports) assert_true(p.x == 0.25 && v.x == 0);
            else assert_true(p.x > 0.58 && v.x > 28); // 0.5 and the radius, but a little aside
            skein_world_destroy(world);
        }
}

/* ---- the same as by `motion` ---- */

/* Dust on something that moves: by `motion`, or by being set to the same places step by step. */
static void same_as_motion(const char *method, bool set, double end[static 12]) {
    skein_world *world = new_world(method, 10);
    const double speed = 0.4, spin = 1.5;
    double motion = set ? 0 : 1;
    skein_handle box = add_collider(world, "box",
                                    SKEIN_SETTINGS(SKEIN_VEC3("size", 2, 0.2, 2), SKEIN_VEC3("centre", 0, -0.1, 0),
                                                   SKEIN_VEC3("motion.velocity", motion * speed, 0, 0),
                                                   SKEIN_REAL("motion.spin", motion * spin)));
    for (int i = 0; i < 4; i++) add_particle(world, 0.1, 0.2 * i, 0.002, 0.1 * i);
    add_gravity(world);
    for (int step = 1; step <= 60; step++) {
        double t = step * dt;
        if (set) set_vector(world, box, "centre", speed * t, -0.1, 0);
        if (set) set_vector(world, box, "rotation", 0, spin * t * 180 / PI, 0);
        steps(world, 1, dt);
    }
    skein_pose pose;
    OK(world, skein_collider_pose(world, box, &pose));
    assert_near(pose.position[0], speed, 1e-5);
    assert_near(pose.rotation[0], cos(spin), 1e-5);
    OK(world, skein_positions_copy(world, 0, 4, end));
    skein_world_destroy(world);
}

static void boxes_turn_as_by_motion(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        double end[2][12];
        for (int set = 0; set < 2; set++) same_as_motion(all_methods[m], set, end[set]);
        assert_true(fabs(end[0][9] - 0.6) > 0.1); // it was taken along
        for (int k = 0; k < 12; k++) assert_near(end[1][k], end[0][k], 2e-3);
    }
}

/* The pose in the midst of a step is seen by what it throws: here by a particle that a turning rod hits at its end. */
static void rods_strike_with_their_ends(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 40);
        uint32_t hit = add_particle(world, 1, 0.45, 0.2, 0);
        skein_handle rod = add_collider(world, "capsule",
                                        SKEIN_SETTINGS(SKEIN_REAL("radius", 0.05), SKEIN_REAL("restitution", 1),
                                                       SKEIN_REAL("friction", 0), SKEIN_REAL("thickness", 0)));
        double angle = 0, spin = 12; // 0.2 rad a step: the end goes 0.1 m, twice the radius
        for (int step = 0; step < 4; step++) {
            angle += spin * dt;
            set_vector(world, rod, "from", -0.5 * cos(angle), -0.5 * sin(angle), 0);
            set_vector(world, rod, "to", 0.5 * cos(angle), 0.5 * sin(angle), 0);
            steps(world, 1, dt);
        }
        // across the rod it has twice the speed of the point that hit it, and none along it
        vec3 v = velocity_of(world, hit);
        double r = hypot(0.45, 0.2), lever = sqrt(r * r - 0.05 * 0.05);
        assert_near(length3(v), 2 * spin * lever, 0.02 * 2 * spin * lever);
        skein_world_destroy(world);
    }
}

/* A plane that rises and tilts lifts what lies on it. */
static void planes_lift(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], substeps_of(all_methods[m]));
        uint32_t low = add_particle(world, 1, 0, 0.002, 0), far = add_particle(world, 1, 1, 0.002, 0);
        add_gravity(world);
        skein_handle plane = add_collider(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0)));
        for (int step = 1; step <= 6; step++) {
            OK(world, skein_set(world, plane, "offset", skein_number(0.6 * step * dt)));
            steps(world, 1, dt);
            assert_near(position_of(world, low).y, 0.002 + 0.6 * step * dt, 1e-4);
            assert_near(velocity_of(world, low).y, 0.6, 0.02);
        }
        OK(world, skein_set(world, plane, "offset", skein_number(0)));
        OK(world, skein_world_reset(world));
        steps(world, 1, dt);
        assert_near(position_of(world, low).y, 0.002, 1e-4);
        set_vector(world, plane, "normal", -0.02, 1, 0); // 1.2 rad/s
        steps(world, 1, dt);
        assert_near(velocity_of(world, far).y, 1.2, 0.05);
        assert_near(velocity_of(world, low).y, 0, 0.05);
        skein_world_destroy(world);
    }
}

/* ---- what is a way and what is not ---- */

/* The velocity of a collider, as a particle takes it that lies on it and sticks. */
static double speed_felt(skein_world *world, uint32_t rider) {
    steps(world, 1, dt);
    double v = velocity_of(world, rider).x;
    OK(world, skein_world_reset(world));
    return v;
}

static void only_ways_that_are_made_count(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    uint32_t rider = add_particle(world, 1, 0, 0.002, 0);
    add_gravity(world);
    skein_handle box = add_collider(
        world, "box",
        SKEIN_SETTINGS(SKEIN_VEC3("size", 9, 1, 9), SKEIN_VEC3("centre", 0, -0.5, 0), SKEIN_REAL("friction", 1e6)));
    const double step = 0.5 * dt;
    set_vector(world, box, "centre", step, -0.5, 0);
    assert_near(speed_felt(world, rider), 0.5, 1e-3);
    assert_near(speed_felt(world, rider), 0, 1e-6); // it rests where it is
    // twice in one step: from the first place to the last
    set_vector(world, box, "centre", 5, -0.5, 0);
    set_vector(world, box, "centre", 3 * step, -0.5, 0);
    assert_near(speed_felt(world, rider), 1, 1e-3);
    // a call says that it made no way; so does a jump of time, and what is not enabled makes none
    set_vector(world, box, "centre", 0, -0.5, 0);
    OK(world, skein_collider_teleport(world, box));
    assert_near(speed_felt(world, rider), 0, 1e-6);
    set_vector(world, box, "centre", step, -0.5, 0);
    OK(world, skein_world_time_set(world, 0));
    assert_near(speed_felt(world, rider), 0, 1e-6);
    OK(world, skein_set(world, box, "enabled", skein_number(0)));
    set_vector(world, box, "centre", 0, -0.5, 0);
    OK(world, skein_set(world, box, "enabled", skein_number(1)));
    assert_near(speed_felt(world, rider), 0, 1e-6);
    // a size, a friction: no way
    OK(world, skein_set(world, box, "thickness", skein_number(0.002)));
    assert_near(speed_felt(world, rider), 0, 1e-6);
    // motion adds to it; set alone, it is no way
    set_vector(world, box, "motion.velocity", 0.25, 0, 0);
    assert_near(speed_felt(world, rider), 0.25, 1e-3);
    set_vector(world, box, "centre", step, -0.5, 0);
    assert_near(speed_felt(world, rider), 0.75, 1e-3);
    // together they say how it goes on from where it stands
    steps(world, 60, dt);
    skein_pose pose;
    OK(world, skein_collider_pose(world, box, &pose));
    OK(world, skein_set(world, box, "motion.start", skein_number(skein_world_time(world))));
    set_vector(world, box, "motion.velocity", -1, 0, 0);
    set_vector(world, box, "centre", pose.position[0], -0.5, 0);
    assert_near(speed_felt(world, rider), -1, 1e-2);
    skein_handle stale = {.index = 99, .generation = 1};
    FAILS(world, SKEIN_ERROR_HANDLE, "no such", skein_collider_teleport(world, stale));
    skein_world_destroy(world);
}

/* ---- Galileo, with contact ---- */

/* The largest stretch of a cloth that falls on a ball and hangs over it, in a world that moves at this speed. */
static double stretch_at(double speed, const char *method, const char *isa) {
    enum { FRAMES = 24 };
    setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = new_world(method, !strcmp(method, "explicit_euler")                                   ? 100
                                           : !strcmp(method, "backward_euler")                                 ? 4
                                           : !strcmp(method, "lookahead_euler") || !strcmp(method, "midpoint") ? 60
                                                                                                               : 20);
    unsetenv("SKEIN_SIMD");
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 11, 11), SKEIN_PAIR("size", 0.5, 0.5),
                                            SKEIN_VEC3("position", 0, 0.206, 0), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 60), SKEIN_REAL("shear.stiffness", 30),
                                            SKEIN_REAL("stretch.tether", INFINITY), SKEIN_REAL("stretch.limit", 0.05),
                                            SKEIN_REAL("stretch.damping", 0.05), SKEIN_REAL("shear.damping", 0.03),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 4),
                                            SKEIN_REAL("bend.damping", 0.01)),
                             NULL));
    add_gravity(world);
    size_t count = skein_particle_count(world);
    double *xyz = calloc(6 * count, sizeof *xyz), *v = xyz + 3 * count, back = -0.5 * speed * FRAMES * dt, worst = 0;
    skein_handle ball =
        add_collider(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_VEC3("centre", back, 0, 0)));
    OK(world, skein_positions_copy(world, 0, count, xyz));
    for (size_t i = 0; i < count; i++) xyz[3 * i] += back, v[3 * i] = speed;
    OK(world, skein_positions_set(world, 0, count, xyz));
    OK(world, skein_velocities_set(world, 0, count, v));
    for (int frame = 1; frame <= FRAMES; frame++) {
        double x = speed * frame * dt, corners[6];
        for (int k = 0; k < 3; k++) corners[k] = xyz[k], corners[3 + k] = xyz[30 + k];
        corners[0] += x, corners[3] += x;
        OK(world, skein_pins_move(world, (uint32_t[]){0, 10}, 2, corners));
        set_vector(world, ball, "centre", back + x, 0, 0);
        steps(world, 1, dt);
        worst = fmax(worst, statistics_of(world).max_stretch);
    }
    assert_true(statistics_of(world).contacts > 5);
    skein_world_destroy(world);
    free(xyz);
    return worst;
}

static void stretch_on_a_ball_knows_no_speed(void **state) {
    (void)state;
    static const char *const isas[] = {"sse", "avx2", "avx512"};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t i = 0; i < COUNT(isas); i++) {
            if (i && m % 3 != 1) continue; // bits are the same on all of them: test_bits.c
            double still = stretch_at(0, all_methods[m], isas[i]);
            assert_true(still > 0.005);
            for (int speed = 3; speed <= 30; speed *= 10) {
                double moving = stretch_at(speed, all_methods[m], isas[i]);
                assert_share(moving, still, 0.02);
            }
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_takes_along),          cmocka_unit_test(impacts_have_its_velocity),
        cmocka_unit_test(fast_ones_do_not_tunnel),       cmocka_unit_test(boxes_turn_as_by_motion),
        cmocka_unit_test(rods_strike_with_their_ends),   cmocka_unit_test(planes_lift),
        cmocka_unit_test(only_ways_that_are_made_count), cmocka_unit_test(stretch_on_a_ball_knows_no_speed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
