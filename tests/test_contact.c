/* Contact against closed forms: Coulomb friction on a slope, bounces, a ball that pushes out, colliders that move,
 * and what the statistics say about it. */
#include "helpers.h"

static const double g = 9.81, slope = 20 * PI / 180;

/* A plane through the origin, tilted so that down is along (cos a, -sin a, 0). */
static skein_handle add_slope(skein_world *world, double angle, double friction, double restitution, double thickness) {
    skein_handle handle;
    OK(world, skein_collider_add(
                  world, "plane",
                  SKEIN_SETTINGS(SKEIN_VEC3("normal", sin(angle), cos(angle), 0), SKEIN_REAL("friction", friction),
                                 SKEIN_REAL("restitution", restitution), SKEIN_REAL("thickness", thickness)),
                  &handle));
    return handle;
}

/* How far down the slope a point is. */
static double down(vec3 p) {
    return p.x * cos(slope) - p.y * sin(slope);
}

/* ---- Friction ----------------------------------------------------------------------------------- */

static void a_particle_stays_or_slides(void **state) {
    (void)state;
    static const double part[] = {0, 0.3, 0.6, 0.9, 1.05, 2};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(part); i++) {
            double friction = part[i] * tan(slope), thickness = 0.01;
            skein_world *world = new_world(method_names[m], 10);
            add_gravity(world);
            add_slope(world, slope, friction, 0, thickness);
            // off the fall line too: friction is against the slide, wherever that goes
            add_particle(world, 0.3, thickness * sin(slope), thickness * cos(slope), 0);
            for (int second = 1; second <= 2; second++) {
                steps(world, 90, 1.0 / 90);
                vec3 p = position_of(world, 0), v = velocity_of(world, 0);
                double ought = g * (sin(slope) - friction * cos(slope));
                if (part[i] > 1) {
                    assert_under(down(p), 1e-5);
                    assert_under(length3(v), 1e-4);
                } else {
                    assert_share(down(v), ought * second, 0.02);
                    assert_share(down(p), ought * second * second / 2, 0.02);
                }
                assert_under(p.z, 1e-6);
                assert_near(p.x * sin(slope) + p.y * cos(slope), thickness, 1e-5);
            }
            skein_world_destroy(world);
        }
}

/* On the level friction slows every direction alike: a slide of v0 ends after v0 / (mu g). */
static void friction_is_against_the_slide(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        add_slope(world, 0, 0.25, 0, 0);
        add_moving(world, 2, 0, 0, 0, 1.2, 0, 1.6);
        steps(world, 45, 1.0 / 90);
        vec3 v = velocity_of(world, 0);
        assert_share(v.x, 1.2 * (1 - 0.5 * 0.25 * g / 2), 0.02);
        assert_share(v.z, 1.6 * (1 - 0.5 * 0.25 * g / 2), 0.02);
        steps(world, 45, 1.0 / 90);
        double way = 4 / (2 * 0.25 * g); // v0^2 / (2 mu g)
        assert_share(position_of(world, 0).x, 0.6 * way, 0.02);
        assert_share(position_of(world, 0).z, 0.8 * way, 0.02);
        assert_under(length3(velocity_of(world, 0)), 1e-4);
        skein_world_destroy(world);
    }
}

static skein_world *cloth_on_a_slope(const char *method, double friction) {
    skein_world *world = new_world(method, 10);
    add_gravity(world);
    add_slope(world, slope, friction, 0, 0.004);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 7, 6), SKEIN_PAIR("size", 0.5, 0.4),
                                            SKEIN_REAL("density", 0.3), SKEIN_VEC3("rotation", 0, 0, -20),
                                            SKEIN_VEC3("position", 0.004 * sin(slope), 0.004 * cos(slope), 0),
                                            SKEIN_REAL("stretch.stiffness", 500), SKEIN_REAL("shear.stiffness", 100),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 5)),
                             NULL));
    return world;
}

static vec3 middle_of(const skein_world *world) {
    size_t count = skein_particle_count(world);
    vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        vec3 p = position_of(world, i);
        sum.x += p.x / (double)count, sum.y += p.y / (double)count, sum.z += p.z / (double)count;
    }
    return sum;
}

