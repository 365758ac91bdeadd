/* Coarse grids of a cloth: what swings stays firm and keeps its time, nothing gains momentum, and what is taken in every
 * second substep gains no energy. */
#include "swing.h"
#include "world/world.h"

enum { SIDE = 64 };

static skein_world *swinging(uint32_t side, int substeps, double drag, double limit) {
    skein_world *world = new_world("xpbd", substeps);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.limit", limit)),
                             NULL));
    add_gravity(world);
    if (drag > 0) OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", drag)), NULL));
    return world;
}

static bool has_coarse_grids(const skein_world *world) {
    bool has = false;
    for (size_t i = 0; i < world->rules.batches.count; i++) has |= world->rules.batches.data[i]->coarse != NULL;
    return has;
}

/* Let go from level. With spans alone the 99th percentile comes to 1.9 %, and single edges to 3.5. */
static void a_cloth_that_swings_is_firm(void **state) {
    (void)state;
    skein_world *world = swinging(SIDE, 10, 1, INFINITY);
    assert_true(has_coarse_grids(world));
    double most = 0, p99 = 0;
    for (int n = 0; n < 90; n++) {
        steps(world, 1, 1.0 / 60);
        most = fmax(most, statistics_of(world).max_stretch), p99 = fmax(p99, statistics_of(world).p99_stretch);
    }
    assert_under(p99, 0.01);
    assert_under(most, 0.03);
    skein_world_destroy(world);
}

typedef struct sheet {
    int rows, columns;
    double x, z, rigidity, p99, most;
} sheet;

/* Lets sheets go from level, which swing by two corners, and asks in every frame how far they are stretched. */
static void stay_firm(const sheet *sheets, size_t count) {
    for (size_t i = 0; i < count; i++) {
        skein_world *world = new_world("xpbd", 10);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", sheets[i].rows, sheets[i].columns),
                                                SKEIN_PAIR("size", sheets[i].x, sheets[i].z),
                                                SKEIN_REAL("bend.rigidity", sheets[i].rigidity),
                                                SKEIN_TEXT("pins", "top corners")),
                                 NULL));
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
        for (int n = 0; n < 45; n++) {
            steps(world, 1, 1.0 / 60);
            assert_under(statistics_of(world).p99_stretch, sheets[i].p99);
            assert_under(statistics_of(world).max_stretch, sheets[i].most);
        }
        skein_world_destroy(world);
    }
}

/* Sheets whose cells are longer one way, with coarse grids and (45 x 45) without. With the shear springs swept in one
 * direction only they shiver: 5.6 to 14 % at the 99th percentile, 15 to 43 % at most. */
static void longer_cells_are_as_firm(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const sheet sheets[] = {{61, 53, 1.2, 1, 1e-5, 0.01, 0.03},
                                   {53, 61, 1, 1.2, 1e-5, 0.01, 0.03},
                                   {64, 64, 2, 1, 1e-5, 0.01, 0.03},
                                   {64, 64, 1, 1.5, 1e-5, 0.01, 0.03},
                                   {45, 45, 1.5, 1, 1e-5, 0.02, 0.04},
                                   {100, 20, 0.2, 1, 1e-5, 0.017, 0.03}}; // lies the other way round, else 4.3 % at most
    stay_firm(sheets, COUNT(sheets));
}

/* Bending that is too stiff for the substep to wait (rigidity, or small cells) is swept forth and back: in one order these
 * shivered, by 17 and by 36 % at the largest. */
static void stiff_bending_does_not_shiver(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const sheet sheets[] = {{100, 64, 0.5, 0.5, 1e-4, 0.03, 0.05}, {128, 128, 1, 1, 1e-3, 0.01, 0.03}};
    stay_firm(sheets, COUNT(sheets));
}

static double time_of_swing(uint32_t side, int substeps, double limit) {
    return time_of_swing_of(swinging(side, substeps, 0, limit), (size_t)side * side, -0.5);
}

static void a_swing_keeps_its_time(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    double few = time_of_swing(SIDE, 10, INFINITY), many = time_of_swing(SIDE, 60, INFINITY),
           limited = time_of_swing(SIDE, 10, 0.005);
    assert_true(many > 1 && many < 2);
    assert_near(few, many, 0.02 * many);
    assert_near(limited, many, 0.02 * many); // a strain limit is one-sided, and takes no time either
}

static const uint32_t sides[] = {20, 40, 80};
static const int few_or_many[] = {5, 10, 20}; // substeps

static void a_swing_takes_the_same_time_at_any_size(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    double middle = time_of_swing(40, 10, INFINITY);
    for (size_t i = 0; i < COUNT(sides); i++)
        for (size_t k = 0; k < COUNT(few_or_many); k++)
            assert_share(time_of_swing(sides[i], few_or_many[k], INFINITY), middle, 0.005);
}

/* Where its tethers hold a sheet by four corners, its middle is (1 + slack) d from each of them, d being half a diagonal: it sags
 * by d sqrt((1 + slack)^2 - 1), at any resolution and with any number of substeps. */
