/* Tests of the command as its users see it: arguments and help, runs and their files, reports, and what
 * happens when a disk is full, a pipe is closed or somebody presses Ctrl-C. */
#include "test_command.h"

#include <inttypes.h>
#include <math.h>

#include "io/exporters.h"
#include "io/mesh.h"
#include "io/pc2.h"
#include "io/scene.h"

/* ---- Arguments ------------------------------------------------------------------------------------ */

#define RUN_USAGE "usage: skein run SCENE [--out FOLDER] [options]\n"

static void wrong_arguments_are_told(void **state) {
    (void)state;
    static const struct {
        const char *arguments[5], *words;
    } wrong[] = {
        {{"fly"}, "skein: there is no command 'fly'; `skein --help` shows all\n"},
        {{"runn"}, "skein: there is no command 'runn'; did you mean 'run'? `skein --help` shows all\n"},
        {{"help", "chek"}, "skein: there is no command 'chek'; did you mean 'check'? `skein --help` shows all\n"},
        {{"--frames"}, "skein: there is no command '--frames'; `skein --help` shows all\n"},
        {{"run"}, "skein run: which scene? " RUN_USAGE},
        {{"check"}, "skein check: which scene? usage: skein check SCENE [--set PATH=VALUE]...\n"},
        {{"explain", "--set", "a=b"}, "skein explain: which scene? usage: skein explain SCENE [--set PATH=VALUE]...\n"},
        {{"run", "a.json", "b.json"}, "skein run: 'b.json' is one argument too many; " RUN_USAGE},
        {{"run", "a.json", "--", "--quiet"}, "skein run: '--quiet' is one argument too many; " RUN_USAGE},
        {{"run", "a.json", "--frame", "3"}, "skein run: there is no option --frame; did you mean 'frames'? `skein run --help` shows all\n"},
        {{"run", "a.json", "--frame=3"}, "skein run: there is no option --frame; did you mean 'frames'? `skein run --help` shows all\n"},
        {{"run", "-x", "a.json"}, "skein run: there is no option -x; `skein run --help` shows all\n"},
        {{"check", "a.json", "--frames", "3"}, "skein check: there is no option --frames; `skein check --help` shows all\n"},
        {{"run", "a.json", "--frames"}, "skein run: --frames takes N\n"},
        {{"run", "a.json", "--out"}, "skein run: --out takes FOLDER\n"},
        {{"run", "a.json", "--quiet=yes"}, "skein run: --quiet takes no value\n"},
        {{"check", "a.json", "--set"}, "skein check: --set takes PATH=VALUE\n"},
        {{"run", "a.json", "--frames", "many"}, "skein run: --frames many: expected a whole number\n"},
        {{"run", "a.json", "--frames", "5x"}, "skein run: --frames 5x: expected a whole number\n"},
        {{"run", "a.json", "--frames="}, "skein run: --frames : expected a whole number\n"},
        {{"run", "a.json", "--frames", "1.5"}, "skein run: --frames 1.5: expected a whole number, not 1.5\n"},
        {{"run", "a.json", "--frames", "-1"}, "skein run: --frames -1: -1 is out of range: expected from 0 to 1e+08\n"},
        {{"run", "a.json", "--fps", "0"}, "skein run: --fps 0: 0 is out of range: expected from 0.001 to 1e+06 1/s\n"},
        {{"run", "a.json", "--fps", "nan"}, "skein run: --fps nan: nan is out of range: expected from 0.001 to 1e+06 1/s\n"},
        {{"run", "a.json", "--threads", "0"}, "skein run: --threads 0: 0 is out of range: expected from 1 to 64\n"},
        {{"run", "a.json", "--threads", "65"}, "skein run: --threads 65: 65 is out of range: expected from 1 to 64\n"},
        {{"run", "no/such.json"}, "skein: no/such.json: cannot read: no such file or directory\n"},
        {{"list", "cats", "dogs"}, "skein list: 'dogs' is one argument too many; "
                                   "usage: skein list [scene|bodies|constraints|forces|colliders|methods|exporters|KIND]\n"},
        {{"list", "bodys"}, "skein list: there is no list or kind 'bodys'; did you mean 'bodies'? "
                            "usage: skein list [scene|bodies|constraints|forces|colliders|methods|exporters|KIND]\n"},
        {{"list", "spere"}, "skein list: there is no list or kind 'spere'; did you mean 'sphere'? "
                            "usage: skein list [scene|bodies|constraints|forces|colliders|methods|exporters|KIND]\n"},
    };
    for (size_t i = 0; i < COUNT(wrong); i++) {
        const char *const *a = wrong[i].arguments;
        assert_says(2, "", wrong[i].words, a[0], a[1], a[2], a[3]);
    }
}

