/* Studies: which rows they have, what one measures, and what their folder keeps. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "io/study.h"

static char said[4000];
static char folder[64];

static void note(void *user, const skein_error *error) {
    (void)user;
    size_t length = strlen(said);
    snprintf(said + length, sizeof said - length, "%s: %s\n", error->where, error->message);
}

static const skein_kind *const no_kinds[] = {NULL};

/* A study of a text that has ' in the place of ". */
static io_study *read_study(const char *text) {
    char copy[4000];
    io_faults faults = {note, NULL, 0, NULL};
    snprintf(copy, sizeof copy, "%s", text);
    for (char *at = copy; (at = strchr(at, '\'')) != NULL;) *at = '"';
    said[0] = 0;
    return io_study_read_text(copy, strlen(copy), "s.json", no_kinds, &faults);
}

static io_study *good_study(const char *text) {
    io_study *study = read_study(text);
    if (!study) fail_msg("%s", said);
    return study;
}

static double number(const io_study *study, size_t row, size_t v) {
    json_t *value = io_study_value(study, row, v);
    assert_true(json_is_number(value));
    double x = json_number_value(value);
    json_decref(value);
    return x;
}

/* Things that fall: nothing but gravity. */
#define FALLING                                                                                                \
    "'scene': {'frames': 10, 'step': 0.05, 'fps': 20, 'method': {'type': 'symplectic_euler', 'substeps': 1}, " \
    "'bodies': [{'type': 'flock', 'name': 'stones', 'count': 3, 'spread': [0, 0, 0], 'position': [1, 5, 2], "  \
    "'speed': 0, 'mass': 2}], 'forces': [{'type': 'gravity', 'name': 'weight'}]}"

/* ---- rows ---- */

static void lists_and_ranges_make_a_grid(void **state) {
    (void)state;
    io_study *study = good_study(
        "{'study': 1, " FALLING ", 'vary': {'bodies.stones.mass': [1, 2.5], "
        "'bodies.stones.position': [[0, 0.1, 0]], 'bodies.stones.speed': {'from': 0, 'to': 0.3, 'count': 4}, "
        "'forces.weight.acceleration': [[0, -1, 0], [0, -2, 0]]}, 'measure': ['lowest']}");
    assert_int_equal(io_study_rows(study), 16);
    const double speeds[] = {0, 0.1, 0.2, 0.3}; // what people would write, not 0.30000000000000004
    for (size_t row = 0; row < 16; row++) {
        assert_true(number(study, row, 0) == (row < 8 ? 1 : 2.5));
        assert_true(number(study, row, 2) == speeds[row / 2 % 4]);
    }
    char *command = io_study_command(study, 15);
    assert_string_equal(command, "skein run scene.json --set bodies.stones.mass=2.5 --set "
                                 "'bodies.stones.position=[0,0.1,0]' --set bodies.stones.speed=0.3 --set "
                                 "'forces.weight.acceleration=[0,-2,0]'");
    free(command);
    io_study_free(study);
    study = good_study("{'study': 1, " FALLING
                       ", 'vary': {'bodies.0.mass': {'from': 0.01, 'to': 100, 'count': 5, 'scale': 'log'}, "
                       "'bodies.0.speed': {'from': 1, 'to': 0.05, 'step': -0.3}}, 'measure': ['lowest']}");
    assert_int_equal(io_study_rows(study), 5 * 4);
    const double masses[] = {0.01, 0.1, 1, 10, 100}, falling[] = {1, 0.7, 0.4, 0.1};
    for (size_t row = 0; row < 20; row++) {
        assert_true(number(study, row, 0) == masses[row / 4]);
        assert_true(number(study, row, 1) == falling[row % 4]);
    }
    io_study_free(study);
}

#define CHANCE(seed_)                                                                                  \
    "{'study': 1, 'seed': " seed_ ", " FALLING ", 'vary': {'bodies.0.mass': {'random': [1, 3]}, "      \
    "'bodies.0.seed': {'random': [1, 6], 'whole': true}, 'bodies.0.speed': {'random': [0.001, 1000], " \
    "'scale': 'log'}}, 'repeat': 6000, 'measure': ['lowest']}"

