/* Tearing: edges that are stretched beyond their bound give way, one after the other, and nobody else does; under every
 * method, with the same bits for threads, widths, snapshots and recordings. */
#include <skein/cut.h>
#include <skein/gradient.h>
#include <skein/record.h>
#include <skein/share.h>

#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

typedef struct sheet {
    skein_world *world;
    skein_handle cloth;
    skein_surface surface;
} sheet;

static skein_world *world_of(const char *method, int substeps, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    add_particle(world, 1, 9, 9, 9); // so that the body does not begin with particle 0
    return world;
}

static sheet add_sheet(skein_world *world, const skein_setting *settings) {
    sheet s = {.world = world};
    OK(world, skein_body_add(world, "cloth", NULL, settings, &s.cloth));
    OK(world, skein_body_surface(world, s.cloth, &s.surface));
    return s;
}

static size_t torn(const sheet *s) {
    skein_cuts cuts;
    OK(s->world, skein_body_cuts(s->world, s->cloth, &cuts));
    return cuts.count;
}

/* ---- who gives way ---- */

/* A ladder of 2 x 12 particles without any stiffness, from x = 0 on; the rungs' distances grow by a twentieth each, so that the
 * last one is stretched most, by 55 %, and those before it less and less. */
static sheet ladder(double tear) {
    sheet s = add_sheet(world_of("xpbd", 1, 1),
                        SKEIN_SETTINGS(SKEIN_PAIR("grid", 2, 12), SKEIN_PAIR("size", 11, 1),
                                       SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("shear.stiffness", 0),
                                       SKEIN_REAL("bend.rigidity", 0), SKEIN_REAL("stretch.tear", tear)));
    for (size_t i = 0; i < 24; i++) {
        double k = (double)(i % 12), z = position_of(s.world, s.surface.first_particle + i).z;
        place_particle(s.world, s.surface.first_particle + i, k + k * (k + 1) / 2 / 20, 0, z);
    }
    return s;
}

/* Where nothing pulls, nothing is relieved, and the ladder comes apart from its worst rung on, one face a step, as far as
 * stretch is beyond the bound: rung k is stretched by k/20, so that of 0.31 the last five are left. */
static void the_worst_gives_way_first(void **state) {
    (void)state;
    sheet s = ladder(0.31);
    skein_cuts cuts;
    for (size_t step = 1; step < 9; step++) {
        steps(s.world, 1, dt);
        assert_int_equal(torn(&s), step < 5 ? step : 5);
        OK(s.world, skein_body_cuts(s.world, s.cloth, &cuts));
        for (size_t f = 0; f < 11; f++) assert_int_equal(cuts.face[f], f + step >= 11 && f >= 6);
    }
    OK(s.world, skein_set(s.world, s.cloth, "stretch.tear", skein_number(0))); // never
    OK(s.world, skein_cut_mend(s.world, s.cloth));
    steps(s.world, 3, dt);
    assert_int_equal(torn(&s), 0);
    OK(s.world, skein_set(s.world, s.cloth, "stretch.tear", skein_number(0.51)));
    steps(s.world, 3, dt);
    assert_int_equal(torn(&s), 1); // 55 %, not 50
    skein_world_destroy(s.world);
}

/* A ribbon of 1 m between two pinned ends, which part at 1 m/s. */
static sheet ribbon(const char *method, double tear) {
    return add_sheet(world_of(method, 20, 1),
                     SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 11), SKEIN_PAIR("size", 1, 0.2),
                                    SKEIN_TEXT("pins", "left edge, right edge"), SKEIN_REAL("stretch.stiffness", 20),
                                    SKEIN_REAL("shear.stiffness", 2), SKEIN_REAL("stretch.damping", 0.1),
                                    SKEIN_REAL("stretch.tether", INFINITY), SKEIN_REAL("stretch.tear", tear)));
}

static void part_ends(const sheet *s, double by) {
    uint32_t pins[6];
    double places[6][3];
    for (uint32_t i = 0; i < 6; i++) {
        pins[i] = s->surface.first_particle + 11 * (i / 2) + (i % 2 ? 10 : 0);
        vec3 p = position_of(s->world, pins[i]);
        places[i][0] = (i % 2 ? 1 : -1) * (0.5 + by / 2), places[i][1] = p.y, places[i][2] = p.z;
    }
    OK(s->world, skein_pins_move(s->world, pins, 6, &places[0][0]));
    steps(s->world, 1, dt);
}