static int longest_line(const char *text) {
    int longest = 0;
    for (; *text; text += strcspn(text, "\n"), text += *text == '\n')
        if ((int)strcspn(text, "\n") > longest) longest = (int)strcspn(text, "\n");
    return longest;
}

static void help_is_there_when_asked_for(void **state) {
    (void)state;
    static const char *const asking[] = {"--help", "-h", "help"};
    outcome top = SKEIN("--help");
    assert_status(top, 0);
    assert_string_equal(top.err, "");
    for (size_t i = 1; i < COUNT(asking); i++) assert_says(0, top.out, "", asking[i]);
    // without a word it is help, too, but no success
    assert_says(2, "", top.out, NULL);

    static const char *const commands[] = {"run", "check", "explain", "list"};
    for (size_t c = 0; c < COUNT(commands); c++) {
        char words[64];
        snprintf(words, sizeof words, "\n  %s ", commands[c]);
        assert_contains(top.out, words);
        outcome o = SKEIN(commands[c], "--help");
        assert_status(o, 0);
        assert_string_equal(o.err, "");
        snprintf(words, sizeof words, "usage: skein %s ", commands[c]);
        assert_int_equal(strncmp(o.out, words, strlen(words)), 0);
        assert_true(longest_line(o.out) <= 120);
        assert_says(0, o.out, "", "help", commands[c]);
        assert_says(0, o.out, "", commands[c], "scenes/flag.json", "-h");
        outcome_free(&o);
    }
    static const char *const options[] = {"--out FOLDER", "--frames N", "--fps N", "--threads N", "--set PATH=VALUE", "--quiet", "--help"};
    outcome o = SKEIN("run", "--help");
    for (size_t i = 0; i < COUNT(options); i++) {
        char words[64];
        snprintf(words, sizeof words, "\n  %s ", options[i]);
        assert_contains(o.out, words);
    }
    outcome_free(&o);
    assert_says(0, sizeof(skein_real) == 8 ? "skein " SKEIN_VERSION " (double)\n" : "skein " SKEIN_VERSION "\n", "", "--version");
    outcome_free(&top);
}

/* ---- Running the scenes that we ship ---------------------------------------------------------------- */

static json_t *read_report(const char *path) {
    json_error_t error;
    json_t *report = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!report) fail_msg("%s:%d: %s", path, error.line, error.text);
    return report;
}

static double number_of(const json_t *report, const char *key) {
    const json_t *value = json_object_get(report, key);
    if (!json_is_number(value)) fail_msg("the report has no number '%s'", key);
    return json_number_value(value);
}

static const char *text_of(const json_t *report, const char *key) {
    const char *text = json_string_value(json_object_get(report, key));
    if (!text) fail_msg("the report has no text '%s'", key);
    return text;
}