static void a_cloth_stays_or_slides(void **state) {
    (void)state;
    static const double part[] = {0, 0.5, 0.9, 1.1};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(part); i++) {
            double friction = part[i] * tan(slope);
            skein_world *world = cloth_on_a_slope(method_names[m], friction);
            vec3 start = middle_of(world);
            steps(world, 120, 1.0 / 90);
            double way = down(minus(middle_of(world), start)), t = 120.0 / 90;
            double ought = g * (sin(slope) - friction * cos(slope)) * t * t / 2;
            if (part[i] > 1) assert_under(way, 1e-4);
            else assert_share(way, ought, 0.02);
            skein_world_destroy(world);
        }
}

/* ---- Bounces ------------------------------------------------------------------------------------ */

/* Falls from 1 m and rises to e^2 m. */
static void a_bounce_keeps_its_restitution(void **state) {
    (void)state;
    static const double restitutions[] = {0, 0.3, 0.7, 0.95, 1};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(restitutions); i++) {
            double e = restitutions[i], top = 0;
            skein_world *world = new_world(method_names[m], 20);
            add_gravity(world);
            add_slope(world, 0, 0.3, e, 0.01);
            add_particle(world, 0.2, 0, 1.01, 0);
            double fall = sqrt(2 / g); // s
            steps(world, (int)(fall * 90) + 2, 1.0 / 90);
            for (int n = 0; n < (int)(e * fall * 90) + 4; n++) {
                double y = position_of(world, 0).y - 0.01;
                if (y > top) top = y;
                steps(world, 1, 1.0 / 90);
            }
            assert_near(top, e * e, 0.001 + 0.03 * e * e);
            skein_world_destroy(world);
        }
}

/* A bounce turns the speed along the normal only; without friction the rest goes on. */
static void a_bounce_off_a_slope_is_a_mirror(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_slope(world, PI / 4, 0, 1, 0);
        add_moving(world, 0.2, 0, 0.5, 0, 0, -2, 0.3);
        steps(world, 45, 1.0 / 90);
        vec3 v = velocity_of(world, 0);
        assert_share(v.x, 2, 0.005);
        assert_under(v.y, 0.01);
        assert_share(v.z, 0.3, 0.005);
        skein_world_destroy(world);
    }
}

/* ---- Pushing out -------------------------------------------------------------------------------- */

/* The sphere's own numbers, exactly: out along the unit normal, not along the centre's distance. */
static void a_sphere_pushes_out_along_the_unit_normal(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        OK(world, skein_collider_add(world, "sphere",
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.5, 0), SKEIN_REAL("radius", 1),
                                                    SKEIN_REAL("thickness", 0), SKEIN_REAL("recovery", 1e6)),
                                     NULL));
        add_particle(world, 1, 0, 1.4, 0);
        add_particle(world, 1, 0.3, 0.5, 0.4);
        add_particle(world, 1, 0, 0.5, 0);   // in the very centre: up is as good a way as any
        add_particle(world, 0, 0.1, 0.5, 0); // held: stays
        add_particle(world, 1, 0, 1.6, 0);   // outside: stays
        steps(world, 1, 1.0 / 90);
        vec3 p = position_of(world, 0);
        assert_true(p.x == 0 && p.y == 1.5 && p.z == 0);
        assert_under(length3(minus(position_of(world, 1), (vec3){0.6, 0.5, 0.8})), 4 * EPSILON);
        assert_under(length3(minus(position_of(world, 2), (vec3){0, 1.5, 0})), 4 * EPSILON);
        assert_under(length3(minus(position_of(world, 3), (vec3){0.1, 0.5, 0})), EPSILON);
        assert_under(length3(minus(position_of(world, 4), (vec3){0, 1.6, 0})), EPSILON);
        skein_world_destroy(world);
    }
}

