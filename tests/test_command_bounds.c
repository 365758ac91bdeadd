/* What a scene and a run may take of the machine: which files are read, memory, time; and that nobody's locale gets into
 * numbers. */
#include "test_command.h"

/* ---- Files that scenes name ------------------------------------------------------------------------- */

static void write_mesh(const char *path) {
    write_text(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

/* A scene with that mesh, checked from a folder where nothing lies. */
static outcome check_mesh(const char *mesh, const char *option, const char *value) {
    char text[1200], here[1024];
    static char scene[200];
    snprintf(scene, sizeof scene, "%s", in_folder("project/scenes/a.json"));
    snprintf(text, sizeof text, "{'frames': 1, 'bodies': [{'type': 'cloth', 'mesh': '%s'}]}", mesh);
    write_scene(scene, text);
    assert_non_null(getcwd(here, sizeof here));
    assert_int_equal(chdir(in_folder("elsewhere")), 0);
    outcome o = option ? SKEIN("check", scene, option, value) : SKEIN("check", scene);
    assert_int_equal(chdir(here), 0);
    return o;
}

static void assert_checks(int status, const char *mesh, const char *option, const char *value) {
    outcome o = check_mesh(mesh, option, value);
    if (o.status != status) fprintf(stderr, "mesh %s\n", mesh);
    assert_status(o, status);
    if (status) assert_contains(o.err, "; if you trust it: --allow-path ");
    outcome_free(&o);
}

static void a_scene_reads_only_beside_itself(void **state) {
    (void)state;
    static const char *const folders[] = {"project", "project/scenes", "project/scenes/in", "project/meshes",
                                          "outside", "outside/deep",   "elsewhere"};
    char path[600], named[900], link[600];
    for (size_t i = 0; i < COUNT(folders); i++) assert_int_equal(mkdir(in_folder(folders[i]), 0777), 0);
    static const char *const meshes[] = {"project/scenes/a.obj", "project/scenes/in/a.obj", "project/meshes/a.obj",
                                         "project/a.obj",        "outside/deep/a.obj",      "elsewhere/a.obj"};
    for (size_t i = 0; i < COUNT(meshes); i++) write_mesh(in_folder(meshes[i]));
    snprintf(link, sizeof link, "%s", in_folder("project/scenes/link.obj"));
    assert_int_equal(symlink("../../outside/deep/a.obj", link), 0);
    snprintf(path, sizeof path, "%s", in_folder("outside/deep/a.obj"));

    assert_checks(0, "a.obj", NULL, NULL);
    assert_checks(0, "in/../in/a.obj", NULL, NULL);
    assert_checks(0, "../meshes/a.obj", NULL, NULL);
    assert_checks(0, in_folder("elsewhere/a.obj"), NULL, NULL); // the current folder
    assert_checks(2, "../a.obj", NULL, NULL);
    assert_checks(2, "../../outside/deep/a.obj", NULL, NULL);
    assert_checks(2, "link.obj", NULL, NULL);
    assert_checks(2, path, NULL, NULL);
    // allowed: a folder with all that is in it, a file, another folder, one whose name only begins so
    assert_checks(0, "link.obj", "--allow-path", in_folder("outside"));
    assert_checks(0, path, "--allow-path", in_folder("outside/deep/"));
    assert_checks(0, path, "--allow-path", path);
    assert_checks(2, path, "--allow-path", in_folder("project"));
    assert_checks(2, path, "--allow-path", in_folder("out"));
    // what the user names himself
    snprintf(named, sizeof named, "bodies.0.mesh=%s", path);
    assert_checks(0, "a.obj", "--set", named);
    // images and caches, too
    snprintf(
        named, sizeof named,
        "{'bodies': [{'type': 'cloth', 'grid': [3, 3], 'pins': 'corners'}], 'motions': [{'type': 'cache', 'file': '%s'}]}",
        path);
    write_scene(in_folder("project/b.json"), named);
    outcome o = SKEIN("check", in_folder("project/b.json"));
    assert_status(o, 2);
    assert_contains(o.err, "--allow-path");
    outcome_free(&o);
    // the message names the file and the folder to allow
    o = check_mesh("link.obj", NULL, NULL);
    snprintf(named, sizeof named, "bodies.0.mesh: %s is not read: ", path);
    assert_contains(o.err, named);
    snprintf(named, sizeof named, "--allow-path %s\n", in_folder("outside/deep"));
    assert_contains(o.err, named);
    outcome_free(&o);
}

/* A run that goes on reads what it read. */
static void a_run_goes_on_with_what_was_allowed(void **state) {
    (void)state;
    char text[700];
    assert_int_equal(mkdir(in_folder("a"), 0777) || mkdir(in_folder("b"), 0777), 0);
    write_mesh(in_folder("b/m.obj"));
    snprintf(text, sizeof text, "{'frames': 3, 'output': ['pc2'], 'bodies': [{'type': 'cloth', 'mesh': '../b/m.obj'}]}");
    write_scene(in_folder("a/s.json"), text);
    outcome o = SKEIN("run", in_folder("a/s.json"), "--allow-path", in_folder("b"), "--out", in_folder("out"),
                      "--snapshots", "1", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    hash_of(SKEIN("run", "--resume", in_folder("out"), "--frames", "5"));
}

/* ---- Time and memory ------------------------------------------------------------------------------------ */

static void a_run_ends_when_its_time_is_up(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--frames", "100000000", "--max-time", "2", "--out", in_folder("out"), "--no-progress");
    assert_status(o, 1);
    assert_contains(o.err, "skein run: --max-time 2: the time is up");
    outcome_free(&o);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_true(json_is_true(json_object_get(report, "interrupted")));
    shape grid = shape_of_grid(5, 5);
    judge_files(in_folder("out/sheet"), &grid, (uint32_t)number_of(report, "frames") + 1);
    free(grid.corners);
    json_decref(report);
    // before it has begun
    o = SKEIN("run", s, "--set", "bodies.0.grid=[2000, 2000]", "--max-time", "0.01");
    assert_status(o, 1);
    assert_string_equal(o.err, "skein run: --max-time 0.01: the time is up, and nothing was finished\n");
    outcome_free(&o);
    // one that suffices makes no difference
    const char *plenty = SPARING ? "900000G" : "8G"; // sanitizers reserve terabytes
    o = SKEIN("run", s, "--max-time", "1000", "--max-memory", plenty);
    hash_of(o);
    assert_says(2, "", "skein run: --max-time soon: expected seconds, 0.01 to 1e7\n", "run", s, "--max-time", "soon");
    assert_says(2, "", "skein run: --max-memory 5x: expected a size from 1M, 500M or 2G\n", "run", s, "--max-memory",
                "5x");
}

static void memory_has_a_bound(void **state) {
    (void)state;
    if (SPARING) skip(); // its own memory is over any bound
    outcome o = SKEIN("run", tiny_scene(), "--set", "bodies.0.grid=[2000, 2000]", "--max-memory", "100M");
    if (!o.status) fail_msg("4 million particles in 100 MB");
    assert_contains(o.err, "memory");
    assert_contains(o.err, "skein: --max-memory 100M is all that it may have");
    outcome_free(&o);
}

/* ---- Locales ------------------------------------------------------------------------------------------------ */

/* Where a program has asked for a locale that writes 0,5, as one with a window would, files are the same. */
static void a_locale_changes_no_number(void **state) {
    (void)state;
    if (SPARING) skip(); // a sanitizer's library wants to be the first
    char command[300];
    snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s >/dev/null 2>&1", in_folder("de_DE.UTF-8"));
    if (system(command)) skip(); // no package locales
    static const char *const names[] = {"sheet.csv", "cloth.xdmf", "sheet.usda", "sheet_0004.obj", "sheet.mdd"};
    static const char outputs[] = "output=[\"csv\", \"hdf5\", \"usda\", \"mdd\", {\"type\": \"obj\", \"every\": 2}]";
    static const char pins[] = "bodies.0.pins=[{\"sphere\": [0.5, 0, 0.5, 0.25]}]";
    setenv("LOCPATH", folder, 1);
    setenv("LC_ALL", "de_DE.UTF-8", 1);
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--set", pins, "--out", in_folder("plain"), "--set", outputs, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN_IN((surroundings){.fail = "locale"}, "run", s, "--set", pins, "--out", in_folder("german"), "--set",
                 outputs, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    for (size_t i = 0; i < COUNT(names); i++) {
        char path[100];
        snprintf(path, sizeof path, "plain/%s", names[i]);
        io_bytes plain, german;
        assert_int_equal(io_file_read(in_folder(path), 1 << 26, &plain, NULL), 0);
        snprintf(path, sizeof path, "german/%s", names[i]);
        assert_int_equal(io_file_read(in_folder(path), 1 << 26, &german, NULL), 0);
        if (plain.size != german.size || memcmp(plain.data, german.data, plain.size)) fail_msg("%s", names[i]);
        io_bytes_free(&plain);
        io_bytes_free(&german);
    }
    read_report(in_folder("german/report.json"));
    unsetenv("LC_ALL");
    unsetenv("LOCPATH");
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(a_scene_reads_only_beside_itself), TEST(a_run_goes_on_with_what_was_allowed),
        TEST(a_run_ends_when_its_time_is_up),   TEST(memory_has_a_bound),
        TEST(a_locale_changes_no_number),
    };
    return cmocka_run_group_tests_name("command bounds", tests, NULL, NULL);
}
