/* Snapshots: a world that reads one goes on with the bits of the world that it was taken of; and one that does not fit
 * is refused with words, before anything has changed. */
#include <dirent.h>

#include "all_methods.h"
#include "helpers.h"
#include "io/scene.h"
#include "world/snapshot.h"

static const double dt = 1.0 / 60;

typedef struct snapshot {
    unsigned char *bytes;
    size_t size;
} snapshot;

static snapshot take(const skein_world *world) {
    snapshot s = {.size = skein_snapshot_size(world)};
    size_t written = 0;
    assert_non_null(s.bytes = malloc(s.size));
    OK(world, skein_snapshot_write(world, s.bytes, s.size, &written));
    assert_int_equal(written, s.size);
    return s;
}

static void go_back(skein_world *world, snapshot s) {
    OK(world, skein_snapshot_read(world, s.bytes, s.size));
}

static uint64_t hash_after(skein_world *world, int count) {
    steps(world, count, dt);
    return skein_world_hash(world);
}

/* ---- everything a step reads is in it ---- */

/* Two bodies, colliders and pins; whatever the tests below change. */
static skein_world *make_world(const char *method) {
    skein_world *world = new_world(method, 60);
    const skein_setting sheet[] = {SKEIN_TEXT("name", "sheet"),        SKEIN_PAIR("grid", 7, 9),
                                   SKEIN_PAIR("size", 0.6, 0.8),       SKEIN_VEC3("position", 0, 0.5, 0),
                                   SKEIN_TEXT("pins", "top edge"),     SKEIN_REAL("stretch.stiffness", 60),
                                   SKEIN_REAL("stretch.damping", 0.1), SKEIN_END};
    OK(world, skein_body_add(world, "cloth", NULL, sheet, NULL));
    OK(world, skein_body_add(world, "rope", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "line"), SKEIN_REAL("count", 7),
                                            SKEIN_REAL("stretch.stiffness", 50)),
                             NULL));
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_TEXT("name", "ball"), SKEIN_REAL("radius", 0.2)),
                                 NULL));
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_TEXT("name", "wind")), NULL));
    add_gravity(world);
    return world;
}

static void set_number(skein_world *world, const char *path, double x) {
    OK(world, skein_set_path(world, path, skein_number(x)));
}

static void wait_for_pin(skein_world *world) {
    uint32_t pin = 0;
    OK(world, skein_particle_pin(world, pin, true));
    OK(world, skein_pins_move(world, &pin, 1, (const double[]){0.1, 0.6, 0.1}));
}

static void hold_on_the_way(skein_world *world) {
    OK(world, skein_particle_pin(world, 30, true));
    OK(world, skein_velocities_set(world, 30, 1, (const double[]){0.3, 0, -0.2}));
    OK(world, skein_particle_pin(world, 0, false));
}

static void move_ball(skein_world *world) {
    OK(world, skein_set_path(world, "colliders.ball.centre", skein_vector(0.1, 0.45, 0)));
}

static void move_ball_and_step(skein_world *world) {
    move_ball(world);
    steps(world, 1, dt);
}

static void stiffen(skein_world *world) {
    set_number(world, "bodies.sheet.stretch.stiffness", 40);
    set_number(world, "method.substeps", 61);
    OK(world, skein_set_path(world, "colliders.ball.motion.velocity", skein_vector(0, 0.1, 0)));
}

static void take_out(skein_world *world) {
    set_number(world, "bodies.line.enabled", 0);
}

static void let_be(skein_world *world) {
    (void)world;
}

static void all_of_the_state(void **state) {
    (void)state;
    static void (*const changes[])(skein_world *) = {
        let_be, wait_for_pin, hold_on_the_way, move_ball, move_ball_and_step, stiffen, take_out};
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t c = 0; c < COUNT(changes); c++) {
            if (is_spared(m * COUNT(changes) + c, 3)) continue;
            skein_world *one = make_world(all_methods[m]), *other = make_world(all_methods[m]);
            steps(one, 5, dt);
            changes[c](one);
            snapshot s = take(one);
            uint64_t unbroken = hash_after(one, 7);
            go_back(other, s);
            assert_true(skein_world_time(other) > 0);
            if (hash_after(other, 7) != unbroken) fail_msg("change %zu under %s: another hash", c, all_methods[m]);
            // and what is told of it
            skein_statistics a, b;
            OK(one, skein_world_statistics(one, &a));
            OK(other, skein_world_statistics(other, &b));
            assert_int_equal(a.steps, b.steps);
            assert_int_equal(a.substeps, b.substeps);
            if (!(a.dissipated_energy == b.dissipated_energy) || !(a.time == b.time))
                fail_msg("change %zu under %s: %.17g J and %.17g", c, all_methods[m], a.dissipated_energy,
                         b.dissipated_energy);
            double blended[2][3];
            OK(one, skein_positions_blend(one, 0.5, 20, 1, blended[0]));
            OK(other, skein_positions_blend(other, 0.5, 20, 1, blended[1]));
            assert_memory_equal(blended[0], blended[1], sizeof blended[0]);
            // the same world goes back, too
            go_back(one, s);
            assert_true(hash_after(one, 7) == unbroken);
            free(s.bytes);
            skein_world_destroy(one);
            skein_world_destroy(other);
        }
}