static void random_values_are_even_and_the_same_again(void **state) {
    (void)state;
    io_study *study = good_study(CHANCE("7")), *again = good_study(CHANCE("7")), *other = good_study(CHANCE("8"));
    double mean = 0, square = 0, logs = 0, product = 0;
    int faces[7] = {0}, same = 0;
    assert_int_equal(io_study_rows(study), 6000);
    for (size_t i = 0; i < 6000; i++) {
        size_t row = 5999 - i; // whatever was drawn before
        double mass = number(study, row, 0), face = number(study, row, 1), speed = number(study, row, 2);
        assert_true(mass >= 1 && mass <= 3 && speed >= 0.001 && speed <= 1000);
        assert_true(face >= 1 && face <= 6 && face == floor(face));
        mean += mass / 6000, square += (mass - 2) * (mass - 2) / 6000, logs += log10(speed) / 6000;
        product += (mass - 2) * log10(speed) / 6000;
        faces[(int)face]++;
        assert_true(mass == number(again, row, 0) && speed == number(again, row, 2));
        same += mass == number(other, row, 0);
    }
    // five standard deviations of 6,000 draws
    assert_true(fabs(mean - 2) < 5 * sqrt(1 / 3.0 / 6000) && fabs(square - 1 / 3.0) < 0.02);
    assert_true(fabs(logs) < 5 * sqrt(3.0 / 6000) && fabs(product) < 5 * sqrt(1.0 / 6000));
    for (int f = 1; f <= 6; f++) assert_true(abs(faces[f] - 1000) < 5 * 29);
    assert_true(same < 5);
    io_study_free(study), io_study_free(again), io_study_free(other);
}

/* ---- faults ---- */

static void faults_have_places(void **state) {
    (void)state;
    static const struct {
        const char *text, *words;
    } all[] = {
        {"{'study': 1", "s.json: line 1, column"},
        {"[]", "a study is an object"},
        {"{'study': 2, 'vary': {'a': [1]}, 'measure': ['lowest'], 'scene': 'rope'}",
         "study: expected a whole number, 1 to 1"},
        {"{'vari': 3}", "vari: there is no member 'vari'; did you mean 'vary'?"},
        {"{'vary': {}}", "vary: expected fields and their values"},
        {"{'vary': {'a': 3}}", "vary.a: expected a list, a range"},
        {"{'vary': {'a': []}}", "vary.a: a list without values"},
        {"{'vary': {'a': {'from': 1, 'to': 2}}}", "vary.a: expected a range"},
        {"{'vary': {'a': {'from': 1, 'to': 2, 'count': 3, 'cuont': 3}}}", "vary.a.cuont: there is no member"},
        {"{'vary': {'a': {'from': 1, 'to': 2, 'step': -1}}}", "vary.a: step: expected a number that leads from 1 to 2"},
        {"{'vary': {'a': {'from': 0, 'to': 2, 'count': 3, 'scale': 'log'}}}", "ends over 0"},
        {"{'vary': {'a': {'from': 0, 'to': 2, 'step': 1e-9}}}", "more than the 10000000 rows"},
        {"{'vary': {'a': {'random': [2, 1]}}}", "random: expected the least and the most"},
        {"{'vary': {'a': [1, 2]}, 'repeat': 2}", "rows would come out alike"},
        {"{'vary': {'a': [1]}, 'measure': []}", "measure: expected a list"},
        {"{'vary': {'a': [1]}, 'measure': ['lowset']}",
         "measure.0: there is no measure 'lowset'; did you mean 'lowest'?"},
        {"{'vary': {'a': [1]}, 'measure': ['lowest', 'lowest']}", "the column 'lowest' is there twice"},
        {"{'vary': {'a': [1]}, 'measure': [{'measure': 'contacts', 'body': 'x'}]}",
         "measure.0.body: contacts is of the whole world"},
        {"{'vary': {'a': [1]}, 'measure': [{'measure': 'lowest', 'over': 'all'}]}", "measure.0.over: expected"},
        {"{'vary': {'a': [1]}, 'measure': ['lowest'], 'plot': {'x': 'b'}}", "plot.x: 'b' is not varied"},
        {"{'vary': {'a': [1]}, 'measure': ['lowest'], 'plot': {'show': ['b']}}", "plot.show: 'b' is not measured"},
        {"{'vary': {'a': [1]}, 'measure': ['lowest']}", "scene: expected a scene's name"},
        {"{'vary': {'a': [1]}, 'measure': ['lowest'], 'scene': 'no such'}", "no such"},
        {"{'vary': {'bodies.stones.mas': [1]}, 'measure': ['lowest'], " FALLING "}", "did you mean 'mass'?"},
        {"{'vary': {'bodies.stones.mass': [-1]}, 'measure': ['lowest'], " FALLING "}", "bodies.0.mass"},
        {"{'vary': {'bodies.stones.mass': [1]}, 'measure': [{'measure': 'lowest', 'body': 'stone'}], " FALLING "}",
         "there is no body of the name stone"},
        {"{'vary': {'bodies.stones.groups': ['stone']}, 'measure': [{'measure': 'lowest', 'body': 'stone'}], " FALLING
         "}",
         "there is no body of the name stone; it is the name of a group, and one body is meant"},
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        io_study *study = read_study(all[i].text);
        if (study || !strstr(said, all[i].words)) fail_msg("%s\nsays: %s\nnot: %s", all[i].text, said, all[i].words);
    }
}

