/* Motions: pins that a world leads by itself, from a program and from scenes. */
#include "all_methods.h"
#include "helpers.h"
#include <unistd.h>

#include "io/pc2.h"
#include "io/scene.h"

static const double dt = 1.0 / 64;

static skein_world *three_pins(const char *method) {
    skein_world *world = new_world(method, 4);
    OK(world, skein_body_add(world, "rope", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "line"), SKEIN_REAL("count", 5),
                                            SKEIN_VEC3("from", 0, 0, 0), SKEIN_VEC3("to", 4, 0, 0),
                                            SKEIN_TEXT("pins", "0 2 4"), SKEIN_REAL("stretch.stiffness", 100)),
                             NULL));
    return world;
}

static skein_handle add_motion(skein_world *world, const char *kind, const skein_setting *settings) {
    skein_handle handle;
    OK(world, skein_motion_add(world, kind, NULL, settings, &handle));
    return handle;
}

static void check_place(skein_world *world, size_t particle, double x, double y, double z) {
    vec3 p = position_of(world, particle);
    assert_near(p.x, x, 20 * EPSILON);
    assert_near(p.y, y, 20 * EPSILON);
    assert_near(p.z, z, 20 * EPSILON);
}

static void each_kind_leads_where_it_says(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = three_pins(all_methods[m]);
        add_motion(world, "translate",
                   SKEIN_SETTINGS(SKEIN_TEXT("on", "line"), SKEIN_VEC3("velocity", 0, 2, 0), SKEIN_REAL("start", 0.25)));
        skein_handle turn = add_motion(world, "turn",
                                       SKEIN_SETTINGS(SKEIN_TEXT("pins", "4, sphere 0 0 0 0.1"),
                                                      SKEIN_REAL("speed", PI / 2), SKEIN_VEC3("centre", 2, 0, 0)));
        add_motion(world, "keys",
                   SKEIN_SETTINGS(SKEIN_TEXT("pins", "2"), SKEIN_TEXT("keys", "0 0 0 0, 0.5 0 0 1, 1 0 0 0"),
                                  SKEIN_REAL("smooth", 0)));
        steps(world, 16, dt);
        check_place(world, 0, 2 - 2 * cos(PI / 8), 0, 2 * sin(PI / 8));
        check_place(world, 2, 2, 0, 0.5);
        steps(world, 32, dt); // 0.75 s
        check_place(world, 0, 2 - 2 * cos(3 * PI / 8), 1, 2 * sin(3 * PI / 8));
        check_place(world, 4, 2 + 2 * cos(3 * PI / 8), 1, -2 * sin(3 * PI / 8));
        check_place(world, 2, 2, 1, 0.5);
        // the same again, after a reset and from a time in between
        uint64_t hash = skein_world_hash(world);
        OK(world, skein_world_reset(world));
        steps(world, 48, dt);
        assert_true(skein_world_hash(world) == hash);
        OK(world, skein_world_time_set(world, 0.25));
        steps(world, 32, dt);
        check_place(world, 0, 2 - 2 * cos(3 * PI / 8), 1, 2 * sin(3 * PI / 8));
        // what is let go is led no more; what a program says counts; what is removed leads nobody
        OK(world, skein_particle_pin(world, 2, false));
        OK(world, skein_pins_move(world, (uint32_t[]){4}, 1, (double[]){7, 8, 9}));
        steps(world, 1, dt);
        check_place(world, 4, 7, 8, 9);
        OK(world, skein_remove(world, turn));
        steps(world, 15, dt);
        check_place(world, 0, 0, 1.5, 0);
        assert_true(fabs(position_of(world, 2).y - 1.5) > 1e-3);
        skein_world_destroy(world);
    }
}