/* Any normal of any length, any offset, a thickness on top. */
static void a_plane_pushes_out_to_its_thickness(void **state) {
    (void)state;
    double unit[3] = {2 / 7.0, -3 / 7.0, 6 / 7.0};
    static const double heights[] = {-5, 0.8, 1.2}; // along the normal; the plane's is 0.75, and its skin 0.125 thick
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        OK(world, skein_collider_add(world, "plane",
                                     SKEIN_SETTINGS(SKEIN_VEC3("normal", 4, -6, 12), SKEIN_REAL("offset", 0.75),
                                                    SKEIN_REAL("thickness", 0.125), SKEIN_REAL("recovery", 1e6)),
                                     NULL));
        for (size_t i = 0; i < COUNT(heights); i++)
            add_particle(world, 1, 3 + heights[i] * unit[0], 2 + heights[i] * unit[1],
                         heights[i] * unit[2]); // (3, 2, 0) is on the level
        steps(world, 1, 1.0 / 90);
        for (size_t i = 0; i < COUNT(heights); i++) {
            double height = fmax(heights[i], 0.875);
            assert_under(length3(minus(position_of(world, i),
                                       (vec3){3 + height * unit[0], 2 + height * unit[1], height * unit[2]})),
                         10 * EPSILON);
        }
        skein_world_destroy(world);
    }
}

/* A contact pushes and never pulls: what is drawn or thrown off flies as if there were no plane. */
static void nothing_sticks(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        add_slope(world, 0, 5, 0.5, 0.01);
        OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0, 3, 0)), NULL));
        add_particle(world, 0.2, 0, 0.01, 0); // 3 N up, 2 N down
        add_moving(world, 10, 1, 0.01, 0, 0.5, 2, 0);
        steps(world, 30, 1.0 / 90);
        // in its first substep the one that is thrown still lies there: it feels no weight, and friction
        assert_near(velocity_of(world, 0).y, (3 / 0.2 - g) / 3, 0.005);
        assert_near(velocity_of(world, 1).y, 2 + (3 / 10.0 - g) / 3, 0.002 + g / 900);
        assert_near(velocity_of(world, 1).x, 0.5, 0.002 + 5 * g / 900);
        skein_world_destroy(world);
    }
}

/* What lies does not bounce, however springy: a step's own fall is no impact. And what bounces ends up lying; but for
 * symplectic Euler, where the substep of a bounce feels no weight: that keeps up bounces of a tenth of a millimetre. */
static void a_springy_thing_comes_to_lie(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        add_slope(world, 0, 0.3, 0.9, 0.01);
        add_particle(world, 1, 0, 0.01, 0);
        steps(world, 90, 1.0 / 90);
        assert_under(velocity_of(world, 0).y, 1e-3);
        place_particle(world, 0, 0, 0.11, 0);
        steps(world, 90 * 6, 1.0 / 90);
        assert_under(velocity_of(world, 0).y, m ? 1e-3 : 6 * g / 900);
        assert_near(position_of(world, 0).y, 0.01, m ? 1e-5 : 2e-4);
        skein_world_destroy(world);
    }
}

/* ---- Colliders that move ------------------------------------------------------------------------ */

static void a_moving_plane_carries_by_friction(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int rough = 0; rough < 2; rough++) {
            skein_world *world = new_world(method_names[m], 10);
            add_gravity(world);
            skein_handle belt = add_slope(world, 0, rough ? 0.5 : 0, 0, 0);
            OK(world, skein_set(world, belt, "motion.velocity", skein_vector(0.8, 0, -0.4)));
            OK(world, skein_set(world, belt, "motion.start", skein_number(0.5)));
            add_particle(world, 1, 0, 0, 0);
            steps(world, 45, 1.0 / 90);
            assert_under(length3(position_of(world, 0)), 1e-5);
            steps(world, 180, 1.0 / 90);
            // it slips until mu g t = v, and is v^2 / (2 mu g) late from then on
            double speed = sqrt(0.8), late = speed * speed / (2 * 0.5 * g), way = rough ? 2 * speed - late : 0;
            vec3 p = position_of(world, 0);
            assert_near(p.x, way * 0.8 / speed, 0.01);
            assert_near(p.z, -way * 0.4 / speed, 0.01);
            assert_under(p.y, 1e-5);
            skein_pose pose;
            OK(world, skein_collider_pose(world, belt, &pose));
            assert_near(pose.position[0], 1.6, 1e-6);
            assert_near(pose.position[2], -0.8, 1e-6);
            skein_world_destroy(world);
        }
}