static void before_the_next_step(void **state) {
    (void)state;
    skein_world *one = make_world("xpbd"), *other = make_world("xpbd");
    steps(one, 3, dt);
    snapshot s = take(one), t;
    go_back(other, s);
    t = take(other);
    assert_int_equal(s.size, t.size);
    assert_memory_equal(s.bytes, t.bytes, s.size);
    free(s.bytes);
    free(t.bytes);
    // and another method is set, too
    OK(one, skein_method_set(one, "rk4", SKEIN_SETTINGS(SKEIN_REAL("substeps", 70))));
    s = take(one);
    go_back(other, s);
    assert_true(hash_after(one, 4) == hash_after(other, 4));
    free(s.bytes);
    skein_world_destroy(one);
    skein_world_destroy(other);
}

/* A state that is not finite any more leaves nothing behind when the world is taken back, by a snapshot or by a reset. */
static void back_from_a_blow_up_by(bool reset) {
    skein_world *world = new_world("symplectic_euler", 4);
    const skein_setting rope[] = {SKEIN_REAL("count", 5),
                                  SKEIN_TEXT("pins", "0"),
                                  SKEIN_REAL("stretch.stiffness", 10),
                                  SKEIN_REAL("stretch.limit", INFINITY),
                                  SKEIN_REAL("stretch.tether", INFINITY),
                                  SKEIN_END};
    OK(world, skein_body_add(world, "rope", NULL, rope, NULL));
    add_gravity(world);
    snapshot s = take(world);
    uint64_t good = hash_after(world, 4);
    OK(world, skein_velocities_set(world, 2, 1, (const double[]){1e15, 1e15, 0}));
    for (int i = 0; i < 2; i++) OK(world, skein_velocities_set(world, 3, 1, (const double[]){-1e15, 0, 0}));
    OK(world, skein_set_path(world, "bodies.0.stretch.stiffness", skein_number(1e14)));
    steps(world, 9, dt);
    skein_statistics now;
    OK(world, skein_world_statistics(world, &now));
    assert_true(now.nonfinite > 0);
    OK(world, skein_set_path(world, "bodies.0.stretch.stiffness", skein_number(10)));
    if (reset) OK(world, skein_world_reset(world));
    else go_back(world, s);
    assert_true(hash_after(world, 4) == good);
    free(s.bytes);
    skein_world_destroy(world);
}

static void back_from_a_blow_up(void **state) {
    (void)state;
    back_from_a_blow_up_by(false);
    back_from_a_blow_up_by(true);
}

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static skein_world *load(const char *path) {
    static const skein_kind *const none[] = {NULL};
    io_faults faults = {report, NULL, 0, NULL};
    io_scene *scene = io_scene_read(path, NULL, none, &faults);
    assert_non_null(scene);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_true(world && !faults.count);
    io_scene_free(scene);
    return world;
}

static void every_scene(void **state) {
    (void)state;
    DIR *folder = opendir("scenes");
    assert_non_null(folder);
    struct dirent *entry;
    int count = 0;
    while ((entry = readdir(folder))) {
        char path[400];
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 5, ".json") != 0) continue;
        if (!strcmp(entry->d_name, "elephant.json") || !strcmp(entry->d_name, "statue.json"))
            continue; // meshes are to be fetched
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        skein_world *one = load(path);
        if (skein_particle_count(one) > (SPARING ? 1000u : 20000u)) {
            skein_world_destroy(one);
            continue;
        }
        steps(one, 3, dt);
        snapshot s = take(one);
        skein_world *other = load(path);
        go_back(other, s);
        if (hash_after(one, 3) != hash_after(other, 3)) fail_msg("%s: another hash", path);
        skein_world_destroy(one);
        skein_world_destroy(other);
        free(s.bytes);
        count++;
    }
    closedir(folder);
    assert_true(count > (SPARING ? 5 : 20));
}

