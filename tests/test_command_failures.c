/* Whatever the operating system refuses, in turn: each file that is opened, each read, write, sync, cut, close and
 * rename, each folder and each thread (failing/interpose.c makes it so). The command says so and ends with 1, or all it
 * wrote is right all the same; under a final name stands what a good run writes, to the byte, or nothing; and what was
 * to be gone on from can be gone on from. */
#include "test_command.h"

/* One failure of so many is tried. */
static const int stride = 1;

/* ---- What a run left --------------------------------------------------------------------------------- */

static bool ends_with(const char *text, const char *end) {
    size_t length = strlen(text), size = strlen(end);
    return length >= size && !strcmp(text + length - size, end);
}

/* The same paths for as long as a test lasts, where in_folder() forgets after a hundred. */
static const char *place_of(const char *name) {
    static char places[16][200];
    static int count;
    for (int i = 0; i < count && i < 16; i++)
        if (ends_with(places[i], name) && !strncmp(places[i], folder, strlen(folder))) return places[i];
    snprintf(places[count % 16], sizeof places[0], "%s/%s", folder, name);
    return places[count++ % 16];
}

static const char *trouble; // what was made to fail, for messages
static int complaints;      // all are told, and none is allowed
#define complain(...) (complaints++, fprintf(stderr, __VA_ARGS__), fputc('\n', stderr))

static void assert_same_bytes(const char *path, const char *good) {
    io_bytes a, b;
    skein_error error;
    assert_int_equal(io_file_read(path, (size_t)1 << 30, &a, &error), SKEIN_OK);
    if (io_file_read(good, (size_t)1 << 30, &b, &error)) {
        complain("%s: a good run leaves no %s", trouble, path);
        io_bytes_free(&a);
        return;
    }
    if (a.size != b.size || memcmp(a.data, b.data, a.size))
        complain("%s: %s has %zu bytes, and not those that a good run leaves (%zu)", trouble, path, a.size, b.size);
    io_bytes_free(&a);
    io_bytes_free(&b);
}

/* Judges a folder by that of a good run, with all that is in it. Returns how many files are whole. */
static int judge_folder(const char *path, const char *good) {
    DIR *open_folder = opendir(path);
    int whole = 0;
    char inside[700], good_inside[700];
    for (struct dirent *entry; open_folder && (entry = readdir(open_folder)) != NULL;) {
        const char *name = entry->d_name;
        if (!strcmp(name, ".") || !strcmp(name, "..")) continue;
        snprintf(inside, sizeof inside, "%s/%s", path, name);
        snprintf(good_inside, sizeof good_inside, "%s/%s", good, name);
        if (ends_with(name, ".part")) complain("%s: %s is left", trouble, inside);
        if (ends_with(name, ".json")) json_decref(read_report(inside)); // times and paths differ
        else if (!strncmp(name, "compare.", 8)) continue;               // has times
        else if (!strcmp(name, "resume") || !strcmp(name, "blow_up") || strstr(name, ".failed.")) continue;
        else if (ends_with(name, ".mp4")) whole++; // its bytes differ from time to time
        else if (entry->d_type == DT_DIR) whole += judge_folder(inside, good_inside);
        else {
            assert_same_bytes(inside, good_inside);
            whole++;
        }
    }
    if (open_folder) closedir(open_folder);
    return whole;
}

static void remove_all(const char *path) {
    if (exists(path)) assert_int_equal(nftw(path, remove_entry, 8, FTW_DEPTH | FTW_PHYS), 0);
}

/* ---- Failing in turn --------------------------------------------------------------------------------- */

/* A command whose every call is to fail: `prepare` lays what it needs, `judge` looks at what it left. */
typedef struct way {
    void (*prepare)(void);
    void (*judge)(const outcome *o);
    const char *const *arguments;
} way;

