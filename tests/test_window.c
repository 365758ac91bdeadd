/* The window as a user has it: each key, the mouse and the panels, on a virtual screen; what they do is looked for in
 * the state that the window tells, or in its pictures. One window serves most of it, as one sitting would. */
#include "window.h"

#include <math.h>

static char method_before[64];

/* A word after " name=" of the line that was heard last. */
static const char *word_of(const char *name, char out[64]) {
    char key[64];
    snprintf(key, sizeof key, " %s=", name);
    const char *at = strstr(screen.line, key);
    assert_non_null(at);
    at += strlen(key);
    snprintf(out, 64, "%.*s", (int)strcspn(at, " "), at);
    return out;
}

static void eye_of(double eye[3]) {
    const char *at = strstr(screen.line, " eye=");
    assert_non_null(at);
    assert_int_equal(sscanf(at, " eye=%lf,%lf,%lf", &eye[0], &eye[1], &eye[2]), 3);
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* A key without a meaning changes nothing, and the state is told after every key. */
static void ask_state(void) {
    press_key("k");
}

/* ---- One sitting ------------------------------------------------------------------------------------ */

static const char hanging[] =
    "{ 'name': 'sheet', 'method': { 'type': 'xpbd', 'substeps': 4 }, 'bodies': [ { 'type': 'cloth',"
    "  'grid': [9, 9], 'size': [1, 1], 'position': [0, 1, 0], 'rotation': [90, 0, 0], 'pins': 'top corners' } ],"
    "  'forces': [ { 'type': 'gravity' }, { 'type': 'drag', 'rate': 2 } ],"
    "  'colliders': [ { 'type': 'plane', 'name': 'ground', 'offset': 0 } ] }";

/* Opens from the gallery, by a click on its card. */
static void opens_from_the_gallery(void **state) {
    double x, y;
    (void)state;
    mkdir(in_folder("scenes"), 0777);
    write_scene(in_folder("scenes/sheet.json"), hanging);
    const char *const arguments[] = {"--size", "640x360", "--scenes", in_folder("scenes"), "--paused", NULL};
    open_window(arguments);
    expect("card 0 drawn sheet");
    place_of("card sheet", &x, &y);
    click(x, y);
    expect("opened particles=81 ");
    assert_non_null(strstr(screen.line, "sheet.json"));
}

static void plays_and_pauses(void **state) {
    (void)state;
    press_key("space");
    assert_true(told("paused") == 0);
    pause_for(0.3);
    press_key("space");
    assert_true(told("paused") == 1);
    double time = told("time"), frame = told("frame");
    assert_true(frame >= 1 && fabs(time - frame / 60) < 1e-6);
    pause_for(0.2);
    ask_state();
    assert_true(told("time") == time);
}

static void steps_goes_back_and_branches(void **state) {
    char first[64], second[64], again[64];
    (void)state;
    press_key("BackSpace");
    assert_true(told("frame") == 0 && told("time") == 0);
    for (int i = 0; i < 3; i++) press_key("period");
    assert_true(told("frame") == 3);
    word_of("hash", first);
    press_key("period");
    word_of("hash", second);
    press_key("comma");
    assert_true(told("frame") == 3);
    assert_string_equal(word_of("hash", again), first);
    press_key("period");
    assert_string_equal(word_of("hash", again), second); // the same bits, from a frame that was kept
}

static void switches_methods_and_colours(void **state) {
    char method[64];
    (void)state;
    word_of("method", method_before);
    press_key("9");
    assert_string_equal(word_of("method", method), "pbd");
    for (int i = 0; i < 3; i++) {
        char key[8];
        snprintf(key, sizeof key, "%d", i + 2);
        press_key(key);
        assert_string_equal(word_of("method", method), skein_kind_at(SKEIN_METHOD, (size_t)i + 1)->name);
    }
    press_key("8");
    assert_string_equal(word_of("method", method), "xpbd");
    double colour = told("colour");
    press_key("r");
    assert_true(told("colour") == colour + 1);
    for (int i = 0; i < 3; i++) press_key("r");
    assert_true(told("colour") == colour);
}

static void drags_a_slider(void **state) {
    double x, y;
    (void)state;
    place_of("method.0.substeps", &x, &y);
    listen_from_here();
    drag(x - 40, y, x, y, 1);
    expect("set method 0 substeps=");
    double set = strtod(strrchr(screen.line, '=') + 1, NULL);
    assert_true(set > 4 && set <= 100);
}

/* ---- The camera ---------------------------------------------------------------------------------------- */

static void orbits_pans_and_zooms(void **state) {
    double before[3], after[3], target[3], moved[3];
    (void)state;
    press_key("BackSpace");
    eye_of(before);
    assert_int_equal(sscanf(strstr(screen.line, " target="), " target=%lf,%lf,%lf", &target[0], &target[1], &target[2]),
                     3);
    listen_from_here();
    drag(600, 300, 560, 320, 3);
    expect("camera ");
    assert_int_equal(sscanf(screen.line, "camera %lf %lf %lf", &after[0], &after[1], &after[2]), 3);
    assert_true(distance(before, after) > 0.1);
    assert_true(fabs(distance(before, target) - distance(after, target)) < 1e-3); // around the target
    tool("mousemove 560 320 sleep 0.1 click 4");
    pause_for(0.1);
    ask_state();
    eye_of(moved);
    assert_true(distance(moved, target) < 0.9 * distance(after, target));
    listen_from_here();
    drag(600, 300, 560, 320, 2);
    expect("camera ");
    assert_int_equal(sscanf(screen.line, "camera %lf %lf %lf", &after[0], &after[1], &after[2]), 3);
    assert_true(distance(moved, after) > 0.01);
}

/* W, A, S, D, Q and E move it, as long as they are down; C begins and ends a flight. */
static void moves_by_keys_and_flies(void **state) {
    static const char *const keys[] = {"w", "s", "a", "d", "q", "e"};
    double before[3], after[3], flown[3];
    (void)state;
    ask_state();
    for (size_t k = 0; k < COUNT(keys); k++) {
        char words[64];
        eye_of(before);
        snprintf(words, sizeof words, "keydown %s sleep 0.15 keyup %s sleep 0.05", keys[k], keys[k]);
        tool(words);
        ask_state();
        eye_of(after);
        if (distance(before, after) < 1e-3) fail_msg("key %s moves nothing", keys[k]);
    }
    eye_of(before);
    press_key("c");
    assert_true(told("flying") == 1);
    drag(600, 300, 570, 310, 1); // looks around: the eye stays
    ask_state();
    eye_of(after);
    assert_true(distance(before, after) < 1e-4);
    tool("keydown w sleep 0.15 keyup w sleep 0.05");
    ask_state();
    eye_of(flown);
    assert_true(distance(after, flown) > 1e-3);
    press_key("c");
    assert_true(told("flying") == 0);
    eye_of(after);
    assert_true(distance(before, after) < 1e-4); // the first view
}

/* ---- Files ---------------------------------------------------------------------------------------------- */

static void saves_pictures_and_meshes(void **state) {
    io_mesh mesh;
    (void)state;
    listen_from_here();
    tool("key x");
    expect("note saved sheet-001.png");
    assert_true(exists(in_folder("sheet-001.png")));
    tool("key o");
    expect("note saved sheet-001.obj: 81 vertices, 64 faces");
    assert_int_equal(io_mesh_read(in_folder("sheet-001.obj"), &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    assert_int_equal(mesh.vertex_count, 81);
    assert_int_equal(mesh.face_count, 64);
    io_mesh_free(&mesh);
}

/* With Ctrl and Q, as a user would; no driver had a word to say. */
static void closes_cleanly(void **state) {
    (void)state;
    listen_from_here();
    tool("key ctrl+q");
    expect("opengl stage errors=0 warnings=0");
    expect("opengl window errors=0 warnings=0");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

/* ---- Without a window ------------------------------------------------------------------------------------ */

static void says_what_to_do_without_a_display(void **state) {
    (void)state;
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    outcome said = SKEIN("view", "scenes/flag.json");
    if (screen.display[0]) setenv("DISPLAY", screen.display, 1);
    assert_status(said, 1);
    assert_contains(said.err, "there is no display");
    assert_contains(said.err, "skein render");
    outcome_free(&said);
}

static void refuses_bad_arguments(void **state) {
    (void)state;
    assert_says(2, "", "skein view: --size 12: expected two whole numbers from 64 to 16384, as in 1280x720\n", "view",
                "--size", "12");
    assert_says(2, "", "skein view: --unfocused often: expected scene, pause or play\n", "view", "--unfocused",
                "often");
    assert_says(2, "", "skein view: --scale big: expected a number from 0.5 to 8\n", "view", "--scale", "big");
    outcome help = SKEIN("view", "--help");
    assert_status(help, 0);
    assert_contains(help.out, "Backspace    puts the scene back to its start");
    outcome_free(&help);
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    open_screen();
    return 0;
}

static int end(void **state) {
    end_process(&screen.skein, SIGKILL);
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

int main(void) {
    const struct CMUnitTest alone[] = {
        cmocka_unit_test(says_what_to_do_without_a_display),
        cmocka_unit_test(refuses_bad_arguments),
    };
    const struct CMUnitTest sitting[] = {
        cmocka_unit_test(opens_from_the_gallery),
        cmocka_unit_test(plays_and_pauses),
        cmocka_unit_test(steps_goes_back_and_branches),
        cmocka_unit_test(switches_methods_and_colours),
        cmocka_unit_test(drags_a_slider),
        cmocka_unit_test(orbits_pans_and_zooms),
        cmocka_unit_test(moves_by_keys_and_flies),
        cmocka_unit_test(saves_pictures_and_meshes),
        cmocka_unit_test(closes_cleanly),
    };
    int failed = cmocka_run_group_tests(alone, make_folder, remove_folder);
    if (!can_open_screen()) return failed;
    return failed + cmocka_run_group_tests(sitting, begin, end);
}
