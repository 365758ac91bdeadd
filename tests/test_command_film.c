/* Tests of films as the command makes them: `skein render` and the exporter "film", in processes that end well,
 * are interrupted, killed, or run out of disk. */
#include "test_command.h"

#include <math.h>

#include "film_reader.h"

#define SMALL "--size", "64x36", "--samples", "1", "--no-progress"

static long size_of(const char *path) {
    struct stat info;
    return stat(path, &info) ? -1 : (long)info.st_size;
}

/* The part of the picture's pixels that differ from another picture's by more than `least`. */
static double difference(const film_seen *a, int i, const film_seen *b, int k, int least) {
    int count = 0;
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            const uint8_t *p = film_seen_pixel(a, i, x, y), *q = film_seen_pixel(b, k, x, y);
            count += abs(p[0] - q[0]) > least || abs(p[1] - q[1]) > least || abs(p[2] - q[2]) > least;
        }
    return (double)count / (a->width * a->height);
}

/* ---- Films that end well ------------------------------------------------------------------------------- */

static void every_format_shows_the_same(void **state) {
    static const struct {
        const char *name, *codec;
        int pictures;
        double rate;
    } films[] = {{"a.mp4", "h264", 18, 60}, {"a.webm", "vp9", 18, 60}, {"a.gif", "gif", 9, 30}};
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    // the same in pictures that lose nothing
    outcome o = SKEIN("render", s, "-o", in_folder("p##.png"), "--frames", "18", SMALL);
    assert_status(o, 0);
    outcome_free(&o);
    film_seen first = film_see(in_folder("p00.png")), last = film_see(in_folder("p16.png"));
    assert_true(first.pictures == 1 && last.pictures == 1);
    assert_true(difference(&first, 0, &last, 0, 12) > 0.02);
    for (size_t i = 0; i < COUNT(films); i++) {
        int n = films[i].pictures, every = 18 / n;
        o = SKEIN("render", s, "-o", in_folder(films[i].name), "--frames", "18", "--quality", "90", SMALL);
        assert_status(o, 0);
        assert_string_equal(o.err, "");
        snprintf(words, sizeof words, "wrote %s: %d pictures of 64 x 36, 0.30 s at %g a second, ",
                 in_folder(films[i].name), n, films[i].rate);
        assert_contains(o.out, words);
        outcome_free(&o);
        film_seen seen = film_see(in_folder(films[i].name));
        assert_string_equal(seen.codec, films[i].codec);
        assert_false(seen.broken);
        assert_int_equal(seen.pictures, n);
        assert_true(seen.width == 64 && seen.height == 36);
        assert_true(fabs(seen.length - 18.0 / 60) < 0.03);
        // picture k shows the world after k frames, in the colours of the PNG
        assert_true(difference(&seen, 0, &first, 0, 40) < 0.01);
        assert_true(difference(&seen, 16 / every, &last, 0, 40) < 0.01);
        double off[3] = {0};
        for (int p = 0; p < 64 * 36; p++)
            for (int k = 0; k < 3; k++) off[k] += (double)seen.pixels[3 * p + k] - first.pixels[3 * p + k];
        for (int k = 0; k < 3; k++) assert_true(fabs(off[k]) / (64 * 36) < 2);
        film_seen_free(&seen);
    }
    film_seen_free(&first);
    film_seen_free(&last);
}

static void what_is_changed_is_noted(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("render", s, "-o", in_folder("a.mp4"), "--size", "65x37", "--fps", "480", "--samples", "1");
    assert_status(o, 0);
    assert_contains(o.err, "a.mp4: H.264 in MP4 has even sizes only: 64 x 36 instead of 65 x 37\n");
    assert_contains(o.err, "a.mp4: H.264 in MP4 plays 240 pictures a second at most: one frame in 2 is taken\n");
    assert_contains(o.err, "] frame 4 of 4, ");
    assert_contains(o.out, ": 2 pictures of 64 x 36, 0.01 s at 240 a second, ");
    outcome_free(&o);
    film_seen seen = film_see(in_folder("a.mp4"));
    assert_true(seen.pictures == 2 && seen.width == 64 && seen.height == 36);
    film_seen_free(&seen);
    // no frames: the start alone
    o = SKEIN("render", s, "-o", in_folder("a.webm"), "--frames", "0", SMALL);
    assert_status(o, 0);
    assert_contains(o.out, ": 1 picture of 64 x 36, ");
    outcome_free(&o);
    seen = film_see(in_folder("a.webm"));
    assert_int_equal(seen.pictures, 1);
    film_seen_free(&seen);
}

