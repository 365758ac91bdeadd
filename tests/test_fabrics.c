/* Fabrics: a word for a cloth's numbers. What is said itself counts, wherever it stands; and the numbers mean what their
 * sources mean by them. */
#include "helpers.h"

static const char *const fabrics[] = {"cotton", "silk", "denim", "wool", "felt", "rubber", "paper"};
static const char *const numbers[] = {"density", "stretch.stiffness", "shear.stiffness", "bend.rigidity"};

static double number_of(const skein_world *world, skein_handle body, const char *field) {
    skein_value value;
    OK(world, skein_get(world, body, field, &value));
    return value.number[0];
}

static skein_handle add_sheet(skein_world *world, const skein_setting *more) {
    skein_setting settings[8] = {SKEIN_PAIR("grid", 9, 9)};
    skein_handle body;
    for (size_t i = 0; more && more[i].name; i++) settings[i + 1] = more[i];
    OK(world, skein_body_add(world, "cloth", NULL, settings, &body));
    return body;
}

/* In the ranges that anything of the sort has, and no two alike; none is what there was before. */
static void each_fabric_has_numbers_of_its_own(void **state) {
    (void)state;
    static const double least[] = {0.03, 300, 5, 1e-6}, most[] = {1, 1e6, 5e5, 1e-3};
    double seen[COUNT(fabrics) + 1][COUNT(numbers)];
    for (size_t f = 0; f <= COUNT(fabrics); f++) {
        skein_world *world = new_world("xpbd", 1);
        skein_handle body = add_sheet(world, f < COUNT(fabrics) ? SKEIN_SETTINGS(SKEIN_TEXT("fabric", fabrics[f])) : NULL);
        for (size_t n = 0; n < COUNT(numbers); n++) {
            seen[f][n] = number_of(world, body, numbers[n]);
            assert_true(seen[f][n] >= least[n] && seen[f][n] <= most[n]);
            for (size_t other = 0; other < f && f < COUNT(fabrics); other++) assert_true(seen[other][n] != seen[f][n]);
        }
        // a square metre weighs its density
        double mass = 0;
        for (size_t i = 0; i < 81; i++) {
            skein_view v = skein_velocity_view(world);
            mass += (double)v.xyzw[4 * (size_t)v.slot_of[i] + 3];
        }
        assert_share(mass, seen[f][0], 100 * EPSILON);
        // what stretches is not tethered
        bool rubber = f < COUNT(fabrics) && !strcmp(fabrics[f], "rubber");
        assert_true(isinf(number_of(world, body, "stretch.tether")) == rubber);
        skein_world_destroy(world);
    }
    static const double before[] = {0.2, 2e4, 2e3, 1e-5};
    for (size_t n = 0; n < COUNT(numbers); n++) assert_true(seen[COUNT(fabrics)][n] == before[n]);
}

static void what_is_said_itself_counts(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    skein_handle denim = add_sheet(world, SKEIN_SETTINGS(SKEIN_TEXT("fabric", "denim")));
    skein_handle first = add_sheet(world, SKEIN_SETTINGS(SKEIN_REAL("density", 0.5), SKEIN_TEXT("fabric", "denim")));
    skein_handle last = add_sheet(world, SKEIN_SETTINGS(SKEIN_TEXT("fabric", "denim"), SKEIN_REAL("density", 0.5)));
    for (size_t i = 0; i < 2; i++) {
        skein_handle body = i ? last : first;
        assert_true(number_of(world, body, "density") == 0.5);
        for (size_t n = 1; n < COUNT(numbers); n++)
            assert_true(number_of(world, body, numbers[n]) == number_of(world, denim, numbers[n]));
    }
    // of two words the last one counts, as it does of two numbers
    skein_handle two = add_sheet(world, SKEIN_SETTINGS(SKEIN_TEXT("fabric", "silk"), SKEIN_TEXT("fabric", "denim")));
    assert_true(number_of(world, two, "density") == number_of(world, denim, "density"));
    // it weighs what it was built with
    FAILS(world, SKEIN_ERROR_VALUE, "shapes", skein_set(world, denim, "fabric", skein_text("silk")));
    FAILS(world, SKEIN_ERROR_VALUE, "denim", skein_body_add(world, "cloth", NULL,
                                                            SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("fabric", "jute")), NULL));
    OK(world, skein_set(world, denim, "stretch.stiffness", skein_number(1e3)));
    assert_true(number_of(world, denim, "stretch.stiffness") == 1e3);
    skein_world_destroy(world);
}

/* Sheared by gamma, a square metre holds G gamma^2 / 2; stretched by e along its threads, E e^2 / 2: what the sources
 * measure is what the fields mean. */
static void stiffness_is_that_of_the_sheet(void **state) {
    (void)state;
    const double gamma = 0.02;
    for (size_t f = 0; f < COUNT(fabrics); f++)
        for (int shears = 0; shears < 2; shears++) {
            skein_world *world = new_world("xpbd", 1);
            skein_handle body = add_sheet(world, SKEIN_SETTINGS(SKEIN_TEXT("fabric", fabrics[f]), SKEIN_REAL("bend.rigidity", 0),
                                                                SKEIN_REAL(shears ? "stretch.stiffness" : "shear.stiffness", 0)));
            for (size_t i = 0; i < 81; i++) {
                vec3 p = position_of(world, i);
                place_particle(world, i, p.x + gamma * (shears ? p.z : p.x), p.y, p.z);
            }
            double stiffness = number_of(world, body, shears ? "shear.stiffness" : "stretch.stiffness");
            assert_share(statistics_of(world).elastic_energy, stiffness * gamma * gamma / 2, 0.02);
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fabric_has_numbers_of_its_own),
        cmocka_unit_test(what_is_said_itself_counts),
        cmocka_unit_test(stiffness_is_that_of_the_sheet),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
