/* Tests of `skein run`: every scene that we ship makes the files and the report that it should, and what a
 * run is told by its options arrives. */
#include "test_command.h"

#include <math.h>

/* ---- Running the scenes that we ship ---------------------------------------------------------------- */

/* Every key, and values that can be. */
static void judge_report(const json_t *report, int frames) {
    const struct {
        const char *key;
        double least, most;
    } numbers[] = {
        {"fps", 1, 1000},
        {"step", 1e-4, 1}, // a scene that goes on by keys may take a whole second
        {"time", 0, 1e3},
        {"particles", 2, 1e6},
        {"pinned_particles", 0, 1e3},
        {"constraints", 0, 1e6},
        {"contacts", 0, 1e6},
        {"load_seconds", 0, 100},
        {"run_seconds", 0, 200},
        {"ms_per_step", 0, 1e5},
        {"realtime_factor", 0, 1e6},
        {"kinetic_energy", 0, 5e3},
        {"potential_energy", -1e3, 1e3},
        {"elastic_energy", -1, 1e3}, // a gas that has expanded has given some away
        {"dissipated_energy", -1e3, 1e3},
        {"max_stretch", 0, 1},
        {"p99_stretch", 0, 1},
        {"worst_stretch_of_run", 0, 1},
        {"limited_edges", 0, 1e6},
        {"edges_over_limit", 0, 1e6},
        {"most_over_limit", 0, 1},
        {"worst_over_limit_of_run", 0, 1},
        {"max_penetration", 0, 0.1},
        {"warnings", 0, 10},
        {"memory_bytes", 1e3, 1e9},
        {"threads", 0, 64},
        {"steps", 0, 1e5},
        {"substeps", 0, 1e7},
        {"crossings", 0, 0},
        {"asleep_particles", 0, 1e6},
        {"worst_crossings_of_run", 0, 0},
        {"crossed_frames", 0, 0},
        {"contact_overflows", 0, 0},
        {"unsolved", 0, 0},
        {"solver_failures", 0, 0},
        {"nonfinite_particles", 0, 0},
        {"guarded_values", 0, 0},
        {"device_bytes", 0, 0},
        {"frames", frames, frames},
    };
    for (size_t i = 0; i < COUNT(numbers); i++) {
        double x = number_of(report, numbers[i].key);
        if (!(x >= numbers[i].least && x <= numbers[i].most)) fail_msg("'%s' is %g", numbers[i].key, x);
    }
    const json_t *flocks = json_object_get(report, "flocks"); // where there are some
    assert_int_equal(json_object_size(report), COUNT(numbers) + 13 + (flocks ? 1 : 0));
    for (size_t i = 0; i < json_array_size(flocks); i++) {
        const json_t *flock = json_array_get(flocks, i), *milling = json_object_get(flock, "milling");
        assert_int_equal(json_array_size(milling), (frames + 15) / 16 + 1);
        assert_int_equal(json_array_size(json_object_get(flock, "time")), json_array_size(milling));
        bool strewn = !strcmp(text_of(report, "name"), "whirl"); // all others begin in a ring
        double first = json_number_value(json_array_get(milling, 0));
        assert_true(first > (strewn ? 0 : 0.4) && first <= 1);
    }
    assert_string_equal(text_of(report, "skein"), SKEIN_VERSION);
    assert_true(strlen(text_of(report, "commit")) >= 7);
    assert_string_equal(json_string_value(json_array_get(json_object_get(report, "command_line"), 0)), "run");
    // the scene with all that was set: it is a good scene by itself
    const json_t *document = json_object_get(report, "document");
    assert_int_equal(number_of(document, "frames"), frames);
    assert_string_equal(text_of(report, "device"), "processor");
    assert_string_equal(text_of(report, "precision"), sizeof(skein_real) == 8 ? "double" : "float");
    assert_true(strlen(text_of(report, "scene")) > 0 && strlen(text_of(report, "method")) > 0);
    assert_non_null(text_of(report, "name"));
    assert_int_equal(strspn(text_of(report, "state_hash"), "0123456789abcdef"), 16);
    assert_true(json_is_false(json_object_get(report, "interrupted")));
    assert_true(fabs(number_of(report, "time") - frames / number_of(report, "fps")) < 1e-6);
    assert_true(fabs(number_of(report, "steps") * number_of(report, "step") - number_of(report, "time")) < 1e-6);
    assert_true(number_of(report, "p99_stretch") <= number_of(report, "max_stretch"));
    assert_true(number_of(report, "worst_stretch_of_run") >= number_of(report, "max_stretch"));
    assert_true((number_of(report, "steps") > 0) == (number_of(report, "ms_per_step") > 0));
    size_t index;
    json_t *file;
    json_array_foreach(json_object_get(report, "files"), index, file) assert_true(exists(json_string_value(file)));
}