/* The n-th line of the log of calls; how many there are for -1. */
static int read_calls(int number, char line[600]) {
    FILE *log = fopen(in_folder(".calls"), "r");
    int count = 0;
    *line = '\0';
    for (char text[600]; log && fgets(text, sizeof text, log); count++)
        if (atoi(text) == number && !*line) snprintf(line, 600, "%.*s", (int)strcspn(text, "\n"), text);
    if (log) fclose(log);
    return count;
}

static outcome run_failing(const way *w, const char *what) {
    unlink(in_folder(".calls"));
    w->prepare();
    return finish_skein(start_skein((surroundings){.fail = what}, w->arguments));
}

static bool fails_anyway; // the command ends with 1 without help

/* Has every call fail whose line in the log has `which`; each outcome is judged. */
static void fail_in_turn_from(const way *w, const char *kind, int step, const char *which) {
    char what[40], line[600], told[700];
    outcome o = run_failing(w, "count");
    assert_status(o, fails_anyway);
    outcome_free(&o);
    int calls = read_calls(-1, line);
    assert_true(calls > 0);
    char *log = read_text(in_folder(".calls"));
    for (int n = 0; n < calls; n += step) {
        char number[20];
        snprintf(number, sizeof number, "%d ", n);
        const char *at = log;
        while (at && strncmp(at, number, strlen(number))) at = (at = strchr(at, '\n')) ? at + 1 : NULL;
        if (at && (!strstr(at, which) || strstr(at, which) > at + strcspn(at, "\n"))) continue;
        snprintf(what, sizeof what, "%s %d", kind, n);
        o = run_failing(w, what);
        read_calls(n, line);
        snprintf(told, sizeof told, "%s (%s)", what, line);
        trouble = told;
        if (o.status != 0 && o.status != 1 && o.status != 2) complain("%s: exit status %d: %s", told, o.status, o.err);
        if (o.status != 0 && !*o.err) complain("%s: ended with %d without a word", told, o.status);
        w->judge(&o);
        outcome_free(&o);
    }
    free(log);
    assert_int_equal(complaints, 0);
}
static void fail_in_turn(const way *w, const char *kind, int step) {
    fail_in_turn_from(w, kind, step, "");
}

/* ---- Runs that write every format ------------------------------------------------------------------------ */

static const char every_format[] =
    "output=[\"pc2\", \"mdd\", \"usda\", \"glb\", \"ply\", \"stl\", \"csv\", \"hdf5\", {\"type\": \"obj\", \"every\": 2}]";

static void clear(void) {
    remove_all(in_folder("out"));
    unlink(in_folder("log.csv"));
}

static int files_of_good_run;

/* A log tells what was until it failed: it breaks off behind a line. */
static void judge_log(void) {
    if (!exists(in_folder("log.csv"))) return;
    char *log = read_text(in_folder("log.csv")), *good = read_text(in_folder("good.csv"));
    if (strncmp(log, good, strlen(log)) || !ends_with(log, "\n")) complain("%s: the log is %s", trouble, log);
    free(log);
    free(good);
}

/* A failure is an error that is told, or made no difference. */
static void judge_run(const outcome *o) {
    int whole = judge_folder(in_folder("out"), in_folder("good"));
    judge_log();
    if (o->status == 0 && (whole != files_of_good_run || !exists(in_folder("log.csv"))))
        complain("%s: ended with 0, but wrote %d of %d files", trouble, whole, files_of_good_run);
}

static void every_format_fails_as_it_should(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o =
        SKEIN("run", s, "--out", in_folder("good"), "--set", every_format, "--log", in_folder("good.csv"), "--quiet");
    assert_status(o, 0);
    outcome_free(&o);
    trouble = "nothing";
    files_of_good_run = judge_folder(in_folder("good"), in_folder("good"));
    assert_int_equal(files_of_good_run, 2 * 12);
    const char *const arguments[] = {
        "run", s, "--out", place_of("out"), "--log", place_of("log.csv"), "--set", every_format, "--no-progress", NULL};
    const way w = {clear, judge_run, arguments};
    fail_in_turn(&w, "once", stride);
    fail_in_turn(&w, "full", 3 * stride);
    // a system that moves less than was asked for, and is interrupted, is no failure
    o = run_failing(&w, "pieces");
    assert_status(o, 0);
    trouble = "pieces";
    judge_run(&o);
    outcome_free(&o);
}