/* ---- a row ---- */

static double measured(const json_t *result, size_t m) {
    return json_number_value(json_array_get(json_object_get(result, "measures"), m));
}

static const char *text_of(const json_t *result, const char *name) {
    const char *text = json_string_value(json_object_get(result, name));
    return text ? text : "";
}

/* Symplectic Euler falls by g h^2 n(n + 1)/2 in n steps, and is then g h n fast. */
static void measures_are_those_of_free_fall(void **state) {
    (void)state;
    io_study *study = good_study(
        "{'study': 1, " FALLING
        ", 'set': {'frames': 20}, 'vary': {'forces.weight.acceleration': [[0, -2, 0], [0, -4, 0]]}, "
        "'measure': ['lowest', 'centre_x', 'spread', 'kinetic_energy', {'measure': 'momentum_y', 'over': 'least'}, "
        "{'measure': 'highest', 'over': 'most', 'from': 0.5}, {'measure': 'highest', 'over': 'mean', 'every': 10, 'name': 'm'}]}");
    for (size_t row = 0; row < 2; row++) {
        json_t *result = io_study_run(study, row, 1, NULL, NULL);
        double g = row ? 4 : 2, h = 0.05, fallen[21];
        for (int n = 0; n <= 20; n++) fallen[n] = g * h * h * n * (n + 1) / 2;
        assert_string_equal(text_of(result, "outcome"), "good");
        assert_int_equal(json_integer_value(json_object_get(result, "steps")), 20);
        const double ought[] = {5 - fallen[20],
                                1,
                                0,
                                3 * 2 * pow(g * h * 20, 2) / 2,
                                -3 * 2 * g * h * 20,
                                5 - fallen[10],
                                5 - (fallen[10] + fallen[20]) / 3};
        for (size_t m = 0; m < 7; m++)
            if (fabs(measured(result, m) - ought[m]) > 1e-4 * (1 + fabs(ought[m])))
                fail_msg("row %zu: %s is %.9g, not %.9g", row, io_study_measure(study, m), measured(result, m),
                         ought[m]);
        json_decref(result);
    }
    assert_string_equal(io_study_measure(study, 4), "momentum_y_least");
    assert_string_equal(io_study_measure(study, 6), "m");
    io_study_free(study);
}

static bool stop_at_once(void *user) {
    ++*(int *)user;
    return false;
}