static void judge_picture(const char *path) {
    char *bytes = read_text(path);
    assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x40\0\0\0\x30", 24);
    free(bytes);
}

static bool can_draw(void) {
    outcome o = SKEIN("list", "exporters");
    bool found = strstr(o.out, "\n  png: ") != NULL;
    outcome_free(&o);
    return found;
}

/* A mesh of a scene's first body or of a collider that is not there, as the scene calls it; else NULL. */
static const char *missing_mesh(json_t *scene) {
    json_t *body = json_array_get(json_object_get(scene, "bodies"), 0),
           *colliders = json_object_get(scene, "colliders");
    for (size_t i = 0; i <= json_array_size(colliders); i++) {
        const char *mesh = json_string_value(json_object_get(i ? json_array_get(colliders, i - 1) : body, "mesh"));
        char path[600];
        snprintf(path, sizeof path, "scenes/%s", mesh ? mesh : "");
        if (mesh && !exists(path)) return mesh;
    }
    return NULL;
}

/* Runs three frames of a scene, its grid made small, into the folder "out". */
static void run_scene(const char *path, bool draws) {
    json_t *scene = json_load_file(path, 0, NULL), *body = json_array_get(json_object_get(scene, "bodies"), 0);
    assert_non_null(body);
    const char *mesh = json_string_value(json_object_get(body, "mesh"));
    char file[600], mesh_path[600];
    snprintf(mesh_path, sizeof mesh_path, "scenes/%s", mesh ? mesh : "");
    const char *name = text_of(body, "name"), *title = text_of(scene, "name");
    const char *wanted = missing_mesh(scene);
    if (wanted) { // it is fetched from elsewhere
        outcome o = SKEIN("run", path, "--out", in_folder("out"));
        assert_status(o, 2);
        assert_contains(o.err, ".mesh: scenes/");
        assert_contains(o.err, wanted);
        outcome_free(&o);
        json_decref(scene);
        return;
    }
    // a mesh has nothing to be made small: what is set in its place has no effect
    const char *output = draws ? "output=[\"obj\", \"pc2\", { \"type\": \"png\", \"size\": [64, 48], \"samples\": 1 }]"
                               : "output=[\"pc2\", \"obj\"]";
    outcome o = SKEIN("run", path, "--out", in_folder("out"), "--frames", "3", "--no-progress", "--set", output,
                      "--set", mesh ? "skein=1" : "bodies.0.grid=[7,9]");
    if (strstr(path, "cape")) assert_contains(o.err, "comes out at its recovery"); // which begins inside on purpose
    else if (strstr(path, "statue"))
        assert_contains(o.err, "the field may miss what is thinner"); // fingers: make demo fetches it
    else assert_string_equal(o.err, "");
    assert_status(o, 0);

    shape s = mesh ? shape_of_mesh(mesh_path) : shape_of_grid(7, 9);
    snprintf(file, sizeof file, "%s/out/%s", folder, name);
    judge_files(file, &s, 4);
    free(s.corners);
    snprintf(file, sizeof file, "%s/out/%s.png", folder, title);
    for (char *c = file + strlen(folder); *c; c++)
        if (*c == ' ') *c = '_';
    if (draws) judge_picture(file);
    json_t *report = read_report(in_folder("out/report.json"));
    judge_report(report, 3);
    assert_string_equal(text_of(report, "scene"), path);
    assert_string_equal(text_of(report, "name"), title);
    assert_int_equal(json_array_size(json_object_get(report, "files")), draws ? 3 : 2);
    assert_int_equal(count_entries(in_folder("out")), draws ? 4 : 3);

    // the same in words
    snprintf(file, sizeof file, "\nstate hash %s\n", text_of(report, "state_hash"));
    assert_contains(o.out, file);
    assert_contains(o.out, " 3 frames, 3 steps of 16.67 ms\n");
    snprintf(file, sizeof file, "\nwrote %s/out/%s.obj\n", folder, name);
    assert_contains(o.out, file);
    snprintf(file, sizeof file, "\nwrote %s/out/report.json\n", folder);
    assert_contains(o.out, file);
    json_decref(report);
    json_decref(scene);
    outcome_free(&o);
}

