/* Ropes: where they are laid, what they weigh, how far they stretch, and what holds them. */
#include "helpers.h"
#include "world/world.h"

static double length_of(const skein_world *world, size_t count) {
    double length = 0;
    for (size_t i = 1; i < count; i++) length += length3(minus(position_of(world, i), position_of(world, i - 1)));
    return length;
}

static void a_rope_lies_between_its_ends(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    OK(world,
       skein_body_add(world, "rope", NULL,
                      SKEIN_SETTINGS(SKEIN_REAL("count", 5), SKEIN_VEC3("from", 1, 2, 3), SKEIN_VEC3("to", 5, 2, 3),
                                     SKEIN_REAL("density", 0.5), SKEIN_TEXT("pins", "first, last")),
                      NULL));
    for (size_t i = 0; i < 5; i++)
        assert_under(length3(minus(position_of(world, i), (vec3){1 + (double)i, 2, 3})), 1e-6);
    assert_near((double)skein_velocity_view(world).xyzw[3], 0.4, 1e-7); // 2 kg on 5
    assert_int_equal(statistics_of(world).constraints, 4 + 3);
    assert_int_equal(statistics_of(world).pinned_particles, 2);
    skein_world_destroy(world);
    // a shorter one goes that way, and a longer one hangs
    world = skein_world_create(NULL, NULL);
    OK(world, skein_body_add(
                  world, "rope", NULL,
                  SKEIN_SETTINGS(SKEIN_REAL("count", 3), SKEIN_VEC3("to", 0, 0, -7), SKEIN_REAL("length", 2)), NULL));
    assert_under(length3(minus(position_of(world, 2), (vec3){0, 0, -2})), 1e-6);
    FAILS(world, SKEIN_ERROR_VALUE, "two ends that are apart",
          skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_VEC3("to", 0, 0, 0)), NULL));
    FAILS(world, SKEIN_ERROR_NAME, "names no part of a rope",
          skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_TEXT("pins", "middle")), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "particle 33 is out of range",
          skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_TEXT("pins", "0 33")), NULL));
    assert_int_equal(skein_particle_count(world), 3);
    skein_world_destroy(world);
}

/* Any ends, any length: it ends where it ought to, is as long as it ought to be, and hangs as a catenary: the slope
 * grows by the same for every part of the way along it. */
static void a_long_rope_hangs(void **state) {
    (void)state;
    static const double ends[][4] = {{2, 0, 0, 2.5}, {1, 1, 2, 4},      {-3, -2, 0.5, 3.7}, {0, 0, 0, 2},
                                     {0, 1.5, 0, 2}, {1, 0, 1, 1.4143}, {0.001, 0, 0, 1}};
    for (size_t e = 0; e < COUNT(ends); e++) {
        enum { PARTICLES = 401 };
        skein_world *world = skein_world_create(NULL, NULL);
        vec3 from = {0.5, 3, -1}, to = {0.5 + ends[e][0], 3 + ends[e][1], -1 + ends[e][2]};
        double length = ends[e][3], link = length / (PARTICLES - 1);
        OK(world,
           skein_body_add(world, "rope", NULL,
                          SKEIN_SETTINGS(SKEIN_REAL("count", PARTICLES), SKEIN_VEC3("from", from.x, from.y, from.z),
                                         SKEIN_VEC3("to", to.x, to.y, to.z), SKEIN_REAL("length", length)),
                          NULL));
        assert_under(length3(minus(position_of(world, 0), from)), 1e-6);
        assert_under(length3(minus(position_of(world, PARTICLES - 1), to)), 1e-6);
        double ground = hypot(ends[e][0], ends[e][2]), before = 0, first = 0;
        assert_near(length_of(world, PARTICLES), length, 0.01 * length); // a narrow loop is turned in less than a link
        if (ground < 0.1) {
            skein_world_destroy(world);
            continue;
        }
        assert_near(length_of(world, PARTICLES), length, 2e-5 * length);
        for (size_t i = 20; i < PARTICLES; i += 20) {
            vec3 d = minus(position_of(world, i), position_of(world, i - 20));
            double slope = d.y / hypot(d.x, d.z);
            assert_near(length3(d), 20 * link, 0.03 * link * 20);
            if (i == 40) first = slope - before;
            if (i > 40) assert_near(slope - before, first, 0.03 * first + 2e-4);
            before = slope;
        }
        skein_world_destroy(world);
    }
}

/* Its stretch is the weight over the stiffness, with any number of particles. (One pass of XPBD a substep is softer.)
 */
