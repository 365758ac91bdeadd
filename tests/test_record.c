/* Recordings: what was done is done again with the same bits, and what came out otherwise is named. */
#include <skein/record.h>

#include "helpers.h"

static const double dt = 1.0 / 60;

typedef struct tape {
    unsigned char *bytes;
    size_t size, capacity, room; /* room: after so many bytes nothing goes in; 0: any number */
} tape;

static bool put(void *user, const void *bytes, size_t size) {
    tape *t = user;
    if (t->room && t->size + size > t->room) return false;
    if (t->size + size > t->capacity) {
        t->capacity = 2 * (t->size + size);
        assert_non_null(t->bytes = realloc(t->bytes, t->capacity));
    }
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
    return true;
}

static const double corner[3][3] = {{-3, -0.5, 0}, {0, -0.5, 5}, {3, -0.5, 0}};

/* Lifts the triangle to what hangs over it. */
static void lift(skein_world *world, double by) {
    double to[3][3];
    memcpy(to, corner, sizeof to);
    for (int v = 0; v < 3; v++) to[v][1] += by;
    OK(world, skein_collider_vertices_set(world, skein_object_at(world, SKEIN_COLLIDER, 1), to[0], 3));
}

static skein_world *make_world(void) {
    skein_world *world = new_world("xpbd", 4);
    add_particle(world, 1, 9, 9, 9); // so that bodies do not begin with particle 0
    OK(world,
       skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "line"), SKEIN_REAL("count", 70)), NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "cape"), SKEIN_PAIR("grid", 12, 12),
                                            SKEIN_TEXT("pins", "top edge")),
                             NULL));
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3)), NULL));
    OK(world, skein_collider_add_mesh(world, "mesh",
                                      &(skein_mesh){corner[0], 3, &(uint32_t){3}, 1, (const uint32_t[]){0, 1, 2}, 3},
                                      NULL, NULL));
    add_gravity(world);
    return world;
}

static void begin(skein_world *world, tape *t) {
    skein_recorder to = {.write = put, .user = t, .note = "a test"};
    OK(world, skein_record_begin(world, &to));
}

static skein_difference replay(const tape *t) {
    skein_world *world = make_world();
    skein_difference d;
    OK(world, skein_replay(world, t->bytes, t->size, &d));
    if (d.found) assert_true(!d.body.generation || skein_handle_valid(world, d.body));
    skein_world_destroy(world);
    return d;
}