static void keys_turn_wait_and_repeat(void **state) {
    (void)state;
    skein_world *world = three_pins("xpbd");
    skein_handle keys = add_motion(world, "keys",
                                   SKEIN_SETTINGS(SKEIN_TEXT("keys", "0.5 0 0 0, 1.5 0 1 0 0 90 0, 2.5 0 0 0"),
                                                  SKEIN_VEC3("centre", 4, 0, 0), SKEIN_REAL("repeat", 1)));
    steps(world, 16, dt);
    check_place(world, 0, 0, 0, 0); // not yet
    steps(world, 48, dt);           // 1 s: half way, and as fast as it gets
    check_place(world, 0, 4 - 4 * cos(PI / 4), 0.5, 4 * sin(PI / 4));
    steps(world, 32, dt);
    check_place(world, 0, 4, 1, 4);
    steps(world, 64 + 32, dt); // 3 s is 1 s
    check_place(world, 0, 4 - 4 * cos(PI / 4), 0.5, 4 * sin(PI / 4));
    OK(world, skein_set(world, keys, "keys", skein_text("0 0 0 3")));
    steps(world, 1, dt);
    check_place(world, 0, 0, 0, 3);
    FAILS(world, SKEIN_ERROR_VALUE, "key 1: expected", skein_set(world, keys, "keys", skein_text("0 0 0 3, 1 2")));
    FAILS(world, SKEIN_ERROR_VALUE, "not after", skein_set(world, keys, "keys", skein_text("1 0 0 3, 1 0 0 4")));
    FAILS(world, SKEIN_ERROR_VALUE, "key 0: expected", skein_set(world, keys, "keys", skein_text("")));
    steps(world, 1, dt);
    check_place(world, 0, 0, 0, 3); // the old one is still there
    skein_world_destroy(world);
}

