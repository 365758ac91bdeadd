/* Order parameters against what they are by definition, and against all pairs. */
#include "helpers.h"

static skein_order order_of(skein_world *world, double group_distance) {
    skein_order o;
    OK(world, skein_order_measure(world, 0, skein_particle_count(world), (const double[]){0, 0, 0}, group_distance, &o));
    return o;
}

/* Sixty birds on a circle of radius 5 round the vertical; each flies at this angle to the tangent. */
static skein_world *ring(double angle) {
    skein_world *world = new_world("symplectic_euler", 1);
    for (int i = 0; i < 60; i++) {
        double a = 2 * PI * i / 60, b = a + PI / 2 + angle;
        add_moving(world, 1, 5 * cos(a), 0, 5 * sin(a), 2 * cos(b), 0, 2 * sin(b));
    }
    return world;
}

static void rings_mill_and_lines_are_polarized(void **state) {
    (void)state;
    for (int k = 0; k < 5; k++) {
        double angle = 0.4 * k;
        skein_world *world = ring(angle);
        skein_order o = order_of(world, 0.6);
        assert_near(o.milling, fabs(cos(angle)), 1e-6);
        assert_near(o.polarization, 0, 1e-6);
        assert_near(o.radius, 5, 1e-6);
        assert_near(o.farthest, 5, 1e-6);
        assert_near(o.speed, 2, 1e-6);
        assert_near(o.nearest, 10 * sin(PI / 60), 1e-6);
        assert_int_equal(o.groups, 1);
        assert_int_equal(order_of(world, 0.5).groups, 60); // neighbours are 0.523 apart
        assert_int_equal(o.count, 60);
        // half of them the other way round
        for (int i = 0; i < 30; i++) {
            vec3 v = velocity_of(world, (size_t)i);
            throw_particle(world, (size_t)i, -v.x, -v.y, -v.z);
        }
        assert_near(order_of(world, 0).milling, 0, 1e-6);
        assert_int_equal(order_of(world, 0).groups, 0);
        for (size_t i = 0; i < 60; i++) throw_particle(world, i, 1, 2, 3 + 1e-3 * (double)i);
        assert_near(order_of(world, 0).polarization, 1, 1e-4);
        skein_world_destroy(world);
    }
}

static void nearest_and_groups_are_those_of_all_pairs(void **state) {
    (void)state;
    enum { MOST = 700 };
    static const size_t counts[] = {2, 3, 50, MOST};
    static vec3 x[MOST];
    static int group[MOST];
    for (size_t c = 0; c < COUNT(counts); c++)
        for (int shape = 0; shape < 3; shape++) {
            size_t n = counts[c];
            skein_world *world = new_world("symplectic_euler", 1);
            // in a box, in a box with far outliers, on a line
            OK(world, skein_body_add(world, "flock", NULL,
                                     SKEIN_SETTINGS(SKEIN_REAL("count", (double)n),
                                                    SKEIN_VEC3("spread", 10, shape < 2 ? 10 : 0, shape < 2 ? 10 : 0)),
                                     NULL));
            if (shape == 1) place_particle(world, 0, 3000, 0, 0), place_particle(world, n - 1, 3000, 5000, 1);
            OK(world, skein_positions_copy(world, 0, n, &x[0].x));
            double nearest = 0, distance = 0.9;
            size_t groups = n;
            for (size_t i = 0; i < n; i++) group[i] = (int)i;
            for (size_t i = 0; i < n; i++) {
                double best = INFINITY;
                for (size_t j = 0; j < n; j++) {
                    double d = length3(minus(x[i], x[j]));
                    if (j != i) best = fmin(best, d);
                    if (j <= i || d >= distance || group[i] == group[j]) continue;
                    int gone = group[j];
                    for (size_t k = 0; k < n; k++)
                        if (group[k] == gone) group[k] = group[i];
                    groups--;
                }
                nearest += best / (double)n;
            }
            skein_order o = order_of(world, distance);
            assert_share(o.nearest, nearest, 1e-9);
            assert_int_equal(o.groups, groups);
            skein_world_destroy(world);
        }
}

static void few_and_odd_birds_are_measured_too(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    skein_order o = order_of(world, 1);
    assert_true(o.count == 0 && o.groups == 0 && o.milling == 0);
    add_particle(world, 1, 0, 0, 0);
    o = order_of(world, 1);
    assert_true(o.count == 1 && o.groups == 1 && o.milling == 0 && o.polarization == 0 && o.nearest == 0);
    add_particle(world, 1, 0, 0, 0); // in the same place, at rest
    o = order_of(world, 1);
    assert_true(o.count == 2 && o.groups == 1 && o.nearest == 0);
    FAILS(world, SKEIN_ERROR_VALUE, "the world has 2",
          skein_order_measure(world, 1, 2, (const double[]){0, 0, 0}, 1, &o));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rings_mill_and_lines_are_polarized),
        cmocka_unit_test(nearest_and_groups_are_those_of_all_pairs),
        cmocka_unit_test(few_and_odd_birds_are_measured_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
