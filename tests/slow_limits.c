/* A limit of stretch is a contract: 1 % is kept to 1.1 by every edge of what has come to rest, from 16 x 16 to 256 x 256, from
 * 5,000 to 1,000,000 N/m, by grids and by irregular meshes that hang by two corners, and by meshes that hang by an edge; and to 64 x 64 by what
 * hangs by one point. tests/test_limits.c has the smaller ones. */
#include "helpers.h"
#include "irregular.h"

static const char corners[] = "sphere -0.5 0 -0.5 0.001, sphere 0.5 0 -0.5 0.001";

static const char edge[] = "box -1 -1 -0.501 1 1 -0.499";

static void keeps_its_limit(uint32_t side, double stiffness, bool mesh, const char *pins) {
    skein_world *world = new_world("xpbd", 10);
    if (mesh)
        add_irregular(world, side,
                      SKEIN_SETTINGS(SKEIN_TEXT("pins", pins), SKEIN_REAL("stretch.limit", 0.01),
                                     SKEIN_REAL("stretch.stiffness", stiffness)));
    else
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_REAL("stretch.limit", 0.01),
                                                SKEIN_TEXT("pins", pins), SKEIN_REAL("stretch.stiffness", stiffness)),
                                 NULL));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
    steps(world, 180, 1.0 / 60);
    skein_statistics s = statistics_of(world);
    print_message("%s %u x %u, %g N/m: at most %.3f %%, %.2g J\n", mesh ? "mesh" : "grid", side, side, stiffness,
                  100 * s.max_stretch, s.kinetic_energy);
    assert_true(s.limited > side * side);
    assert_int_equal(s.over_limit, 0);
    assert_true(s.max_stretch <= 0.011 + 1e-5 && s.kinetic_energy < 0.02);
    skein_world_destroy(world);
}

static void grids_keep_their_limit(void **state) {
    (void)state;
    static const uint32_t sides[] = {16, 64, 128, 256};
    for (size_t i = 0; i < COUNT(sides); i++)
        for (double stiffness = 5e3; stiffness < 2e6; stiffness *= 200)
            keeps_its_limit(sides[i], stiffness, false, corners);
}

static void meshes_keep_their_limit(void **state) {
    (void)state;
    static const uint32_t sides[] = {16, 64, 128, 200, 256};
    for (size_t i = 0; i < COUNT(sides); i++)
        for (double stiffness = 5e3; stiffness < 2e6; stiffness *= 200)
            keeps_its_limit(sides[i], stiffness, true, corners);
    for (size_t i = 1; i < COUNT(sides); i++) keeps_its_limit(sides[i], 5e3, true, edge);
}

/* All of its weight at one point, where folds run together: by a corner; by two below each other, of which the upper one bears all;
 * by a few points of its middle; by opposite corners. It begins upright, a little askew, and falls together. */
static void what_hangs_by_little_keeps_its_limit(void **state) {
    (void)state;
    static const double at[][2][2] = {
        {{-0.5, -0.5}, {-0.5, -0.5}}, {{-0.5, -0.5}, {-0.5, 0.5}}, {{0, 0}, {0, 0}}, {{-0.5, -0.5}, {0.5, 0.5}}};
    static const uint32_t sides[] = {16, 33, 64};
    const double a = 80 * PI / 180, b = 10 * PI / 180;
    for (int mesh = 0; mesh < 2; mesh++)
        for (size_t n = 0; n < COUNT(sides) * COUNT(at); n++) {
            const size_t p = n % COUNT(at);
            const uint32_t side = sides[n / COUNT(at)];
            const double stiffness = n % 2 ? 5e3 : 1e6;
            char pins[200];
            size_t size = 0;
            for (int k = 0; k < 2; k++) {
                const double x = at[p][k][0], z = at[p][k][1] * cos(a);
                size += (size_t)snprintf(pins + size, sizeof pins - size, "%ssphere %.9g %.9g %.9g %g", k ? ", " : "",
                                         x * cos(b) + z * sin(b), -at[p][k][1] * sin(a), z * cos(b) - x * sin(b),
                                         p == 2 ? 0.05 : 0.001);
            }
            skein_world *world = new_world("xpbd", 10);
            skein_setting settings[] = {SKEIN_TEXT("pins", pins),          SKEIN_REAL("stretch.limit", 0.01),
                                        SKEIN_VEC3("rotation", 80, 10, 0), SKEIN_REAL("stretch.stiffness", stiffness),
                                        SKEIN_PAIR("grid", side, side),    SKEIN_END};
            if (mesh) settings[4] = settings[5]; // which has its own
            if (mesh) add_irregular(world, side, settings);
            else OK(world, skein_body_add(world, "cloth", NULL, settings, NULL));
            add_gravity(world);
            OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
            steps(world, 300, 1.0 / 60);
            skein_statistics s = statistics_of(world);
            print_message("%s %u x %u, pins %zu: at most %.3f %%, %.2g J\n", mesh ? "mesh" : "grid", side, side, p,
                          100 * s.max_stretch, s.kinetic_energy);
            assert_true(s.max_stretch <= 0.011 + 1e-5 && s.kinetic_energy < 0.02);
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(grids_keep_their_limit),
                                       cmocka_unit_test(meshes_keep_their_limit),
                                       cmocka_unit_test(what_hangs_by_little_keeps_its_limit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
