/* Tests of the command in trouble: a full disk, a closed pipe, files in the way, Ctrl-C, a scene that blows
 * up. Whatever happens, it is said, and nothing half written is left. */
#include "test_command.h"

/* ---- Trouble ----------------------------------------------------------------------------------------- */

static void a_file_in_the_way_is_told(void **state) {
    (void)state;
    char words[1024];
    const char *s = tiny_scene();
    write_text(in_folder("file"), "mine");
    static const char *const ways[] = {"file", "file/", "file/below", "new/../file/below"};
    for (size_t i = 0; i < COUNT(ways); i++) {
        char *out = in_folder(ways[i]);
        snprintf(words, sizeof words,
                 "skein run: --out %s: cannot write there: there is a file where a folder should be\n", out);
        assert_says(2, "", words, "run", s, "--out", out);
        char *text = read_text(in_folder("file"));
        assert_string_equal(text, "mine");
        free(text);
    }
    assert_false(exists(in_folder("new")));
    assert_says(2, "", "skein run: --out '': expected the name of a folder, up to 1023 bytes\n", "run", s, "--out", "");
    // a directory under a file's name: the run fails at its end, the other files are whole
    assert_int_equal(mkdir(in_folder("out"), 0777) || mkdir(in_folder("out/sheet.obj"), 0777), 0);
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--no-progress");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it is a directory\n", in_folder("out/sheet.obj"));
    assert_string_equal(o.err, words);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(json_array_size(json_object_get(report, "files")), 3);
    json_decref(report);
    // nor can the report be written
    outcome_free(&o);
    assert_int_equal(rmdir(in_folder("out/sheet.obj")) || unlink(in_folder("out/report.json")), 0);
    assert_int_equal(mkdir(in_folder("out/report.json"), 0777), 0);
    o = SKEIN("run", s, "--out", in_folder("out"), "--no-progress");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it is a directory\n", in_folder("out/report.json"));
    assert_string_equal(o.err, words);
    outcome_free(&o);
}

static void a_folder_that_may_not_be_written_is_told(void **state) {
    (void)state;
    if (geteuid() == 0) skip(); // the superuser may write everywhere
    char words[1024];
    const char *s = tiny_scene();
    assert_int_equal(chmod(folder, 0555), 0);
    snprintf(words, sizeof words, "skein run: --out %s: cannot write there: Permission denied\n", in_folder("closed"));
    outcome o = SKEIN_IN(((surroundings){.out = STDERR_FILENO}), "run", s, "--out", in_folder("closed"));
    chmod(folder, 0777);
    assert_status(o, 2);
    outcome_free(&o);
}

static void a_full_disk_leaves_nothing_half_written(void **state) {
    (void)state;
    char words[600];
    const char *s = tiny_scene();
    // the point cache outgrows the limit in some frame
    outcome o = SKEIN_IN((surroundings){.file_limit = 30000}, "run", s, "--out", in_folder("out"), "--frames", "400",
                         "--no-progress");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it grew over the limit for a file's size\n",
             in_folder("out/sheet.pc2"));
    assert_true(!strncmp(o.err, words, strlen(words)));
    assert_contains(o.err, "skein: what was written before that is kept in ");
    assert_string_equal(o.out, "");
    // what was finished is there, under names that say what it is; nothing is under a final name
    assert_int_equal(count_entries(in_folder("out")), 3);
    assert_true(exists(in_folder("out/sheet.failed.pc2")) && exists(in_folder("out/cloth.failed.pc2")));
    json_t *told = read_report(in_folder("out/report.failed.json"));
    assert_contains(text_of(told, "failed"), "it grew over the limit for a file's size");
    assert_int_equal(json_array_size(json_object_get(told, "files")), 2);
    json_decref(told);
    outcome_free(&o);
    assert_int_equal(nftw(in_folder("out"), remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
    // the mesh does, at the end; the rest is whole, and the report lists what there is
    o = SKEIN_IN((surroundings){.file_limit = 10000}, "run", s, "--out", in_folder("out"), "--no-progress", "--set",
                 "output=[\"obj\"]", "--set", "bodies.1.grid=[2,2]", "--set", "bodies.0.grid=[20,20]");
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it grew over the limit for a file's size\n",
             in_folder("out/sheet.obj"));
    assert_string_equal(o.err, words);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 2);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(json_array_size(json_object_get(report, "files")), 1);
    json_decref(report);
    assert_true(exists(in_folder("out/cloth.obj")));
    // what stood there before still stands
    write_text(in_folder("out/sheet.pc2"), "old");
    o = SKEIN_IN((surroundings){.file_limit = 30000}, "run", s, "--out", in_folder("out"), "--frames", "400",
                 "--no-progress");
    assert_status(o, 1);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 6);
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
    o = SKEIN_IN((surroundings){.out = ends[1]}, "run", tiny_scene(), "--out", in_folder("out"), "--no-progress");
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
        for (struct dirent *entry; open_folder && (entry = readdir(open_folder)) != NULL;)
            found |= strstr(entry->d_name, ".part") != NULL;
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
        pid_t child =
            start_skein((surroundings){0}, (const char *const[]){"run", tiny_scene(), "--out", in_folder("out"),
                                                                 "--frames", "100000000", "--no-progress", NULL});
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