/* A ribbon that is drawn out gives way when its stretch has come to the bound, by any method, and then hangs on no more: what
 * is torn off goes with its own end. */
static void a_ribbon_gives_way_at_its_bound(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        sheet s = ribbon(all_methods[m], 0.3);
        double by = 0, strain = 0;
        bool drags = !strcmp(all_methods[m], "pbd"); // its springs are as stiff as its iterations make them
        while (!torn(&s) && by < 1) strain = by, part_ends(&s, by += dt);
        if (strain < 0.2 || by > 0.32) print_message("%s: torn as its ends had parted by %g m\n", all_methods[m], by);
        // ends that part at 1 m/s stretch the edges beside them first, where springs are as slow as they are here
        assert_true(by <= 0.3 + 2 * dt && by >= (drags ? 0.25 : 0.2));
        for (int i = 0; i < 60; i++) part_ends(&s, by += dt);
        assert_true(torn(&s) >= 2 && torn(&s) < 20);
        skein_statistics now = statistics_of(s.world);
        assert_true(now.max_stretch < 0.3 && !now.nonfinite); // ends are 2 m apart
        skein_world_destroy(s.world);
    }
}

/* Without a tear there is none, however far it is stretched; and a bound that nothing comes to changes no bit. */
static void never_is_never(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int bounded = 0; bounded < 2; bounded++) {
        sheet s = ribbon("xpbd", bounded ? 40 : 0);
        double by = 0;
        for (int i = 0; i < 90; i++) part_ends(&s, by += dt);
        assert_int_equal(torn(&s), 0);
        assert_true(statistics_of(s.world).max_stretch > 1.2);
        hash[bounded] = skein_world_hash(s.world);
        skein_world_destroy(s.world);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- the same bits ---- */

/* A sheet that is torn from its upper edge on: one half of it goes to the front, the other to the back. */
static sheet trousers(uint32_t rows, int threads) {
    sheet s = {.world = world_of("xpbd", 10, threads)};
    add_gravity(s.world);
    s = add_sheet(s.world, SKEIN_SETTINGS(SKEIN_PAIR("grid", rows, rows), SKEIN_VEC3("rotation", 90, 0, 0),
                                          SKEIN_TEXT("pins", "top edge"), SKEIN_REAL("stretch.tear", 0.15)));
    return s;
}

static void pull(const sheet *s, uint32_t rows, int first, int end) {
    for (int step = first; step < end; step++) {
        for (uint32_t i = 0; i < rows; i++) {
            vec3 p = position_of(s->world, s->surface.first_particle + i);
            double z = (i < rows / 2 ? 1 : -1) * 0.02 * step;
            OK(s->world, skein_pins_move(s->world, (const uint32_t[]){s->surface.first_particle + i}, 1,
                                         (const double[]){p.x, p.y, z}));
        }
        steps(s->world, 1, dt);
    }
}

static void the_same_bits(void **state) {
    (void)state;
    static const char *const sets[] = {"sse", "avx2", "avx512"};
    const uint32_t sizes[] = {20, 52}; // the larger one would have coarse grids if it did not tear
    for (size_t k = 0; k < COUNT(sizes); k++) {
        uint64_t hash = 0;
        size_t faces = 0;
        for (int threads = 1; threads < 4; threads++)
            for (size_t i = 0; i < COUNT(sets); i++) {
                if (SPARING && (threads == 2 || i == 1)) continue;
                setenv("SKEIN_SIMD", sets[i], 1);
                sheet s = trousers(sizes[k], threads);
                unsetenv("SKEIN_SIMD");
                pull(&s, sizes[k], 1, 16);
                if (!hash) hash = skein_world_hash(s.world), faces = torn(&s);
                assert_true(skein_world_hash(s.world) == hash && torn(&s) == faces);
                skein_world_destroy(s.world);
            }
        assert_true(faces > 4 && faces < (sizes[k] - 1) * (sizes[k] - 1) / 2);
    }
}

/* ---- what holds a tear ---- */

static void a_reset_makes_whole(void **state) {
    (void)state;
    sheet s = trousers(20, 1);
    pull(&s, 20, 1, 12);
    size_t faces = torn(&s);
    uint64_t hash = skein_world_hash(s.world);
    assert_true(faces > 0);
    OK(s.world, skein_world_reset(s.world));
    assert_int_equal(torn(&s), 0);
    pull(&s, 20, 1, 12);
    assert_true(torn(&s) == faces && skein_world_hash(s.world) == hash);
    skein_world_destroy(s.world);
}

static void snapshots_hold_tears(void **state) {
    (void)state;
    sheet s = trousers(20, 1), other = trousers(20, 2);
    pull(&s, 20, 1, 12);
    size_t size = skein_snapshot_size(s.world), faces = torn(&s);
    void *bytes = malloc(size);
    OK(s.world, skein_snapshot_write(s.world, bytes, size, NULL));
    OK(other.world, skein_snapshot_read(other.world, bytes, size));
    free(bytes);
    assert_int_equal(torn(&other), faces);
    pull(&s, 20, 12, 16), pull(&other, 20, 12, 16);
    assert_true(torn(&s) == torn(&other) && torn(&s) > faces);
    assert_true(skein_world_hash(s.world) == skein_world_hash(other.world));
    skein_world_destroy(s.world), skein_world_destroy(other.world);
}

typedef struct tape {
    unsigned char bytes[1 << 20];
    size_t size;
} tape;

static bool put(void *user, const void *bytes, size_t size) {
    tape *t = user;
    if (size > sizeof t->bytes - t->size) return false;
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
    return true;
}

static void recordings_tear_again(void **state) {
    (void)state;
    sheet s = trousers(20, 2), other = trousers(20, 1);
    tape *t = calloc(1, sizeof *t);
    pull(&s, 20, 1, 9);
    OK(s.world, skein_record_begin(s.world, &(skein_recorder){.write = put, .user = t, .note = "a tear"}));
    size_t before = torn(&s);
    pull(&s, 20, 9, 16);
    OK(s.world, skein_record_end(s.world));
    skein_difference d;
    OK(other.world, skein_replay(other.world, t->bytes, t->size, &d));
    assert_true(!d.found && d.is_whole && d.steps == 7);
    assert_true(torn(&s) > before && torn(&other) == torn(&s));
    assert_true(skein_world_hash(s.world) == skein_world_hash(other.world));
    skein_world_destroy(s.world), skein_world_destroy(other.world);
    free(t);
}

/* A body that is not there does not tear. */
static void what_is_disabled_does_not_tear(void **state) {
    (void)state;
    sheet s = ladder(0.31);
    OK(s.world, skein_set(s.world, s.cloth, "enabled", skein_number(0)));
    steps(s.world, 3, dt);
    assert_int_equal(torn(&s), 0);
    OK(s.world, skein_set(s.world, s.cloth, "enabled", skein_number(1)));
    steps(s.world, 3, dt);
    assert_int_equal(torn(&s), 3);
    skein_world_destroy(s.world);
}

/* ---- refusals ---- */

static double nothing(void *user, const skein_gradient_state *state) {
    (void)user, (void)state;
    return 0;
}

static void refusals(void **state) {
    (void)state;
    sheet s = ladder(0.31);
    size_t count;
    skein_gradient_result result = {.value = 0};
    skein_gradient_desc desc = {.steps = 1, .dt = dt, .measure = nothing};
    FAILS(s.world, SKEIN_ERROR_VALUE, "a body that tears", skein_world_share_bodies(s.world, dt, NULL, 0, &count));
    FAILS(s.world, SKEIN_ERROR_VALUE, sizeof(skein_real) == sizeof(double) ? "a body that tears" : "double precision",
          skein_gradient(s.world, &desc, &result));
    FAILS(s.world, SKEIN_ERROR_VALUE, "stretch.tear", skein_set(s.world, s.cloth, "stretch.tear", skein_number(-1)));
    skein_world_destroy(s.world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_worst_gives_way_first),
        cmocka_unit_test(a_ribbon_gives_way_at_its_bound),
        cmocka_unit_test(never_is_never),
        cmocka_unit_test(the_same_bits),
        cmocka_unit_test(a_reset_makes_whole),
        cmocka_unit_test(snapshots_hold_tears),
        cmocka_unit_test(recordings_tear_again),
        cmocka_unit_test(what_is_disabled_does_not_tear),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