/* ---- Runs that can be gone on with ------------------------------------------------------------------------- */

static const char *hash_text; // how a run that was never broken off ends

/* A run that failed, gone on with, ends as if it had not; where not one snapshot was kept there is nothing to go on
 * with, and that is said. */
static int gone_on;
static void judge_snapshots(const outcome *o) {
    judge_folder(in_folder("out"), in_folder("good"));
    if (o->status == 0 && !strstr(o->out, hash_text)) complain("%s: another hash: %s", trouble, o->out);
    outcome again = SKEIN("run", "--resume", in_folder("out"), "--no-progress");
    if (again.status != 0 && again.status != 2) complain("%s, gone on with: %s", trouble, again.err);
    if (again.status == 0) {
        gone_on++;
        if (!strstr(again.out, hash_text)) complain("%s, gone on with: another hash: %s", trouble, again.out);
        int whole = judge_folder(in_folder("out"), in_folder("good"));
        if (whole != files_of_good_run) complain("%s, gone on with: %d files", trouble, whole);
    }
    outcome_free(&again);
}

static char *hash_of_good_run(const char *s) {
    outcome o = SKEIN("run", s, "--out", in_folder("good"), "--set", "output=[\"pc2\", \"csv\"]");
    assert_status(o, 0);
    char *hash = strdup(strstr(o.out, "state hash"));
    outcome_free(&o);
    hash[strcspn(hash, "\n")] = '\0';
    trouble = "nothing";
    files_of_good_run = judge_folder(in_folder("good"), in_folder("good"));
    return hash;
}

static void snapshots_that_fail_can_be_gone_on_from(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char *hash = hash_of_good_run(s);
    hash_text = hash;
    const char *const arguments[] = {
        "run",           s,   "--out", place_of("out"), "--set", "output=[\"pc2\", \"csv\"]", "--snapshots", "1",
        "--no-progress", NULL};
    const way w = {clear, judge_snapshots, arguments};
    gone_on = 0;
    fail_in_turn(&w, "once", stride);
    fail_in_turn(&w, "full", 3 * stride);
    assert_true(gone_on > 60 / stride); // most of them
    free(hash);
}

/* ---- Going on -------------------------------------------------------------------------------------------------- */

static void lay_broken_run(void) {
    char command[1400];
    clear();
    snprintf(command, sizeof command, "cp -a %s %s", in_folder("broken"), in_folder("out"));
    assert_int_equal(system(command), 0);
}

static void going_on_fails_as_it_should(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char *hash = hash_of_good_run(s);
    hash_text = hash;
    // the disk runs full on the way
    outcome o = SKEIN_IN((surroundings){.fail = "full 40"}, "run", s, "--out", in_folder("out"), "--set",
                         "output=[\"pc2\", \"csv\"]", "--snapshots", "1", "--no-progress");
    assert_status(o, 1);
    outcome_free(&o);
    assert_int_equal(rename(in_folder("out"), in_folder("broken")), 0);
    const char *const arguments[] = {"run", "--resume", place_of("out"), "--no-progress", NULL};
    const way w = {lay_broken_run, judge_snapshots, arguments};
    gone_on = 0;
    fail_in_turn(&w, "once", stride);
    fail_in_turn(&w, "full", 3 * stride);
    assert_true(gone_on > 25 / stride);
    free(hash);
}

/* ---- Recordings ---------------------------------------------------------------------------------------------------
 */

static void clear_recording(void) {
    unlink(in_folder("new.skeinrec"));
}

