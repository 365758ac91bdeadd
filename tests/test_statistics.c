/* The measures of a state against closed forms: energies, what is lost of them, momenta. */
#include "all_methods.h"
#include "helpers.h"

/* Three particles whose sums are easily found by hand. */
static void sums_are_those_of_the_particles(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    add_gravity(world);
    OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 2, 0, 0)), NULL));
    add_moving(world, 2, 1, 3, 0, 0, 1, 2);
    add_moving(world, 0.5, 0, -4, 2, 4, 0, 0);
    add_moving(world, 0, 5, 5, 5, 0, 0, 0); // held: it counts in nothing
    add_spring(world, 0, 1, 100, 0);
    skein_statistics s = statistics_of(world);
    assert_near(s.kinetic_energy, 0.5 * 2 * 5 + 0.5 * 0.5 * 16, 1e-5);
    assert_near(s.potential_energy, 9.81 * (2 * 3 - 0.5 * 4) - 2 * (2 * 1), 1e-5);
    assert_near(s.elastic_energy, 0, 1e-9);
    assert_near(s.dissipated_energy, 0, 0);
    const double momentum[3] = {0.5 * 4, 2 * 1, 2 * 2};
    // m x cross v: 2 (1, 3, 0) x (0, 1, 2) + 0.5 (0, -4, 2) x (4, 0, 0)
    const double angular[3] = {2 * 6, 2 * -2 + 0.5 * 8, 2 * 1 + 0.5 * 16};
    for (int k = 0; k < 3; k++) {
        assert_near(s.momentum[k], momentum[k], 1e-5);
        assert_near(s.angular_momentum[k], angular[k], 1e-5);
    }
    // stretched by 1; then switched off; then rigid
    vec3 a = position_of(world, 0), b = position_of(world, 1), d = minus(a, b);
    double length = length3(d);
    place_particle(world, 0, a.x + d.x / length, a.y + d.y / length, a.z + d.z / length);
    assert_share(statistics_of(world).elastic_energy, 50, 1e-5);
    OK(world, skein_set_path(world, "constraints.0.enabled", skein_number(0)));
    assert_near(statistics_of(world).elastic_energy, 0, 0);
    OK(world, skein_set_path(world, "constraints.0.enabled", skein_number(1)));
    OK(world, skein_set_path(world, "constraints.0.stiffness", skein_number(INFINITY)));
    assert_near(statistics_of(world).elastic_energy, 0, 0);
    skein_world_destroy(world);
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The k-th stretch, and the largest, are those that a sort would find, whatever order and however many: that of which 99 % stretch no
 * more. Half of them are stretched alike in the last order. */
static void of_a_hundred_edges_one_stretches_more(void **state) {
    (void)state;
    enum { MOST = 401, ORDERS = 5 };
    static const int counts[] = {1, 2, 3, 7, 100, 101, 201, MOST};
    for (size_t c = 0; c < COUNT(counts); c++)
        for (int order = 0; order < ORDERS; order++) {
            const int count = counts[c];
            uint64_t seed = 11;
            double stretch[MOST];
            skein_world *world = new_world("xpbd", 1);
            for (int i = 0; i < count; i++) {
                const int at = order == 0   ? i * 77 % count
                               : order == 1 ? i
                               : order == 2 ? count - i
                               : order == 3 ? abs(2 * i - count)
                                            : 0;
                stretch[i] = order == 4 ? (i % 2 ? 0.1 : random_between(&seed, 0, 0.2)) : 0.2 * at / count;
                add_particle(world, 1, 0, 0, i);
                add_particle(world, 1, 1, 0, i);
                add_spring(world, 2 * (uint32_t)i, 2 * (uint32_t)i + 1, 1, 0);
            }
            for (int i = 0; i < count; i++) place_particle(world, 2 * (size_t)i + 1, 1 + stretch[i], 0, i);
            qsort(stretch, (size_t)count, sizeof *stretch, compare);
            const skein_statistics s = statistics_of(world);
            assert_near(s.max_stretch, stretch[count - 1], 1e-6);
            assert_near(s.p99_stretch, stretch[(int)(0.99 * (count - 1))], 1e-6);
            skein_world_destroy(world);
        }
}

