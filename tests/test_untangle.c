/* Surfaces that begin in each other, or are driven through each other by pins: they come apart within a second, gain no
 * speed of it, and then keep apart. Crossings are counted by ourselves, over all edges and triangles. */
#include "crossings.h"

#include <skein/names.h>

enum { MOST_BODIES = 2 };

/* A world with contact, on so many threads; `recovery` below 0 leaves it at its default. */
static skein_world *world_on(int threads, const char *method, int substeps, double recovery) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    skein_handle contact;
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.004)), &contact));
    if (recovery >= 0) OK(world, skein_set(world, contact, "recovery", skein_number(recovery)));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    return world;
}

static skein_world *world_with_contact(const char *method, int substeps, double recovery) {
    return world_on(1, method, substeps, recovery);
}

static void add_sheet(skein_world *world, int side, double size, const double at[3], const double turned[3],
                      const char *pins) {
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_PAIR("size", size, size),
                                     SKEIN_VEC3("position", at[0], at[1], at[2]),
                                     SKEIN_VEC3("rotation", turned[0], turned[1], turned[2]), SKEIN_TEXT("pins", pins)),
                      NULL));
}

/* The corner of one sheet is through another one. */
static void corner_through(skein_world *world) {
    add_sheet(world, 24, 0.3, (double[]){0, 0.5, 0}, (double[]){0, 0, 0}, "");
    add_sheet(world, 22, 0.3, (double[]){0.21, 0.5, 0.19}, (double[]){20, 10, 30}, "");
}

/* Two soft cubes have a corner in each other. */
static void cubes_in_each_other(skein_world *world) {
    const double at[MOST_BODIES][3] = {{0, 0.3, 0}, {0.23, 0.47, 0.21}};
    for (int k = 0; k < MOST_BODIES; k++)
        OK(world,
           skein_body_add(world, "lattice", NULL,
                          SKEIN_SETTINGS(SKEIN_VEC3("grid", 6 - k, 6 - k, 6 - k), SKEIN_VEC3("size", 0.3, 0.3, 0.3),
                                         SKEIN_VEC3("position", at[k][0], at[k][1], at[k][2])),
                          NULL));
}

/* A hanging sheet whose folds are in each other. */
static void folds_through(skein_world *world) {
    add_sheet(world, 40, 0.7, (double[]){0, 1, 0}, (double[]){90, 0, 0}, "top edge");
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    for (size_t i = 0; i < skein_particle_count(world); i++) {
        vec3 p = position_of(world, i);
        double down = 1.35 - p.y, x[3] = {p.x + 0.17 * down * sin(p.x * 100), p.y, p.z + 0.085 * down * sin(p.x * 55)};
        OK(world, skein_positions_set(world, i, 1, x));
    }
}

typedef void start(skein_world *world);
static start *const starts[] = {corner_through, cubes_in_each_other, folds_through};

/* How many cross after so many frames; each frame has to be finite. */
static size_t crossings_after(skein_world *world, int frames) {
    crossing_search all = crossing_begin(world);
    size_t now = crossings_now(&all, world);
    for (int f = 0; f < frames; f++) steps(world, 1, 1.0 / 60);
    if (frames) now = crossings_now(&all, world);
    assert_int_equal(statistics_of(world).crossings > 0, now > 0);
    assert_int_equal(statistics_of(world).nonfinite, 0);
    crossing_free(&all);
    return now;
}

/* Each comes apart in a second and stays so, or in some with few substeps, in which no step is over a quarter of the
 * thickness; without recovery it does not. */
static void they_come_apart(void **state) {
    (void)state;
    static const int substeps[] = {4, 10}, frames[] = {180, 60};
    for (size_t s = 0; s < COUNT(starts); s++)
        for (size_t k = 0; k < COUNT(substeps); k++) {
            skein_world *world = world_with_contact("xpbd", substeps[k], -1);
            starts[s](world);
            assert_true(crossings_after(world, 0) > 10);
            size_t left = crossings_after(world, frames[k]);
            if (left) fail_msg("start %zu, %d substeps: %zu crossings are left", s, substeps[k], left);
            for (int f = 0; f < 20; f++) assert_int_equal(crossings_after(world, 1), 0);
            skein_world_destroy(world);
        }
    skein_world *world = world_with_contact("xpbd", 10, 0);
    starts[0](world);
    assert_true(crossings_after(world, 60) > 10);
    skein_world_destroy(world);
}

/* They gain no speed: without gravity and drag, what was led apart at 0.4 m/s is hardly moving. */
static void they_gain_no_speed(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "pbd", "backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = world_with_contact(methods[m], 10, -1);
        cubes_in_each_other(world);
        assert_int_equal(crossings_after(world, 60), 0);
        double fastest = 0;
        for (size_t i = 0; i < skein_particle_count(world); i++)
            fastest = fmax(fastest, length3(velocity_of(world, i)));
        if (fastest > 0.2) fail_msg("%s: %g m/s", methods[m], fastest);
        skein_world_destroy(world);
    }
}