/* A scene of other bodies than one cloth: three frames as it is, and a pair of files for each body. */
static void run_other_scene(const char *path, bool draws) {
    json_t *scene = json_load_file(path, 0, NULL), *bodies = json_object_get(scene, "bodies");
    outcome o = SKEIN("run", path, "--out", in_folder("out"), "--frames", "3", "--no-progress", "--set",
                      draws ? "output=[\"obj\", \"pc2\", { \"type\": \"png\", \"size\": [64, 48], \"samples\": 1 }]"
                            : "output=[\"pc2\", \"obj\"]");
    assert_string_equal(o.err, "");
    assert_status(o, 0);
    json_t *report = read_report(in_folder("out/report.json"));
    judge_report(report, 3);
    size_t files = 2 * json_array_size(bodies) + (draws ? 1 : 0);
    assert_int_equal(json_array_size(json_object_get(report, "files")), files);
    assert_int_equal(count_entries(in_folder("out")), files + 1);
    json_decref(report);
    json_decref(scene);
    outcome_free(&o);
}

static bool is_one_cloth(const char *path) {
    json_t *scene = json_load_file(path, 0, NULL), *bodies = json_object_get(scene, "bodies");
    assert_non_null(bodies);
    bool is = json_array_size(bodies) == 1 && !strcmp(text_of(json_array_get(bodies, 0), "type"), "cloth");
    json_decref(scene);
    return is;
}

static void every_scene_runs(void **state) {
    bool draws = can_draw();
    DIR *scenes = opendir("scenes");
    assert_non_null(scenes);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) {
        char path[512];
        if (!strstr(entry->d_name, ".json")) continue;
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        // a sanitizer sees some of them drawn, here and in test_render_scenes
        (is_one_cloth(path) ? run_scene : run_other_scene)(path, draws && (!SPARING || count % 5 == 0));
        assert_int_equal(remove_folder(state) || make_folder(state), 0);
        count++;
    }
    closedir(scenes);
    assert_true(count >= 11);
}

/* ---- What a run can be told -------------------------------------------------------------------------- */

static void runs_and_threads_give_the_same_bits(void **state) {
    (void)state;
    static const char *const scenes[] = {"scenes/drape.json", "scenes/flag.json"};
    for (size_t i = 0; i < COUNT(scenes); i++) {
        const char *s = scenes[i];
        uint64_t hash = hash_of(SKEIN("run", s, "--frames", "5"));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames", "5")));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames", "5", "--threads", "2")));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames=5", "--threads=1", "--out", in_folder("out"), "--set",
                                          "output=[\"pc2\"]")));
        assert_true(hash != hash_of(SKEIN("run", s, "--frames", "6")));
    }
}

static void sets_reach_what_they_name(void **state) {
    (void)state;
    const char *s = tiny_scene();
    uint64_t plain = hash_of(SKEIN("run", s));
    uint64_t soft = hash_of(SKEIN("run", s, "--set", "bodies.0.stretch.stiffness=5"));
    assert_true(soft != plain);
    assert_true(soft == hash_of(SKEIN("run", s, "--set", "bodies.sheet.stretch.stiffness=5")));
    assert_true(soft == hash_of(SKEIN("run", s, "--set=bodies.0.stretch.stiffness=9",
                                      "--set=bodies.sheet.stretch.stiffness=5")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "forces.weight.acceleration=[0,-1,0]")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "colliders.ball.centre=[0,-0.4,0]")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "method={\"type\": \"symplectic_euler\", \"substeps\": 40}")));
    assert_true(plain == hash_of(SKEIN("run", s, "--set", "bodies.0.visible=false", "--set", "name=other")));
}