/* Every key, and values that can be. */
static void judge_report(const json_t *report, int frames) {
    const struct {
        const char *key;
        double least, most;
    } numbers[] = {
        {"fps", 1, 1000},         {"step", 1e-4, 0.1},         {"time", 0, 1e3},          {"particles", 4, 1e6},
        {"held_particles", 0, 1e3}, {"constraints", 1, 1e6},     {"contacts", 0, 1e6},      {"load_seconds", 0, 100},
        {"run_seconds", 0, 200},  {"ms_per_step", 0, 1e5},     {"realtime_factor", 0, 1e6}, {"kinetic_energy", 0, 1e3},
        {"max_stretch", 0, 1},    {"p99_stretch", 0, 1},       {"worst_stretch_of_run", 0, 1}, {"max_penetration", 0, 0.1},
        {"warnings", 0, 10},      {"memory_bytes", 1e3, 1e9},  {"threads", 1, 64},        {"steps", 0, 1e5},
        {"substeps", 0, 1e7},     {"nonfinite_particles", 0, 0}, {"frames", frames, frames},
    };
    for (size_t i = 0; i < COUNT(numbers); i++) {
        double x = number_of(report, numbers[i].key);
        if (!(x >= numbers[i].least && x <= numbers[i].most)) fail_msg("'%s' is %g", numbers[i].key, x);
    }
    assert_int_equal(json_object_size(report), COUNT(numbers) + 8);
    assert_string_equal(text_of(report, "skein"), SKEIN_VERSION);
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

/* What a body of a scene must look like in files. */
typedef struct shape {
    size_t vertex_count, face_count;
    uint32_t *corners; /* of all faces, in order */
    size_t corner_count;
} shape;

static shape shape_of_grid(uint32_t rows, uint32_t columns) {
    shape s = {rows * columns, (rows - 1) * (columns - 1), malloc(4 * rows * columns * sizeof *s.corners), 0};
    for (uint32_t r = 0; r + 1 < rows; r++)
        for (uint32_t c = 0; c + 1 < columns; c++) {
            uint32_t a = r * columns + c, quad[] = {a, a + columns, a + columns + 1, a + 1};
            for (int k = 0; k < 4; k++) s.corners[s.corner_count++] = quad[k];
        }
    return s;
}

static shape shape_of_mesh(const char *path) {
    io_mesh mesh;
    assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    shape s = {mesh.vertex_count, mesh.face_count, malloc(mesh.face_vertex_count * sizeof *s.corners), mesh.face_vertex_count};
    memcpy(s.corners, mesh.face_vertices, mesh.face_vertex_count * sizeof *s.corners);
    io_mesh_free(&mesh);
    return s;
}

/* The OBJ has the input's vertices and faces in their order, the PC2 a sample of each frame, and its last one
 * is the OBJ. */
static void judge_files(const char *path_without_ending, const shape *s, uint32_t samples) {
    char path[600];
    skein_error error;
    io_mesh mesh;
    io_pc2_header header;
    snprintf(path, sizeof path, "%s.obj", path_without_ending);
    assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error), SKEIN_OK);
    assert_int_equal(mesh.vertex_count, s->vertex_count);
    assert_int_equal(mesh.face_count, s->face_count);
    assert_int_equal(mesh.face_vertex_count, s->corner_count);
    assert_memory_equal(mesh.face_vertices, s->corners, s->corner_count * sizeof *s->corners);

    snprintf(path, sizeof path, "%s.pc2", path_without_ending);
    io_pc2_reader *reader = io_pc2_open(path, &header, &error);
    assert_non_null(reader);
    assert_int_equal(header.points, s->vertex_count);
    assert_int_equal(header.samples, samples);
    assert_true(header.start == 0);
    double *positions = malloc(3 * s->vertex_count * sizeof *positions);
    assert_int_equal(io_pc2_read(reader, samples - 1, positions, &error), SKEIN_OK);
    for (size_t i = 0; i < 3 * s->vertex_count; i++) assert_true((float)positions[i] == (float)mesh.positions[i]);
    free(positions);
    io_pc2_close(reader);
    io_mesh_free(&mesh);
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

/* Runs three frames of a scene, its grid made small, into the folder "out". */
static void run_scene(const char *path, bool draws) {
    json_t *scene = json_load_file(path, 0, NULL), *body = json_array_get(json_object_get(scene, "bodies"), 0);
    assert_non_null(body);
    const char *mesh = json_string_value(json_object_get(body, "mesh"));
    char file[600], mesh_path[600];
    snprintf(mesh_path, sizeof mesh_path, "scenes/%s", mesh ? mesh : "");
    const char *name = text_of(body, "name"), *title = text_of(scene, "name");
    if (mesh && !exists(mesh_path)) { // it is fetched from elsewhere
        outcome o = SKEIN("run", path, "--out", in_folder("out"));
        assert_status(o, 2);
        assert_contains(o.err, "bodies.0.mesh: scenes/");
        outcome_free(&o);
        json_decref(scene);
        return;
    }
    // a mesh has nothing to be made small: what is set in its place has no effect
    const char *output = draws ? "output=[\"obj\", \"pc2\", { \"type\": \"png\", \"size\": [64, 48], \"samples\": 1 }]" : "output=[\"pc2\", \"obj\"]";
    outcome o = SKEIN("run", path, "--out", in_folder("out"), "--frames", "3", "--quiet", "--set", output, "--set", mesh ? "skein=1" : "bodies.0.grid=[7,9]");
    assert_string_equal(o.err, "");
    assert_status(o, 0);

    shape s = mesh ? shape_of_mesh(mesh_path) : shape_of_grid(7, 9);
    snprintf(file, sizeof file, "%s/out/%s", folder, name);
    judge_files(file, &s, 4);
    free(s.corners);
    snprintf(file, sizeof file, "%s/out/%s.png", folder, title);
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

static void every_scene_runs(void **state) {
    bool draws = can_draw();
    DIR *scenes = opendir("scenes");
    assert_non_null(scenes);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(scenes)) != NULL;) {
        char path[512];
        if (!strstr(entry->d_name, ".json")) continue;
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        run_scene(path, draws);
        assert_int_equal(remove_folder(state) || make_folder(state), 0);
        count++;
    }
    closedir(scenes);
    assert_true(count >= 5);
}