/* A scene that blows up after some frames, with other folders to write to. */
#define BLOW_UP(...)                                                                                            \
    SKEIN("run", s, "--no-progress", "--set", "method={\"type\":\"symplectic_euler\",\"substeps\":1}", "--set", \
          "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}", __VA_ARGS__)

/* In its first frame, into a folder that was not there. */
static void what_blows_up_at_once_is_reported(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--no-progress", "--set", "method={\"type\":\"symplectic_euler\",\"substeps\":30}",
                      "--set", "bodies.0.stretch={\"stiffness\":1e12,\"limit\":\"infinite\",\"tether\":\"infinite\"}",
                      "--frames", "9", "--out", in_folder("out/deeper"));
    assert_status(o, 1);
    assert_contains(o.err, "blew up in frame 1: ");
    outcome_free(&o);
    json_t *report = read_report(in_folder("out/deeper/report.failed.json"));
    assert_true(number_of(report, "frames") == 0);
    json_decref(report);
    assert_true(exists(in_folder("out/deeper/blow_up/README.txt")));
}

static void a_run_that_blows_up_names_the_frame(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    int frame = 0, bad = 0, all = 0;
    outcome o = BLOW_UP("--frames", "400", "--out", in_folder("out/deeper"));
    assert_status(o, 1);
    assert_string_equal(o.out, "");
    snprintf(words, sizeof words, "skein: %s: blew up in frame %%d: %%d of %%d particles are no longer finite", s);
    const char *told = strstr(o.err, "skein: /");
    assert_non_null(told);
    assert_int_equal(sscanf(told, words, &frame, &bad, &all), 3);
    assert_contains(told, "; set method.substeps to ");
    assert_true(frame > 2 && frame < 400 && bad > 0 && bad <= all && all == 34);
    snprintf(words, sizeof words, "\nskein: the %d frames before that are kept in %s/*.failed.*\n", frame - 1,
             in_folder("out/deeper"));
    assert_contains(told, words);
    // it was foretold
    assert_contains(o.err, "warning: ");
    assert_contains(o.err, "symplectic_euler is stable with substeps of ");
    outcome_free(&o);
    // a frame earlier all was finite, but far beyond what can be
    snprintf(words, sizeof words, "%d", frame - 1);
    o = BLOW_UP("--frames", words);
    assert_status(o, 1);
    assert_contains(o.err, "ended far beyond its bounds: an edge is stretched by ");
    assert_contains(o.out, "state hash ");
    outcome_free(&o);
    // and so far it is kept, under names that say what it is
    shape grid = shape_of_grid(5, 5);
    io_pc2_header header;
    io_pc2_reader *reader = io_pc2_open(in_folder("out/deeper/sheet.failed.pc2"), &header, NULL);
    assert_non_null(reader);
    assert_true(header.points == grid.vertex_count && header.samples == (uint32_t)frame);
    io_pc2_close(reader);
    free(grid.corners);
    json_t *report = read_report(in_folder("out/deeper/report.failed.json"));
    snprintf(words, sizeof words, "%s: blew up in frame %d: ", s, frame);
    assert_true(!strncmp(text_of(report, "failed"), words, strlen(words)));
    assert_true(number_of(report, "frames") == frame - 1);
    assert_true(number_of(report, "nonfinite_particles") == bad);
    json_decref(report);
    assert_int_equal(count_entries(in_folder("out/deeper")), 4); // and what does it again
    assert_true(exists(in_folder("out/deeper/blow_up/README.txt")));

    // what stood there before still stands; a good run says that it did not fail
    assert_int_equal(mkdir(in_folder("there"), 0777), 0);
    write_text(in_folder("there/sheet.pc2"), "old");
    o = BLOW_UP("--frames", "400", "--out", in_folder("there"));
    assert_status(o, 1);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("there")), 5);
    char *text = read_text(in_folder("there/sheet.pc2"));
    assert_string_equal(text, "old");
    free(text);
    o = SKEIN("run", s, "--out", in_folder("there"), "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    report = read_report(in_folder("there/report.json"));
    assert_true(json_is_false(json_object_get(report, "failed")));
    json_decref(report);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(a_file_in_the_way_is_told),
        TEST(a_folder_that_may_not_be_written_is_told),
        TEST(a_full_disk_leaves_nothing_half_written),
        TEST(output_that_cannot_be_printed_is_told),
        TEST(an_interrupted_run_writes_what_it_has),
        TEST(what_blows_up_at_once_is_reported),
        TEST(a_run_that_blows_up_names_the_frame),
    };
    return cmocka_run_group_tests_name("command trouble", tests, NULL, NULL);
}