static void rows_are_alike_whoever_runs_them(void **state) {
    (void)state;
    static const char text[] =
        "{'study': 1, 'scene': 'scenes/rope.json', 'set': {'frames': 20, 'bodies.0.stretch.stiffness': 1000}, "
        "'vary': {'method.type': ['xpbd', 'rk4', 'nothing'], 'method.substeps': [1, 2]}, "
        "'measure': ['lowest', 'max_stretch']}";
    io_study *study = good_study(text);
    char hashes[6][20];
    for (size_t i = 0; i < 6; i++) {
        size_t row = 5 - i; // in any order, on any number of threads
        json_t *result = io_study_run(study, row, 1, NULL, NULL), *again = io_study_run(study, row, 2, NULL, NULL);
        const char *outcome = text_of(result, "outcome");
        assert_string_equal(outcome, row < 2 ? "good" : row < 4 ? "blew up" : "refused");
        assert_string_equal(text_of(result, "state_hash"), text_of(again, "state_hash"));
        assert_true(row < 2 || text_of(result, "said")[0]);
        if (row >= 4) assert_non_null(strstr(text_of(result, "said"), "nothing"));
        assert_true((row < 2) == json_is_number(json_array_get(json_object_get(result, "measures"), 0)));
        snprintf(hashes[row], sizeof hashes[row], "%s", text_of(result, "scene_hash"));
        json_decref(result), json_decref(again);
    }
    for (size_t a = 0; a < 4; a++)
        for (size_t b = a + 1; b < 4; b++) assert_string_not_equal(hashes[a], hashes[b]);
    int calls = 0;
    json_t *stopped = io_study_run(study, 0, 1, stop_at_once, &calls);
    assert_string_equal(text_of(stopped, "outcome"), "stopped");
    assert_int_equal(calls, 1);
    json_decref(stopped);
    io_study_free(study);
}

/* What is only looked at does not change a scene's hash; a mesh counts as what is in it, wherever it lies. */
static uint64_t hash_of(const char *text) {
    char copy[1000];
    io_faults faults = {note, NULL, 0, NULL};
    snprintf(copy, sizeof copy, "%s", text);
    for (char *at = copy; (at = strchr(at, '\'')) != NULL;) *at = '"';
    io_scene *scene = io_scene_read_text(copy, strlen(copy), "s.json", NULL, no_kinds, &faults);
    assert_non_null(scene);
    uint64_t hash = io_scene_hash(scene);
    io_scene_free(scene);
    return hash;
}

static void a_scene_s_hash_is_of_what_acts(void **state) {
    (void)state;
    char moved[300], copied[100];
    io_bytes mesh;
    skein_error error;
    assert_int_equal(io_file_read("meshes/ball.obj", 1 << 24, &mesh, &error), SKEIN_OK);
    snprintf(copied, sizeof copied, "%s/other.obj", folder);
    FILE *file = fopen(copied, "wb");
    assert_int_equal(fwrite(mesh.data, 1, mesh.size, file), mesh.size);
    fclose(file);
    io_bytes_free(&mesh);
    snprintf(moved, sizeof moved, "{'bodies': [{'mesh': '%s', 'type': 'cloth'}], 'name': 'x', 'threads': 2}", copied);
    uint64_t hash = hash_of("{'bodies': [{'type': 'cloth', 'mesh': 'meshes/ball.obj'}]}");
    assert_true(hash == hash_of(moved));
    file = fopen(copied, "ab");
    fputs("v 0 0 0\n", file);
    fclose(file);
    assert_true(hash != hash_of(moved));
    assert_true(hash != hash_of("{'bodies': [{'type': 'cloth', 'mesh': 'meshes/ball.obj', 'density': 2}]}"));
}

/* ---- the folder ---- */

static const char folder_study[] =
    "{'study': 1, " FALLING ", 'vary': {'bodies.0.mass': [1, 2, 3, 4, 5, 6, 7]}, 'measure': ['lowest']}";

static char *in(const char *name) {
    static char path[4][200];
    static int turn;
    char *at = path[turn++ % 4];
    snprintf(at, 200, "%s/%s", folder, name);
    return at;
}

static void add_row(io_study_folder *f, const io_study *study, size_t row) {
    skein_error error = {SKEIN_OK, "", ""};
    json_t *result = io_study_run(study, row, 1, NULL, NULL);
    if (io_study_folder_add(f, result, &error)) fail_msg("%s", error.message);
    json_decref(result);
}