/* ---- What a run can be told -------------------------------------------------------------------------- */

static const char tiny[] = "{ \"name\": \"my scene/1\", \"frames\": 4, \"output\": [\"obj\", \"pc2\"],\n"
                           "  \"bodies\": [ { \"type\": \"cloth\", \"name\": \"sheet\", \"grid\": [5, 5], \"pins\": \"corners\" },\n"
                           "    { \"type\": \"cloth\", \"grid\": [3, 3], \"position\": [0, 1, 0] } ],\n"
                           "  \"forces\": [ { \"type\": \"gravity\", \"name\": \"weight\" } ],\n"
                           "  \"colliders\": [ { \"type\": \"sphere\", \"name\": \"ball\", \"centre\": [0, -0.6, 0] } ] }\n";

static const char *tiny_scene(void) {
    static char path[512];
    snprintf(path, sizeof path, "%s/tiny.json", folder);
    write_text(path, tiny);
    return path;
}

/* The hash of a run's end; the outcome is expected to be good. */
static uint64_t hash_of(outcome o) {
    const char *words = strstr(o.out, "state hash ");
    assert_status(o, 0);
    assert_non_null(words);
    uint64_t hash = strtoull(words + strlen("state hash "), NULL, 16);
    assert_true(hash != 0);
    outcome_free(&o);
    return hash;
}

static void runs_and_threads_give_the_same_bits(void **state) {
    (void)state;
    static const char *const scenes[] = {"scenes/drape.json", "scenes/flag.json"};
    for (size_t i = 0; i < COUNT(scenes); i++) {
        const char *s = scenes[i];
        uint64_t hash = hash_of(SKEIN("run", s, "--frames", "5"));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames", "5")));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames", "5", "--threads", "2")));
        assert_true(hash == hash_of(SKEIN("run", s, "--frames=5", "--threads=1", "--out", in_folder("out"), "--set", "output=[\"pc2\"]")));
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
    assert_true(soft == hash_of(SKEIN("run", s, "--set=bodies.0.stretch.stiffness=9", "--set=bodies.sheet.stretch.stiffness=5")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "forces.weight.acceleration=[0,-1,0]")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "colliders.ball.centre=[0,-0.4,0]")));
    assert_true(plain != hash_of(SKEIN("run", s, "--set", "method={\"type\": \"symplectic_euler\"}")));
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
    o = SKEIN("run", s, "--out", in_folder("out"), "--fps", "30", "--set", "frames=9", "--frames", "5", "--set", "output.1={\"type\":\"pc2\",\"every\":2}");
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

    assert_says(2, "", "skein: scenes/flag.json: step: a frame of 1000 s is more than 1000000 steps of 0.0001 s\n", "run", "scenes/flag.json",
                "--fps", "1e-3", "--set", "step=1e-4");
}

static void bodies_never_share_a_file(void **state) {
    (void)state;
    char *s = in_folder("names.json");
#define BODY(name_) "{ \"type\": \"cloth\", \"grid\": [2, 2], \"name\": \"" name_ "\" }"
    write_text(s, "{ \"frames\": 1, \"name\": \"..\", \"output\": [\"obj\"], \"bodies\": [ " BODY("a b") ", " BODY("a_b") ", " BODY("a/b") ", "
                  BODY("a_b-1") ", " BODY("") ", " BODY("cloth") ", " BODY("../up") ", " BODY("h\u00fclle") " ] }");
    outcome o = SKEIN("run", s, "--out", in_folder("out"));
    assert_status(o, 0);
    assert_int_equal(count_entries(in_folder("out")), 9);
    assert_int_equal(count_entries(folder), 4); // with the scene and the two captured streams
    assert_true(exists(in_folder("out/cloth.obj")) && exists(in_folder("out/a_b.obj")) && exists(in_folder("out/h\u00fclle.obj")));
    outcome_free(&o);
}