/* A plane that starts to rise hits what lies on it in that very substep. */
static void a_starting_plane_kicks(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        skein_handle bat = add_slope(world, 0, 0, 0.5, 0.01);
        OK(world, skein_set(world, bat, "motion.velocity", skein_vector(0, 2, 0)));
        add_particle(world, 1, 0, 0.01, 0);
        steps(world, 1, 1.0 / 64);
        assert_near(velocity_of(world, 0).y, 3, 1e-4); // (1 + e) v
        skein_world_destroy(world);
    }
}

static void a_rising_plane_lifts(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 10);
        add_gravity(world);
        skein_handle lift = add_slope(world, 0, 0.5, 0, 0.01);
        OK(world, skein_set(world, lift, "motion.velocity", skein_vector(0, 0.6, 0)));
        add_particle(world, 1, 0, 0.01, 0);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 5), SKEIN_VEC3("position", 3, 0.01, 0),
                                                SKEIN_REAL("stretch.stiffness", 10), SKEIN_REAL("shear.stiffness", 10)),
                                 NULL));
        steps(world, 90, 1.0 / 90);
        // where the plane is at the step's end, not where it was before
        for (size_t i = 0; i < 21; i++) assert_near(position_of(world, i).y, 0.61, 1e-5);
        assert_under(statistics_of(world).max_penetration, 1e-6);
        assert_share(velocity_of(world, 0).y, 0.6, 0.01);
        skein_pose pose;
        OK(world, skein_collider_pose(world, lift, &pose));
        assert_near(pose.position[1], 0.6, 1e-6);
        skein_world_destroy(world);
    }
}

/* A turning table takes along what lies on it, at its own angular speed; without friction nothing turns. */
static void a_turning_plane_takes_along(void **state) {
    (void)state;
    double spin = 1.5, radius = 0.6;
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (int rough = 0; rough < 2; rough++) {
            skein_world *world = new_world(method_names[m], 20);
            add_gravity(world);
            skein_handle table = add_slope(world, 0, rough ? 5 : 0, 0, 0);
            // the axis may have any length
            OK(world, skein_set(world, table, "motion.axis", skein_vector(0, 7, 0)));
            OK(world, skein_set(world, table, "motion.spin", skein_number(spin)));
            OK(world, skein_set(world, table, "motion.start", skein_number(0.502)));
            add_particle(world, 1, radius, 0, 0);
            steps(world, 45, 1.0 / 90);
            assert_under(length3(minus(position_of(world, 0), (vec3){radius, 0, 0})), 1e-5); // not yet
            if (rough) throw_particle(world, 0, 0, 0, -spin * radius);
            steps(world, 180, 1.0 / 90);
            vec3 p = position_of(world, 0);
            // about y from z to x: an angle of +a takes (r, 0, 0) to (r cos a, 0, -r sin a)
            double angle = atan2(-p.z, p.x), turned = spin * (2.5 - 0.502), ought = rough ? turned : 0;
            assert_near(angle, ought, 0.02 * ought + 1e-5);
            assert_share(hypot(p.x, p.z), radius, 0.02);
            skein_pose pose;
            OK(world, skein_collider_pose(world, table, &pose));
            assert_near(pose.rotation[0], cos(turned), 1e-5);
            assert_near(pose.rotation[2], sin(turned), 1e-5);
            skein_world_destroy(world);
        }
}