static void the_exporter_makes_a_film_where_it_is_asked_for(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("run", s, "--out", in_folder("out"), "--frames", "6", "--no-progress", "--set",
                      "output=[\"obj\",{\"type\":\"film\",\"size\":[64,36],\"samples\":1,\"format\":\"webm\"}]");
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    assert_contains(o.out, "/out/my_scene_1.webm\n");
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 4);
    film_seen seen = film_see(in_folder("out/my_scene_1.webm"));
    assert_true(seen.pictures == 6 && seen.width == 64);
    assert_true(fabs(seen.length - 0.1) < 0.01);
    film_seen_free(&seen);
    json_t *report = read_report(in_folder("out/report.json"));
    assert_int_equal(json_array_size(json_object_get(report, "files")), 3);
    json_decref(report);
    // the film changes nothing in what is simulated
    uint64_t with = hash_of(SKEIN("run", s, "--out", in_folder("out"), "--frames", "6", "--no-progress", "--set",
                                  "output=[{\"type\":\"film\",\"size\":[64,36],\"samples\":1}]"));
    assert_true(with == hash_of(SKEIN("run", s, "--frames", "6", "--no-progress")));
    assert_true(exists(in_folder("out/my_scene_1.mp4")));
    // by default there is none, and a run that fails leaves none under its name
    write_scene(in_folder("plain.json"),
                "{ 'frames': 2, 'name': 'plain', 'bodies': [ { 'type': 'cloth', 'grid': [3, 3] } ] }");
    o = SKEIN("run", in_folder("plain.json"), "--out", in_folder("plain"), "--no-progress");
    assert_status(o, 0);
    assert_false(exists(in_folder("plain/plain.mp4")));
    assert_true(exists(in_folder("plain/plain.png")));
    outcome_free(&o);
    o = SKEIN_IN((surroundings){.file_limit = 1500}, "run", s, "--out", in_folder("full"), "--frames", "130",
                 "--no-progress", "--set",
                 "output=[{\"type\":\"film\",\"size\":[64,36],\"samples\":1,\"quality\":100}]");
    assert_status(o, 1);
    assert_contains(o.err, "my_scene_1.mp4: cannot write: it grew over the limit for a file's size\n");
    assert_false(exists(in_folder("full/my_scene_1.mp4"))); // what there is has a name that says so
    assert_true(exists(in_folder("full/my_scene_1.failed.mp4")));
    outcome_free(&o);
}

/* ---- Films that are cut off ------------------------------------------------------------------------------ */

/* Starts a film without end, and waits until what is on the disk has `least` pictures, a minute at most. */
static pid_t start_film(const char *path, int least) {
    const struct timespec pause = {0, 20000000};
    pid_t child = start_skein((surroundings){0},
                              (const char *const[]){"render", tiny_scene(), "-o", path, "--frames", "100000000",
                                                    "--fps", "10", "--set", "step=0.1", SMALL, NULL});
    for (int i = 0; least && i < 3000; i++) {
        kill(child, SIGSTOP); // or the reader might never catch up
        film_seen seen = film_see(path);
        kill(child, SIGCONT);
        int pictures = seen.pictures;
        film_seen_free(&seen);
        if (pictures >= least) return child;
        nanosleep(&pause, NULL);
    }
    if (least) kill(child, SIGKILL);
    assert_int_equal(least, 0);
    return child;
}