static void all_that_is_done(void **state) {
    (void)state;
    tape t = {0};
    skein_world *world = make_world();
    steps(world, 3, dt);
    begin(world, &t);
    steps(world, 2, dt);
    OK(world, skein_set_path(world, "colliders.0.centre", skein_vector(0.1, 0.2, 0)));
    OK(world, skein_set_path(world, "bodies.cape.stretch.stiffness", skein_number(300)));
    OK(world, skein_set_path(world, "method.substeps", skein_number(5)));
    OK(world, skein_set_path(world, "bodies.line.name", skein_text("cord")));
    steps(world, 2, dt);
    OK(world, skein_particle_pin(world, 5, true));
    OK(world, skein_pins_move(world, (const uint32_t[]){5}, 1, (const double[]){0, 1, 2}));
    steps(world, 2, dt);
    OK(world, skein_particle_pin(world, 5, false));
    OK(world, skein_velocities_set(world, 100, 1, (const double[]){1, 2, 3}));
    OK(world, skein_positions_set(world, 1, 1, (const double[]){0, 0, 0.1}));
    OK(world, skein_set_path(world, "colliders.0.centre", skein_vector(0, 0.2, 0)));
    OK(world, skein_collider_teleport(world, skein_object_at(world, SKEIN_COLLIDER, 0)));
    lift(world, 0.4);
    steps(world, 2, dt / 2);
    OK(world, skein_set_path(world, "bodies.0.enabled", skein_number(0)));
    steps(world, 2, dt);
    size_t size = skein_snapshot_size(world);
    void *snapshot = malloc(size);
    OK(world, skein_snapshot_write(world, snapshot, size, NULL));
    OK(world, skein_world_reset(world));
    steps(world, 2, dt);
    OK(world, skein_snapshot_read(world, snapshot, size));
    free(snapshot);
    OK(world, skein_method_set(world, "pbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 3))));
    OK(world, skein_world_time_set(world, 2));
    steps(world, 3, dt);
    uint64_t hash = skein_world_hash(world);
    OK(world, skein_record_end(world));
    FAILS(world, SKEIN_ERROR_VALUE, "not being recorded", skein_record_end(world));
    skein_world_destroy(world);
    world = make_world();
    skein_difference d;
    OK(world, skein_replay(world, t.bytes, t.size, &d));
    if (d.found) fail_msg("differs after %d steps in %u", (int)d.steps, d.particle);
    assert_int_equal(d.steps, 15);
    assert_true(d.is_whole);
    assert_true(skein_world_hash(world) == hash);
    skein_world_destroy(world);
    skein_recording_info info;
    assert_int_equal(skein_recording_look(t.bytes, t.size, &info, NULL), SKEIN_OK);
    assert_string_equal(info.note, "a test");
    free(t.bytes);
}

/* The lowest bit of one number, past all calls. */
static void flip(const skein_world *world, size_t particle, bool velocity) {
    skein_view view = velocity ? skein_velocity_view(world) : skein_position_view(world);
    unsigned char *bytes = (unsigned char *)(uintptr_t)(view.xyzw + 4 * (size_t)view.slot_of[particle] + 1);
    *bytes ^= 1; // the least significant one comes first on all machines that are tried
}

static void a_flipped_bit_is_named(void **state) {
    (void)state;
    const int all = SPARING ? 100 : 1000;
    static const uint32_t particles[] = {0, 1, 64, 65, 100, 150, 214};
    static const int bodies[] = {-1, 0, 0, 0, 1, 1, 1};
    for (size_t i = 0; i < COUNT(particles); i++) {
        tape t = {0};
        skein_world *world = make_world();
        bool velocity = i % 2 == 0;
        begin(world, &t);
        steps(world, all / 2, dt);
        flip(world, particles[i], velocity);
        steps(world, all / 2, dt);
        OK(world, skein_record_end(world));
        skein_world_destroy(world);
        world = make_world();
        skein_difference d;
        OK(world, skein_replay(world, t.bytes, t.size, &d));
        assert_true(d.found && d.exact);
        assert_int_equal(d.steps, all / 2);
        assert_int_equal(d.particle, particles[i]);
        assert_int_equal(d.blocks, 1);
        assert_true(d.velocity == velocity && d.position == !velocity);
        skein_handle body =
            bodies[i] < 0 ? (skein_handle){0, 0, 0} : skein_object_at(world, SKEIN_BODY, (size_t)bodies[i]);
        assert_true(skein_handle_equal(d.body, body));
        skein_world_destroy(world);
        free(t.bytes);
    }
}

static void where_it_ends(void **state) {
    (void)state;
    tape t = {0};
    skein_world *world = make_world();
    begin(world, &t);
    steps(world, 3, dt);
    size_t at = t.size;
    OK(world, skein_force_add(world, "wind", NULL, NULL));
    steps(world, 3, dt);
    OK(world, skein_record_end(world));
    skein_difference d = replay(&t);
    assert_true(!d.found && strstr(d.stopped, "an object was added"));
    assert_int_equal(d.steps, 3);
    // broken off: what is there is replayed
    d = replay(&(tape){t.bytes, at - 20, 0, 0});
    assert_true(!d.found && !d.is_whole);
    assert_int_equal(d.steps, 2);
    free(t.bytes);
    // no room: said at its end
    t = (tape){.room = at - 20};
    skein_world_destroy(world);
    world = make_world();
    begin(world, &t);
    steps(world, 3, dt);
    FAILS(world, SKEIN_ERROR_FILE, "could not be written", skein_record_end(world));
    tape last = {0};
    begin(world, &last); // a world that goes ends it
    skein_world_destroy(world);
    free(t.bytes);
    free(last.bytes);
}

static void damage(void **state) {
    (void)state;
    tape t = {0};
    skein_world *world = make_world(), *other = make_world();
    begin(world, &t);
    steps(world, 2, dt);
    OK(world, skein_record_end(world));
    skein_difference d;
    for (size_t i = 0; i < t.size; i += i < 60 ? 1 : 211) {
        if (i == 8 || (i >= 12 && i < 27)) continue; // an older version, a real's bytes, and the note
        t.bytes[i] ^= 2;
        skein_status status = skein_replay(other, t.bytes, t.size, &d);
        assert_true(status || !d.is_whole);
        t.bytes[i] ^= 2;
    }
    t.bytes[8] = 4;
    FAILS(other, SKEIN_ERROR_LIMIT, "a recording of version 4", skein_replay(other, t.bytes, t.size, &d));
    t.bytes[8] = 3;
    skein_world *third = new_world("xpbd", 4);
    FAILS(third, SKEIN_ERROR_VALUE, "this world", skein_replay(third, t.bytes, t.size, &d));
    skein_world_destroy(third);
    skein_world_destroy(other);
    skein_world_destroy(world);
    free(t.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_that_is_done),
        cmocka_unit_test(a_flipped_bit_is_named),
        cmocka_unit_test(where_it_ends),
        cmocka_unit_test(damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