/* The second of two border vertices in one place goes where the first goes, and both are written. */
static void seams_are_welded_and_exported_as_they_came(void **state) {
    (void)state;
    char *s = in_folder("seam.json");
    write_text(in_folder("seam.obj"), "v 0 0 0\nv 0 0 1\nv 1 0 1\nv 1 0 0\nv 1 0 0\nv 1 0 1\nv 2 0 1\nv 2 0 0\nf 1 2 3 4\nf 5 6 7 8\n");
    write_text(s, "{ \"frames\": 3, \"output\": [\"obj\", \"pc2\"], \"forces\": [ { \"type\": \"gravity\" } ],\n"
                  "  \"bodies\": [ { \"type\": \"cloth\", \"mesh\": \"seam.obj\", \"weld\": 1e-6, \"pins\": [0] } ] }");
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--quiet");
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
    assert_contains(o.out, "seam.json: good; 8 particles (1 held), ");
    assert_contains(o.out, ", 1 force, 0 colliders, xpbd; 2 warnings\n");
    outcome_free(&o);
}

/* ---- check, explain, list ------------------------------------------------------------------------------ */

static void check_counts_what_is_there(void **state) {
    (void)state;
    char words[600];
    const char *s = tiny_scene();
    snprintf(words, sizeof words, "%s: good; 34 particles (4 held), 140 constraints, 1 force, 1 collider, xpbd; 0 warnings\n", s);
    // 5 x 5: 40 edges, 32 diagonals, 30 over folds; 3 x 3: 12, 8 and 6; and 12 more by what is set
    assert_says(0, words, "", "check", s, "--set",
                "constraints=[{\"type\":\"distance\",\"particles\":[0,25,1,26,2,27,3,28,4,29,5,30,6,31,7,32,8,33,9,25,10,26,11,27]}]");
}

static void explain_shows_every_kind_of_row(void **state) {
    (void)state;
    static const char *const kinds[] = {"combine", "grid", "field", "neighbour", "force", "project", "multiplier", "contact F", "contact V", "contact X", "limit", "repeat"};
    bool seen[COUNT(kinds)] = {false};
    static const char *const methods[] = {"method={\"type\":\"symplectic_euler\"}", "method={\"type\":\"xpbd\",\"iterations\":2}"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        outcome o = SKEIN("explain", tiny_scene(), "--set", methods[m], "--set", "forces=[{\"type\":\"gravity\"},{\"type\":\"separation\"}]", "--fps", "60");
        assert_status(o, 2); // --fps is of `run` only
        outcome_free(&o);
        o = SKEIN("explain", tiny_scene(), "--set", methods[m], "--set", "forces=[{\"type\":\"gravity\"},{\"type\":\"separation\"}]", "--set", "fps=30");
        assert_status(o, 0);
        assert_string_equal(o.err, "");
        assert_contains(o.out, m == 0 ? ": symplectic_euler, a step of 0.0166667 s, 2 a frame\n" : ": xpbd, a step of 0.0166667 s, 2 a frame\n");
        assert_contains(o.out, "= ball, ");
        assert_contains(o.out, " elements, ordered\n");
        assert_true(longest_line(o.out) <= 120);
        for (size_t k = 0; k < COUNT(kinds); k++) {
            char words[32];
            snprintf(words, sizeof words, "\n    %s ", kinds[k]);
            seen[k] |= strstr(o.out, words) != NULL;
            snprintf(words, sizeof words, "\n%s ", kinds[k]);
            seen[k] |= strstr(o.out, words) != NULL;
        }
        outcome_free(&o);
    }
    for (size_t k = 0; k < COUNT(kinds); k++)
        if (!seen[k]) fail_msg("no plan has a row '%s'", kinds[k]);
}

/* The field has a line of its own behind `at`, with its help's first word. */
static void expect_field(const char *at, const skein_field *field) {
    char words[64];
    snprintf(words, sizeof words, "\n    %-18s ", field->name);
    const char *line = strstr(at, words);
    if (!line) fail_msg("no field '%s' in\n%s", field->name, at);
    size_t length = strcspn(line + 1, "\n"), first = strcspn(field->help, " ");
    snprintf(words, sizeof words, " %.*s", (int)first, field->help);
    const char *found = strstr(line + 23, words);
    if (!found || found > line + 1 + length) fail_msg("no help in '%.*s'", (int)length, line + 1);
    if (field->unit[0] && ((found = strstr(line + 23, field->unit)) == NULL || found > line + 1 + length)) fail_msg("no unit '%s'", field->unit);
}