/* The spin is about the collider's own point, wherever that is, and about any axis. */
static void a_spinning_ball_drags_its_skin(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        add_gravity(world);
        OK(world, skein_collider_add(world, "sphere",
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 3, 1, -2), SKEIN_REAL("radius", 0.5),
                                                    SKEIN_REAL("thickness", 0), SKEIN_REAL("friction", 1e6),
                                                    SKEIN_VEC3("motion.axis", 0, 0, 2), SKEIN_REAL("motion.spin", 4),
                                                    SKEIN_VEC3("motion.velocity", 0, 0, 0.25)),
                                     NULL));
        add_particle(world, 1, 3, 1.5, -2); // on top, where spin x radius = (0, 0, 4) x (0, 0.5, 0)
        steps(world, 1, 1.0 / 256);
        vec3 v = velocity_of(world, 0);
        assert_near(v.x, -2, 0.02);
        assert_near(v.z, 0.25, 0.02);
        skein_world_destroy(world);
    }
}

/* ---- Statistics --------------------------------------------------------------------------------- */

static void penetration_and_contacts_are_counted(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_handle ground = add_slope(world, 0, 0.3, 0, 0.01), ball;
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 5, 1, 0), SKEIN_REAL("radius", 0.5),
                                                SKEIN_REAL("thickness", 0.02)),
                                 &ball));
    add_particle(world, 1, 0, 1, 0);
    assert_true(statistics_of(world).max_penetration == 0);
    assert_int_equal(statistics_of(world).contacts, 0);
    add_particle(world, 1, 0, -0.3, 0);
    assert_near(statistics_of(world).max_penetration, 0.31, 1e-6);
    assert_int_equal(statistics_of(world).contacts, 1);
    add_particle(world, 1, 5.1, 1, 0); // 0.4 under the ball's surface
    assert_near(statistics_of(world).max_penetration, 0.42, 1e-6);
    assert_int_equal(statistics_of(world).contacts, 2);
    add_particle(world, 0, 0, -2, 0); // held: it touches, but nobody can push it
    assert_near(statistics_of(world).max_penetration, 0.42, 1e-6);
    assert_int_equal(statistics_of(world).contacts, 3);
    OK(world, skein_set(world, ball, "enabled", skein_number(0)));
    assert_near(statistics_of(world).max_penetration, 0.31, 1e-6);
    // where the collider is now counts
    OK(world, skein_set(world, ground, "motion.velocity", skein_vector(0, -90, 0)));
    steps(world, 1, 1.0 / 90);
    assert_true(statistics_of(world).max_penetration == 0);
    assert_int_equal(statistics_of(world).contacts, 1);
    skein_world_destroy(world);
}

/* A particle between two colliders, or in none, is nobody's trouble; a plane without a direction is refused. */
static void a_plane_needs_a_normal(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    FAILS(world, SKEIN_ERROR_VALUE, "normal",
          skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_VEC3("normal", 0, 0, 0)), NULL));
    assert_int_equal(skein_object_count(world, SKEIN_COLLIDER), 0);
    skein_handle plane = add_slope(world, 0, 0, 0, 0);
    FAILS(world, SKEIN_ERROR_VALUE, "normal", skein_set(world, plane, "normal", skein_vector(0, 0, 0)));
    skein_value value;
    OK(world, skein_get(world, plane, "normal", &value));
    assert_true(value.number[1] == 1);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_particle_stays_or_slides),
        cmocka_unit_test(friction_is_against_the_slide),
        cmocka_unit_test(a_cloth_stays_or_slides),
        cmocka_unit_test(a_bounce_keeps_its_restitution),
        cmocka_unit_test(a_bounce_off_a_slope_is_a_mirror),
        cmocka_unit_test(a_sphere_pushes_out_along_the_unit_normal),
        cmocka_unit_test(a_plane_pushes_out_to_its_thickness),
        cmocka_unit_test(nothing_sticks),
        cmocka_unit_test(a_springy_thing_comes_to_lie),
        cmocka_unit_test(a_moving_plane_carries_by_friction),
        cmocka_unit_test(a_starting_plane_kicks),
        cmocka_unit_test(a_rising_plane_lifts),
        cmocka_unit_test(a_turning_plane_takes_along),
        cmocka_unit_test(a_spinning_ball_drags_its_skin),
        cmocka_unit_test(penetration_and_contacts_are_counted),
        cmocka_unit_test(a_plane_needs_a_normal),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
