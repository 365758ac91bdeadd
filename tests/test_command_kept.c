/* Tests of what a run leaves that did not come to its end: killed, out of room, blown up, or beside another one.
 * Whoever reads HDF5 here is the HDF5 library, which had no part in writing it. */
#include "test_command.h"

#include <math.h>
#ifdef SKEIN_HDF5
#include <hdf5.h>
#endif

/* ---- Looking ------------------------------------------------------------------------------------------ */

/* The path of the one entry of out/ that begins so; false if there is none. */
static bool find_entry(const char *beginning, char path[700]) {
    DIR *open_folder = opendir(in_folder("out"));
    int found = 0;
    for (struct dirent *entry; open_folder && (entry = readdir(open_folder)) != NULL;)
        if (!strncmp(entry->d_name, beginning, strlen(beginning))) {
            snprintf(path, 700, "%s/%s", in_folder("out"), entry->d_name);
            found++;
        }
    if (open_folder) closedir(open_folder);
    assert_true(found <= 1);
    return found;
}

/* Samples of a recording that a plain reader finds, all of them whole: their times are those of the frames, a free
 * particle's place moves. -1: it cannot be read. Of a file that still grows that may happen now and then, for a reader
 * takes several looks, and what it saw first may have been replaced meanwhile; of one that rests it is a fault. */
static long samples_of(const char *path) {
#ifdef SKEIN_HDF5
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file < 0) return -1;
    static const char *const names[] = {"/time", "/positions", "/velocities"};
    hsize_t size[3][3] = {{0}};
    double *numbers[3] = {NULL};
    bool whole = true;
    for (int i = 0; i < 3 && whole; i++) {
        hid_t set = H5Dopen2(file, names[i], H5P_DEFAULT), space = set < 0 ? -1 : H5Dget_space(set);
        whole =
            space >= 0 && H5Sget_simple_extent_dims(space, size[i], NULL) == (i ? 3 : 1) && size[i][0] == size[0][0];
        numbers[i] = whole ? malloc(((size_t)H5Sget_simple_extent_npoints(space) + 1) * sizeof(double)) : NULL;
        whole &= numbers[i] &&
                 (!size[i][0] || H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers[i]) >= 0);
        if (space >= 0) H5Sclose(space);
        if (set >= 0) H5Dclose(set);
    }
    size_t one = (size_t)size[1][1] * 3;
    for (size_t s = 0; s < size[0][0] && whole; s++) {
        whole = fabs(numbers[0][s] - (double)s / 60) < 1e-9 * (1 + (double)s);
        const double *x = numbers[1] + s * one, *v = numbers[2] + s * one;
        for (size_t k = 0; k < one; k++) whole &= fabs(x[k]) < 1e3 && fabs(v[k]) < 1e3;
        whole &= s == 0 || memcmp(x, x - one, one * sizeof *x) != 0;
    }
    for (int i = 0; i < 3; i++) free(numbers[i]);
    H5Fclose(file);
    return whole ? (long)size[0][0] : -1;
#else
    (void)path;
    return -1;
#endif
}

/* The samples that the header of a point cache counts, all of them there; -1: not to be read. */
static long samples_of_cache(const char *path) {
    io_pc2_header header;
    io_pc2_reader *reader = io_pc2_open(path, &header, NULL);
    if (!reader) return -1;
    double *x = malloc(3 * header.points * sizeof *x);
    for (uint32_t s = 0; s < header.samples; s++) {
        assert_int_equal(io_pc2_read(reader, s, x, NULL), SKEIN_OK);
        for (size_t k = 0; k < 3 * header.points; k++) assert_true(fabs(x[k]) < 1e3);
    }
    free(x);
    io_pc2_close(reader);
    return header.samples;
}

/* A cloth that falls and swings for ever. */
static const char *swinging_scene(void) {
    static char path[512];
    snprintf(path, sizeof path, "%s/swing.json", folder);
    write_scene(path, "{ 'fps': 60, 'output': ['hdf5', 'pc2', 'csv'],\n"
                      "  'bodies': [ { 'type': 'cloth', 'name': 'c', 'grid': [5, 5], 'pins': '0' } ],\n"
                      "  'forces': [ { 'type': 'gravity' } ] }\n");
    return path;
}

/* ---- Killed --------------------------------------------------------------------------------------------- */