static void expect_kind(const char *text, const skein_kind *kind) {
    char words[64];
    snprintf(words, sizeof words, "\n  %s: ", kind->name);
    const char *at = strstr(text, words);
    if (!at) fail_msg("no kind '%s'", kind->name);
    const char *end = strstr(at, "\n\n");
    char *block = strndup(at, end ? (size_t)(end - at) : strlen(at));
    for (size_t i = 0; i < kind->field_count; i++) expect_field(block, &kind->fields[i]);
    free(block);
    // and alone
    outcome o = SKEIN("list", kind->name);
    assert_status(o, 0);
    assert_contains(o.out, words);
    size_t common_count;
    const skein_field *common = skein_common_fields(kind->category, &common_count);
    for (size_t i = 0; i < common_count; i++) expect_field(o.out, &common[i]);
    outcome_free(&o);
}

static void list_shows_every_kind_and_field(void **state) {
    (void)state;
    static const char *const words[] = {"bodies", "constraints", "forces", "colliders", "methods", "scene", "exporters"};
    outcome all = SKEIN("list");
    assert_status(all, 0);
    assert_string_equal(all.err, "");
    assert_true(longest_line(all.out) <= 120);
    size_t length = 0;
    for (int c = 0; c < SKEIN_CATEGORY_COUNT; c++) {
        outcome o = SKEIN("list", words[c]);
        assert_status(o, 0);
        assert_contains(all.out, o.out);
        length += strlen(o.out);
        for (size_t i = 0; skein_kind_at((skein_category)c, i); i++) expect_kind(o.out, skein_kind_at((skein_category)c, i));
        for (size_t i = 0; c == SKEIN_EXPORTER && io_exporter_at(i); i++) expect_kind(o.out, io_exporter_at(i));
        if (c == SKEIN_SCENE) expect_kind(o.out, io_scene_kind());
        for (size_t i = 0; c == SKEIN_SCENE && io_scene_section_at(i); i++) assert_contains(o.out, io_scene_section_at(i)->name);
        size_t common_count;
        const skein_field *common = skein_common_fields((skein_category)c, &common_count);
        for (size_t i = 0; i < common_count; i++) expect_field(o.out, &common[i]);
        outcome_free(&o);
    }
    assert_int_equal(strlen(all.out), length);
    assert_contains(all.out, "\n    stiffness          10000 N/m        0 to infinite      force a metre of stretch;");
    assert_contains(all.out, "\n    restitution        0                0 to 1             ");
    assert_contains(all.out, "\n    normals            area             area|uniform|angle what ");
    outcome_free(&all);
}

/* ---- Trouble ----------------------------------------------------------------------------------------- */

static void a_file_in_the_way_is_told(void **state) {
    (void)state;
    char words[1024];
    const char *s = tiny_scene();
    write_text(in_folder("file"), "mine");
    static const char *const ways[] = {"file", "file/", "file/below", "new/../file/below"};
    for (size_t i = 0; i < COUNT(ways); i++) {
        char *out = in_folder(ways[i]);
        snprintf(words, sizeof words, "skein run: --out %s: cannot write there: there is a file where a folder should be\n", out);
        assert_says(2, "", words, "run", s, "--out", out);
        char *text = read_text(in_folder("file"));
        assert_string_equal(text, "mine");
        free(text);
    }
    assert_false(exists(in_folder("new")));
    assert_says(2, "", "skein run: --out '': expected the name of a folder, up to 1023 bytes\n", "run", s, "--out", "");
    // a directory under a file's name: the run fails at its end, the other files are whole
    assert_int_equal(mkdir(in_folder("out"), 0777) || mkdir(in_folder("out/sheet.obj"), 0777), 0);
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--quiet");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it is a directory\n", in_folder("out/sheet.obj"));
    assert_string_equal(o.err, words);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(json_array_size(json_object_get(report, "files")), 3);
    json_decref(report);
    outcome_free(&o);
    if (geteuid() == 0) return; // the superuser may write everywhere
    assert_int_equal(chmod(folder, 0555), 0);
    snprintf(words, sizeof words, "skein run: --out %s: cannot write there: Permission denied\n", in_folder("closed"));
    o = SKEIN_IN(((surroundings){.out = STDERR_FILENO}), "run", s, "--out", in_folder("closed"));
    chmod(folder, 0777);
    assert_status(o, 2);
    outcome_free(&o);
}