static void frames_and_their_rate_can_be_told(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--out", in_folder("out/of/the/way/"), "--frames", "0");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    assert_contains(o.out, "; 0 frames, 0 steps of ");
    outcome_free(&o);
    json_t *report = read_report(in_folder("out/of/the/way/report.json"));
    judge_report(report, 0);
    assert_true(number_of(report, "kinetic_energy") == 0);
    json_decref(report);
    // names: the second body has none of its own, so it goes by its kind
    shape grid = shape_of_grid(5, 5), other = shape_of_grid(3, 3);
    judge_files(in_folder("out/of/the/way/sheet"), &grid, 1);
    judge_files(in_folder("out/of/the/way/cloth"), &other, 1);

    // two steps of 1/60 s make a frame of 1/30 s; --frames wins over --set
    o = SKEIN("run", s, "--out", in_folder("out"), "--fps", "30", "--set", "frames=9", "--frames", "5", "--set",
              "output.1={\"type\":\"pc2\",\"every\":2}");
    assert_status(o, 0);
    assert_contains(o.out, "; 5 frames, 10 steps of 16.67 ms\n");
    outcome_free(&o);
    report = read_report(in_folder("out/report.json"));
    judge_report(report, 5);
    assert_true(number_of(report, "fps") == 30 && number_of(report, "steps") == 10);
    json_decref(report);
    io_pc2_header header;
    io_pc2_reader *reader = io_pc2_open(in_folder("out/sheet.pc2"), &header, NULL);
    assert_non_null(reader);
    assert_int_equal(header.samples, 3); // frames 0, 2 and 4
    assert_true(header.rate == 2);
    io_pc2_close(reader);
    free(grid.corners);
    free(other.corners);

    assert_says(2, "", "skein: scenes/flag.json: step: a frame of 1000 s is more than 1000000 steps of 0.0001 s\n",
                "run", "scenes/flag.json", "--fps", "1e-3", "--set", "step=1e-4");
}

static void bodies_never_share_a_file(void **state) {
    (void)state;
    char *s = in_folder("names.json");
#define BODY(name_) "{ 'type': 'cloth', 'grid': [2, 2], 'name': '" name_ "' }"
#define BODIES BODY("a b") "," BODY("a_b") "," BODY("a/b") "," BODY("a_b-1") "," BODY("") "," BODY("cloth")
    write_scene(s, "{ 'frames': 1, 'name': '..', 'output': ['obj'],\n"
                   "  'bodies': [ " BODIES "," BODY("../up") "," BODY("h\u00fclle") " ] }");
    outcome o = SKEIN("run", s, "--out", in_folder("out"));
    assert_status(o, 0);
    assert_int_equal(count_entries(in_folder("out")), 9);
    assert_int_equal(count_entries(folder), 4);     // with the scene and the two captured streams
    assert_true(exists(in_folder("out/body.obj"))); // not a hidden file, and not above
    assert_true(exists(in_folder("out/cloth.obj")) && exists(in_folder("out/a_b.obj")) &&
                exists(in_folder("out/h\u00fclle.obj")));
    outcome_free(&o);
}