static void tracks_are_followed(void **state) {
    (void)state;
    skein_world *world = three_pins("rk4");
    const uint32_t particles[] = {4, 0};
    const double places[] = {4, 0, 0, 0, 0, 0, 5, 0, 0, 0, 1, 0, 5, 0, 2, 0, 1, 0};
    const skein_track track = {particles, places, 2, 3, 0.5};
    skein_handle handle;
    OK(world, skein_motion_add(world, "cache", &track, SKEIN_SETTINGS(SKEIN_TEXT("on", "line")), &handle));
    steps(world, 16, dt);
    check_place(world, 4, 4.5, 0, 0);
    check_place(world, 0, 0, 0.5, 0);
    steps(world, 32, dt);
    check_place(world, 4, 5, 0, 1);
    steps(world, 64, dt); // it ends there
    check_place(world, 4, 5, 0, 2);
    check_place(world, 2, 2, 0, 0);
    OK(world, skein_set(world, handle, "repeat", skein_number(1))); // 1.75 s is 0.75 s
    OK(world, skein_world_time_set(world, 1.75 - dt));
    steps(world, 1, dt);
    check_place(world, 4, 5, 0, 1);
    assert_false(skein_field_is_live(world, handle, "file"));
    FAILS(world, SKEIN_ERROR_VALUE, "needs places", skein_motion_add(world, "cache", NULL, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "takes no places", skein_motion_add(world, "turn", &track, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "no particle 9",
          skein_motion_add(world, "cache", &(skein_track){(uint32_t[]){9}, places, 1, 1, 1}, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "interval",
          skein_motion_add(world, "cache", &(skein_track){particles, places, 2, 3, 0}, NULL, NULL));
    const double wild[] = {0, NAN, 0};
    FAILS(world, SKEIN_ERROR_VALUE, "finite",
          skein_motion_add(world, "cache", &(skein_track){particles, wild, 1, 1, 1}, NULL, NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "axis",
          skein_motion_add(world, "turn", NULL, SKEIN_SETTINGS(SKEIN_VEC3("axis", 0, 0, 0)), NULL));
    FAILS(world, SKEIN_ERROR_NAME, "no motion 'trun'", skein_motion_add(world, "trun", NULL, NULL, NULL));
    add_motion(world, "turn", SKEIN_SETTINGS(SKEIN_TEXT("on", "lime")));
    FAILS(world, SKEIN_ERROR_NAME, "no body or group of the name 'lime'", skein_world_step(world, dt));
    OK(world, skein_set_path(world, "motions.1.on", skein_text("line")));
    skein_world_destroy(world);
}

/* A living motion is not given a body or pins that are not there: what it had stays, and it goes on. */
static void motions_are_given_what_is_there(void **state) {
    (void)state;
    skein_world *world = three_pins("xpbd");
    skein_value value;
    skein_handle motion =
        add_motion(world, "translate", SKEIN_SETTINGS(SKEIN_TEXT("on", "line"), SKEIN_VEC3("velocity", 0, 2, 0)));
    FAILS(world, SKEIN_ERROR_NAME, "no body or group of the name 'lime'",
          skein_set(world, motion, "on", skein_text("lime")));
    FAILS(world, SKEIN_ERROR_NAME, "'top edge'", skein_set(world, motion, "pins", skein_text("top edge")));
    FAILS(world, SKEIN_ERROR_VALUE, "out of range", skein_set(world, motion, "pins", skein_text("7")));
    OK(world, skein_get(world, motion, "on", &value));
    assert_string_equal(value.text, "line");
    OK(world, skein_get(world, motion, "pins", &value));
    assert_string_equal(value.text, "");
    steps(world, 32, dt);
    check_place(world, 0, 0, 1, 0);
    OK(world, skein_set(world, motion, "pins", skein_text("0, 2")));
    // where it goes to another body, its pins are to be there, too
    OK(world,
       skein_body_add(world, "rope", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "short"), SKEIN_REAL("count", 2)), NULL));
    FAILS(world, SKEIN_ERROR_VALUE, "out of range", skein_set(world, motion, "on", skein_text("short")));
    OK(world, skein_set(world, motion, "on", skein_text("")));
    OK(world, skein_set(world, motion, "name", skein_text("lift"))); // which is any
    steps(world, 32, dt);
    check_place(world, 0, 0, 2, 0);
    skein_world_destroy(world);
}

/* ---- scenes ---- */

typedef struct told {
    char words[2000];
} told;

static void tell(void *user, const skein_error *error) {
    told *all = user;
    size_t length = strlen(all->words);
    snprintf(all->words + length, sizeof all->words - length, "%s: %s\n", error->where, error->message);
}

static skein_world *build(const char *text, told *all) {
    all->words[0] = 0;
    io_faults faults = {tell, all, 0, NULL};
    io_scene *scene =
        io_scene_read_text(text, strlen(text), "x.json", NULL, (const skein_kind *const[]){NULL}, &faults);
    skein_world *world = scene ? io_scene_build(scene, NULL, &faults) : NULL;
    io_scene_free(scene);
    return world;
}

#define CLOTH \
    "\"bodies\": [{\"type\": \"cloth\", \"name\": \"flag\", \"grid\": [3, 4], \"pins\": \"left edge\", \"groups\": \"held\"}]"

static void write_cache(const char *path, uint32_t points) {
    skein_error error;
    double *xyz = calloc(points, 3 * sizeof *xyz);
    io_pc2_writer *writer = io_pc2_create(path, (io_pc2_header){points, 0, 2, 3}, &error);
    assert_non_null(writer);
    for (uint32_t s = 0; s < 3; s++) {
        for (uint32_t i = 0; i < points; i++) xyz[3 * i] = i, xyz[3 * i + 1] = s;
        assert_int_equal(io_pc2_add(writer, xyz, &error), SKEIN_OK);
    }
    assert_int_equal(io_pc2_commit(writer, &error), SKEIN_OK);
    free(xyz);
}

static void scenes_lead_pins(void **state) {
    (void)state;
    told all;
    skein_world *world = build(
        "{" CLOTH
        ", \"motions\": [{\"type\": \"keys\", \"on\": \"flag\", \"keys\": [[0, 0, 0, 0], [1, 0.5, 0, 0, 0, 90, 0]], "
        "\"smooth\": false}, {\"type\": \"translate\", \"velocity\": [0, 1, 0], \"pins\": [0, 4]}]}",
        &all);
    if (!world) fail_msg("%s", all.words);
    vec3 first = position_of(world, 0), last = position_of(world, 8);
    steps(world, 64, dt);
    check_place(world, 0, 0.5 + first.z, 1, -first.x);
    check_place(world, 8, 0.5 + last.z, 0, -last.x); // only 0 and 4 rise
    skein_world_destroy(world);

    char path[] = "/tmp/skein_cache_XXXXXX", text[600];
    int file = mkstemp(path);
    assert_true(file >= 0);
    for (uint32_t points = 3; points <= 12; points += 9) { // the pins, all of them
        write_cache(path, points);
        snprintf(text, sizeof text,
                 "{" CLOTH ", \"motions\": [{\"type\": \"cache\", \"on\": \"flag\", \"file\": \"%s\", \"fps\": 4}]}",
                 path);
        world = build(text, &all);
        if (!world) fail_msg("%s", all.words);
        steps(world, 48, dt); // a sample each half a second
        check_place(world, 8, points == 3 ? 2 : 8, 1.5, 0);
        skein_world_destroy(world);
    }
    write_cache(path, 5);
    assert_null(build(text, &all));
    assert_non_null(strstr(
        all.words,
        "x.json: motions.0.file: the file has 5 points: expected as many as the body has vertices (12), particles (12) or pins (3)"));
    unlink(path);
    assert_null(build(text, &all));
    assert_non_null(strstr(all.words, "motions.0.file: /tmp/skein_cache_"));
}

static void scenes_say_what_is_wrong(void **state) {
    (void)state;
    static const struct {
        const char *motion, *words;
    } faults[] = {
        {"\"type\": \"keys\", \"keys\": [[0, 0, 0, 0], [1, 2]]",
         "x.json: motions.0.keys: key 1: expected a time and 3 numbers"},
        {"\"type\": \"keys\", \"keys\": [[0, 0, \"a\", 0]]", "x.json: motions.0.keys: "},
        {"\"type\": \"keys\", \"keys\": [[]]", "x.json: motions.0.keys: "},
        {"\"type\": \"turn\", \"axis\": [0, 0, 0]", "x.json: motions.0.axis: an axis cannot be zero"},
        {"\"type\": \"turn\", \"sped\": 1", "x.json: motions.0.sped: turn has no field 'sped'; did you mean 'speed'?"},
        {"\"type\": \"twist\"", "x.json: motions.0.type: there is no motion 'twist'"},
        {"\"type\": \"cache\"", "x.json: motions.0.file: expected the name of a PC2 file"},
        {"\"type\": \"cache\", \"on\": \"flog\", \"file\": \"a\"",
         "x.json: motions.0.on: there is no body of the name 'flog'"},
        {"\"type\": \"cache\", \"on\": \"held\", \"file\": \"a\"",
         "x.json: motions.0.on: there is no body of the name 'held'; it is the name of a group, and one body is meant"},
        {"\"type\": \"turn\", \"name\": \"round\", \"on\": \"flog\"",
         "x.json: motions.0.on: there is no body or group of the name 'flog'; did you mean 'flag'?"},
    };
    for (size_t i = 0; i < COUNT(faults); i++) {
        char text[600];
        told all;
        snprintf(text, sizeof text, "{" CLOTH ", \"motions\": [{%s}]}", faults[i].motion);
        assert_null(build(text, &all));
        if (!strstr(all.words, faults[i].words)) fail_msg("%s\nexpected %s", all.words, faults[i].words);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_leads_where_it_says), cmocka_unit_test(keys_turn_wait_and_repeat),
        cmocka_unit_test(tracks_are_followed),           cmocka_unit_test(scenes_lead_pins),
        cmocka_unit_test(scenes_say_what_is_wrong),      cmocka_unit_test(motions_are_given_what_is_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