static void a_full_disk_leaves_nothing_half_written(void **state) {
    (void)state;
    char words[600];
    const char *s = tiny_scene();
    // the point cache outgrows the limit in some frame
    outcome o = SKEIN_IN((surroundings){.file_limit = 30000}, "run", s, "--out", in_folder("out"), "--frames", "400", "--quiet");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it grew over the limit for a file's size\n", in_folder("out/sheet.pc2"));
    assert_string_equal(o.err, words);
    assert_string_equal(o.out, "");
    assert_false(exists(in_folder("out")));
    outcome_free(&o);
    // the mesh does, at the end; the rest is whole, and the report lists what there is
    o = SKEIN_IN((surroundings){.file_limit = 2000}, "run", s, "--out", in_folder("out"), "--quiet", "--set", "output=[\"obj\"]", "--set", "bodies.1.grid=[2,2]");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it grew over the limit for a file's size\n", in_folder("out/sheet.obj"));
    assert_string_equal(o.err, words);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 2);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(json_array_size(json_object_get(report, "files")), 1);
    json_decref(report);
    assert_true(exists(in_folder("out/cloth.obj")));
    // what stood there before still stands
    write_text(in_folder("out/sheet.pc2"), "old");
    o = SKEIN_IN((surroundings){.file_limit = 30000}, "run", s, "--out", in_folder("out"), "--frames", "400", "--quiet");
    assert_status(o, 1);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 3);
    char *text = read_text(in_folder("out/sheet.pc2"));
    assert_string_equal(text, "old");
    free(text);
}

static void output_that_cannot_be_printed_is_told(void **state) {
    (void)state;
    int full = open("/dev/full", O_WRONLY | O_CLOEXEC), ends[2];
    assert_true(full >= 0);
    outcome o = SKEIN_IN((surroundings){.out = full}, "list");
    assert_status(o, 1);
    assert_string_equal(o.err, "skein: cannot write to standard output: No space left on device\n");
    outcome_free(&o);
    close(full);
    // nobody reads: the files are there all the same
    assert_int_equal(pipe2(ends, O_CLOEXEC), 0);
    close(ends[0]);
    o = SKEIN_IN((surroundings){.out = ends[1]}, "run", tiny_scene(), "--out", in_folder("out"), "--quiet");
    assert_status(o, 1);
    assert_string_equal(o.err, "skein: cannot write to standard output: Broken pipe\n");
    assert_int_equal(count_entries(in_folder("out")), 5);
    outcome_free(&o);
    // nor the faults
    o = SKEIN_IN(((surroundings){.out = ends[1], .err = ends[1]}), "check", "tests/bad/scenes/empty.json");
    assert_status(o, 2);
    outcome_free(&o);
    close(ends[1]);
}

/* Waits up to a minute until the folder has a file that is being written. */
static void wait_for_part(const char *path) {
    const struct timespec pause = {0, 5000000};
    for (int i = 0; i < 12000; i++) {
        DIR *open_folder = opendir(path);
        bool found = false;
        for (struct dirent *entry; open_folder && (entry = readdir(open_folder)) != NULL;) found |= strstr(entry->d_name, ".part") != NULL;
        if (open_folder) closedir(open_folder);
        if (found) return;
        nanosleep(&pause, NULL);
    }
    fail_msg("the run did not begin");
}

static void an_interrupted_run_writes_what_it_has(void **state) {
    (void)state;
    static const int signals[] = {SIGINT, SIGTERM};
    for (size_t i = 0; i < COUNT(signals); i++) {
        pid_t child = start_skein((surroundings){0}, (const char *const[]){"run", tiny_scene(), "--out", in_folder("out"), "--frames", "100000000", "--quiet", NULL});
        wait_for_part(in_folder("out"));
        kill(child, signals[i]);
        outcome o = finish_skein(child);
        assert_status(o, 128 + signals[i]);
        assert_string_equal(o.err, "");
        assert_contains(o.out, " (interrupted)\n");
        json_t *report = read_report(in_folder("out/report.json"));
        assert_true(json_is_true(json_object_get(report, "interrupted")));
        int frames = (int)number_of(report, "frames");
        assert_true(frames < 100000000);
        shape grid = shape_of_grid(5, 5);
        judge_files(in_folder("out/sheet"), &grid, (uint32_t)frames + 1);
        assert_int_equal(count_entries(in_folder("out")), 5);
        free(grid.corners);
        json_decref(report);
        outcome_free(&o);
    }
}

