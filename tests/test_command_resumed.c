/* Runs that go on: killed at any moment they leave what can be read, and resumed they end with the state and the files
 * of a run that was never broken off. With a number behind it, the test kills so many (40), from the seed SKEIN_SEED.
 */
#include "test_command.h"

#ifdef SKEIN_HDF5
#include <hdf5.h>
#endif

static int most_kills = SPARING ? 8 : 40;
static bool draws; /* a picture and a film, too, which take most of the time */

/* Every format there is, on a sheet that swings over a ball. */
static const char *swinging(void) {
    static char path[512], text[1024];
    snprintf(path, sizeof path, "%s/swing.json", folder);
    snprintf(
        text, sizeof text,
        "{'frames': 30, 'step': 0.016666666666666666, 'bodies': [{'type': 'cloth', 'name': 'c', 'grid': [9, 9], 'pins': 'corners', "
        "'position': [0, 1, 0]}], 'forces': [{'type': 'gravity'}], 'colliders': [{'type': 'sphere', "
        "'radius': 0.3, 'centre': [0, 0.6, 0], 'motion': {'velocity': [0.2, 0, 0]}}], "
        "'motions': [{'type': 'translate', 'on': 'c', 'velocity': [0, 0.1, 0]}], 'output': ["
        "{'type': 'obj', 'every': 3}, 'pc2', 'mdd', 'glb', 'usda', 'ply', 'stl', 'csv'"
#ifdef SKEIN_HDF5
        ", 'hdf5'"
#endif
        "%s]}",
        draws ? ", {'type': 'png', 'size': [64, 36]}, {'type': 'film', 'format': 'gif', 'size': [64, 36]}" : "");
    write_scene(path, text);
    return path;
}

/* ---- comparing ---- */

#ifdef SKEIN_HDF5
static double *numbers_of(const char *path, const char *name, size_t *count) {
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), set = H5Dopen2(file, name, H5P_DEFAULT),
          space = H5Dget_space(set);
    *count = (size_t)H5Sget_simple_extent_npoints(space);
    double *numbers = malloc((*count + 1) * sizeof *numbers);
    assert_true(numbers && H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers) >= 0);
    H5Sclose(space), H5Dclose(set), H5Fclose(file);
    return numbers;
}

/* Where blocks lie in the file depends on when they were written through; what is in it does not. */
static void check_same_hdf5(const char *one, const char *other) {
    static const char *const names[] = {"/time", "/positions", "/velocities", "/masses"};
    for (size_t i = 0; i < COUNT(names); i++) {
        size_t a_count, b_count;
        double *a = numbers_of(one, names[i], &a_count), *b = numbers_of(other, names[i], &b_count);
        assert_int_equal(a_count, b_count);
        assert_memory_equal(a, b, a_count * sizeof *a);
        free(a), free(b);
    }
}
#endif

static void check_same_file(const char *one, const char *other) {
    io_bytes a, b;
    skein_error error;
    if (io_file_read(one, (size_t)1 << 30, &a, &error) || io_file_read(other, (size_t)1 << 30, &b, &error))
        fail_msg("%s: %s", error.where, error.message);
    if (a.size != b.size || memcmp(a.data, b.data, a.size) != 0) fail_msg("%s differs from %s", other, one);
    io_bytes_free(&a), io_bytes_free(&b);
}

static char *hash_in(const char *out) {
    char path[900];
    snprintf(path, sizeof path, "%s/report.json", out);
    json_t *report = json_load_file(path, 0, NULL);
    assert_non_null(report);
    char *hash = strdup(json_string_value(json_object_get(report, "state_hash")));
    assert_true(json_integer_value(json_object_get(report, "frames")) > 0);
    json_decref(report);
    return hash;
}

/* All files of a folder are those of the other; no more and no less, but for reports and what --resume needs. */
static void check_same_folder(const char *one, const char *other) {
    DIR *open_folder = opendir(one);
    assert_non_null(open_folder);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;) {
        char a[900], b[900];
        if (entry->d_name[0] == '.' || !strcmp(entry->d_name, "report.json") || !strcmp(entry->d_name, "resume"))
            continue;
        snprintf(a, sizeof a, "%s/%s", one, entry->d_name);
        snprintf(b, sizeof b, "%s/%s", other, entry->d_name);
#ifdef SKEIN_HDF5
        if (strstr(a, ".h5")) check_same_hdf5(a, b);
        else
#endif
            check_same_file(a, b);
        count++;
    }
    closedir(open_folder);
    assert_true(count > 15);
    int more = 0; // parts of processes that were killed before they had said who they are
    open_folder = opendir(other);
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        more += entry->d_name[0] != '.' && !strstr(entry->d_name, ".part");
    closedir(open_folder);
    assert_int_equal(more, count + 2); // the report and the resume folder
    char *a = hash_in(one), *b = hash_in(other);
    assert_string_equal(a, b);
    free(a), free(b);
}

