/* Sheets that begin through solids, or through each other, as chance has it: they come apart. Crossings are counted by ourselves. */
#include "crossings.h"

static uint64_t seed;

static double some(double least, double most) {
    return random_between(&seed, least, most);
}

static skein_world *begin_world(int number, bool falls) {
    seed = 7919 * (uint64_t)number + 5;
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 4 + number % 8))));
    OK(world, skein_force_add(world, "contact", NULL, NULL));
    if (falls) {
        add_gravity(world);
        OK(world, skein_collider_add(world, "plane",
                                     SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5), SKEIN_REAL("offset", -0.3)), NULL));
    }
    return world;
}

static void add_sheet(skein_world *world, int side, double width, double across, const char *pins) {
    const double x = some(-across, across), y = 0.5 + some(-across, across), z = some(-across, across);
    const double pitch = some(-90, 90), yaw = some(-90, 90);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_PAIR("size", width, width),
                                            SKEIN_VEC3("position", x, y, z), SKEIN_VEC3("rotation", pitch, yaw, 0),
                                            SKEIN_TEXT("pins", pins)),
                             NULL));
}

/* Whether they do, and stay so; they have no more energy by then than that, J, where nothing moved. */
static bool come_apart(skein_world *world, int number, bool falls, double most) {
    enum { MOST = 150, AFTER = 20 };
    if (!crossings_of(world)) fail_msg("pair %d does not begin in each other", number);
    int frames = 0;
    for (; frames < MOST && crossings_of(world) > 0; frames++) steps(world, 1, 1.0 / 60);
    const bool apart = frames < MOST;
    const double energy = statistics_of(world).kinetic_energy;
    if (apart && !falls && energy > most) fail_msg("pair %d: %g J where nothing moved", number, energy);
    if (apart) steps(world, AFTER, 1.0 / 60);
    if (apart && crossings_of(world) > 0)
        fail_msg("pair %d: %zu crossings, once it was apart", number, crossings_of(world));
    skein_world_destroy(world);
    return apart;
}

static void sheets_leave_solids(void **state) {
    (void)state;
    enum { PAIRS = 16 };
    int stay = 0;
    for (int number = 0; number < PAIRS; number++) {
        if (is_spared((size_t)number, 5)) continue;
        skein_world *world = begin_world(number, number % 2);
        const int side = (int)some(3, 9), threads = (int)some(10, 30);
        const double x = some(-0.1, 0.1), y = 0.5 + some(-0.1, 0.1), pitch = some(-60, 60), yaw = some(-60, 60),
                     mass = some(0.2, 3);
        OK(world, skein_body_add(world, "lattice", NULL,
                                 SKEIN_SETTINGS(SKEIN_VEC3("grid", side, side, side), SKEIN_VEC3("size", 0.3, 0.3, 0.3),
                                                SKEIN_REAL("mass", mass), SKEIN_VEC3("position", x, y, 0),
                                                SKEIN_VEC3("rotation", pitch, yaw, 0)),
                                 NULL));
        add_sheet(world, threads, 1, 0, number % 4 < 2 ? "corners" : "");
        stay += !come_apart(world, number, number % 2, 0.3);
    }
    assert_true(stay <= 1); // none today; it was one in four
}

/* Along a line that divides one of them or neither: each is led as a whole. (Where one is pinned, a few take longer than this.) */
static void sheets_leave_each_other(void **state) {
    (void)state;
    enum { PAIRS = 24 };
    int stay = 0;
    for (int number = 0; number < PAIRS; number++) {
        if (is_spared((size_t)number, 5)) continue;
        skein_world *world = begin_world(number, number % 2);
        const int first = (int)some(8, 30), second = (int)some(8, 30);
        add_sheet(world, first, some(0.5, 1), 0.1, "");
        add_sheet(world, second, 1, 0, "");
        stay += !come_apart(world, number, number % 2, 0.05);
    }
    assert_true(stay <= 2); // one today, which gravity pulls into folds; it was one in three
}

static void add_thrown(skein_world *world, int columns, int rows, double size, const char *fabric) {
    const double x = some(-0.4, 0.4), y = 0.2 + some(-0.3, 0.3), z = some(-0.3, 0.3), pitch = some(0, 360),
                 yaw = some(0, 360), roll = some(0, 360);
    const double u = some(-1, 1), v = some(-1, 1), w = some(-1, 1);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", columns, rows),
                                            SKEIN_PAIR("size", size * (columns - 1) / (rows - 1), size),
                                            SKEIN_VEC3("position", x, y, z), SKEIN_VEC3("velocity", u, v, w),
                                            SKEIN_VEC3("rotation", pitch, yaw, roll), SKEIN_TEXT("fabric", fabric)),
                             NULL));
}

/* They are led apart before they lie in one heap: nothing leads out of its folds. */
static void sheets_that_move_leave_each_other(void **state) {
    (void)state;
    enum { PAIRS = 36 };
    int begun = 0, stay = 0;
    for (int number = 0; number < PAIRS; number++) {
        if (is_spared((size_t)number, 5)) continue;
        skein_world *world = begin_world(number, true);
        add_thrown(world, 45, 29, 0.7, "wool");
        add_thrown(world, 24, 24, 0.6, "silk");
        if (!crossings_of(world)) skein_world_destroy(world);
        else begun++, stay += !come_apart(world, number, true, 0);
    }
    if ((PLAIN && begun < 10) || stay > 2) fprintf(stderr, "%d of %d stay\n", stay, begun);
    assert_true(begun >= (PLAIN ? 10 : 1));
    assert_true(stay <= 2); // one at most today, in both precisions; it was six
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(sheets_leave_solids), cmocka_unit_test(sheets_leave_each_other),
                                       cmocka_unit_test(sheets_that_move_leave_each_other)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