/* The second of two border vertices in one place goes where the first goes, and both are written. */
static void seams_are_welded_and_exported_as_they_came(void **state) {
    (void)state;
    char *s = in_folder("seam.json");
    write_text(in_folder("seam.obj"),
               "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 1 0 0\nv 1 0 1\nv 2 0 1\nv 2 0 0\nf 1 2 3 4\nf 5 6 7 8\n");
    write_scene(s, "{ 'frames': 3, 'output': ['obj', 'pc2'], 'forces': [ { 'type': 'gravity' } ],\n"
                   "  'bodies': [ { 'type': 'cloth', 'mesh': 'seam.obj', 'weld': 1e-6, 'pins': [0] } ] }");
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--no-progress");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    assert_int_equal(strncmp(o.out, "6 particles", 11), 0);
    outcome_free(&o);
    shape as_it_came = shape_of_mesh(in_folder("seam.obj"));
    judge_files(in_folder("out/cloth"), &as_it_came, 4);
    io_mesh mesh;
    assert_int_equal(io_mesh_read(in_folder("out/cloth.obj"), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    assert_memory_equal(mesh.positions + 9, mesh.positions + 12, 3 * sizeof(double));
    assert_memory_equal(mesh.positions + 6, mesh.positions + 15, 3 * sizeof(double));
    assert_true(mesh.positions[10] < -1e-3);
    io_mesh_free(&mesh);
    free(as_it_came.corners);

    // unwelded it is two pieces, which is worth a warning and no more
    o = SKEIN("check", s, "--set", "bodies.0.weld=0");
    assert_status(o, 0);
    assert_contains(o.err, "skein: warning: cloth: ");
    assert_contains(o.err, "border vertices lie on another one");
    assert_contains(o.out, "seam.json: good; 8 particles (1 pinned), ");
    assert_contains(o.out, ", 1 force, 0 colliders, xpbd; 2 warnings\n");
    outcome_free(&o);
}

/* A header with units, then a line for the start and for each step. */
static void a_log_has_a_line_a_step(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--frames", "3", "--fps", "30", "--log", in_folder("run.csv"), "--no-progress");
    assert_status(o, 0);
    assert_contains(o.out, "run.csv\n");
    outcome_free(&o);
    char *text = read_text(in_folder("run.csv")), *line = strtok(text, "\n");
    assert_non_null(
        strstr(line, "step,time (s),kinetic (J),potential (J),elastic (J),dissipated (J),momentum x (kg m/s)"));
    size_t columns = 1;
    for (const char *at = line; (at = strchr(at, ',')) != NULL; at++) columns++;
    double start = 0;
    for (int n = 0; n <= 6; n++) {
        char *at = strtok(NULL, "\n");
        assert_non_null(at);
        double value[32];
        for (size_t c = 0; c < columns; c++, at++) {
            value[c] = strtod(at, &at);
            assert_true(isfinite(value[c]));
            assert_int_equal(*at, c + 1 < columns ? ',' : 0);
        }
        assert_true(value[0] == n && fabs(value[1] - n / 60.0) < 1e-8);
        // the account of energies is kept
        double all = value[2] + value[3] + value[4];
        if (!n) start = all;
        assert_true(fabs(value[5] - (start - all)) < 1e-6);
    }
    assert_null(strtok(NULL, "\n"));
    free(text);

    // a run that blows up leaves its log, which says how it came to it
    o = SKEIN("run", s, "--log", in_folder("bad.csv"), "--no-progress", "--frames", "400", "--set",
              "method={\"type\":\"explicit_euler\",\"substeps\":1}", "--set", "bodies.0.stretch.stiffness=1e6");
    assert_status(o, 1);
    assert_contains(o.err, "blew up");
    assert_true(exists(in_folder("bad.csv")));
    outcome_free(&o);
    o = SKEIN("run", s, "--log", in_folder("no/such/run.csv"), "--no-progress", "--out", in_folder("not made"));
    assert_status(o, 2);
    assert_contains(o.err, "no/such/run.csv");
    assert_false(exists(in_folder("not made")));
    outcome_free(&o);
}

/* ---- What is said, and how ------------------------------------------------------------------------- */

/* What begins inside a collider takes its time to come out of it; loose particles fly off by themselves, and gulls sit on rocks. */
static void a_start_inside_a_collider_is_told(void **state) {
    (void)state;
    outcome o = SKEIN("check", "drape", "--set", "bodies.0.position=[0, 0.6, 0]");
    assert_status(o, 0);
    assert_contains(o.err, "'cloth' lies 0.3 m deep in 'ball', and comes out at its recovery of 1 m/s, in 0.3 s");
    outcome_free(&o);
    o = SKEIN("check", "gulls");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    outcome_free(&o);
}

/* Surfaces that begin in each other are told of, and so is in how many frames they were. */
static void a_start_in_each_other_is_told(void **state) {
    (void)state;
    const char *path = in_folder("crossed.json");
    write_text(path,
               "{\"skein\": 1, \"frames\": 60, \"bodies\": ["
               "{\"type\": \"cloth\", \"name\": \"a\", \"grid\": [20, 20], \"size\": [0.3, 0.3]},"
               "{\"type\": \"cloth\", \"name\": \"b\", \"grid\": [19, 19], \"size\": [0.3, 0.3],"
               " \"position\": [0.21, 0, 0.19], \"rotation\": [20, 10, 30]}], \"forces\": [{\"type\": \"contact\"}]}");
    outcome o = SKEIN("check", path);
    assert_status(o, 0);
    assert_contains(o.err, "edges go through faces at the start: contact leads surfaces apart at its recovery");
    outcome_free(&o);
    o = SKEIN("run", path, "--no-progress");
    assert_status(o, 0);
    assert_contains(o.out, "frames had edges that go through faces");
    assert_contains(o.out, "; 0 at the end");
    outcome_free(&o);
}

/* A blow-up may stay finite: limits hold a sheet together, and a spring turns faster and faster. */
static void an_end_beyond_bounds_is_no_success(void **state) {
    (void)state;
    outcome o = SKEIN("run", "hanging", "--set", "method.type=symplectic_euler", "--set", "bodies.0.grid=9 9", "--set",
                      "method.substeps=1", "--set", "bodies.0.stretch.stiffness=2e5", "--frames", "40", "--no-progress",
                      "--out", in_folder("out"), "--set", "output=[]");
    assert_status(o, 1);
    assert_contains(o.err, "warning: scenes/hanging.json: symplectic_euler is stable with substeps of ");
    const char *remedy = strstr(o.err, "set method.substeps to ");
    assert_non_null(remedy);
    assert_contains(o.err, "ended far beyond its bounds: an edge is stretched by ");
    json_t *report = read_report(in_folder("out/report.json"));
    assert_contains(text_of(report, "failed"), "most_stretch is 100 %");
    json_decref(report);
    // the remedy is one
    char enough[64];
    snprintf(enough, sizeof enough, "method.substeps=%d", atoi(remedy + strlen("set method.substeps to ")));
    outcome_free(&o);
    o = SKEIN("run", "hanging", "--set", "method.type=symplectic_euler", "--set", "bodies.0.grid=9 9", "--set",
              "bodies.0.stretch.stiffness=2e5", "--frames", "40", "--no-progress", "--set", enough);
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    outcome_free(&o);
    // one who means it says so
    write_scene(in_folder("long.json"),
                "{ 'frames': 60, 'bodies': [ { 'type': 'cloth', 'grid': [2, 2], 'pins': 'top edge', 'density': 1,\n"
                "  'stretch': { 'stiffness': 0.3, 'limit': 'infinite', 'tether': 'infinite' } } ],\n"
                "  'forces': [ { 'type': 'gravity' } ] }");
    o = SKEIN("run", in_folder("long.json"), "--quiet");
    assert_status(o, 1);
    outcome_free(&o);
    o = SKEIN("run", in_folder("long.json"), "--quiet", "--set", "most_stretch=infinite");
    assert_status(o, 0);
    outcome_free(&o);
}

static void energy_from_nowhere_is_no_success(void **state) {
    (void)state;
    // a stone thrown into a spring of formulas has no edges that could be too long
    write_scene(in_folder("orbit.json"),
                "{ 'frames': 200, 'method': { 'type': 'explicit_euler', 'substeps': 1 },\n"
                "  'bodies': [ { 'type': 'flock', 'count': 1, 'speed': 0, 'side': 1 } ],\n"
                "  'forces': [ { 'type': 'potential', 'energy': '40 * dot(p - vec3(1, 0, 0), p - vec3(1, 0, 0))' } ] }");
    outcome o = SKEIN("run", in_folder("orbit.json"), "--no-progress");
    assert_status(o, 1);
    assert_contains(o.err, "its energy has grown by ");
    assert_contains(o.err, "nothing does work on it; ");
    outcome_free(&o);
    // a method that keeps energy, and one where something pushes
    o = SKEIN("run", in_folder("orbit.json"), "--no-progress", "--set", "method.type=leapfrog");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("run", in_folder("orbit.json"), "--no-progress", "--set", "method.type=leapfrog", "--set",
              "forces=[{\"type\": \"wind\", \"force\": [1, 0, 0]}]");
    assert_status(o, 0);
    outcome_free(&o);
}

/* All steps' unsolved substeps are counted, not the last one's. */
static void what_was_not_solved_is_told(void **state) {
    (void)state;
    const char *arguments[] = {"run",
                               "hanging",
                               "--no-progress",
                               "--frames",
                               "6",
                               "--set",
                               "bodies.0.grid=9 9",
                               "--set",
                               "method.type=backward_euler",
                               "--set",
                               "method.cg_iterations=1",
                               "--set",
                               "method.newton_iterations=1",
                               "--json",
                               NULL};
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_status(o, 0);
    json_t *report = json_loads(o.out, 0, NULL);
    assert_non_null(report);
    double unsolved = number_of(report, "unsolved");
    assert_true(unsolved > 0 && unsolved <= number_of(report, "substeps"));
    json_decref(report);
    outcome_free(&o);
    arguments[13] = NULL;
    o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_contains(o.out, "substeps were left unsolved");
    outcome_free(&o);
}

static void a_run_says_as_much_as_it_is_asked_to(void **state) {
    (void)state;
    const char *s = tiny_scene();
    assert_says(0, "", "", "run", s, "--quiet");
    assert_says(0, "", "", "render", s, "--quiet", "-o", in_folder("a.png"), "--frame", "1", "--size", "64x36");
    // the report, to standard output: the same that --out writes
    outcome o = SKEIN("run", s, "--json", "--set", "method.substeps=4", "--out", in_folder("out"), "--no-progress");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    json_t *said = json_loads(o.out, 0, NULL), *written = read_report(in_folder("out/report.json"));
    assert_non_null(said);
    static const char *const same[] = {"state_hash", "document", "command_line", "commit", "frames", "unsolved"};
    for (size_t i = 0; i < COUNT(same); i++) {
        assert_non_null(json_object_get(said, same[i]));
        assert_true(json_equal(json_object_get(said, same[i]), json_object_get(written, same[i])));
    }
    // the document runs again, to the same state
    const json_t *method = json_object_get(json_object_get(said, "document"), "method");
    assert_string_equal(text_of(method, "type"), "xpbd"); // the scene has none: it is the world's
    assert_int_equal(json_dump_file(json_object_get(said, "document"), in_folder("again.json"), 0), 0);
    uint64_t hash = strtoull(text_of(said, "state_hash"), NULL, 16);
    assert_true(hash == hash_of(SKEIN("run", in_folder("again.json"))));
    json_decref(said);
    json_decref(written);
    outcome_free(&o);
}

static void files_of_one_run_have_different_names(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    static const char *const logs[] = {"out/report.json", "out/../out/report.json", "out/sheet.csv", "out/sheet.obj"};
    for (size_t i = 0; i < COUNT(logs); i++) {
        assert_true(!mkdir(in_folder("out"), 0777) || errno == EEXIST);
        snprintf(words, sizeof words, "skein run: --log %s: the run itself writes a file of that name into --out %s\n",
                 in_folder(logs[i]), in_folder("out"));
        assert_says(2, "", words, "run", s, "--out", in_folder("out"), "--log", in_folder(logs[i]));
        assert_int_equal(count_entries(in_folder("out")), 0);
    }
    hash_of(SKEIN("run", s, "--out", in_folder("out"), "--log", in_folder("out/log.csv")));
    assert_true(exists(in_folder("out/log.csv")) && exists(in_folder("out/report.json")));
    assert_says(2, "", "skein run: --out -: a run writes many files into a folder; --json prints its report\n", "run",
                s, "--out", "-");
}

/* The farthest that a point of two caches is apart in their last samples. */
static double farthest_apart(const char *a, const char *b) {
    io_pc2_header of[2];
    io_pc2_reader *reader[2] = {io_pc2_open(a, &of[0], NULL), io_pc2_open(b, &of[1], NULL)};
    assert_true(reader[0] && reader[1] && of[0].points == of[1].points && of[0].samples == of[1].samples);
    double *x[2], farthest = 0;
    for (int i = 0; i < 2; i++) {
        x[i] = malloc(3 * of[i].points * sizeof *x[i]);
        assert_int_equal(io_pc2_read(reader[i], of[i].samples - 1, x[i], NULL), SKEIN_OK);
        io_pc2_close(reader[i]);
    }
    for (size_t k = 0; k < 3 * (size_t)of[0].points; k += 3)
        farthest = fmax(farthest, sqrt(pow(x[0][k] - x[1][k], 2) + pow(x[0][k + 1] - x[1][k + 1], 2) +
                                       pow(x[0][k + 2] - x[1][k + 2], 2)));
    free(x[0]), free(x[1]);
    return farthest;
}

/* An animated surface holds a cloth that has no pins: no farther off than it says, nor behind it. What only leads pins needs
 * some. */
static void a_cache_holds_what_is_free(void **state) {
    (void)state;
    char s[512], led[600], free_fall[600];
    snprintf(s, sizeof s, "%s", in_folder("s.json"));
    snprintf(led, sizeof led, "%s", in_folder("led/t.pc2"));
    write_scene(s, "{'frames': 30, 'bodies': [{'type': 'cloth', 'name': 't', 'grid': [9, 9]}], 'output': ['pc2'],"
                   " 'forces': [{'type': 'gravity', 'acceleration': [0, -0.5, 0]}]}");
    hash_of(SKEIN("run", s, "--out", in_folder("led")));
    static const struct {
        const char *says;
        double most;
    } rows[] = {{"\"max_distance\": 0.1", 0.1},
                {"\"max_distance\": 0.1, \"backstop\": 0.02, \"backstop_radius\": 20", 0.1},
                {"\"pull\": 1000", 0.01}};
    for (size_t i = 0; i < COUNT(rows); i++) {
        char motion[300];
        snprintf(motion, sizeof motion, "motions=[{\"type\": \"cache\", \"file\": \"led/t.pc2\", %s}]", rows[i].says);
        hash_of(
            SKEIN("run", s, "--out", in_folder("held"), "--set", motion, "--set", "forces.0.acceleration=[0,-9.81,0]"));
        snprintf(free_fall, sizeof free_fall, "%s", in_folder("held/t.pc2"));
        double far = farthest_apart(led, free_fall);
        if (i == 0) assert_true(fabs(far - rows[i].most) < 1e-4);
        assert_true(far < rows[i].most + 1e-4);
    }
    outcome o = SKEIN("run", s, "--out", in_folder("held"), "--set",
                      "motions=[{\"type\": \"cache\", \"file\": \"led/t.pc2\"}]");
    assert_status(o, 2);
    assert_contains(o.err, "the body has no pins that a cache could lead");
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(every_scene_runs),
        TEST(runs_and_threads_give_the_same_bits),
        TEST(sets_reach_what_they_name),
        TEST(a_cache_holds_what_is_free),
        TEST(a_start_inside_a_collider_is_told),
        TEST(a_start_in_each_other_is_told),
        TEST(an_end_beyond_bounds_is_no_success),
        TEST(energy_from_nowhere_is_no_success),
        TEST(what_was_not_solved_is_told),
        TEST(a_run_says_as_much_as_it_is_asked_to),
        TEST(files_of_one_run_have_different_names),
        TEST(frames_and_their_rate_can_be_told),
        TEST(a_log_has_a_line_a_step),
        TEST(bodies_never_share_a_file),
        TEST(seams_are_welded_and_exported_as_they_came),
    };
    return cmocka_run_group_tests_name("command run", tests, NULL, NULL);
}