static void it_hangs_the_same_at_any_resolution(void **state) {
    (void)state;
    static const int counts[] = {9, 17};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t c = 0; c < COUNT(counts); c++) {
            skein_world *world = new_world(method_names[m], 30);
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 12)), NULL));
            // straight down, 2 m of 0.5 kg/m: the mean pull is half of 9.81 N, so 1 % of stretch
            OK(world, skein_body_add(world, "rope", NULL,
                                     SKEIN_SETTINGS(SKEIN_REAL("count", counts[c]), SKEIN_VEC3("to", 0, -2, 0),
                                                    SKEIN_REAL("density", 0.5), SKEIN_TEXT("pins", "first"),
                                                    SKEIN_REAL("stretch.stiffness", 490.5),
                                                    SKEIN_REAL("stretch.tether", INFINITY)),
                                     NULL));
            steps(world, 60, 1.0 / 60);
            assert_near(position_of(world, (size_t)counts[c] - 1).y, -2.02, m ? 0.002 : 1e-4);
            assert_under(length3(velocity_of(world, (size_t)counts[c] - 1)), 2e-3);
            skein_world_destroy(world);
        }
}

/* Three particles, bent to a right angle: the ends are sqrt 2 apart where 2 is rest. */
static void bending_pushes_the_ends_apart(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    OK(world,
       skein_body_add(world, "rope", NULL,
                      SKEIN_SETTINGS(SKEIN_REAL("count", 3), SKEIN_VEC3("to", 2, 0, 0), SKEIN_REAL("density", 1.5),
                                     SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("bend.stiffness", 12)),
                      NULL));
    place_particle(world, 2, 1, 1, 0);
    double h = 1.0 / 1024, force = 12 * (2 - sqrt(2)) / 2;
    steps(world, 1, h);
    assert_share(velocity_of(world, 2).x, force / sqrt(2) * h, 1e-5);
    assert_share(velocity_of(world, 0).y, -force / sqrt(2) * h, 1e-5);
    assert_true(length3(velocity_of(world, 1)) == 0);
    skein_world_destroy(world);
}

/* A soft rope with a firm tether is no longer than its bound, whatever holds it. */
static void tethers_keep_it_short(void **state) {
    (void)state;
    static const char *const pins[] = {"first", "last", "first, last", "0 4 8 12 16 20"};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(pins); i++) {
            skein_world *world = new_world(method_names[m], 10);
            add_gravity(world);
            skein_handle rope;
            OK(world,
               skein_body_add(world, "rope", NULL,
                              SKEIN_SETTINGS(SKEIN_REAL("count", 21), SKEIN_VEC3("to", 2, 0, 0),
                                             SKEIN_REAL("length", i == 2 ? 3 : 0), SKEIN_TEXT("pins", pins[i]),
                                             SKEIN_REAL("stretch.stiffness", 1), SKEIN_REAL("stretch.tether", 0.02)),
                              &rope));
            steps(world, 60, 1.0 / 90);
            double link = (i == 2 ? 3.0 : 2.0) / 20;
            for (size_t p = 0; p < 21; p++) {
                // of many pins only the nearest holds
                size_t low = i == 3 ? (p + 1) / 4 * 4 : 0, high = i == 3 ? low : 20;
                double first = length3(minus(position_of(world, p), position_of(world, low))),
                       last = length3(minus(position_of(world, p), position_of(world, high)));
                if (i != 1) assert_true(first < fabs((double)p - (double)low) * link * 1.0201 + 1e-6);
                if (i != 0) assert_true(last < fabs((double)high - (double)p) * link * 1.0201 + 1e-6);
            }
            // without them it stretches
            OK(world, skein_set(world, rope, "stretch.tether", skein_number(INFINITY)));
            steps(world, 30, 1.0 / 90);
            assert_true(statistics_of(world).max_stretch > 0.1);
            skein_world_destroy(world);
        }
}

/* As long as a rope can be, held at both ends: whatever takes time by the square of the length takes many minutes here.
 */
static void the_longest_rope_is_built_soon(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_handle rope;
    OK(world, skein_body_add(world, "rope", NULL,
                             SKEIN_SETTINGS(SKEIN_REAL("count", 1000000), SKEIN_REAL("length", 2),
                                            SKEIN_TEXT("pins", "first, last")),
                             &rope));
    skein_statistics now = statistics_of(world);
    assert_true(now.particles == 1000000 && now.pinned_particles == 2);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_rope_lies_between_its_ends),
        cmocka_unit_test(a_long_rope_hangs),
        cmocka_unit_test(it_hangs_the_same_at_any_resolution),
        cmocka_unit_test(bending_pushes_the_ends_apart),
        cmocka_unit_test(tethers_keep_it_short),
        cmocka_unit_test(the_longest_rope_is_built_soon),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