static void a_run_that_blows_up_names_the_frame(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    int frame = 0, bad = 0, all = 0;
    for (int existing = 0; existing < 2; existing++) {
        if (existing) {
            assert_int_equal(mkdir(in_folder("out"), 0777), 0);
            write_text(in_folder("out/sheet.obj"), "old");
        }
        outcome o = SKEIN("run", s, "--out", in_folder(existing ? "out" : "out/deeper"), "--quiet", "--frames", "400", "--set", "method={\"type\":\"symplectic_euler\",\"substeps\":1}",
                          "--set", "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}");
        assert_status(o, 1);
        assert_string_equal(o.out, "");
        snprintf(words, sizeof words, "skein: %s: blew up in frame %%d: %%d of %%d particles are no longer finite", s);
        assert_int_equal(sscanf(o.err, words, &frame, &bad, &all), 3);
        assert_true(frame > 1 && frame < 400 && bad > 0 && bad <= all && all == 34);
        assert_true(strchr(o.err, '\n') == o.err + strlen(o.err) - 1);
        outcome_free(&o);
        if (!existing) assert_false(exists(in_folder("out")));
    }
    assert_int_equal(count_entries(in_folder("out")), 1);
    // a frame earlier all was well
    char frames[16];
    snprintf(frames, sizeof frames, "%d", frame - 1);
    hash_of(SKEIN("run", s, "--frames", frames, "--set", "method={\"type\":\"symplectic_euler\",\"substeps\":1}", "--set",
                  "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}"));
}

/* ---- Progress ------------------------------------------------------------------------------------------ */

static int count_words(const char *text, const char *words) {
    int count = 0;
    for (; (text = strstr(text, words)) != NULL; text++) count++;
    return count;
}

static void progress_is_shown(void **state) {
    (void)state;
    const char *s = tiny_scene();
    // in a file: ten lines
    outcome o = SKEIN("run", s, "--frames", "20");
    assert_int_equal(count_words(o.err, "\n"), 10);
    assert_int_equal(strncmp(o.err, "[###...........................] frame 2 of 20, ", 48), 0);
    assert_contains(o.err, "\n[##############################] frame 20 of 20, ");
    outcome_free(&o);
    o = SKEIN("run", s, "--frames", "3");
    assert_int_equal(count_words(o.err, "\n"), 3);
    outcome_free(&o);
    o = SKEIN("run", s, "--frames", "3", "--quiet");
    assert_string_equal(o.err, "");
    assert_contains(o.out, "3 frames");
    outcome_free(&o);

    // on a terminal: one line, drawn again in place
    int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(terminal >= 0);
    assert_int_equal(grantpt(terminal) || unlockpt(terminal), 0);
    int end = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
    assert_true(end >= 0);
    o = SKEIN_IN((surroundings){.err = end}, "run", s, "--frames", "20");
    assert_status(o, 0);
    char text[8192];
    ssize_t length = read(terminal, text, sizeof text - 1);
    assert_true(length > 0);
    text[length] = 0;
    assert_int_equal(text[0], '\r');
    assert_int_equal(count_words(text, "\n"), 1);
    assert_contains(text, "\r[##############################] frame 20 of 20, ");
    close(end);
    close(terminal);
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(wrong_arguments_are_told),
        TEST(help_is_there_when_asked_for),
        TEST(every_scene_runs),
        TEST(runs_and_threads_give_the_same_bits),
        TEST(sets_reach_what_they_name),
        TEST(frames_and_their_rate_can_be_told),
        TEST(bodies_never_share_a_file),
        TEST(seams_are_welded_and_exported_as_they_came),
        TEST(check_counts_what_is_there),
        TEST(explain_shows_every_kind_of_row),
        TEST(list_shows_every_kind_and_field),
        TEST(a_file_in_the_way_is_told),
        TEST(a_full_disk_leaves_nothing_half_written),
        TEST(output_that_cannot_be_printed_is_told),
        TEST(an_interrupted_run_writes_what_it_has),
        TEST(a_run_that_blows_up_names_the_frame),
        TEST(progress_is_shown),
    };
    return cmocka_run_group_tests_name("command", tests, NULL, NULL);
}