/* ---- colliders whose vertices a program leads ---- */

static void place_slab(double x, double corner[8][3]) {
    for (int v = 0; v < 8; v++)
        for (int k = 0; k < 3; k++) corner[v][k] = (v >> k & 1 ? 0.3 : -0.3) + (k ? 0 : x);
}

/* A sheet that lies on a cube, tied to it by a corner. */
static skein_world *with_slab(skein_handle *slab) {
    static const uint32_t quads[] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5},
                          sizes[] = {4, 4, 4, 4, 4, 4};
    double corner[8][3];
    skein_world *world = new_world("xpbd", 5);
    place_slab(0, corner);
    OK(world, skein_collider_add_mesh(world, "mesh", &(skein_mesh){corner[0], 8, sizes, 6, quads, 24}, NULL, slab));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 11, 11), SKEIN_PAIR("size", 0.5, 0.5),
                                            SKEIN_VEC3("position", 0, 0.305, 0), SKEIN_TEXT("pins", "0")),
                             NULL));
    OK(world, skein_motion_add(world, "attach", NULL, NULL, NULL));
    add_gravity(world);
    return world;
}

static void lead_slab(skein_world *world, skein_handle slab, bool by_field, int step) {
    double corner[8][3];
    if (by_field) {
        OK(world, skein_set(world, slab, "position", skein_vector(0.01 * step, 0, 0)));
        return;
    }
    place_slab(0.01 * step, corner);
    OK(world, skein_collider_vertices_set(world, slab, corner[0], 8));
}

/* Led by vertices, or by its field, and what is tied to it. Taken after a step, or with places that wait for the next one; read by the world itself, by one that has made a step, and by one
 * that has made none; and one of a world that led nothing. */
static void vertices_that_are_led(void **state) {
    (void)state;
    for (int way = 0; way < 4; way++) {
        const bool waiting = way % 2, by_field = way / 2;
        skein_handle slab, others[2];
        skein_world *world = with_slab(&slab), *other[2] = {with_slab(&others[0]), with_slab(&others[1])};
        const snapshot start = take(world);
        steps(other[0], 1, dt);
        for (int s = 1; s <= 20; s++) lead_slab(world, slab, by_field, s), steps(world, 1, dt);
        if (waiting) lead_slab(world, slab, by_field, 21);
        const snapshot s = take(world);
        if (!waiting) lead_slab(world, slab, by_field, 21);
        steps(world, 1, dt);
        const uint64_t first = skein_world_hash(world), rest = (steps(world, 2, dt), skein_world_hash(world));
        for (int w = 0; w < 3; w++) {
            skein_world *to = w < 2 ? other[w] : world;
            go_back(to, s);
            if (!waiting) lead_slab(to, w < 2 ? others[w] : slab, by_field, 21);
            assert_true(hash_after(to, 1) == first);
            assert_true(hash_after(to, 2) == rest);
        }
        skein_world_destroy(other[0]), skein_world_destroy(other[1]);
        other[0] = with_slab(&slab);
        const uint64_t from_start = hash_after(other[0], 3);
        go_back(world, start);
        assert_true(hash_after(world, 3) == from_start);
        free(s.bytes), free(start.bytes);
        skein_world_destroy(other[0]), skein_world_destroy(world);
    }
}

/* Who is tied to a collider sits where that was built, whatever of it is set before the first step. */
static void seats_are_where_all_was_built(void **state) {
    (void)state;
    static const struct {
        const char *name;
        skein_value value;
    } sets[] = {
        {"scale", {1, {1.5, 0, 0}, NULL}}, {"position", {3, {0.1, 0, 0}, NULL}}, {"rotation", {3, {0, 0, 20}, NULL}}};
    for (size_t i = 0; i < COUNT(sets); i++) {
        skein_handle slab, other_slab;
        skein_world *world = with_slab(&slab), *other = with_slab(&other_slab);
        OK(world, skein_set(world, slab, sets[i].name, sets[i].value));
        const snapshot s = take(world);
        const uint64_t hash = hash_after(world, 2);
        go_back(other, s);
        assert_true(hash_after(other, 2) == hash);
        go_back(world, s);
        assert_true(hash_after(world, 2) == hash);
        free(s.bytes);
        skein_world_destroy(world), skein_world_destroy(other);
    }
}

