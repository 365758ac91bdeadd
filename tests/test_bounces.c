/* Bounces under every method: a particle rises to e^2 of its height, and what bounces on springs gains no energy. */
#include "all_methods.h"
#include "helpers.h"

static const double g = 9.81;

/* Falls from 1 m and rises to e^2 m within 1 %, wherever in its substep it hits. */
static void a_bounce_is_within_a_percent(void **state) {
    (void)state;
    static const double restitutions[] = {0.3, 0.9, 1};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t i = 0; i < COUNT(restitutions); i++)
            for (int start = 0; start < 3; start++) {
                double e = restitutions[i], height = 1 + 0.0013 * start, top = 0;
                skein_world *world = new_world(all_methods[m], 1);
                add_gravity(world);
                OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("restitution", e)), NULL));
                add_particle(world, 0.2, 0, height + 0.002, 0);
                steps(world, (int)(sqrt(2 * height / g) * 2400) + 3, 1.0 / 2400);
                for (int n = 0; n < (int)(e * sqrt(2 * height / g) * 2400) + 10; n++) {
                    top = fmax(top, position_of(world, 0).y - 0.002);
                    steps(world, 1, 1.0 / 2400);
                }
                if (fabs(top / (e * e * height) - 1) > 0.01)
                    print_message("%s, e = %g: %g\n", all_methods[m], e, top / (e * e * height));
                assert_share(top, e * e * height, 0.01);
                skein_world_destroy(world);
            }
}

/* The impulse is (1 + e) |v.n|, and friction takes mu times that of the slide: not only of what came in. */
static void friction_takes_its_share_of_the_whole_bounce(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 1);
        OK(world, skein_collider_add(world, "plane",
                                     SKEIN_SETTINGS(SKEIN_REAL("restitution", 0.5), SKEIN_REAL("friction", 0.2)), NULL));
        add_moving(world, 0.3, 0, 0.002, 0, 3, -2, 0);
        steps(world, 1, 1e-4);
        vec3 v = velocity_of(world, 0);
        bool moves = strstr(all_methods[m], "pbd"); // whose friction knows the push out alone
        assert_near(v.x, 3 - 0.2 * (moves ? 1 : 1.5) * 2, 1e-5 + moves * 1e-3);
        assert_near(v.y, 0.5 * 2, 1e-5 + moves * 1e-3);
        skein_world_destroy(world);
    }
}

/* What touches and leaves already: weight that would not bring it back within the substep is not held, but for a
 * collider with a mass, which holds all of it while it touches. */
static void what_leaves_is_pulled_back_by_its_weight(void **state) {
    (void)state;
    for (int massive = 0; massive < 2; massive++) {
        skein_world *world = new_world("explicit_euler", 1);
        add_gravity(world);
        OK(world, skein_collider_add(world, "sphere",
                                     SKEIN_SETTINGS(SKEIN_REAL("radius", 1), SKEIN_VEC3("centre", 0, -1, 0),
                                                    SKEIN_REAL("mass", massive)),
                                     NULL));
        add_moving(world, 0.3, 0, 0.001, 0, 0, 1, 0);
        steps(world, 1, 1e-3);
        assert_near(velocity_of(world, 0).y, massive ? 1 : 1 - g * 1e-3, 1e-6);
        skein_world_destroy(world);
    }
}

/* A cube on undamped springs, that falls on a corner. */
static skein_world *bouncing_cube(const char *method, double restitution) {
    skein_world *world = new_world(method, 40);
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane",
                                 SKEIN_SETTINGS(SKEIN_REAL("restitution", restitution), SKEIN_REAL("friction", 0),
                                                SKEIN_REAL("thickness", 0)),
                                 NULL));
    OK(world, skein_body_add(world, "lattice", NULL,
                             SKEIN_SETTINGS(SKEIN_VEC3("grid", 3, 3, 3), SKEIN_VEC3("size", 0.5, 0.5, 0.5),
                                            SKEIN_VEC3("position", 0, 0.6, 0), SKEIN_VEC3("rotation", 10, 20, 30),
                                            SKEIN_REAL("mass", 10), SKEIN_REAL("structural.stiffness", 1000),
                                            SKEIN_REAL("shear.stiffness", 500), SKEIN_REAL("bending.stiffness", 250)),
                             NULL));
    return world;
}

/* Kinetic, elastic, and of gravity above the plane. */
static double energy_of(skein_world *world) {
    skein_statistics s = statistics_of(world);
    return s.kinetic_energy + s.potential_energy + s.elastic_energy;
}

/* Explicit Euler grows without any contact. */
static void springs_that_bounce_gain_nothing(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const double restitutions[] = {0.5, 1};
    for (size_t m = 1; m < COUNT(all_methods); m++)
        for (size_t i = 0; i < COUNT(restitutions); i++) {
            skein_world *world = bouncing_cube(all_methods[m], restitutions[i]);
            double start = energy_of(world), most = 0;
            for (int n = 0; n < 200; n++) {
                steps(world, 1, 1.0 / 60);
                most = fmax(most, energy_of(world));
            }
            print_message("%s, e = %g: energy %.4f at most, %.4f at the end\n", all_methods[m], restitutions[i],
                          most / start, energy_of(world) / start);
            assert_true(most < 1.01 * start);
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_bounce_is_within_a_percent),
        cmocka_unit_test(friction_takes_its_share_of_the_whole_bounce),
        cmocka_unit_test(what_leaves_is_pulled_back_by_its_weight),
        cmocka_unit_test(springs_that_bounce_gain_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
