/* Tests of what the world lists for those who draw: springs with their strain, contacts, texture coordinates. */
#include "helpers.h"

/* Three particles in a row, one metre apart, with a spring between the first two and one between the ends. */
static skein_world *two_springs(skein_handle *rule) {
    skein_world *world = skein_world_create(NULL, NULL);
    const double positions[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0}, masses[3] = {1, 1, 1};
    const uint32_t pairs[4] = {0, 1, 2, 0};
    OK(world, skein_particles_add(world, 3, positions, NULL, masses, NULL));
    OK(world, skein_constraint_add(world, "distance", pairs, 2, NULL, rule));
    return world;
}

static void springs_tell_their_strain(void **state) {
    (void)state;
    skein_handle rule;
    skein_world *world = two_springs(&rule);
    skein_spring springs[3] = {{{7, 7}, 7, true}, {{7, 7}, 7, true}, {{7, 7}, 7, true}};
    size_t count = 0;
    OK(world, skein_springs_copy(world, springs, 3, &count));
    assert_int_equal(count, 2);
    assert_int_equal(springs[0].particle[0], 0);
    assert_int_equal(springs[0].particle[1], 1);
    assert_int_equal(springs[1].particle[0], 2);
    assert_int_equal(springs[1].particle[1], 0);
    assert_true(springs[0].strain == 0 && springs[1].strain == 0 && springs[0].measured);

    // the first grows by a quarter, the other shrinks by three eighths
    const double moved[9] = {0, 0, 0, 0, 1.25, 0, 0, 0, -1.25};
    OK(world, skein_positions_set(world, 0, 3, moved));
    OK(world, skein_springs_copy(world, springs, 3, &count));
    assert_near(springs[0].strain, 0.25, 1e-6);
    assert_near(springs[1].strain, -0.375, 1e-6);

    // less room than springs: what there is room for; a disabled rule has none
    springs[1].strain = 7;
    OK(world, skein_springs_copy(world, springs, 1, &count));
    assert_int_equal(count, 2);
    assert_true(springs[1].strain == 7);
    OK(world, skein_springs_copy(world, NULL, 0, &count));
    assert_int_equal(count, 2);
    OK(world, skein_set(world, rule, "enabled", skein_number(0)));
    OK(world, skein_springs_copy(world, NULL, 0, &count));
    assert_int_equal(count, 0);
    skein_world_destroy(world);
}

/* The longest of the list is the statistics' stretch, also where there are more than one block of them. */
static void springs_agree_with_the_statistics(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 20, 30), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("shear.stiffness", 0), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 0)),
                             NULL));
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    for (int i = 0; i < 20; i++) OK(world, skein_world_step(world, SKEIN_DEFAULT_STEP));
    skein_statistics now;
    OK(world, skein_world_statistics(world, &now));
    size_t count = 0;
    OK(world, skein_springs_copy(world, NULL, 0, &count));
    assert_int_equal(count, now.constraints);
    skein_spring *springs = calloc(count, sizeof *springs);
    OK(world, skein_springs_copy(world, springs, count, &count));
    size_t found = 0, edges = 0;
    for (size_t i = 0; i < count; i++) edges += springs[i].measured;
    assert_int_equal(edges, 19 * 30 + 20 * 29);
    for (size_t i = 0; i < count; i++)
        found += springs[i].measured && (double)springs[i].strain == (double)(float)now.max_stretch;
    assert_true(found >= 1);
    free(springs);
    skein_world_destroy(world);
}

static void contacts_are_listed(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle ball, floor;
    // thirty that touch nothing, then four
    const double positions[12] = {0, 1.5, 0, 0, 0.005, 3, 5, 5, 5, 0.995, 1, 0}, masses[4] = {1, 1, 1, 1};
    for (int i = 0; i < 30; i++) OK(world, skein_particles_add(world, 1, &positions[6], NULL, masses, NULL));
    OK(world, skein_particles_add(world, 4, positions, NULL, masses, NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01)), &floor));
    OK(world, skein_collider_add(
                  world, "sphere",
                  SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 1, 0), SKEIN_REAL("radius", 1), SKEIN_REAL("thickness", 0.01)),
                  &ball));
    skein_contact contacts[4];
    size_t count = 0;
    OK(world, skein_contacts_copy(world, contacts, 4, &count));
    assert_int_equal(count, 3);
    assert_true(contacts[0].particle == 31 && contacts[0].collider.index == floor.index);
    assert_near(contacts[0].gap, 0.005, 1e-6);
    assert_near(contacts[0].normal[1], 1, 1e-6);
    // half a metre deep in the ball, and a little deep
    assert_true(contacts[1].particle == 30 && contacts[1].collider.index == ball.index);
    assert_near(contacts[1].gap, -0.5, 1e-6);
    assert_near(contacts[1].normal[1], 1, 1e-6);
    assert_true(contacts[2].particle == 33);
    assert_near(contacts[2].gap, -0.005, 1e-6);
    assert_near(contacts[2].normal[0], 1, 1e-6);

    skein_statistics now;
    OK(world, skein_world_statistics(world, &now));
    assert_int_equal(now.contacts, count);
    contacts[1].particle = 77;
    OK(world, skein_contacts_copy(world, contacts, 1, &count));
    assert_int_equal(count, 3);
    assert_int_equal(contacts[1].particle, 77);
    OK(world, skein_set(world, ball, "enabled", skein_number(0)));
    OK(world, skein_contacts_copy(world, contacts, 4, &count));
    assert_int_equal(count, 1);
    skein_world_destroy(world);
}

static void texture_coordinates_are_kept(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    const double positions[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const uint32_t sizes[2] = {3, 3}, corners[6] = {0, 1, 2, 0, 2, 3};
    const skein_mesh mesh = {positions, 4, sizes, 2, corners, 6};
    skein_handle body;
    skein_surface surface;
    OK(world, skein_body_add(world, "cloth", &mesh, NULL, &body));
    OK(world, skein_body_surface(world, body, &surface));
    assert_null(surface.corner_uv);

    float uv[12] = {0, 0, 1, 0, 1, 1, 0.5f, 0, 1, 1, 0, 1};
    OK(world, skein_body_uv_set(world, body, uv, 6));
    OK(world, skein_body_surface(world, body, &surface));
    assert_memory_equal(surface.corner_uv, uv, sizeof uv);
    FAILS(world, SKEIN_ERROR_VALUE, "4 corners", skein_body_uv_set(world, body, uv, 4));
    FAILS(world, SKEIN_ERROR_VALUE, "7 corners", skein_body_uv_set(world, body, uv, 7));
    uv[7] = NAN;
    FAILS(world, SKEIN_ERROR_VALUE, "corner 3", skein_body_uv_set(world, body, uv, 6));
    FAILS(world, SKEIN_ERROR_HANDLE, "no such body",
          skein_body_uv_set(world, (skein_handle){.index = 9, .generation = 9}, uv, 6));
    OK(world, skein_body_surface(world, body, &surface));
    assert_true(surface.corner_uv[7] == 0);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(springs_tell_their_strain),
        cmocka_unit_test(springs_agree_with_the_statistics),
        cmocka_unit_test(contacts_are_listed),
        cmocka_unit_test(texture_coordinates_are_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
