/* Fabrics: a word for a cloth's numbers. What is said itself counts, wherever it stands; and the numbers mean what their
 * sources mean by them. */
#include "helpers.h"

static const char *const fabrics[] = {"cotton", "silk", "denim", "wool", "felt", "rubber", "paper"};
static const char *const numbers[] = {"density", "stretch.stiffness", "shear.stiffness", "bend.rigidity",
                                      "contact.thickness"};

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
    static const double least[] = {0.03, 300, 5, 1e-6, 1e-4}, most[] = {1, 1e6, 5e5, 1e-3, 2e-3};
    double seen[COUNT(fabrics) + 1][COUNT(numbers)];
    for (size_t f = 0; f <= COUNT(fabrics); f++) {
        skein_world *world = new_world("xpbd", 1);
        skein_handle body =
            add_sheet(world, f < COUNT(fabrics) ? SKEIN_SETTINGS(SKEIN_TEXT("fabric", fabrics[f])) : NULL);
        for (size_t n = 0; n < COUNT(numbers); n++) {
            seen[f][n] = number_of(world, body, numbers[n]);
            if (f < COUNT(fabrics)) assert_true(seen[f][n] >= least[n] && seen[f][n] <= most[n]);
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
    static const double before[] = {0.2, 2e4, 2e3, 1e-5, 0};
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
    FAILS(world, SKEIN_ERROR_VALUE, "denim",
          skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_TEXT("fabric", "jute")),
                         NULL));
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
            skein_handle body =
                add_sheet(world, SKEIN_SETTINGS(SKEIN_TEXT("fabric", fabrics[f]), SKEIN_REAL("bend.rigidity", 0),
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

/* ---- in contact ---- */

/* A patch on a board that is held, both level, and gravity that pulls it on to the board and along x. */
typedef struct lying {
    skein_world *world;
    skein_handle patch;
    skein_surface surface;
} lying;

static lying lay(const skein_setting *board, const skein_setting *patch, double gap, double angle) {
    lying l = {.world = new_world("xpbd", 10)};
    const double radians = angle * 0.017453292519943295;
    skein_setting settings[2][8] = {
        {SKEIN_PAIR("grid", 9, 9), SKEIN_TEXT("pins", "all")},
        {SKEIN_PAIR("grid", 4, 4), SKEIN_PAIR("size", 0.15, 0.15), SKEIN_VEC3("position", -0.2, gap, 0.03)}};
    for (size_t i = 0; board[i].name; i++) settings[0][2 + i] = board[i];
    for (size_t i = 0; patch[i].name; i++) settings[1][3 + i] = patch[i];
    OK(l.world,
       skein_force_add(l.world, "gravity",
                       SKEIN_SETTINGS(SKEIN_VEC3("acceleration", 9.81 * sin(radians), -9.81 * cos(radians), 0)), NULL));
    OK(l.world, skein_force_add(l.world, "contact", NULL, NULL)); // which says nothing itself
    OK(l.world, skein_body_add(l.world, "cloth", NULL, settings[0], NULL));
    OK(l.world, skein_body_add(l.world, "cloth", NULL, settings[1], &l.patch));
    OK(l.world, skein_body_surface(l.world, l.patch, &l.surface));
    return l;
}

static vec3 middle_of(const lying *l) {
    vec3 sum = {0, 0, 0};
    for (size_t i = 0; i < 16; i++) {
        vec3 p = position_of(l->world, l->surface.first_particle + i);
        sum.x += p.x / 16, sum.y += p.y / 16, sum.z += p.z / 16;
    }
    return sum;
}

#define DENIM SKEIN_TEXT("fabric", "denim")
#define SILK SKEIN_TEXT("fabric", "silk")

/* What lies on another is as far from it as the mean of their thicknesses: a fabric's, one that is said, or the rule's. */
static void it_lies_as_thick_as_it_is(void **state) {
    (void)state;
    const struct {
        const skein_setting *board, *patch;
        double gap;
    } cases[] = {
        {SKEIN_SETTINGS(DENIM), SKEIN_SETTINGS(DENIM), 0.0009},
        {SKEIN_SETTINGS(DENIM), SKEIN_SETTINGS(SILK), (0.0009 + 0.00025) / 2},
        {SKEIN_SETTINGS(SKEIN_REAL("density", 0.2)), SKEIN_SETTINGS(DENIM), (0.005 + 0.0009) / 2},
        {SKEIN_SETTINGS(DENIM, SKEIN_REAL("contact.thickness", 0.003)), SKEIN_SETTINGS(DENIM), (0.003 + 0.0009) / 2},
        {SKEIN_SETTINGS(DENIM, SKEIN_REAL("contact.thickness", 0)), SKEIN_SETTINGS(DENIM), (0.005 + 0.0009) / 2},
        {SKEIN_SETTINGS(SKEIN_REAL("density", 0.2)), SKEIN_SETTINGS(SKEIN_REAL("density", 0.2)), 0.005},
    };
    for (size_t c = 0; c < COUNT(cases); c++) {
        lying l = lay(cases[c].board, cases[c].patch, 0.008, 0);
        steps(l.world, 60, 1.0 / 60);
        double y = middle_of(&l).y;
        if (fabs(y - cases[c].gap) > 0.03 * cases[c].gap) print_message("case %zu: %g, not %g\n", c, y, cases[c].gap);
        assert_share(y, cases[c].gap, 0.03);
        size_t count = 0;
        skein_surface_contact contact[64];
        OK(l.world, skein_surface_contacts_copy(l.world, contact, COUNT(contact), &count));
        assert_true(count > 0);
        for (size_t i = 0; i < count && i < COUNT(contact); i++) assert_share(contact[i].thickness, cases[c].gap, 1e-5);
        skein_world_destroy(l.world);
    }
}

/* On a slope of 20 degrees (tan 0.36) denim stays on denim (0.45), and silk slides on silk (0.25) by g (sin - mu cos) t^2/2;
 * silk on denim is between them (0.35), and slides slowly. */
static void it_slides_as_its_friction_says(void **state) {
    (void)state;
    const struct {
        const skein_setting *board, *patch;
        double gap, friction;
    } cases[] = {
        {SKEIN_SETTINGS(DENIM), SKEIN_SETTINGS(DENIM), 0.0009, 0.45},
        {SKEIN_SETTINGS(SILK), SKEIN_SETTINGS(SILK), 0.00025, 0.25},
        {SKEIN_SETTINGS(DENIM), SKEIN_SETTINGS(SILK), (0.0009 + 0.00025) / 2, 0.35},
        {SKEIN_SETTINGS(SILK, SKEIN_REAL("contact.friction", 0)),
         SKEIN_SETTINGS(SILK, SKEIN_REAL("contact.friction", 0.1)), 0.00025, 0.05},
    };
    for (size_t c = 0; c < COUNT(cases); c++) {
        const double angle = 20, radians = angle * 0.017453292519943295, t = 0.5;
        lying l = lay(cases[c].board, cases[c].patch, cases[c].gap, angle);
        double x = middle_of(&l).x;
        steps(l.world, 30, 1.0 / 60);
        double way = middle_of(&l).x - x, rate = 9.81 * fmax(sin(radians) - cases[c].friction * cos(radians), 0);
        if (fabs(way - rate * t * t / 2) > 0.012) print_message("case %zu: %g, not %g\n", c, way, rate * t * t / 2);
        assert_near(way, rate * t * t / 2, 0.012);
        skein_world_destroy(l.world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_fabric_has_numbers_of_its_own), cmocka_unit_test(what_is_said_itself_counts),
        cmocka_unit_test(stiffness_is_that_of_the_sheet),     cmocka_unit_test(it_lies_as_thick_as_it_is),
        cmocka_unit_test(it_slides_as_its_friction_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