static void a_sag_is_that_of_the_tethers(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    const double slack = 0.003, ought = sqrt(0.5 * ((1 + slack) * (1 + slack) - 1));
    for (size_t i = 0; i < COUNT(sides); i++)
        for (size_t k = 0; k < COUNT(few_or_many); k++) {
            skein_world *world = new_world("xpbd", few_or_many[k]);
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", sides[i], sides[i]), SKEIN_TEXT("pins", "corners"),
                                             SKEIN_REAL("stretch.stiffness", 200), SKEIN_REAL("shear.stiffness", 20),
                                             SKEIN_REAL("stretch.tether", slack)),
                              NULL));
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 4)), NULL));
            steps(world, 300, 1.0 / 60);
            double lowest = 0;
            for (size_t p = 0; p < sides[i] * sides[i]; p++) lowest = fmin(lowest, position_of(world, p).y);
            assert_share(-lowest, ought, 0.05);
            skein_world_destroy(world);
        }
}

/* Free sheets, whose margins beyond the coarse grids differ, are thrown apart. What is symmetric need not be: shares of
 * corrections by anything but the masses carried along gave such a sheet 2 to 9 % of what it had. */
static void nothing_gains_momentum(void **state) {
    (void)state;
    static const int grids[][2] = {{53, 100}, {64, 70}};
    for (size_t i = 0; i < COUNT(grids); i++) {
        skein_world *world = new_world("xpbd", 10);
        OK(world,
           skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", grids[i][0], grids[i][1])), NULL));
        assert_true(has_coarse_grids(world));
        size_t count = skein_particle_count(world);
        double *v = malloc(3 * count * sizeof *v), all = 0;
        for (size_t k = 0; k < count; k++) {
            vec3 x = position_of(world, k);
            v[3 * k] = 3 * x.x + 2 * x.x * x.x, v[3 * k + 1] = sin(7 * x.x) + 2 * x.z, v[3 * k + 2] = 2 * x.z + x.x;
            all += fabs(v[3 * k]) * 0.2 / (double)count;
        }
        OK(world, skein_velocities_set(world, 0, count, v));
        skein_statistics before = statistics_of(world);
        steps(world, 20, 1.0 / 60);
        skein_statistics after = statistics_of(world);
        for (int k = 0; k < 3; k++) assert_near(after.momentum[k], before.momentum[k], 1e-4 * all);
        for (int k = 0; k < 3; k++) assert_near(after.angular_momentum[k], before.angular_momentum[k], 0.02 * all);
        assert_true(after.kinetic_energy < before.kinetic_energy);
        free(v);
        skein_world_destroy(world);
    }
}

/* Stiff bending in every second substep: its move is a velocity for two of them, and must not lead beyond. A sheet that
 * was shaken gains nothing. */
static void seldom_bending_gains_nothing(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 24, 24), SKEIN_REAL("bend.rigidity", 0.1)), NULL));
    size_t count = skein_particle_count(world);
    double v[3 * 24 * 24];
    for (size_t i = 0; i < 3 * count; i++) v[i] = i % 3 == 1 ? 0.2 * sin(1.7 * (double)i) : 0;
    OK(world, skein_velocities_set(world, 0, count, v));
    double most = 0, first = statistics_of(world).kinetic_energy;
    for (int n = 0; n < 40; n++) {
        steps(world, 1, 1.0 / 60);
        most = fmax(most, statistics_of(world).kinetic_energy);
    }
    assert_under(most, first); // with twice the stiffness and no more 6,000 times as much
    skein_world_destroy(world);
}

/* Folds run to the one point that a sheet hangs by. With springs for diagonals cells cannot fold, and sheets jam there: 5.9, 8.3
 * and 4.5 % at the 99th percentile, 32, 44 and 18 at most. */
static void a_cloth_that_hangs_by_a_point_is_firm(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    static const struct {
        const char *pins, *diagonals;
        double p99;
    } sheets[] = {{"sphere -0.5 0 -0.5 0.001", "pins", 0.03},
                  {"sphere 0 0 0 0.012", "pins", 0.05},
                  {"sphere -0.5 0 -0.5 0.001, sphere 0.5 0 0.5 0.001", "ties", 0.02}};
    for (size_t i = 0; i < COUNT(sheets); i++) {
        skein_world *world = new_world("xpbd", 10);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_TEXT("pins", sheets[i].pins),
                                                SKEIN_TEXT("shear.diagonals", sheets[i].diagonals)),
                                 NULL));
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
        for (int n = 0; n < 100; n++) {
            steps(world, 1, 1.0 / 60);
            assert_under(statistics_of(world).p99_stretch, sheets[i].p99);
        }
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_cloth_that_swings_is_firm),   cmocka_unit_test(longer_cells_are_as_firm),
        cmocka_unit_test(stiff_bending_does_not_shiver), cmocka_unit_test(a_cloth_that_hangs_by_a_point_is_firm),
        cmocka_unit_test(a_swing_keeps_its_time),        cmocka_unit_test(a_swing_takes_the_same_time_at_any_size),
        cmocka_unit_test(a_sag_is_that_of_the_tethers),  cmocka_unit_test(nothing_gains_momentum),
        cmocka_unit_test(seldom_bending_gains_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