static void a_killed_film_can_be_played(void **state) {
    static const char *const names[] = {"killed.mp4", "killed.webm"};
    (void)state;
    if (SPARING) skip(); // which the killed process tells nothing
    for (size_t i = 0; i < COUNT(names); i++) {
        pid_t child = start_film(in_folder(names[i]), 20);
        kill(child, SIGKILL);
        outcome o = finish_skein(child);
        assert_status(o, -SIGKILL);
        film_seen seen = film_see(in_folder(names[i]));
        assert_false(seen.broken);
        assert_true(seen.pictures >= 20 && seen.width == 64 && seen.height == 36);
        assert_true(fabs(seen.end - (seen.pictures - 1) / 10.0) < 0.01);
        assert_true(difference(&seen, 0, &seen, seen.pictures - 1, 30) > 0.01);
        film_seen_free(&seen);
        outcome_free(&o);
    }
}

static void an_interrupted_film_ends_well(void **state) {
    static const struct {
        const char *name;
        int signal, least;
    } films[] = {{"a.mp4", SIGINT, 10}, {"a.webm", SIGTERM, 10}, {"a.gif", SIGINT, 0}};
    (void)state;
    for (size_t i = 0; i < COUNT(films); i++) {
        pid_t child = start_film(in_folder(films[i].name), films[i].least);
        const struct timespec pause = {0, 10000000}; // a GIF grows unseen: wait until it was begun
        for (int k = 0; !films[i].least && k < 6000 && size_of(in_folder(films[i].name)) < 0; k++)
            nanosleep(&pause, NULL);
        kill(child, films[i].signal);
        outcome o = finish_skein(child);
        assert_status(o, 128 + films[i].signal);
        assert_string_equal(o.err, "");
        int told = 0;
        const char *at = strstr(o.out, films[i].name);
        assert_non_null(at);
        assert_int_equal(sscanf(at + strlen(films[i].name), ": %d picture", &told), 1);
        film_seen seen = film_see(in_folder(films[i].name));
        assert_false(seen.broken);
        assert_true(told >= 1 && told >= films[i].least && seen.pictures == told);
        assert_true(fabs(seen.length - told / 10.0) < 0.02);
        film_seen_free(&seen);
        outcome_free(&o);
    }
}

static void a_full_disk_ends_a_film(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    outcome o = SKEIN_IN((surroundings){.file_limit = 8000}, "render", s, "-o", in_folder("a.mp4"), "--frames",
                         "100000", "--fps", "10", "--set", "step=0.1", SMALL);
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: it grew over the limit for a file's size\n",
             in_folder("a.mp4"));
    assert_string_equal(o.err, words);
    assert_string_equal(o.out, "");
    outcome_free(&o);
    assert_false(exists(in_folder("a.mp4")));
    film_seen seen = film_see(in_folder("a.failed.mp4"));
    assert_true(seen.pictures >= 10); // what was there before
    film_seen_free(&seen);
    assert_int_equal(symlink("/dev/full", in_folder("full.webm")), 0);
    o = SKEIN("render", s, "-o", in_folder("full.webm"), SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "full.webm: cannot write: the disk is full, make room or write elsewhere\n");
    outcome_free(&o);
    o = SKEIN_IN((surroundings){.file_limit = 20000}, "render", s, "-o", in_folder("a.gif"), "--frames", "40", SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "a.gif: cannot write: it grew over the limit for a file's size\n");
    assert_false(exists(in_folder("a.gif")));
    outcome_free(&o);
}