static void judge_recording(const outcome *o) {
    if (exists(in_folder("new.skeinrec")) != (o->status == 0)) complain("%s: a recording, or none", trouble);
    if (o->status == 0) assert_same_bytes(in_folder("new.skeinrec"), in_folder("good.skeinrec"));
}

static void judge_verdict(const outcome *o) { // what cannot be read is not what differs
    if (o->status == 1 && !strstr(o->err, "cannot read")) complain("%s: %s", trouble, o->err);
}

static void nothing_to_lay(void) {}

static void recordings_fail_as_they_should(void **state) {
    (void)state;
    const char *const record[] = {"record", tiny_scene(), "-o", place_of("new.skeinrec"), "--quiet", NULL};
    outcome o = finish_skein(start_skein((surroundings){0}, record));
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(rename(in_folder("new.skeinrec"), in_folder("good.skeinrec")), 0);
    const way recording = {clear_recording, judge_recording, record};
    fail_in_turn(&recording, "once", stride);
    fail_in_turn(&recording, "full", 3 * stride);
    const char *const verify[] = {"verify", place_of("good.skeinrec"), NULL};
    const way verifying = {nothing_to_lay, judge_verdict, verify};
    fail_in_turn(&verifying, "once", 1);
}

/* ---- What blows up ---------------------------------------------------------------------------------------------- */

static void judge_blow_up(const outcome *o) {
    if (o->status == 0) complain("%s: exit status %d: %s", trouble, o->status, o->err);
    judge_folder(in_folder("out"), in_folder("good"));
}

/* It ends badly in any case; and whatever fails besides, nothing comes to stand under a final name. */
static void a_blow_up_fails_as_it_should(void **state) {
    (void)state;
    const char *const arguments[] = {
        "run",
        tiny_scene(),
        "--out",
        place_of("out"),
        "--frames",
        "400",
        "--no-progress",
        "--set",
        "method={\"type\":\"symplectic_euler\",\"substeps\":1}",
        "--set",
        "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}",
        NULL};
    assert_int_equal(mkdir(in_folder("good"), 0777), 0);
    const way w = {clear, judge_blow_up, arguments};
    fails_anyway = true;
    fail_in_turn(&w, "once", stride);
    fail_in_turn(&w, "full", 3 * stride);
}

/* ---- Threads ----------------------------------------------------------------------------------------------------- */

static void judge_hash(const outcome *o) { // fewer threads come to the same
    if (o->status || !strstr(o->out, hash_text)) complain("%s: another hash: %s", trouble, o->out);
}

static void threads_that_are_not_to_be_had_are_done_without(void **state) {
    (void)state;
    const char *const arguments[] = {
        "run", tiny_scene(), "--frames", "300", "--threads", "4", "--set", "bodies.0.grid=[40,40]", "--quiet", NULL};
    const char *loud[COUNT(arguments)];
    memcpy(loud, arguments, sizeof arguments);
    loud[COUNT(loud) - 2] = "--no-progress";
    outcome o = finish_skein(start_skein((surroundings){.fail = "count"}, loud));
    assert_status(o, 0);
    char hash[40], line[600];
    snprintf(hash, sizeof hash, "%.27s", strstr(o.out, "state hash"));
    outcome_free(&o);
    hash_text = hash;
    char *log = read_text(in_folder(".calls"));
    assert_contains(log, " pthread_create "); // otherwise nothing is tested here
    free(log);
    assert_true(read_calls(-1, line) < 20);
    const way w = {nothing_to_lay, judge_hash, loud};
    fail_in_turn_from(&w, "once", 1, " pthread_create ");
}

#ifdef SKEIN_TRY_FILMS
/* ---- Pictures and films ---------------------------------------------------------------------------------- */

static const char *picture; // what is made

static void clear_picture(void) {
    unlink(picture);
}

