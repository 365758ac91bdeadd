/* Worlds made at random, of sheets that fall on each other, cross from the start, or hang from pins that are led about: from a
 * snapshot of any frame, and with other threads, each goes on with the same bits. Which pairs are known by then, which patches
 * are calm and who has a course depends on what has gone on before, which must not count. In rough ones, pins go so far in two
 * substeps that edges get eight times as long. */
#include "helpers.h"

static uint64_t seed;

static double some(double least, double most) {
    return random_between(&seed, least, most);
}

static void add_some_sheet(skein_world *world, int number, bool rough) {
    static const char *const pins[] = {"", "", "top edge", "top corners", "corners", "top edge, bottom edge"};
    char name[16], keys[128];
    snprintf(name, sizeof name, "sheet %d", number);
    const int rows = (int)some(12, 30), columns = (int)some(12, 30), held = (int)some(0, COUNT(pins));
    const double cell = some(0.015, 0.03), x = some(-0.1, 0.1), y = 0.3 * number + some(0, 0.2), z = some(-0.1, 0.1);
    const double pitch = some(-100, 100), yaw = some(0, 90), roll = some(-20, 20), down = held < 2 ? some(-3, 0) : 0;
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", name), SKEIN_PAIR("grid", rows, columns),
                                     SKEIN_PAIR("size", cell * rows, cell * columns), SKEIN_TEXT("pins", pins[held]),
                                     SKEIN_VEC3("position", x, y, z), SKEIN_VEC3("rotation", pitch, yaw, roll),
                                     SKEIN_VEC3("velocity", 0, down, 0)),
                      NULL));
    const double most = rough ? 0.35 : 0.2, time = some(rough ? 0.1 : 0.2, 0.5);
    const double to[] = {some(-most, most), some(-most, most + 0.1), some(-most, most)};
    snprintf(keys, sizeof keys, "0 0 0 0, %g %g %g %g, %g 0 0 0", time, to[0], to[1], to[2], 2 * time);
    if (held >= 2)
        OK(world, skein_motion_add(world, "keys", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("on", name), SKEIN_TEXT("keys", keys)), NULL));
}

static skein_world *world_of(int number, bool rough, int threads) {
    static const char *const methods[] = {"xpbd", "xpbd", "pbd"};
    seed = 7919 * (uint64_t)number + 13;
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    const int method = (int)some(0, COUNT(methods)), substeps = rough ? 2 : (int)some(3, 12), sheets = (int)some(2, 5);
    OK(world, skein_method_set(world, methods[method], SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    add_gravity(world);
    const double thickness = some(0.003, 0.008), friction = some(0, 0.6);
    OK(world,
       skein_force_add(world, "contact",
                       SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness), SKEIN_REAL("friction", friction)), NULL));
    for (int i = 0; i < sheets; i++) add_some_sheet(world, i, rough);
    if (some(0, 1) < 0.5)
        OK(world, skein_collider_add(world, "plane",
                                     SKEIN_SETTINGS(SKEIN_REAL("offset", -0.5), SKEIN_REAL("friction", 0.5)), NULL));
    return world;
}

/* How many frames somebody touches in, and how much edges get longer. */
static size_t go_on(int number, bool rough, double *stretch) {
    enum { FRAMES = 33 };
    const int every = rough ? 8 : 4;
    skein_world *world = world_of(number, rough, 1);
    void *saved[FRAMES];
    size_t size[FRAMES], met = 0;
    uint64_t hash[FRAMES + 1];
    *stretch = 0;
    for (int f = 0; f < FRAMES; f++) {
        hash[f] = skein_world_hash(world);
        size[f] = skein_snapshot_size(world);
        saved[f] = malloc(size[f]);
        OK(world, skein_snapshot_write(world, saved[f], size[f], &size[f]));
        steps(world, 1, 1.0 / 60);
        skein_surface_contact contact[1];
        size_t contacts = 0;
        OK(world, skein_surface_contacts_copy(world, contact, 1, &contacts));
        met += contacts > 0;
        *stretch = fmax(*stretch, statistics_of(world).max_stretch);
    }
    hash[FRAMES] = skein_world_hash(world);
    skein_world_destroy(world);
    for (int f = 1; f < FRAMES; f += every) {
        skein_world *other = world_of(number, rough, 1 + f / every % 3);
        OK(other, skein_snapshot_read(other, saved[f], size[f]));
        for (int g = f; g < FRAMES; g++) {
            steps(other, 1, 1.0 / 60);
            if (skein_world_hash(other) != hash[g + 1])
                fail_msg("world %d, stretched by up to %g, goes on otherwise from frame %d in frame %d", number,
                         *stretch, f, g + 1);
        }
        skein_world_destroy(other);
    }
    for (int f = 0; f < FRAMES; f++) free(saved[f]);
    return met;
}

static void it_goes_on_alike(void **state) {
    (void)state;
    enum { WORLDS = 6, LEAST = 16 };
    size_t met = 0;
    double stretch;
    for (int number = 0; number < WORLDS; number++) met += go_on(number, false, &stretch);
    assert_true(met > WORLDS * LEAST); // they do touch
}

static void what_is_torn_goes_on_alike(void **state) {
    (void)state;
    double most = 0;
    for (int number = 1; number <= 5; number += 4) { // both went on otherwise: from frame 25, and from frame 1
        double stretch;
        go_on(number, true, &stretch);
        most = fmax(most, stretch);
    }
    assert_true(most > 7); // some is
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(it_goes_on_alike), cmocka_unit_test(what_is_torn_goes_on_alike)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
