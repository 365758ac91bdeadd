/* What is done in the window is recorded, and `skein verify` does it again: pulls, pins, fields, methods, steps back and
 * forth; where the scene is built anew the next part begins; a world beside the first has its own. */
#define SCREEN_SIZE "720x1500"
#include "window.h"

static const char cube[] =
    "{ 'name': 'cube', 'method': { 'type': 'xpbd', 'substeps': 3 }, 'bodies': [ { 'type': 'lattice', 'grid': [16, 16, 2],"
    "  'size': [2, 2, 0.2], 'position': [0, 2, 0] }, { 'type': 'flock', 'count': 8, 'name': 'f', 'position': [0, 3.2, 0], 'spread': [1, 0.1, 0.1] } ],"
    "  'forces': [ { 'type': 'gravity' }, { 'type': 'flocking', 'on': 'f' } ],"
    "  'colliders': [ { 'type': 'plane', 'offset': 0 } ] }";

/* Waits until the panels are laid out: nobody says anything any more. */
static void settle(void) {
    struct stat info;
    long size = -1;
    for (int turn = 0; turn < 20; turn++) {
        if (!stat(screen.events, &info) && (long)info.st_size == size) return;
        size = (long)info.st_size;
        pause_for(0.3);
    }
}

static void open_cube(const char *const *more) {
    const char *arguments[20] = {
        in_folder("cube.json"), "--size", "700x1500", "--scale", "1", "--samples", "1", "--paused"};
    for (size_t i = 0; more[i]; i++) arguments[8 + i] = more[i];
    write_scene(in_folder("cube.json"), cube);
    open_window(arguments);
    screen.seen = 0;
    expect("recording ");
}

