/* The stable steps that are foretold: theory's for one spring, and those of a net as runs at either side of them show.
 */
#include "all_methods.h"
#include "helpers.h"

/* One spring of 1 kg: omega and zeta are known. */
static void one_spring_is_as_theory_says(void **state) {
    (void)state;
    static const double omegas[] = {0.5, 300}, zetas[] = {0, 0.1, 0.7};
    for (size_t i = 0; i < COUNT(omegas); i++)
        for (size_t k = 0; k < COUNT(zetas); k++) {
            double w = omegas[i], zeta = zetas[k];
            skein_world *world = new_world("xpbd", 1);
            uint32_t a = add_particle(world, 0, 0, 0, 0), b = add_particle(world, 1, 1, 2, 3);
            add_spring(world, a, b, w * w, 2 * zeta * w);
            skein_stability s;
            OK(world, skein_world_stability(world, &s));
            assert_share(s.modes[0].frequency, w, 1e-4);
            assert_near(s.modes[0].damping_rate, zeta * w, 1e-4 * w);
            assert_int_equal(s.swinging_is_free, zeta > 0);
            assert_near(skein_stable_substep("explicit_euler", &s), 2 * zeta / w, 1e-3 / w);
            assert_share(skein_stable_substep("symplectic_euler", &s), 2 * (sqrt(1 + zeta * zeta) - zeta) / w, 1e-3);
            if (!zeta) {
                assert_share(skein_stable_substep("leapfrog", &s), 2 / w, 1e-3);
                assert_share(skein_stable_substep("rk4", &s), 2 * sqrt(2) / w, 1e-3);
                assert_share(skein_stable_substep("lookahead_euler", &s), 1 / w, 1e-3);
                assert_near(skein_stable_substep("midpoint", &s), 0, 0);
            }
            assert_true(isinf(skein_stable_substep("backward_euler", &s)) && isinf(skein_stable_substep("xpbd", &s)));
            assert_true(isnan(skein_stable_substep("euler", &s)));
            steps(world, 1, 0.01); // the world goes on as before
            skein_world_destroy(world);
        }
}

/* A net with two materials and some damping, at rest but for a breath. */
static skein_world *net(const char *method, double damping, double rate) {
    skein_world *world = new_world(method, 50);
    // what gains energy is held by damping alone, of every spring by its stiffness
    bool even = !strcmp(method, "explicit_euler") || !strcmp(method, "midpoint");
    OK(world, skein_body_add(
                  world, "cloth", NULL,
                  SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 8), SKEIN_TEXT("pins", "corners"),
                                 SKEIN_REAL("stretch.stiffness", 400), SKEIN_REAL("stretch.damping", damping),
                                 SKEIN_REAL("shear.stiffness", 100), SKEIN_TEXT("bend.by", "springs"),
                                 SKEIN_REAL("bend.stiffness", 50), SKEIN_REAL("shear.damping", even ? damping / 4 : 0),
                                 SKEIN_REAL("bend.damping", even ? damping / 8 : damping / 2),
                                 SKEIN_REAL("stretch.limit", INFINITY), SKEIN_REAL("stretch.tether", INFINITY)),
                  NULL));
    if (rate > 0) OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", rate)), NULL));
    uint64_t seed = 3;
    for (size_t i = 0; i < 72; i++) {
        if (i == 0 || i == 7 || i == 64 || i == 71) continue;
        double v[3];
        for (int k = 0; k < 3; k++) v[k] = random_between(&seed, -1e-2, 1e-2);
        throw_particle(world, i, v[0], v[1], v[2]);
    }
    return world;
}

/* By how much the energy has grown after many substeps of h. */
static double growth(const char *method, double damping, double rate, double h) {
    skein_world *world = net(method, damping, rate);
    skein_statistics s = statistics_of(world);
    double start = s.kinetic_energy + s.elastic_energy;
    for (int n = 0; n < 100; n++) {
        steps(world, 1, 50 * h);
        s = statistics_of(world);
        if (s.nonfinite || !(s.kinetic_energy < 1e6 * start)) break;
    }
    double end = s.nonfinite ? INFINITY : s.kinetic_energy + s.elastic_energy;
    skein_world_destroy(world);
    return end / start;
}

static void runs_grow_beyond_it_and_not_before(void **state) {
    (void)state;
    static const struct {
        const char *method;
        double damping, rate;
    } rows[] = {
        {"symplectic_euler", 0, 0},    {"leapfrog", 0, 0},       {"rk4", 0, 0},       {"lookahead_euler", 0, 0},
        {"symplectic_euler", 0.05, 0}, {"leapfrog", 0.05, 0},    {"rk4", 0.05, 0},    {"lookahead_euler", 0.05, 0},
        {"symplectic_euler", 0.4, 0},  {"explicit_euler", 2, 0}, {"midpoint", 2, 0},  {"rk4", 2, 0},
        {"symplectic_euler", 0, 800},  {"leapfrog", 0, 800},     {"midpoint", 0, 800}};
#ifdef SK_ONE_ISA
    const size_t stride = 4; // sanitizers need not see them all
#else
    const size_t stride = 1;
#endif
    for (size_t m = 0; m < COUNT(rows); m += stride) {
        skein_stability s;
        skein_world *world = net(rows[m].method, rows[m].damping, rows[m].rate);
        OK(world, skein_world_stability(world, &s));
        skein_world_destroy(world);
        double h = skein_stable_substep(rows[m].method, &s);
        double before = growth(rows[m].method, rows[m].damping, rows[m].rate, 0.95 * h),
               beyond = growth(rows[m].method, rows[m].damping, rows[m].rate, 1.05 * h);
        if (!(before < 300) || !(beyond > 1e3))
            print_message("%s, damping %g, rate %g: %g and %g at %g s\n", rows[m].method, rows[m].damping, rows[m].rate,
                          before, beyond, h);
        assert_true(before < 300 && beyond > 1e3);
    }
}

/* Nothing to vibrate; rigid springs, which are no explicit method's business; air alone. */
static void worlds_without_modes(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_stability s;
    OK(world, skein_world_stability(world, &s));
    assert_int_equal(s.mode_count, 0);
    uint32_t a = add_particle(world, 0, 0, 0, 0), b = add_particle(world, 2, 1, 0, 0);
    add_spring(world, a, b, INFINITY, 0);
    OK(world, skein_world_stability(world, &s));
    assert_int_equal(s.mode_count, 0);
    assert_true(isinf(skein_stable_substep("explicit_euler", &s)));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("linear", 10)), NULL));
    OK(world, skein_world_stability(world, &s));
    assert_false(s.swinging_is_free);
    // v' = v - h c/m v: stable up to 2 m/c
    assert_share(skein_stable_substep("symplectic_euler", &s), 2.0 * 2 / 10, 0.01);
    assert_share(skein_stable_substep("explicit_euler", &s), 2.0 * 2 / 10, 0.01);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_spring_is_as_theory_says),
        cmocka_unit_test(runs_grow_beyond_it_and_not_before),
        cmocka_unit_test(worlds_without_modes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
