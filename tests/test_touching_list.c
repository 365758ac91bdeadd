/* Contacts of surfaces as a program reads them, and pairs of bodies that are said not to meet. */
#include "helpers.h"

static const double dt = 1.0 / 60;

static skein_handle add_sheet(skein_world *world, const char *name, double y, const char *pins) {
    skein_handle body;
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", name), SKEIN_PAIR("grid", 6, 6), SKEIN_PAIR("size", 0.3, 0.3),
                                     SKEIN_VEC3("position", 0.011, y, 0.007), SKEIN_TEXT("pins", pins)),
                      &body));
    return body;
}

static skein_world *two_sheets(const char *ignore, double apart) {
    skein_world *world = new_world("xpbd", 10);
    add_gravity(world);
    OK(world, skein_force_add(world, "contact",
                              SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01), SKEIN_TEXT("ignore", ignore)), NULL));
    add_sheet(world, "low", 0, "box -1 -1 -1 1 1 1");
    add_sheet(world, "high", apart, "");
    return world;
}

/* Every pair says where it touches: weights and normal belong to the places, and no pair of the two sheets is missing, by
 * brute force over vertices and triangles. */
static void contacts_are_as_the_places_say(void **state) {
    (void)state;
    enum { MOST = 4096 };
    static skein_surface_contact list[MOST];
    static const double apart[] = {0.009, 0.02};
    for (int far = 0; far < 2; far++) {
        skein_world *world = two_sheets("", apart[far]);
        size_t count, again, corners = 0, edges = 0;
        OK(world, skein_surface_contacts_copy(world, list, MOST, &count));
        assert_true(count < MOST);
        if (far) assert_int_equal(count, 0);
        for (size_t i = 0; i < count; i++) {
            double way[3] = {0, 0, 0}, sum = 0;
            for (int c = 0; c < 4; c++) {
                vec3 p = position_of(world, list[i].particle[c]);
                way[0] += list[i].weight[c] * p.x, way[1] += list[i].weight[c] * p.y, way[2] += list[i].weight[c] * p.z;
                sum += list[i].weight[c];
            }
            assert_under(sum, 1e-5);
            assert_near(way[0] * list[i].normal[0] + way[1] * list[i].normal[1] + way[2] * list[i].normal[2],
                        list[i].gap, 1e-5);
            assert_near(list[i].gap, apart[far], 1e-5);
            assert_near(fabs(list[i].normal[1]), 1, 1e-5);
            assert_near(list[i].thickness, 0.01, 1e-6);
            assert_string_equal(skein_object_kind(world, list[i].rule)->name, "contact");
            corners += !list[i].edges, edges += list[i].edges;
        }
        // each vertex of one lies on a vertex of the other: it meets all triangles around that, up to six, and no other
        uint64_t met[72] = {0};
        for (size_t i = 0; i < count; i++)
            if (!list[i].edges) met[list[i].particle[0]]++;
        for (int v = 0; v < 72; v++) assert_true(far ? !met[v] : met[v] >= 1 && met[v] <= 6);
        OK(world, skein_surface_contacts_copy(world, NULL, 0, &again));
        assert_int_equal(count, again);
        if (!far) assert_true(corners && edges);
        skein_world_destroy(world);
    }
}

/* Asking changes no bit of what comes. */
static void asking_changes_nothing(void **state) {
    (void)state;
    double x[2][3 * 72];
    for (int asks = 0; asks < 2; asks++) {
        skein_world *world = two_sheets("", 0.03);
        for (int n = 0; n < 30; n++) {
            size_t count;
            steps(world, 1, dt);
            if (asks) OK(world, skein_surface_contacts_copy(world, NULL, 0, &count));
            if (asks && n == 29) assert_true(count > 0);
        }
        OK(world, skein_positions_copy(world, 0, 72, x[asks]));
        skein_world_destroy(world);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
}

static double height_after_a_fall(const char *ignore) {
    skein_world *world = two_sheets(ignore, 0.03);
    steps(world, 40, dt);
    double y = position_of(world, 36 + 14).y;
    skein_world_destroy(world);
    return y;
}

/* A sheet falls onto one that is held, and lies on it; or through it, as if it were not there. */
static void who_is_ignored_is_not_met(void **state) {
    (void)state;
    double t = 40 * dt, fallen = 0.03 - 0.5 * 9.81 * t * t;
    assert_near(height_after_a_fall(""), 0.01, 0.002);
    assert_near(height_after_a_fall("high:high, low"), 0.01, 0.002);
    assert_near(height_after_a_fall("low:high"), fallen, 0.05);
    assert_near(height_after_a_fall("low:low,high : low"), fallen, 0.05);
    // without the other it is the same, to the bit
    skein_world *alone = new_world("xpbd", 10), *world = two_sheets("low:high", 0.03);
    add_gravity(alone);
    OK(alone, skein_force_add(alone, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01)), NULL));
    add_sheet(alone, "high", 0.03, "");
    steps(alone, 40, dt), steps(world, 40, dt);
    for (size_t p = 0; p < 36; p++)
        assert_under(length3(minus(position_of(alone, p), position_of(world, 36 + p))), 1e-5);
    skein_world_destroy(alone), skein_world_destroy(world);
}

static void names_that_are_not_there_are_said(void **state) {
    (void)state;
    skein_world *world = two_sheets("low:hihg", 0.03);
    FAILS(world, SKEIN_ERROR_NAME, "did you mean 'high'", skein_world_step(world, dt));
    skein_handle rule = skein_object_at(world, SKEIN_FORCE, 1);
    OK(world, skein_set(world, rule, "ignore", skein_text("low:high")));
    steps(world, 1, dt);
    size_t count;
    OK(world, skein_set(world, rule, "enabled", skein_number(0)));
    OK(world, skein_surface_contacts_copy(world, NULL, 0, &count));
    assert_int_equal(count, 0);
    skein_world_destroy(world);
}

/* A pair without one of its names says nothing, and is refused where it is said. */
static void pairs_have_two_names(void **state) {
    (void)state;
    static const struct {
        const char *ignore, *words;
    } wrong[] = {
        {"low:", "'low:': a name is missing behind the colon"},
        {"low, :high", "':high': a name is missing before the colon"},
        {" : ,low", "':': a name is missing before the colon"},
        {"low:high: low", "'low:high: low': expected two names"},
    };
    skein_world *world = two_sheets("low:high,", 0.03);
    skein_handle rule = skein_object_at(world, SKEIN_FORCE, 1);
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const size_t rules = skein_object_count(world, SKEIN_FORCE);
        skein_value kept;
        FAILS(world, SKEIN_ERROR_VALUE, wrong[i].words, skein_set(world, rule, "ignore", skein_text(wrong[i].ignore)));
        OK(world, skein_get(world, rule, "ignore", &kept));
        assert_string_equal(kept.text, "low:high,");
        FAILS(world, SKEIN_ERROR_VALUE, wrong[i].words,
              skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_TEXT("ignore", wrong[i].ignore)), NULL));
        assert_string_equal(skein_world_error(world)->where, "ignore");
        assert_int_equal(skein_object_count(world, SKEIN_FORCE), rules);
    }
    steps(world, 1, dt);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(contacts_are_as_the_places_say), cmocka_unit_test(asking_changes_nothing),
        cmocka_unit_test(who_is_ignored_is_not_met), cmocka_unit_test(names_that_are_not_there_are_said),
        cmocka_unit_test(pairs_have_two_names)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