/* Any byte of what is said of them may be another: it is refused, or taken as it stands. */
static void surfaces_that_are_damaged(void **state) {
    (void)state;
    skein_handle slab;
    skein_world *world = with_slab(&slab);
    lead_slab(world, slab, false, 1), steps(world, 1, dt), lead_slab(world, slab, false, 2);
    const snapshot s = take(world);
    const size_t surface = 4 + 4 + 8 + 8 + 8 * 3 * sizeof(skein_real) + 8 * 3 * 8;
    size_t refused = 0;
    for (size_t i = s.size - surface; i < s.size; i++)
        for (int bit = 0; bit < 8; bit += 1 + 6 * SPARING) {
            s.bytes[i] ^= (unsigned char)(1u << bit);
            sk_snapshot_seal(s.bytes, s.size);
            refused += skein_snapshot_read(world, s.bytes, s.size) != SKEIN_OK;
            s.bytes[i] ^= (unsigned char)(1u << bit);
        }
    sk_snapshot_seal(s.bytes, s.size);
    assert_true(refused > 24 + 16);
    go_back(world, s);
    steps(world, 1, dt);
    free(s.bytes);
    skein_world_destroy(world);
}

/* ---- a thickness that was raised ---- */

/* Two sheets at rest on each other. */
static skein_world *with_sheets(double thickness) {
    skein_world *world = new_world("xpbd", 10);
    add_gravity(world);
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    for (int i = 0; i < 2; i++)
        OK(world,
           skein_body_add(
               world, "cloth", NULL,
               SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 6), SKEIN_VEC3("position", 0.01 * i, 0.002 + 0.003 * i, 0)), NULL));
    return world;
}

/* Who touches is led apart for a while: a snapshot knows how far that has come, be it taken before the next step, on the way or after
 * it; and one of another time knows nothing of it. */
static void thickness_that_was_raised(void **state) {
    (void)state;
    static const int frames[] = {0, 3, 200};
    for (size_t i = 0; i < COUNT(frames); i++) {
        skein_world *world = with_sheets(0.003), *other = with_sheets(0.003);
        skein_snapshot_info info;
        steps(world, 20, dt);
        snapshot before = take(world);
        const uint64_t thin = hash_after(world, 3);
        go_back(world, before);
        set_number(world, "forces.1.thickness", 0.01);
        steps(world, frames[i], dt);
        snapshot s = take(world);
        assert_int_equal(skein_snapshot_look(s.bytes, s.size, &info, NULL), SKEIN_OK);
        assert_int_equal(info.version, i == 0 ? 6 : i == 1 ? 5 : 1);
        const uint64_t hash = hash_after(world, 3);
        assert_true(hash != thin);
        go_back(other, s);
        assert_true(hash_after(other, 3) == hash);
        go_back(world, s);
        assert_true(hash_after(world, 3) == hash);
        go_back(world, before);
        assert_true(hash_after(world, 3) == thin);
        go_back(world, s); // the thickness grows by what is read
        assert_true(hash_after(world, 3) == hash);
        // any byte of it may be another
        size_t refused = 0;
        for (size_t k = s.size - (i ? 24 : 32); k < s.size && i < 2; k++)
            for (int bit = 0; bit < 8; bit++) {
                s.bytes[k] ^= (unsigned char)(1u << bit);
                sk_snapshot_seal(s.bytes, s.size);
                refused += skein_snapshot_read(world, s.bytes, s.size) != SKEIN_OK;
                s.bytes[k] ^= (unsigned char)(1u << bit);
            }
        assert_true(i == 2 || refused > 32 + 29 + (i ? 0u : 24u));
        free(before.bytes), free(s.bytes);
        skein_world_destroy(world), skein_world_destroy(other);
    }
}

/* ---- what is refused ---- */

static void put(snapshot s, size_t at, uint64_t word, size_t bytes) {
    sk_byte_writer w = {s.bytes, s.size, at};
    sk_put_word(&w, word, bytes);
}