static void close_window(void) {
    settle();
    listen_from_here();
    tool("key ctrl+q");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

static void hash_now(char hash[32]) {
    const char *at = strstr(screen.line, " hash=");
    assert_non_null(at);
    snprintf(hash, 32, "%.16s", at + 6);
}

/* `skein verify` says that so many steps are the same, and ends with this hash. */
static void verifies(const char *name, int steps, const char *hash) {
    char words[80];
    outcome o = SKEIN("verify", in_folder(name), "--threads", "2");
    assert_status(o, 0);
    snprintf(words, sizeof words, "%d steps, the same to the bit; state hash %s%s", steps, hash, hash[0] ? "\n" : "");
    assert_contains(o.out, words);
    outcome_free(&o);
}

/* Where a press finds a particle: the picture is looked through. */
static void take_particle(void) {
    char words[100];
    // from the middle outwards, where bodies are
    for (int ring = 0; ring < 12; ring++)
        for (int part = 0; part < 8; part++) {
            static const int ways[8][2] = {{0, 1}, {1, 1}, {-1, 1}, {1, 0}, {-1, 0}, {0, -1}, {1, -1}, {-1, -1}};
            int x = 475 + 16 * ring * ways[part][0], y = 750 + 30 * ring * ways[part][1];
            int picked = -1;
            listen_from_here();
            snprintf(words, sizeof words, "mousemove %d %d sleep 0.05 mousedown 1", x, y);
            tool(words);
            expect("picked ");
            sscanf(screen.line, "picked %d", &picked);
            if (picked >= 0 && picked < 512) return; // no bird
            tool("mouseup 1");
        }
    fail_msg("there is no particle in the picture");
}

/* One sitting with all that can be done to a world in place; the recording that was asked for ends by J. */
static void all_that_is_done_is_done_again(void **state) {
    char hash[32], words[100];
    (void)state;
    open_cube((const char *const[]){"--record", "done.skeinrec", NULL});
    press_key("period");
    press_key("period");
    // a click pins
    take_particle();
    listen_from_here();
    tool("mouseup 1");
    expect("note pinned particle ");
    press_key("period");
    // pulled while it plays
    press_key("space");
    take_particle();
    tool("mousemove_relative -- 30 -20 sleep 0.05 mousemove_relative -- 30 -20");
    press_key("i");
    double begun = told("frame");
    do press_key("i");
    while (told("frame") < begun + 8);
    listen_from_here();
    tool("mouseup 1");
    expect("released ");
    press_key("space");
    // a field, a method, and a pull while nothing steps
    press_key("Up");
    press_key("period");
    press_key("ctrl+z");
    press_key("4");
    press_key("period");
    take_particle();
    tool("mousemove_relative -- -20 -20 sleep 0.05 mousemove_relative -- -20 -20");
    listen_from_here();
    tool("mouseup 1");
    expect("released ");
    // back and forth
    press_key("period");
    press_key("comma");
    press_key("comma");
    press_key("period");
    press_key("BackSpace");
    press_key("period");
    press_key("period");
    listen_from_here();
    tool("key j");
    expect("recorded done.skeinrec steps=");
    int steps = (int)told("steps");
    assert_true(steps >= 17);
    expect("state ");
    hash_now(hash);
    verifies("done.skeinrec", steps, hash);

    // by the key it takes a name of its own; what is built anew is another part
    listen_from_here();
    tool("key j");
    expect("recording cube-001.skeinrec");
    press_key("period");
    press_key("period");
    hash_now(hash);
    listen_from_here();
    tool("key F5");
    expect("recorded cube-001.skeinrec steps=2");
    expect("recording cube-001-2.skeinrec");
    verifies("cube-001.skeinrec", 2, hash);
    for (int i = 0; i < 3; i++) press_key("period");
    hash_now(hash);
    listen_from_here();
    tool("key F5");
    expect("recorded cube-001-2.skeinrec steps=3");
    expect("recording cube-001-3.skeinrec");
    verifies("cube-001-2.skeinrec", 3, hash);
    press_key("period");
    hash_now(hash);
    // what follows without a step is no part
    for (int i = 0; i < 2; i++) {
        listen_from_here();
        tool("key F5");
        expect("recording cube-001-4.skeinrec");
    }
    verifies("cube-001-3.skeinrec", 1, hash);
    press_key("period");
    hash_now(hash);
    close_window(); // which ends it
    verifies("cube-001-4.skeinrec", 1, hash);
    snprintf(words, sizeof words, "%s", in_folder("cube-001-5.skeinrec"));
    assert_false(exists(words));
}

/* Two worlds are two files. */
static void each_of_two_worlds_has_its_own(void **state) {
    char hash[32];
    (void)state;
    open_cube((const char *const[]){"--record", "two.skeinrec", "--compare", "method.substeps=7", NULL});
    expect("recording two-other.skeinrec");
    for (int i = 0; i < 3; i++) press_key("period");
    hash_now(hash);
    close_window();
    verifies("two.skeinrec", 3, hash);
    verifies("two-other.skeinrec", 3, "");
    outcome one = SKEIN("verify", in_folder("two.skeinrec")), other = SKEIN("verify", in_folder("two-other.skeinrec"));
    assert_string_not_equal(strstr(one.out, "hash"), strstr(other.out, "hash"));
    outcome_free(&one);
    outcome_free(&other);
}

/* Killed, the window leaves what was written by then; a disk that is full is told, and the window goes on. */
static void what_was_written_is_there(void **state) {
    char name[64];
    (void)state;
    open_cube((const char *const[]){"--record", "killed.skeinrec", NULL});
    press_key("period");
    pause_for(0.4);
    press_key("period");
    press_key("period");
    snprintf(name, sizeof name, "killed.skeinrec.%d.part", (int)screen.skein);
    end_process(&screen.skein, SIGKILL);
    outcome o = SKEIN("verify", in_folder(name));
    assert_status(o, 0);
    assert_contains(o.out, "the same to the bit");
    assert_contains(o.out, "the recording breaks off there");
    outcome_free(&o);
    assert_int_equal(symlink("/dev/full", in_folder("full")), 0);
    write_scene(in_folder("cube.json"), cube);
    const char *const arguments[] = {in_folder("cube.json"), "--size", "700x500", "--paused", "--record", "full", NULL};
    open_window(arguments);
    for (int i = 0; i < 3; i++) {
        press_key("period");
        pause_for(0.3);
    }
    assert_true(told("frame") == 3);
    screen.seen = 0;
    expect("warning ");
    assert_contains(screen.line, "nothing is recorded any more");
    press_key("period");
    assert_true(told("frame") == 4);
    close_window();
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    setenv("XDG_CONFIG_HOME", in_folder("settings"), 1);
    open_screen();
    return 0;
}

/* A sitting that failed leaves no window to the next. */
static int leave(void **state) {
    (void)state;
    drop_hands();
    end_process(&screen.skein, SIGKILL);
    return 0;
}

static int end(void **state) {
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

int main(void) {
    const struct CMUnitTest sitting[] = {
        cmocka_unit_test_teardown(all_that_is_done_is_done_again, leave),
        cmocka_unit_test_teardown(each_of_two_worlds_has_its_own, leave),
        cmocka_unit_test_teardown(what_was_written_is_there, leave),
    };
    if (!can_open_screen()) return 0;
    return cmocka_run_group_tests(sitting, begin, end);
}
