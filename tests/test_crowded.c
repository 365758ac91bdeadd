/* The warning of bodies that are too thick in contact for their edges (src/contact/make/crowded.c). */
#include "helpers.h"

static void note(void *user, skein_log_level level, const char *message) {
    char *text = user;
    assert_int_equal(level, SKEIN_LOG_WARNING);
    snprintf(text + strlen(text), 2048 - strlen(text), "%s\n", message);
}

static skein_world *world_with(char *text) {
    text[0] = '\0';
    skein_world_desc desc = skein_default_world_desc();
    desc.log = note, desc.log_user = text;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    return world;
}

/* A sheet with cells of `cell`, and edges of 1.14 of it in the mean, for of each three one goes across. */
static void add_sheet(skein_world *world, const char *name, double cell, double own, double height) {
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", name), SKEIN_PAIR("grid", 9, 9),
                                            SKEIN_PAIR("size", 8 * cell, 8 * cell),
                                            SKEIN_REAL("contact.thickness", own), SKEIN_VEC3("position", 0, height, 0)),
                             NULL));
}

static void add_contact(skein_world *world, double thickness) {
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
}

static void who_is_too_thick_is_told_of_once(void **state) {
    (void)state;
    char text[2048];
    skein_world *world = world_with(text);
    add_sheet(world, "coarse", 0.02, 0, 0);
    add_sheet(world, "fine", 0.005, 0, 1);
    add_contact(world, 0.005);
    steps(world, 2, 1.0 / 60);
    assert_string_equal(
        text, "contact: fine is 0.005 m thick, and its edges are 0.0057 m long in the mean: all of it is near dozens of "
              "others, which can take several times as long as a thickness of 0.001 m (its contact.thickness, or this "
              "force's thickness)\n");
    add_sheet(world, "finer", 0.004, 0, 2); // another skin: once is enough
    steps(world, 2, 1.0 / 60);
    assert_null(strstr(text, "finer"));
    skein_world_destroy(world);
}

/* What counts is a body's own thickness, where it has one. */
static void who_is_thin_is_not(void **state) {
    (void)state;
    char text[2048];
    skein_world *world = world_with(text);
    add_sheet(world, "thin", 0.005, 0.003, 0);
    add_sheet(world, "coarse", 0.01, 0, 1);
    add_contact(world, 0.006);
    steps(world, 2, 1.0 / 60);
    assert_string_equal(text, "");
    skein_world_destroy(world);
    world = world_with(text);
    add_sheet(world, "", 0.01, 0.02, 0);
    add_contact(world, 0.001);
    steps(world, 1, 1.0 / 60);
    assert_non_null(strstr(text, "contact: a body is 0.02 m thick"));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(who_is_too_thick_is_told_of_once),
                                       cmocka_unit_test(who_is_thin_is_not)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