/* What was clean has the same bits with recovery and without. */
static void what_is_clean_is_left_alone(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int k = 0; k < 2; k++) {
        skein_world *world = world_with_contact("xpbd", 10, k ? -1 : 0);
        add_sheet(world, 30, 0.4, (double[]){0, 0.35, 0}, (double[]){80, 10, 0}, "");
        OK(world, skein_force_add(world, "gravity", NULL, NULL));
        OK(world, skein_collider_add(world, "plane", NULL, NULL));
        assert_int_equal(crossings_after(world, 40), 0);
        hash[k] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

/* A state that is saved in the midst of it goes on as it would have, and so it does on more threads. */
static void it_needs_no_memory_of_its_own(void **state) {
    (void)state;
    skein_world *world = world_with_contact("xpbd", 4, -1);
    folds_through(world);
    assert_true(crossings_after(world, 1) > 0);
    size_t size = 0;
    void *saved = NULL;
    saved = malloc(skein_snapshot_size(world));
    OK(world, skein_snapshot_write(world, saved, skein_snapshot_size(world), &size));
    (void)crossings_after(world, 20);
    uint64_t hash = skein_world_hash(world);
    skein_world *other = world_on(3, "xpbd", 4, -1);
    folds_through(other);
    OK(other, skein_snapshot_read(other, saved, size));
    for (int f = 0; f < 20; f++) (void)crossings_after(other, 1); // counting leaves no trace
    assert_true(skein_world_hash(other) == hash);
    free(saved);
    skein_world_destroy(other);
    skein_world_destroy(world);
}

/* Three sheets that hang through each other, those that do not meet pressed flat on the ground, in one plane. */
static skein_world *pressed_in_one_plane(void) {
    static const char *const names[] = {"a", "b", "c"};
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 12))));
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    for (int b = 0; b < 3; b++)
        OK(world,
           skein_body_add(
               world, "cloth", NULL,
               SKEIN_SETTINGS(SKEIN_TEXT("name", names[b]), SKEIN_PAIR("grid", 9, 9), SKEIN_PAIR("size", 0.4, 0.4),
                              SKEIN_VEC3("position", 0.03 * b, 0.05 * b, 0.01 * b),
                              SKEIN_TEXT("pins", b == 1 ? "top corners" : ""), SKEIN_REAL("stretch.stiffness", 100),
                              SKEIN_REAL("shear.stiffness", 30), SKEIN_REAL("bend.stiffness", 0)),
               NULL));
    OK(world, skein_force_add(
                  world, "contact",
                  SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01), SKEIN_TEXT("ignore", "a:b, b:c, a:c, c, b")), NULL));
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.002, 0, 0), SKEIN_TEXT("on", "a, c")),
                              NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.02)), NULL));
    return world;
}

/* Edges that lie exactly on each other when they begin to meet: rounding chooses their sides, so that a world that went on and one
 * that was loaded once did not know the same of them. */
static void what_begins_without_a_gap_needs_no_memory(void **state) {
    (void)state;
    skein_world *world = pressed_in_one_plane(), *other = pressed_in_one_plane();
    for (int f = 0; f < 10; f++) OK(world, skein_world_step(world, 1.0 / 60));
    OK(world, skein_set_path(world, "forces.1.ignore", skein_text("a:b, a:c, a")));
    OK(world, skein_set_path(world, "forces.2.on", skein_text("b, c")));
    for (int f = 0; f < 10; f++) OK(world, skein_world_step(world, 1.0 / 60));
    size_t size = 0;
    void *saved = malloc(skein_snapshot_size(world));
    OK(world, skein_snapshot_write(world, saved, skein_snapshot_size(world), &size));
    OK(other, skein_snapshot_read(other, saved, size));
    for (int f = 0; f < 5; f++) {
        OK(world, skein_world_step(world, 1.0 / 60));
        OK(other, skein_world_step(other, 1.0 / 60));
        assert_true(skein_world_hash(world) == skein_world_hash(other));
    }
    free(saved);
    skein_world_destroy(other);
    skein_world_destroy(world);
}

/* A pinned edge is led through a hanging sheet, wherever contact would hold it, and what hangs on it comes along. */
static void pins_go_through(void **state) {
    (void)state;
    skein_world *world = world_with_contact("xpbd", 10, -1);
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    add_sheet(world, 16, 0.2, (double[]){0, 0.9, 0.12}, (double[]){90, 0, 0}, "top edge");
    add_sheet(world, 30, 0.6, (double[]){0, 0.8, 0}, (double[]){90, 0, 0}, "corners");
    size_t pinned[16], pins = 0, worst = 0;
    for (size_t i = 0; i < 256 && pins < COUNT(pinned); i++)
        if (position_of(world, i).y > 0.99) pinned[pins++] = i;
    assert_int_equal(pins, 16);
    crossing_search all = crossing_begin(world);
    assert_int_equal(crossings_now(&all, world), 0);
    for (int f = 0; f < 180; f++) {
        for (size_t k = 0; k < pins && f < 60; k++) {
            vec3 p = position_of(world, pinned[k]);
            OK(world, skein_positions_set(world, pinned[k], 1, (double[]){p.x, p.y, p.z - 0.008}));
        }
        steps(world, 1, 1.0 / 60);
        size_t now = crossings_now(&all, world);
        if (now > worst) worst = now;
        assert_int_equal(statistics_of(world).nonfinite, 0);
    }
    assert_true(worst > 0);
    assert_int_equal(crossings_now(&all, world), 0);
    crossing_free(&all);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_come_apart),
        cmocka_unit_test(they_gain_no_speed),
        cmocka_unit_test(what_is_clean_is_left_alone),
        cmocka_unit_test(it_needs_no_memory_of_its_own),
        cmocka_unit_test(what_begins_without_a_gap_needs_no_memory),
        cmocka_unit_test(pins_go_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