static void heads(void **state) {
    (void)state;
    skein_world *world = make_world("xpbd");
    snapshot s = take(world);
    skein_snapshot_info info;
    skein_error error;
    assert_int_equal(skein_snapshot_look(s.bytes, s.size, &info, &error), SKEIN_OK);
    assert_int_equal(info.version, 1); // nothing is cut
    assert_int_equal(info.real_size, sizeof(skein_real));
    assert_int_equal(info.particles, skein_particle_count(world));
    put(s, 8, SK_SNAPSHOT_VERSION + 1, 4);
    FAILS(world, SKEIN_ERROR_LIMIT, "a snapshot of version 7", skein_snapshot_read(world, s.bytes, s.size));
    put(s, 8, 1, 4);
    put(s, 12, 12 - sizeof(skein_real), 4);
    FAILS(world, SKEIN_ERROR_VALUE, "take the other build", skein_snapshot_read(world, s.bytes, s.size));
    put(s, 12, sizeof(skein_real), 4);
    FAILS(world, SKEIN_ERROR_LIMIT, "skein_snapshot_size()", skein_snapshot_write(world, s.bytes, s.size - 1, NULL));
    s = (free(s.bytes), take(world));
    for (size_t size = 0; size < s.size; size += size < 200 ? 1 : 37)
        assert_int_not_equal(skein_snapshot_read(world, s.bytes, size), SKEIN_OK);
    for (size_t i = 0; i < s.size; i += i < 200 ? 1 : 31) {
        s.bytes[i] ^= 4;
        bool room = i >= 32 && i < SK_SNAPSHOT_HEAD; // which is not looked at
        if (!room) assert_int_not_equal(skein_snapshot_read(world, s.bytes, s.size), SKEIN_OK);
        s.bytes[i] ^= 4;
    }
    go_back(world, s);
    free(s.bytes);
    skein_world_destroy(world);
}

static skein_world *sheet_of(skein_value grid, double mass) {
    skein_world *world = new_world("xpbd", 8);
    OK(world, skein_body_add(world, "cloth", NULL, (const skein_setting[]){{"grid", grid}, SKEIN_END}, NULL));
    add_particle(world, mass, 0, 1, 0);
    return world;
}

static void other_worlds(void **state) {
    (void)state;
    const skein_value grid = {2, {7, 9, 0}, NULL}, turned = {2, {9, 7, 0}, NULL}, larger = {2, {8, 9, 0}, NULL};
    const struct {
        const char *words;
        skein_world *world;
    } cases[] = {
        {"its grid is", sheet_of(turned, 1)},
        {"masses", sheet_of(grid, 3)},
        {"has 64 particles", sheet_of(larger, 1)},
        {"it was taken of", make_world("xpbd")},
    };
    skein_world *world = sheet_of(grid, 1);
    steps(world, 2, dt);
    snapshot s = take(world);
    for (size_t i = 0; i < COUNT(cases); i++) {
        uint64_t before = skein_world_hash(cases[i].world);
        FAILS(cases[i].world, SKEIN_ERROR_VALUE, cases[i].words, skein_snapshot_read(cases[i].world, s.bytes, s.size));
        assert_true(skein_world_hash(cases[i].world) == before);
        skein_world_destroy(cases[i].world);
    }
    free(s.bytes);
    skein_world_destroy(world);
}

static size_t largest;

static void *note_size(void *user, size_t size, size_t alignment) {
    (void)user;
    if (size > largest) largest = size;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void release(void *user, void *memory, size_t size) {
    (void)user, (void)size;
    free(memory);
}

/* Every place where a number could be a size says a thousand million: nothing so large is asked for. */
static void claims(void **state) {
    (void)state;
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = note_size, desc.release = release;
    skein_world *world = skein_world_create(&desc, NULL);
    OK(world, skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 4)), NULL));
    snapshot s = take(world);
    unsigned char *copy = malloc(s.size);
    assert_non_null(copy);
    largest = 0;
    for (size_t i = SK_SNAPSHOT_HEAD; i + 8 <= s.size; i++) {
        memcpy(copy, s.bytes, s.size);
        put((snapshot){copy, s.size}, i, 1000000000, i % 2 ? 4 : 8);
        sk_snapshot_seal(copy, s.size);
        skein_snapshot_read(world, copy, s.size);
    }
    assert_true(largest < 1 << 20);
    free(copy);
    free(s.bytes);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_of_the_state),
        cmocka_unit_test(before_the_next_step),
        cmocka_unit_test(back_from_a_blow_up),
        cmocka_unit_test(every_scene),
        cmocka_unit_test(vertices_that_are_led),
        cmocka_unit_test(surfaces_that_are_damaged),
        cmocka_unit_test(seats_are_where_all_was_built),
        cmocka_unit_test(thickness_that_was_raised),
        cmocka_unit_test(heads),
        cmocka_unit_test(other_worlds),
        cmocka_unit_test(claims),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