/* A body's springs have shares of its stiffness: a sheet stretched as a whole holds the same at any resolution. */
static void a_sheet_holds_its_energy_at_any_resolution(void **state) {
    (void)state;
    for (int n = 5; n <= 33; n += 14) {
        skein_world *world = new_world("xpbd", 1);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", n, n), SKEIN_REAL("stretch.stiffness", 1000),
                                                SKEIN_REAL("shear.stiffness", 0), SKEIN_TEXT("bend.by", "springs"),
                                                SKEIN_REAL("bend.stiffness", 0)),
                                 NULL));
        for (int i = 0; i < n * n; i++) {
            vec3 p = position_of(world, (size_t)i);
            place_particle(world, (size_t)i, 1.01 * p.x, p.y, p.z);
        }
        // half of 1000 N/m, a square metre, a stretch of 0.01
        assert_share(statistics_of(world).elastic_energy, 0.05, 1e-2);
        skein_world_destroy(world);
    }
}

/* A damped spring ends at rest: all that it held is dissipated, under every method that damps as it should. */
static void what_is_lost_is_counted(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 20);
        uint32_t held = add_particle(world, 0, 0, 0, 0), bob = add_particle(world, 1, 1, 0, 0);
        add_spring(world, held, bob, 100, 4);
        place_particle(world, bob, 1.3, 0, 0);
        assert_share(statistics_of(world).elastic_energy, 4.5, 1e-5);
        steps(world, 400, 0.01);
        skein_statistics s = statistics_of(world);
        assert_share(s.dissipated_energy, 4.5, 1e-4);
        // the account begins anew with a reset
        OK(world, skein_world_reset(world));
        assert_near(statistics_of(world).dissipated_energy, 0, 0);
        throw_particle(world, bob, 0, 0, 2);
        steps(world, 1, 1e-4);
        assert_near(statistics_of(world).dissipated_energy, 0, 1e-3);
        skein_world_destroy(world);
    }
}

/* Free flight keeps the sum of kinetic and potential energy, to the method's order. */
static void flight_keeps_its_energy(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 200);
        add_gravity(world);
        add_moving(world, 3, 0, 2, 0, 1, 4, 0);
        steps(world, 10, 0.02);
        skein_statistics s = statistics_of(world);
        assert_near(s.dissipated_energy, 0, 3 * 9.81 * 9.81 * 1e-4 * 0.2 * 1.1);
        assert_share(s.kinetic_energy + s.potential_energy, 0.5 * 3 * 17 + 3 * 9.81 * 2, 1e-3);
        skein_world_destroy(world);
    }
}

/* Gravity and springs, drag and things at rest give no energy; wind, what moves and what depends on t may. */
static void what_does_work_is_known(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    add_gravity(world);
    add_moving(world, 2, 1, 3, 0, 0, 1, 2);
    add_moving(world, 0.5, 0, -4, 2, 4, 0, 0);
    add_spring(world, 0, 1, 100, 1);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -9)), NULL));
    OK(world, skein_force_add(world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "dot(p, p)")), NULL));
    assert_false(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "colliders.0.motion.velocity", (skein_value){3, {0, 1, 0}, NULL}));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "colliders.0.enabled", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    // one with a mass cancels what would pull back what leaves it
    OK(world, skein_collider_add(world, "bowl", SKEIN_SETTINGS(SKEIN_REAL("radius", 20), SKEIN_REAL("mass", 5)), NULL));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "colliders.1.mass", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1, 0, 0)), NULL));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "forces.3.enabled", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "forces.2.energy", (skein_value){0, {0, 0, 0}, "dot(p, p) * cos(t)"}));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "forces.2.enabled", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    // whose pins may well stand now
    OK(world, skein_motion_add(world, "keys", NULL, SKEIN_SETTINGS(SKEIN_TEXT("keys", "0 0 0 0, 1 0 1 0")), NULL));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "motions.0.enabled", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    // one of the constraint's two rest lengths is at another time
    const uint32_t ends[] = {0, 1};
    OK(world, skein_constraint_add(
                  world, "formula", ends, 1,
                  SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - 1 - sin(t)"), SKEIN_REAL("stiffness", 10)),
                  NULL));
    assert_true(skein_world_is_driven(world));
    OK(world, skein_set_path(world, "constraints.1.enabled", skein_number(0)));
    assert_false(skein_world_is_driven(world));
    add_moving(world, 0, 5, 5, 5, 1, 0, 0);
    assert_true(skein_world_is_driven(world));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_those_of_the_particles), cmocka_unit_test(of_a_hundred_edges_one_stretches_more),
        cmocka_unit_test(what_does_work_is_known),         cmocka_unit_test(a_sheet_holds_its_energy_at_any_resolution),
        cmocka_unit_test(what_is_lost_is_counted),         cmocka_unit_test(flight_keeps_its_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
