/* The commands record and verify, and what a run that blows up leaves. */
#include "test_command.h"

#include <skein/record.h>

#include "io/scene.h"

static const char *sheet(void) {
    static char path[512];
    snprintf(path, sizeof path, "%s/sheet.json", folder);
    write_scene(
        path,
        "{'frames': 40, 'fps': 100, 'step': 0.01, 'bodies': [{'type': 'rope', 'name': 'line', 'count': 9}, {'type': 'cloth', "
        "'name': 'cape', 'grid': [9, 9], 'pins': 'corners', 'position': [0, 1, 0]}], 'forces': [{'type': "
        "'gravity'}], 'colliders': [{'type': 'sphere', 'radius': 0.3}]}");
    return path;
}

static void what_was_done_is_done_again(void **state) {
    (void)state;
    const char *scene = sheet();
    char path[700], part[900];
    snprintf(path, sizeof path, "%s", in_folder("a.skeinrec"));
    outcome o = SKEIN("record", scene, "-o", path, "--no-progress", "--at", "10 colliders.0.radius=0.4", "--at",
                      "20 forces.0.acceleration=[0, -3, 0]", "--at", "25 bodies.line.name=cord", "--at",
                      "30 bodies.cape.stretch.limit=infinite");
    assert_status(o, 0);
    assert_contains(o.out, "state hash");
    char hash[40];
    snprintf(hash, sizeof hash, "%.27s", strstr(o.out, "state hash"));
    outcome_free(&o);
    o = SKEIN("verify", path, "--threads", "3");
    assert_status(o, 0);
    assert_contains(o.out, "40 steps, the same to the bit");
    assert_contains(o.out, hash);
    outcome_free(&o);
    // another file in between, and one that is none
    o = SKEIN("verify", scene);
    assert_status(o, 2);
    assert_contains(o.err, "it is no recording");
    outcome_free(&o);
    io_bytes bytes;
    assert_int_equal(io_file_read(path, 1 << 28, &bytes, NULL), 0);
    FILE *file = fopen(in_folder("cut"), "wb");
    snprintf(part, sizeof part, "%s", in_folder("cut"));
    assert_true(file && fwrite(bytes.data, 1, bytes.size / 2, file) == bytes.size / 2 && !fclose(file));
    io_bytes_free(&bytes);
    o = SKEIN("verify", part);
    assert_status(o, 0);
    assert_contains(o.out, "breaks off");
    outcome_free(&o);
    // changes that are none, and no room
    o = SKEIN("record", scene, "-o", path, "--at", "colliders.0.radius=1");
    assert_status(o, 2);
    outcome_free(&o);
    o = SKEIN("record", scene, "-o", path, "--quiet", "--at", "5 colliders.7.radius=1");
    assert_status(o, 1);
    assert_contains(o.err, "there is no 7");
    outcome_free(&o);
    char full[700];
    snprintf(full, sizeof full, "%s", in_folder("full.skeinrec"));
    for (rlim_t limit = 100; limit < 20000; limit *= 3) {
        o = SKEIN_IN((surroundings){.file_limit = limit}, "record", scene, "-o", full, "--quiet");
        assert_status(o, 1);
        assert_contains(o.err, "cannot write");
        assert_false(exists(full));
        outcome_free(&o);
    }
}

static bool put(void *user, const void *bytes, size_t size) {
    return fwrite(bytes, 1, size, user) == size;
}

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

/* A recording of a world in which the lowest bit of a velocity tips over after step 500 of 1,000, past all calls. */
static void a_flipped_bit_is_named(void **state) {
    (void)state;
    static const skein_kind *const none[] = {NULL};
    const char *scene_path = sheet();
    char path[700], note[4000], words[200];
    snprintf(path, sizeof path, "%s", in_folder("flipped"));
    char *text = read_text(scene_path);
    snprintf(note, sizeof note, "{\"path\": \"%s\", \"scene\": %s}", scene_path, text);
    free(text);
    io_faults faults = {report, NULL, 0, NULL};
    io_scene *scene = io_scene_read(scene_path, NULL, none, &faults);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    FILE *file = fopen(path, "wb");
    assert_true(world && file);
    skein_recorder to = {.write = put, .user = file, .note = note};
    assert_int_equal(skein_record_begin(world, &to), SKEIN_OK);
    for (int step = 0; step < 1000; step++) {
        if (step == 500) {
            skein_view v = skein_velocity_view(world);
            *(unsigned char *)(uintptr_t)(v.xyzw + 4 * (size_t)v.slot_of[9 + 37]) ^= 1;
        }
        assert_int_equal(skein_world_step(world, 0.01), SKEIN_OK);
    }
    assert_int_equal(skein_record_end(world), SKEIN_OK);
    assert_int_equal(fclose(file), 0);
    skein_world_destroy(world);
    io_scene_free(scene);
    outcome o = SKEIN("verify", path);
    assert_status(o, 1);
    snprintf(words, sizeof words, "differs after step 500: body cape, particle 37 of it (46): velocity\n");
    assert_contains(o.out, words);
    outcome_free(&o);
}

static void a_blow_up_can_be_done_again(void **state) {
    (void)state;
    char scene[600], out[600], path[900];
    snprintf(scene, sizeof scene, "%s/stiff.json", folder);
    snprintf(out, sizeof out, "%s", in_folder("out"));
    // springs that are far too stiff for the step, on a rope that is not
    write_scene(
        scene,
        "{'frames': 400, 'method': {'type': 'symplectic_euler', 'substeps': 4}, 'bodies': [{'type': 'rope', "
        "'name': 'line', 'count': 5, 'pins': '0', 'stretch': {'stiffness': 10, 'limit': 'infinite', 'tether': 'infinite'}}], 'constraints': [{'type': 'distance', 'name': "
        "'stiff', 'particles': {'body': 'line', 'over': 'edges'}, 'stiffness': 1e9}], 'forces': [{'type': "
        "'gravity'}], 'output': ['pc2']}");
    outcome o = SKEIN("run", scene, "--out", out, "--no-progress");
    assert_status(o, 1);
    assert_contains(o.err, "blow_up/README.txt");
    char *failed = strdup(strstr(o.err, "blew up in frame"));
    failed[strcspn(failed, ":")] = 0;
    outcome_free(&o);
    snprintf(path, sizeof path, "%s/blow_up/README.txt", out);
    char *text = read_text(path);
    assert_contains(text, "The rule that went first: constraint 0, stiff.");
    assert_contains(text, "of body 0, line");
    free(text);
    snprintf(path, sizeof path, "%s/blow_up", out);
    o = SKEIN("run", "--resume", path, "--no-progress");
    assert_status(o, 1);
    assert_contains(o.err, failed); // in the same frame
    outcome_free(&o);
    free(failed);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_was_done_is_done_again, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_flipped_bit_is_named, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_blow_up_can_be_done_again, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