static void rows_are_kept_one_by_one(void **state) {
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    io_study *study = good_study(folder_study);
    io_study_folder *f = io_study_folder_open(study, in("kept"), 1, 1, &error);
    assert_non_null(f);
    add_row(f, study, 3);
    add_row(f, study, 1);
    assert_null(io_study_folder_open(study, in("kept"), 1, 1, &error));
    assert_non_null(strstr(error.message, "another process is at work"));
    io_study_folder_close(f);
    // cut within the last row, as a kill might
    char path[220];
    snprintf(path, sizeof path, "%s/rows.journal", in("kept"));
    io_bytes bytes;
    assert_int_equal(io_file_read(path, 1 << 24, &bytes, &error), SKEIN_OK);
    assert_int_equal(truncate(path, (off_t)bytes.size - 9), 0);
    io_bytes_free(&bytes);
    f = io_study_folder_open(study, in("kept"), 1, 1, &error);
    assert_non_null(f);
    assert_true(io_study_folder_has(f, 3) && !io_study_folder_has(f, 1));
    assert_int_equal(io_study_folder_missing(f), 6);
    assert_int_equal(io_study_folder_next(f, 0), 0);
    assert_int_equal(io_study_folder_next(f, 3), 4);
    json_t *crashed = io_study_crashed(study, 0, "why");
    assert_int_equal(io_study_folder_add(f, crashed, &error), SKEIN_OK);
    assert_int_equal(io_study_folder_next(f, 0), 0); // it is tried again
    json_decref(crashed);
    for (size_t row; (row = io_study_folder_next(f, 0)) != SIZE_MAX;) add_row(f, study, row);
    assert_int_equal(io_study_folder_done(f), 7);
    assert_int_equal(io_study_folder_tables(f, &error), SKEIN_OK);
    io_study_folder_close(f);
    io_study *other = good_study("{'study': 1, " FALLING ", 'vary': {'bodies.0.mass': [1, 2]}, 'measure': ['lowest']}");
    assert_null(io_study_folder_open(other, in("kept"), 1, 1, &error));
    assert_non_null(strstr(error.message, "rows of another study"));
    io_study_free(other);
    io_study_free(study);
}

static void parts_make_the_whole(void **state) {
    (void)state;
    skein_error error = {SKEIN_OK, "", ""};
    io_study *study = good_study(folder_study);
    io_study_folder *parts[3];
    for (size_t p = 0; p < 3; p++)
        assert_non_null(parts[p] = io_study_folder_open(study, in("parts"), p + 1, 3, &error));
    assert_int_equal(io_study_folder_missing(parts[0]), 3);
    assert_int_equal(io_study_folder_next(parts[1], 0), 1);
    assert_int_equal(io_study_folder_next(parts[1], 2), 4);
    for (size_t p = 3; p-- > 0;) {
        for (size_t row; (row = io_study_folder_next(parts[p], 0)) != SIZE_MAX;) add_row(parts[p], study, row);
        io_study_folder_close(parts[p]);
    }
    io_study_folder *f = io_study_folder_open(study, in("parts"), 1, 1, &error);
    assert_non_null(f);
    assert_int_equal(io_study_folder_done(f), 7);
    assert_int_equal(io_study_folder_missing(f), 0);
    assert_int_equal(io_study_folder_tables(f, &error), SKEIN_OK);
    io_study_folder_close(f);
    io_study_free(study);
    // the same table as one writer's
    io_bytes a, b;
    char path[2][220];
    snprintf(path[0], sizeof path[0], "%s/table.csv", in("parts"));
    snprintf(path[1], sizeof path[1], "%s/table.csv", in("kept"));
    assert_int_equal(io_file_read(path[0], 1 << 24, &a, &error), SKEIN_OK);
    assert_int_equal(io_file_read(path[1], 1 << 24, &b, &error), SKEIN_OK);
    assert_string_equal(a.data, b.data);
    io_bytes_free(&a), io_bytes_free(&b);
}

static int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/skein-study-XXXXXX");
    return mkdtemp(folder) && !chdir(SKEIN_SOURCE_DIR) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_and_ranges_make_a_grid),
        cmocka_unit_test(random_values_are_even_and_the_same_again),
        cmocka_unit_test(faults_have_places),
        cmocka_unit_test(measures_are_those_of_free_fall),
        cmocka_unit_test(rows_are_alike_whoever_runs_them),
        cmocka_unit_test(a_scene_s_hash_is_of_what_acts),
        cmocka_unit_test(rows_are_kept_one_by_one),
        cmocka_unit_test(parts_make_the_whole),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
