/* Solids that begin in each other, as deep as chance has it: they come apart, and do not fly off. Crossings are counted by
 * ourselves. */
#include "crossings.h"

static uint64_t seed;

static double some(double least, double most) {
    return random_between(&seed, least, most);
}

static void add_some_cube(skein_world *world, double height) {
    const int side = (int)some(3, 9);
    const double across = height > 0.4 ? 0.1 : 0, x = some(-across, across), z = some(-across, across);
    const double pitch = some(-60, 60), yaw = some(-60, 60);
    OK(world, skein_body_add(world, "lattice", NULL,
                             SKEIN_SETTINGS(SKEIN_VEC3("grid", side, side, side), SKEIN_VEC3("size", 0.3, 0.3, 0.3),
                                            SKEIN_REAL("mass", 1), SKEIN_VEC3("position", x, height, z),
                                            SKEIN_VEC3("rotation", pitch, yaw, 0)),
                             NULL));
}

/* Returns how long they took, in frames; they have no more energy by then than that, J, where nothing moved. (At 0.4 m/s, as they are led,
 * both would have 0.16; where forces alone act, springs that are led together push back.) */
static int come_apart(const char *method, int substeps, double thickness, double most, bool falls, int number) {
    enum { MOST = 120, AFTER = 30 };
    seed = 7919 * (uint64_t)number + 3;
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
    if (falls) {
        add_gravity(world);
        OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5), SKEIN_REAL("offset", -0.1)), NULL));
    }
    add_some_cube(world, 0.4);
    add_some_cube(world, 0.4 + 0.35 * (1 - some(0.1, 0.7)));
    assert_true(crossings_of(world) > 0);
    int frames = 0;
    for (; frames < MOST && crossings_of(world) > 0; frames++) steps(world, 1, 1.0 / 60);
    if (crossings_of(world) > 0) fail_msg("pair %d, %s: %zu crossings after %d frames", number, method, crossings_of(world), frames);
    const double energy = statistics_of(world).kinetic_energy;
    if (!falls && energy > most) fail_msg("pair %d, %s: %g J where nothing moved", number, method, energy);
    for (int f = 0; f < AFTER; f++) steps(world, 1, 1.0 / 60);
    assert_int_equal(crossings_of(world), 0); // and stay so
    skein_world_destroy(world);
    return frames;
}

static void cubes_come_apart(void **state) {
    (void)state;
    enum { PAIRS = 24 };
    int longest = 0;
    for (int number = 0; number < PAIRS; number++) {
        const int frames = come_apart("xpbd", 4 + number % 8, 0.005, 0.16, number % 2, number);
        longest = frames > longest ? frames : longest;
    }
    assert_true(longest <= 60);
}

/* Where neighbours in contact would hold what is around a crossing, and are left out. */
static void fine_cubes_come_apart(void **state) {
    (void)state;
    enum { PAIRS = 12 };
    for (int number = 0; number < PAIRS; number++) come_apart("xpbd", 4 + number % 8, 0.012, 0.4, number % 2, number);
}

static void so_they_do_under_other_methods(void **state) {
    (void)state;
    enum { PAIRS = 4 };
    for (int number = 0; number < PAIRS; number++) {
        come_apart("pbd", 8, 0.005, 0.16, number % 2, number);
        come_apart("backward_euler", 4, 0.005, 1, number % 2, number);
        come_apart("symplectic_euler", 40, 0.005, 1, number % 2, number);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(cubes_come_apart), cmocka_unit_test(fine_cubes_come_apart),
                                       cmocka_unit_test(so_they_do_under_other_methods)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