static void judge_picture(const outcome *o) {
    if (o->status != 0 && exists(picture)) complain("%s: %s is there", trouble, picture);
    if (o->status == 0 && !exists(picture)) complain("%s: %s is not there", trouble, picture);
}

static void a_film_fails_as_it_should(void **state) {
    (void)state;
    static const char *const names[] = {"a.png", "a.gif", "a.mp4", "a.webm"};
    const char *s = tiny_scene();
    for (size_t i = 0; i < COUNT(names); i++) {
        picture = place_of(names[i]);
        const char *const arguments[] = {"render", s,        "-o",    picture,   "--frames",
                                         "3",      "--size", "64x64", "--quiet", NULL};
        const way w = {clear_picture, judge_picture, arguments};
        fail_in_turn(&w, "once", 1);
        fail_in_turn(&w, "full", 3);
    }
}

/* A run with a film and a picture besides. */
static void judge_run_with_film(const outcome *o) {
    int whole = judge_folder(place_of("out"), place_of("good"));
    if (o->status == 0 && whole != 2) complain("%s: %d files", trouble, whole);
}

static void a_run_with_a_film_fails_as_it_should(void **state) {
    (void)state;
    const char *const arguments[] = {
        "run",
        tiny_scene(),
        "--out",
        place_of("out"),
        "--frames",
        "2",
        "--no-progress",
        "--set",
        "output=[{\"type\": \"film\", \"size\": [64, 64]}, {\"type\": \"png\", \"size\": [64, 64]}]",
        NULL};
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(rename(place_of("out"), place_of("good")), 0);
    const way w = {clear, judge_run_with_film, arguments};
    fail_in_turn(&w, "once", 1);
    fail_in_turn(&w, "full", 3);
}

#endif

/* ---- Studies ----------------------------------------------------------------------------------------------------- */

static void judge_study(const outcome *o) {
    judge_folder(place_of("out"), place_of("good"));
    if (exists(place_of("out/compare.csv"))) {
        char *table = read_text(place_of("out/compare.csv"));
        int lines = 0;
        for (const char *at = table; (at = strchr(at, '\n')) != NULL; at++) lines++;
        if (lines != 2) complain("%s: a table of %d lines", trouble, lines);
        free(table);
    } else if (o->status == 0) complain("%s: no table", trouble);
}

static void a_study_fails_as_it_should(void **state) {
    (void)state;
    const char *const arguments[] = {"compare",  tiny_scene(), "--methods", "xpbd",          "--steps", "1e-3",
                                     "--frames", "2",          "--out",     place_of("out"), NULL};
    outcome o = finish_skein(start_skein((surroundings){0}, arguments));
    assert_status(o, 0);
    outcome_free(&o);
    assert_int_equal(rename(place_of("out"), place_of("good")), 0);
    const way w = {clear, judge_study, arguments};
    fail_in_turn_from(&w, "once", stride, "/out"); // a scene that cannot be read again is a run less, in the table
    fail_in_turn_from(&w, "full", 3 * stride, "/out");
}

static int begin(void **state) {
    complaints = 0;
    fails_anyway = false;
    return make_folder(state);
}

int main(void) {
    if (SPARING) { // whose library wants to be the first, and slows each of a thousand runs twentyfold
        printf("not with sanitizers\n");
        return 0;
    }
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, begin, remove_folder)
        TEST(every_format_fails_as_it_should), TEST(snapshots_that_fail_can_be_gone_on_from),
        TEST(going_on_fails_as_it_should),     TEST(recordings_fail_as_they_should),
        TEST(a_blow_up_fails_as_it_should),    TEST(threads_that_are_not_to_be_had_are_done_without),
#ifdef SKEIN_TRY_FILMS
        TEST(a_film_fails_as_it_should),       TEST(a_run_with_a_film_fails_as_it_should),
#endif
        TEST(a_study_fails_as_it_should),
    };
    return cmocka_run_group_tests_name("command failures", tests, NULL, NULL);
}