/* Whatever stands under a final name is whole: an OBJ of the sequence has all its vertices. */
static void check_finished_frames(const char *out) {
    DIR *open_folder = opendir(out);
    for (struct dirent *entry; open_folder && (entry = readdir(open_folder)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length < 4 || strcmp(entry->d_name + length - 4, ".obj") != 0) continue;
        char path[900];
        snprintf(path, sizeof path, "%s/%s", out, entry->d_name);
        io_mesh mesh;
        skein_error error;
        if (io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error))
            fail_msg("%s: %s", error.where, error.message);
        assert_int_equal(mesh.vertex_count, 81);
        io_mesh_free(&mesh);
    }
    if (open_folder) closedir(open_folder);
}

/* ---- the tests ---- */

static void killed_runs_go_on(void **state) {
    (void)state;
    const char *scene = swinging(), *whole = in_folder("whole"), *broken = in_folder("broken"),
               *log = in_folder("whole.csv"), *broken_log = in_folder("broken.csv");
    char whole_name[700], broken_name[700], logs[2][700], path[900];
    snprintf(whole_name, sizeof whole_name, "%s", whole), snprintf(broken_name, sizeof broken_name, "%s", broken);
    snprintf(logs[0], sizeof logs[0], "%s", log), snprintf(logs[1], sizeof logs[1], "%s", broken_log);
    struct timespec start, end;
    clock_gettime(CLOCK_MONOTONIC, &start);
    outcome o = SKEIN("run", scene, "--out", whole_name, "--log", logs[0], "--quiet");
    clock_gettime(CLOCK_MONOTONIC, &end);
    assert_status(o, 0);
    outcome_free(&o);
    double took = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    const char *given = getenv("SKEIN_SEED");
    uint64_t seed = given ? strtoull(given, NULL, 10) : 19;
    int kills = 0, runs = 0;
    bool begun = false;
    snprintf(path, sizeof path, "%s/resume/run.json", broken_name);
    while (kills < most_kills) {
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        double wait = (double)(seed >> 40) / (double)(1 << 24) * 1.6 * took;
        struct timespec nap = {(time_t)wait, (long)(1e9 * (wait - (double)(time_t)wait))};
        begun = begun && exists(path);
        pid_t child =
            begun
                ? start_skein((surroundings){0}, (const char *const[]){"run", "--resume", broken_name, "--quiet", NULL})
                : start_skein((surroundings){0}, (const char *const[]){"run", scene, "--out", broken_name, "--log",
                                                                       logs[1], "--snapshots", "4", "--quiet", NULL});
        begun = true;
        nanosleep(&nap, NULL);
        kill(child, SIGKILL);
        o = finish_skein(child);
        if (o.status == 0) { // it was done before
            check_same_folder(whole_name, broken_name);
            check_same_file(logs[0], logs[1]);
            begun = false, runs++;
        } else {
            assert_status(o, -SIGKILL);
            kills++;
        }
        outcome_free(&o);
        check_finished_frames(broken_name);
    }
    if (begun && exists(path)) o = SKEIN("run", "--resume", broken_name, "--quiet");
    else o = SKEIN("run", scene, "--out", broken_name, "--log", logs[1], "--snapshots", "4", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    check_same_folder(whole_name, broken_name);
    check_same_file(logs[0], logs[1]);
    print_message("%d kills, %d runs came to their end between them\n", kills, runs);
}

static void a_run_is_made_longer(void **state) {
    (void)state;
    const char *scene = swinging();
    char longer[700], made[700];
    snprintf(longer, sizeof longer, "%s", in_folder("longer")), snprintf(made, sizeof made, "%s", in_folder("made"));
    outcome o = SKEIN("run", scene, "--out", longer, "--frames", "45", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("run", scene, "--out", made, "--snapshots", "10", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("run", "--resume", made, "--frames", "45", "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    check_same_folder(longer, made);
    // one file, too
    char file[700], again[700];
    snprintf(file, sizeof file, "%s", in_folder("a.mdd")), snprintf(again, sizeof again, "%s", in_folder("b.mdd"));
    o = SKEIN("run", scene, "--out", file, "--scale", "100", "--up", "z", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("run", scene, "--out", again, "--scale", "100", "--up", "z", "--snapshots", "10", "--frames", "12",
              "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    o = SKEIN("run", "--resume", again, "--frames", "30", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    check_same_file(file, again);
}

static void fails_with(const char *words, const char *const *arguments) {
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_contains(o.err, words);
    assert_status(o, 2);
    outcome_free(&o);
}
#define FAULT(words_, ...) fails_with((words_), (const char *const[]){__VA_ARGS__, NULL})

static void change_byte(const char *path, long at, int byte) {
    FILE *file = fopen(path, "r+b");
    assert_true(file && !fseek(file, at, SEEK_SET) && fputc(byte, file) == byte && !fclose(file));
}

static void what_does_not_fit_is_refused(void **state) {
    (void)state;
    const char *scene = swinging();
    char out[700], path[900], next[900], run[900];
    snprintf(out, sizeof out, "%s", in_folder("out"));
    FAULT("there is no run.json", "run", "--resume", out);
    FAULT("which scene?", "run");
    FAULT("--snapshots 0: expected a number of frames", "run", scene, "--out", out, "--snapshots", "0");
    FAULT("name a folder with --out", "run", scene, "--snapshots", "5");
    outcome o = SKEIN("run", scene, "--out", out, "--snapshots", "10", "--frames", "20", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    FAULT("keeps what it was begun with", "run", "--resume", out, "--set", "frames=3");
    FAULT("name one of the two", "run", scene, "--resume", out);
    // the newest is damaged: the one before it serves
    char *hash = hash_in(out);
    snprintf(path, sizeof path, "%s/resume/frame-000020.snapshot", out);
    snprintf(next, sizeof next, "%s/resume/frame-000010.snapshot", out);
    change_byte(path, 200, 'x');
    o = SKEIN("run", "--resume", out, "--no-progress");
    assert_status(o, 0);
    assert_contains(o.err, "damaged");
    outcome_free(&o);
    char *again = hash_in(out);
    assert_string_equal(hash, again);
    free(hash), free(again);
    // newer ones are refused
    change_byte(path, 8, 9), change_byte(next, 8, 9);
    o = SKEIN("run", "--resume", out);
    assert_contains(o.err, "a snapshot of version 9");
    outcome_free(&o);
    snprintf(run, sizeof run, "%s/resume/run.json", out);
    write_scene(run, "{'version': 2, 'snapshots': 10}");
    FAULT("a run of version 2", "run", "--resume", out);
    // and another scene
    o = SKEIN("run", scene, "--out", out, "--snapshots", "10", "--frames", "20", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    char *text = read_text(scene), *grid = strstr(text, "[9, 9]");
    grid[1] = '8';
    snprintf(path, sizeof path, "%s/resume/scene.json", out);
    write_text(path, text);
    free(text);
    o = SKEIN("run", "--resume", out);
    assert_contains(o.err, "has 81 particles");
    assert_status(o, 1);
    outcome_free(&o);
}

/* Room for so many bytes in any file: it fails with words, and goes on once there is more. */
static void a_full_disk(void **state) {
    (void)state;
    const char *scene = swinging();
    char whole[700], out[700], path[900];
    snprintf(whole, sizeof whole, "%s", in_folder("all"));
    outcome o = SKEIN("run", scene, "--out", whole, "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    for (rlim_t limit = 300; limit < 120000; limit = limit * 5 / 3) {
        char name[40];
        snprintf(name, sizeof name, "full%d", (int)limit);
        snprintf(out, sizeof out, "%s", in_folder(name));
        o = SKEIN_IN((surroundings){.file_limit = limit}, "run", scene, "--out", out, "--snapshots", "4", "--quiet");
        assert_status(o, 1);
        assert_contains(o.err, "cannot write");
        outcome_free(&o);
        check_finished_frames(out);
        snprintf(path, sizeof path, "%s/resume/run.json", out);
        if (!exists(path)) continue;
        o = SKEIN("run", "--resume", out, "--quiet");
        assert_status(o, 0);
        outcome_free(&o);
        char *a = hash_in(whole), *b = hash_in(out);
        assert_string_equal(a, b);
        free(a), free(b);
    }
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(killed_runs_go_on, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_run_is_made_longer, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(what_does_not_fit_is_refused, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(a_full_disk, make_folder, remove_folder),
    };
    if (argc > 1) {
        most_kills = atoi(argv[1]);
#ifdef SKEIN_FILM
        draws = true;
#endif
        return _cmocka_run_group_tests("kills", tests, 1, NULL, NULL);
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