/* Before the film is begun nothing is lost: the old one stays where no new one can be. */
static void what_cannot_begin_leaves_the_old_film(void **state) {
    (void)state;
    const char *s = tiny_scene();
    write_text(in_folder("a.mp4"), "old");
    setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
    outcome o = SKEIN("render", s, "-o", in_folder("a.mp4"), SMALL);
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    if (o.status == 0) skip(); // a driver that is not Mesa's
    assert_status(o, 1);
    assert_contains(o.err, "skein: EGL: no OpenGL 4.5 to draw with (");
    char *kept = read_text(in_folder("a.mp4"));
    assert_string_equal(kept, "old");
    free(kept);
    outcome_free(&o);
    o = SKEIN("render", s, "-o", in_folder("a.mp4"), "--set", "bodies.0.grid=[1,1]", SMALL);
    assert_status(o, 2);
    kept = read_text(in_folder("a.mp4"));
    assert_string_equal(kept, "old");
    free(kept);
    outcome_free(&o);
    assert_int_equal(mkdir(in_folder("dir.mp4"), 0777), 0);
    o = SKEIN("render", s, "-o", in_folder("dir.mp4"), SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "dir.mp4: cannot write: it is a directory, name a file in it\n");
    outcome_free(&o);
    o = SKEIN("render", s, "-o", in_folder("no/such.mp4"), SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "such.mp4: cannot write: its directory does not exist, create it first\n");
    outcome_free(&o);
}

/* A film of what blows up ends where it did. */
static void a_film_that_blows_up_is_kept_up_to_there(void **state) {
    (void)state;
    int frame = 0, pictures = 0;
    outcome o = SKEIN("render", tiny_scene(), "-o", in_folder("a.mp4"), "--frames", "400", SMALL, "--set",
                      "method={\"type\":\"symplectic_euler\",\"substeps\":1}", "--set",
                      "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}");
    assert_status(o, 1);
    const char *told = strstr(o.err, "blew up in frame "), *wrote = strstr(o.out, "a.mp4: ");
    assert_true(told && wrote);
    assert_int_equal(sscanf(told, "blew up in frame %d", &frame), 1);
    assert_int_equal(sscanf(wrote, "a.mp4: %d pictures", &pictures), 1);
    assert_int_equal(pictures, frame);
    film_seen seen = film_see(in_folder("a.mp4"));
    assert_true(seen.pictures == pictures && !seen.broken);
    film_seen_free(&seen);
    outcome_free(&o);
}

/* ---- Films' libraries ------------------------------------------------------------------------------------ */

static void a_missing_module_says_what_to_do(void **state) {
    (void)state;
    setenv("SKEIN_MODULES", in_folder("nothing"), 1);
    outcome o = SKEIN("render", tiny_scene(), "-o", in_folder("a.mp4"), "--frames", "2", SMALL);
    outcome pictures = SKEIN("render", tiny_scene(), "-o", in_folder("a.png"), "--frame", "2", SMALL);
    unsetenv("SKEIN_MODULES");
    assert_int_not_equal(o.status, 0);
    assert_contains(o.err, "skein_film.so");
    assert_contains(o.err, in_folder("nothing"));
    assert_contains(o.err, "SKEIN_MODULES");
    assert_status(pictures, 0); // these need no module
    outcome_free(&o);
    outcome_free(&pictures);
    assert_int_equal(size_of(in_folder("a.mp4")), -1);
}

static void what_is_no_module_is_refused(void **state) {
    (void)state;
    FILE *file = fopen(in_folder("skein_film.so"), "w");
    assert_non_null(file);
    fputs("nothing\n", file);
    fclose(file);
    setenv("SKEIN_MODULES", folder, 1);
    outcome o = SKEIN("render", tiny_scene(), "-o", in_folder("a.gif"), "--frames", "2", SMALL);
    unsetenv("SKEIN_MODULES");
    assert_int_not_equal(o.status, 0);
    assert_contains(o.err, "cannot be loaded");
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(every_format_shows_the_same),
        TEST(what_is_changed_is_noted),
        TEST(the_exporter_makes_a_film_where_it_is_asked_for),
        TEST(a_killed_film_can_be_played),
        TEST(an_interrupted_film_ends_well),
        TEST(a_full_disk_ends_a_film),
        TEST(what_cannot_begin_leaves_the_old_film),
        TEST(a_film_that_blows_up_is_kept_up_to_there),
        TEST(a_missing_module_says_what_to_do),
        TEST(what_is_no_module_is_refused),
    };
    return cmocka_run_group_tests_name("command film", tests, NULL, NULL);
}