static void wait_a_little(void) {
    nanosleep(&(struct timespec){0, 20000000}, NULL);
}

static void a_killed_run_leaves_what_can_be_read(void **state) {
    (void)state;
    const char *s = swinging_scene();
    char path[700], cache[700];
    uint64_t seed = 7;
    for (int turn = 0; turn < 10; turn++) {
        pid_t child = start_skein((surroundings){0}, (const char *const[]){"run", s, "--out", in_folder("out"),
                                                                           "--frames", "100000000", "--quiet", NULL});
        // until so much is there, as another program sees it; then at any moment
        long before = 0, cached = 0, enough = 10 << (turn % 5);
        for (int i = 0; i < 3000 && (before < enough || cached < enough || !find_entry("c.xdmf.", path));
             i++, wait_a_little()) {
            if (find_entry("c.pc2.", cache)) cached = samples_of_cache(cache);
#ifdef SKEIN_HDF5
            if (find_entry("c.h5.", path)) before = samples_of(path);
#else
            before = enough;
#endif
        }
        assert_true(before >= enough && cached >= enough);
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        nanosleep(&(struct timespec){0, (long)(seed >> 36)}, NULL); // up to a quarter of a second
        kill(child, SIGKILL);
        outcome o = finish_skein(child);
        assert_status(o, -SIGKILL);
        outcome_free(&o);
        assert_true(find_entry("c.pc2.", cache) && samples_of_cache(cache) >= cached);
#ifdef SKEIN_HDF5
        assert_true(find_entry("c.h5.", path) && samples_of(path) >= before);
        // the index, too, is whole, and speaks of what is there
        assert_true(find_entry("c.xdmf.", path));
        char *text = read_text(path);
        assert_string_equal(text + strlen(text) - strlen("</Xdmf>\n"), "</Xdmf>\n");
        assert_contains(text, "c.h5:/positions");
        free(text);
#endif
        assert_false(exists(in_folder("out/c.h5")) || exists(in_folder("out/c.pc2")));
        // nothing of it is in the way of the next run
        outcome next = SKEIN("run", s, "--out", in_folder("out"), "--frames", "3", "--quiet");
        assert_status(next, 0);
        outcome_free(&next);
        assert_int_equal(samples_of_cache(in_folder("out/c.pc2")), 4);
        assert_int_equal(nftw(in_folder("out"), remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
    }
}

/* ---- No room ---------------------------------------------------------------------------------------------- */

static void without_room_what_was_finished_is_kept(void **state) {
    (void)state;
    const char *s = swinging_scene();
    static const char *const outputs[] = {"output=[\"hdf5\"]", "output=[\"pc2\"]", "output=[\"csv\"]"};
    static const char *const names[] = {"c.h5", "c.pc2", "c.csv"}, *const failed[] = {"c.failed.h5", "c.failed.pc2",
                                                                                      "c.failed.csv"};
    int kept = 0;
    for (rlim_t limit = 512; limit < 700000; limit += limit / 2)
        for (size_t i = 0; i < COUNT(outputs); i++) {
            char path[700], words[700];
            outcome o = SKEIN_IN((surroundings){.file_limit = limit}, "run", s, "--out", in_folder("out"), "--frames",
                                 "4000", "--quiet", "--set", outputs[i]);
            assert_status(o, 1);
            snprintf(words, sizeof words, "skein: %s/%s: cannot write: it grew over the limit for a file's size\n",
                     in_folder("out"), names[i]);
            assert_contains(o.err, words);
            snprintf(path, sizeof path, "%s/%s", in_folder("out"), names[i]);
            assert_false(exists(path));
            if (!exists(in_folder("out"))) { // not one frame
                outcome_free(&o);
                continue;
            }
            snprintf(path, sizeof path, "%s/%s", in_folder("out"), failed[i]);
            if (i == 1) assert_int_equal(samples_of_cache(path), (limit - 32) / 300); // all that had room
#ifdef SKEIN_HDF5
            if (i == 0 && exists(path)) assert_true(samples_of(path) >= 1);
#endif
            if (i == 0 && !exists(path)) { // no room for its first chunks
                assert_true(limit < 100000);
                assert_contains(o.err, "not one sample was written: nothing of it is kept\n");
            }
            if (i == 2) {
                char *text = read_text(path);
                assert_true(text[strlen(text) - 1] == '\n');
                free(text);
            }
            json_t *report =
                exists(in_folder("out/report.failed.json")) ? read_report(in_folder("out/report.failed.json")) : NULL;
            if (report) assert_contains(text_of(report, "failed"), "cannot write");
            else assert_true(limit < 4096); // it had no room, either
            json_decref(report);
            assert_false(exists(in_folder("out/report.json")) || find_entry("c.h5.", path) ||
                         find_entry("c.pc2.", path));
            assert_int_equal(nftw(in_folder("out"), remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
            outcome_free(&o);
            kept++;
        }
    assert_true(kept > 20);
}

/* ---- Beside others ------------------------------------------------------------------------------------------ */

static void no_link_is_followed_while_a_file_grows(void **state) {
    (void)state;
    const char *s = swinging_scene();
    assert_int_equal(mkdir(in_folder("out"), 0777), 0);
    write_text(in_folder("mine.txt"), "mine");
    assert_int_equal(symlink("../mine.txt", in_folder("out/c.h5.part")), 0);
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--frames", "3", "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    char *text = read_text(in_folder("mine.txt"));
    assert_string_equal(text, "mine");
    free(text);
    assert_true(exists(in_folder("out/c.h5")) && exists(in_folder("out/c.xdmf")));
}

static void two_runs_do_not_share_a_folder(void **state) {
    (void)state;
    const char *s = swinging_scene();
    char path[700], words[700];
    pid_t child = start_skein((surroundings){0}, (const char *const[]){"run", s, "--out", in_folder("out"), "--frames",
                                                                       "100000000", "--quiet", NULL});
    for (int i = 0; i < 3000 && !find_entry("c.csv.", path); i++) wait_a_little();
    int words_of_its_own = caught(".err2");
    outcome o = SKEIN_IN(((surroundings){.err = words_of_its_own, .out = words_of_its_own}), "run", s, "--out",
                         in_folder("out"), "--frames", "3");
    close(words_of_its_own);
    assert_status(o, 2);
    outcome_free(&o);
    char *text = read_text(in_folder(".err2"));
    snprintf(words, sizeof words,
             "skein run: --out %s: another run writes there; wait for its end, or name another folder\n",
             in_folder("out"));
    assert_string_equal(text, words);
    free(text);
    // the first one knows nothing of it
    kill(child, SIGINT);
    o = finish_skein(child);
    assert_status(o, 130);
    outcome_free(&o);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(samples_of_cache(in_folder("out/c.pc2")), (long)number_of(report, "frames") + 1);
#ifdef SKEIN_HDF5
    assert_int_equal(samples_of(in_folder("out/c.h5")), (long)number_of(report, "frames") + 1);
#endif
    json_decref(report);
}

/* ---- What came in goes out ---------------------------------------------------------------------------------- */

static void a_mesh_keeps_its_texture_and_materials(void **state) {
    (void)state;
    write_text(in_folder("m.obj"),
               "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\n"
               "o cape\nusemtl red\nf 1/1 2/2 3/3 4\ng seam\nusemtl blue\nf 2/1 5/2 3/3\n");
    char *s = in_folder("m.json"), words[700];
    write_scene(s, "{ 'frames': 2, 'output': ['obj'], 'forces': [ { 'type': 'gravity' } ],\n"
                   "  'bodies': [ { 'type': 'cloth', 'name': 'c', 'mesh': 'm.obj', 'pins': '0' } ] }\n");
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--quiet");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    outcome_free(&o);
    char *text = read_text(in_folder("out/c.obj"));
    snprintf(words, sizeof words,
             "/m.mtl\no cape\nusemtl red\nf 1/1/1 2/2/2 3/3/3 4//4\ng seam\nusemtl blue\nf 2/1/2 5/2/5 3/3/3\n");
    assert_contains(text, words);
    assert_contains(text, "vt 0 0\nvt 0.5 0\nvt 0.5 1\nmtllib /");
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(a_killed_run_leaves_what_can_be_read),   TEST(without_room_what_was_finished_is_kept),
        TEST(no_link_is_followed_while_a_file_grows), TEST(two_runs_do_not_share_a_folder),
        TEST(a_mesh_keeps_its_texture_and_materials),
    };
    return cmocka_run_group_tests_name("what is kept", tests, NULL, NULL);
}
