/* The window as a user has it: each key, the mouse and the panels, on a virtual screen; what they do is looked for in
 * the state that the window tells, or in its pictures. One window serves most of it, as one sitting would. */
#include "window.h"

#include <math.h>

#include "render/camera.h"
#include "render/linear.h"
#include "render/view.h"

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
    press_key("i");
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
    for (int i = 0; i < 9; i++) {
        char key[16];
        snprintf(key, sizeof key, "%d", i + 1);
        press_key(key);
        assert_string_equal(word_of("method", method), skein_kind_at(SKEIN_METHOD, (size_t)i)->name);
    }
    press_key("8");
    assert_string_equal(word_of("method", method), "xpbd");
    // one cloth: its body tells nothing, nor where it flies
    static const double colours[] = {RENDER_BY_SPEED, RENDER_BY_STRAIN, RENDER_BY_MATERIAL};
    for (size_t i = 0; i < COUNT(colours); i++) {
        press_key("r");
        assert_true(told("colour") == colours[i]);
    }
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
    static const char *const keys[] = {"w", "s", "a", "d", "q", "e", "Prior", "Next"};
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

/* 0 is the first view, wherever one has gone; F brings all bodies into the picture; T goes along with them. */
static void frames_returns_and_follows(void **state) {
    double first[3], far[3], framed[3], home[3], before[3], after[3];
    (void)state;
    press_key("BackSpace");
    press_key("0");
    ask_state();
    eye_of(first);
    for (int i = 0; i < 12; i++) tool("mousemove 560 320 sleep 0.05 click 5"); // the wheel, away
    pause_for(0.1);
    ask_state();
    eye_of(far);
    assert_true(distance(first, far) > 2);
    press_key("f");
    ask_state();
    eye_of(framed);
    assert_true(distance(first, framed) < 0.5 * distance(first, far));
    press_key("0");
    ask_state();
    eye_of(home);
    assert_true(distance(first, home) < 1e-4);

    press_key("t");
    ask_state();
    eye_of(before);
    for (int i = 0; i < 12; i++) press_key("period");
    ask_state();
    eye_of(after);
    if (!(distance(before, after) > 2e-5)) fail_msg("it goes by %g", distance(before, after)); // the sheet sags
    press_key("t");
    ask_state();
    eye_of(before);
    press_key("period");
    ask_state();
    eye_of(after);
    assert_true(distance(before, after) < 1e-6);
    press_key("BackSpace");
}

/* ---- The hand ------------------------------------------------------------------------------------------- */

/* Where the picture begins, beside the panel. */
static double left = 230;

/* Where the first camera of the state that was heard last shows a point. */
static void pixel_of(const double point[3], double *x, double *y) {
    render_camera lens = {.up = {0, 1, 0}, .fov = render_view_default().camera.fov};
    double right[3], up[3], back[3], off[3], tall = tan(0.5 * lens.fov * 0.017453292519943295);
    eye_of(lens.eye);
    assert_int_equal(sscanf(strstr(screen.line, " target="), " target=%lf,%lf,%lf", &lens.target[0], &lens.target[1],
                            &lens.target[2]),
                     3);
    render_camera_axes(&lens, right, up, back);
    for (int k = 0; k < 3; k++) off[k] = point[k] - lens.eye[k];
    double depth = -render_dot(off, back);
    *x = left + 0.5 * (640 - left) + 180 * render_dot(off, right) / depth / tall;
    *y = 180 - 180 * render_dot(off, up) / depth / tall;
}

/* The sheet's lower corner on the right, in the picture of its start. */
static uint32_t find_corner(double *x, double *y) {
    skein_world *world = skein_world_create(NULL, NULL);
    uint32_t corner = 0;
    assert_int_equal(skein_body_add(world, "cloth", NULL,
                                    SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9), SKEIN_PAIR("size", 1, 1),
                                                   SKEIN_VEC3("position", 0, 1, 0), SKEIN_VEC3("rotation", 90, 0, 0),
                                                   SKEIN_TEXT("pins", "top corners")),
                                    NULL),
                     SKEIN_OK);
    *x = *y = 0;
    for (uint32_t i = 0; i < skein_particle_count(world); i++) {
        double at[3], px, py;
        skein_positions_copy(world, i, 1, at);
        pixel_of(at, &px, &py);
        if (px + py > *x + *y) *x = px, *y = py, corner = i;
    }
    skein_world_destroy(world);
    return corner;
}

/* The corner goes where the pointer takes it, while the world plays; let go, it is a free particle again. */
static void pulls_a_corner(void **state) {
    char words[256];
    double x, y, at[3], last[3];
    uint32_t corner, picked;
    (void)state;
    listen_from_here();
    tool("key ctrl+r"); // back to the file: all that was changed is as it was
    expect("reopened ");
    press_key("BackSpace");
    corner = find_corner(&x, &y);
    x -= 2, y -= 2; // well inside the sheet
    press_key("space");
    listen_from_here();
    snprintf(words, sizeof words, "mousemove %.0f %.0f sleep 0.1 mousedown 1 sleep 0.1", x, y);
    tool(words);
    expect("picked ");
    assert_int_equal(sscanf(screen.line, "picked %u", &picked), 1);
    assert_int_equal(picked, corner);
    snprintf(words, sizeof words, "mousemove %.0f %.0f sleep 0.05 mousemove %.0f %.0f", x + 20, y - 20, x + 70, y - 60);
    tool(words);
    ask_state();
    double begun = told("frame");
    do ask_state();
    while (told("frame") < begun + 30);
    tool("mouseup 1");
    expect("released ");
    assert_int_equal(sscanf(screen.line, "released %u at %lf %lf %lf", &picked, &at[0], &at[1], &at[2]), 4);
    ask_state();
    double px, py;
    pixel_of(at, &px, &py);
    if (hypot(px - x - 70, py - y + 60) > 12) fail_msg("it is at %.0f %.0f, not at %.0f %.0f", px, py, x + 70, y - 60);
    press_key("space");
    // free again: a press on it does not find it where it was let go
    begun = told("frame");
    for (int i = 0; i < 20; i++) press_key("period");
    listen_from_here();
    snprintf(words, sizeof words, "mousemove %.0f %.0f sleep 0.1 mousedown 1 sleep 0.1 mouseup 1", px, py);
    tool(words);
    expect("picked ");
    assert_int_equal(sscanf(screen.line, "picked %lf", &last[0]), 1);
    assert_true(last[0] != corner);
    press_key("BackSpace");
}

static void pins_and_frees(void **state) {
    char words[64];
    double x, y;
    (void)state;
    ask_state();
    uint32_t corner = find_corner(&x, &y);
    listen_from_here();
    click(x - 2, y - 2);
    snprintf(words, sizeof words, "note pinned particle %u", corner);
    expect(words);
    ask_state();
    char hash[64], other[64];
    for (int i = 0; i < 5; i++) press_key("period");
    word_of("hash", hash);
    press_key("BackSpace"); // takes such pins off
    for (int i = 0; i < 5; i++) press_key("period");
    assert_string_not_equal(word_of("hash", other), hash);
    press_key("BackSpace");
    listen_from_here();
    click(x - 2, y - 2);
    expect("note pinned");
    click(x - 2, y - 2);
    snprintf(words, sizeof words, "note freed particle %u", corner);
    expect(words);
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

/* V begins and ends a film: one picture of every frame. */
static void records_a_film(void **state) {
    (void)state;
    press_key("BackSpace");
    listen_from_here();
    tool("key v");
    expect("note records sheet-001.mp4");
    for (int i = 0; i < 3; i++) press_key("period");
    listen_from_here();
    tool("key v");
    expect("note saved sheet-001.mp4: 4 pictures");
    struct stat info;
    assert_int_equal(stat(in_folder("sheet-001.mp4"), &info), 0);
    assert_true(info.st_size > 1000);
}

/* ---- What comes from outside ------------------------------------------------------------------------------ */

/* An editor's change is seen; a broken file leaves the last good scene. */
static void reads_a_changed_file_again(void **state) {
    (void)state;
    listen_from_here();
    char *changed = strdup(hanging);
    memcpy(strstr(changed, "[9, 9]"), "[7, 9]", 6);
    write_scene(in_folder("scenes/sheet.json"), changed);
    free(changed);
    expect("reopened particles=63 ");
    write_text(in_folder("scenes/sheet.json"), "{ \"bodies\": [");
    expect("warning ");
    expect("kept path=");
    press_key("period");
    assert_true(told("frame") == 1); // and it still goes on
    listen_from_here();
    write_scene(in_folder("scenes/sheet.json"), hanging);
    expect("reopened particles=81 ");
}

static void takes_a_dropped_mesh(void **state) {
    (void)state;
    write_text(in_folder("shirt.obj"), "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 2 0 0\nv 2 0 1\nf 1 4 3 2\nf 2 3 6 5\n");
    listen_from_here();
    drop_file(in_folder("shirt.obj"));
    expect("dropped ");
    expect("opened particles=6 bodies=1 ");
    press_key("period");
    assert_true(told("frame") == 1);
    listen_from_here();
    drop_file(in_folder("scenes/sheet.json"));
    expect("opened particles=81 ");
}

static void changes_its_size(void **state) {
    char words[64];
    render_image image = {0};
    (void)state;
    // a fault has opened the log, which takes its room from the picture
    listen_from_here();
    snprintf(words, sizeof words, "windowsize %s 500 410", screen.window);
    tool(words);
    expect("size 270 230"); // beside the panel, above the log
    tool("key F4");
    expect("panel 4 closed");
    expect("size 270 410");
    tool("key x");
    expect("note saved sheet-002.png");
    assert_int_equal(render_image_read(&image, in_folder("sheet-002.png"), NULL), SKEIN_OK);
    assert_int_equal(image.width, 270);
    assert_int_equal(image.height, 410);
    render_image_release(&image);
}

/* Panels open and close by their keys; F1's list is the table that the handler uses. */
static void opens_panels_by_keys(void **state) {
    static const char *const keys[] = {"F1", "F2", "F3", "F4", "Tab"};
    (void)state;
    for (size_t k = 0; k < COUNT(keys); k++) {
        char words[32];
        snprintf(words, sizeof words, "key %s", keys[k]);
        bool opened = false;
        for (int turn = 0; turn < 2; turn++) {
            listen_from_here();
            tool(words);
            expect("panel ");
            bool opens = strstr(screen.line, "open") != NULL;
            assert_true(turn == 0 || opens != opened);
            opened = opens;
        }
    }
}

/* F7 changes the theme, and the next window opens with it; --theme has the last word. */
static void keeps_its_theme(void **state) {
    (void)state;
    for (int turn = 0; turn < 2; turn++) {
        const char *const word = turn ? "dark" : "light";
        char said[32], kept[16] = "";
        listen_from_here();
        tool("key F7");
        snprintf(said, sizeof said, "note %s", word);
        expect(said);
        assert_string_equal(screen.line, said);
        FILE *file = fopen(in_folder("settings/skein/theme"), "r");
        assert_non_null(file);
        assert_non_null(fgets(kept, sizeof kept, file));
        fclose(file);
        assert_true(!strncmp(kept, word, strlen(word)));
    }
}

/* By the button of a window manager, as a user would; no driver had a word to say. */
static void closes_cleanly(void **state) {
    (void)state;
    listen_from_here();
    ask_to_close();
    expect("opengl stage errors=0 warnings=0");
    expect("opengl window errors=0 warnings=0");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

/* ---- Windows of their own ------------------------------------------------------------------------------- */

static void close_window(void) {
    listen_from_here();
    tool("key ctrl+q");
    expect("opengl stage errors=0 warnings=0");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

/* The picture, and the window itself, are what skein render draws, to 1 % of the pixels: where the camera frames the
 * scene by itself, and later from a place of its own. */
static void agree(const char *const *sets, int frame, const char *numbered) {
    const char *arguments[16] = {SKEIN_SOURCE_DIR "/scenes/drape.json", "--size", "640x360", "--paused", "--no-panels"};
    const char *render[16] = {"render", "scenes/drape.json",  "--size", "640x360", "--no-progress",
                              "-o",     in_folder("off.png"), "--frame"};
    char number[16], name[64];
    size_t count = 5, render_count = 8;
    snprintf(number, sizeof number, "%d", frame);
    render[render_count++] = number;
    for (; *sets; sets++) {
        arguments[count++] = render[render_count++] = "--set";
        arguments[count++] = render[render_count++] = *sets;
    }
    open_window(arguments);
    expect("opened ");
    for (int i = 0; i < frame; i++) press_key("period");
    listen_from_here();
    tool("key x");
    snprintf(name, sizeof name, "note saved drape-%s.png", numbered);
    expect(name);
    pause_for(0.3); // until the window shows it, too
    tool("key shift+x");
    snprintf(name, sizeof name, "note saved skein-%s.png", numbered);
    expect(name);
    close_window();
    outcome said = finish_skein(start_skein((surroundings){0}, render));
    assert_status(said, 0);
    outcome_free(&said);
    snprintf(name, sizeof name, "drape-%s.png", numbered);
    double picture = difference(in_folder("off.png"), in_folder(name));
    snprintf(name, sizeof name, "skein-%s.png", numbered);
    double shown = difference(in_folder("off.png"), in_folder(name));
    if (picture >= 0.01 || shown >= 0.01) fail_msg("frame %d: differences of %g and %g", frame, picture, shown);
}

static void pictures_agree_with_the_offscreen_path(void **state) {
    const char *const none[] = {NULL}, *const placed[] = {"view.camera.from=[1.5,1.2,2.5]", "view.camera.at=[0,0.7,0]",
                                                          "view.colour=speed", NULL};
    (void)state;
    agree(none, 0, "001");
    agree(placed, 4, "002");
    assert_true(difference(in_folder("drape-001.png"), in_folder("drape-002.png")) > 0.1); // what differs is seen
}

static const char one_spring[] =
    "{ 'name': 'spring', 'advance': 'key', 'bodies': [ { 'type': 'rope', 'from': [0, 1, 0], 'to': [1, 1, 0],"
    "  'count': 2, 'pins': 'first' } ], 'view': { 'particles': 'all', 'particle_radius': 0.05 } }";

/* A scene that advances by keys: Enter and keys without a meaning solve once; the ends can be dragged. */
static void solves_by_keys(void **state) {
    double a[3], b[3], length, value, lifted = 0, d[6];
    (void)state;
    write_scene(in_folder("spring.json"), one_spring);
    const char *const arguments[] = {in_folder("spring.json"), "--size", "640x360", "--no-panels", NULL};
    open_window(arguments);
    expect("opened particles=2 ");
    ask_state();
    double x, y;
    left = 0;
    pixel_of((const double[]){1, 1, 0}, &x, &y);
    listen_from_here();
    drag(x, y, x - 40, y - 60, 1);
    expect("released 1 ");
    tool("key Return");
    for (int turn = 0; turn < 2; turn++) {
        if (turn) tool("key m");
        expect("log solve ");
        const char *said = strstr(screen.line, "stretch before: C ");
        assert_non_null(said);
        int count = sscanf(
            said, "stretch before: C %lf; derivatives %lf %lf %lf %lf %lf %lf; at (%lf, %lf, %lf) (%lf, %lf, %lf)",
            &value, &d[0], &d[1], &d[2], &d[3], &d[4], &d[5], &a[0], &a[1], &a[2], &b[0], &b[1], &b[2]);
        assert_int_equal(count, 13);
        length = distance(a, b);
        assert_true(fabs(value - (length - 1)) < 1e-4);
        for (int k = 0; k < 3; k++) {
            assert_true(fabs(d[k] - (a[k] - b[k]) / length) < 1e-3);
            assert_true(d[k + 3] == -d[k]);
        }
        if (!turn) lifted = b[1];
        expect("note solve ");
    }
    assert_true(lifted > 1.01); // the drag has lifted it
    close_window();
    char *said = read_text(in_folder("words"));
    assert_contains(said, "derivatives");
    free(said);
}

/* ---- Changes -------------------------------------------------------------------------------------------- */

static const char cube[] =
    "{ 'name': 'cube', 'method': { 'type': 'xpbd', 'substeps': 3 }, 'bodies': [ { 'type': 'lattice', 'grid': [4, 4, 4],"
    "  'size': [1, 1, 1], 'position': [0, 2, 0] } ], 'forces': [ { 'type': 'gravity' } ],"
    "  'colliders': [ { 'type': 'plane', 'offset': 0 } ] }";

/* Drags a control to the right, and keeps what the window says that it has set: "set body 0 size=1 1 2". */
static void change(const char *control, const char *said, char out[sizeof screen.line]) {
    double x, y;
    place_of(control, &x, &y);
    listen_from_here();
    drag(x - 60, y, x - 30, y, 1);
    expect(said);
    memcpy(out, screen.line, sizeof screen.line);
}

/* The hash after some frames from the start. */
static void hash_after(int frames, char hash[64]) {
    press_key("BackSpace");
    for (int i = 0; i < frames; i++) press_key("period");
    word_of("hash", hash);
}

/* A vector of a body can be changed; what was tuned stays when the body is built anew, can be undone and done again, and
 * saved: the file opens to the same bits. */
static void keeps_what_was_changed(void **state) {
    char set[sizeof screen.line], first[64], stiff[64], sized[64], tuned[64], again[64];
    (void)state;
    write_scene(in_folder("cube.json"), cube);
    const char *const arguments[] = {in_folder("cube.json"), "--size", "1000x740", "--samples", "1", "--paused", NULL};
    open_window(arguments);
    expect("opened particles=64 ");
    hash_after(4, first);
    change("body.0.structural.stiffness", "set body 0 structural.stiffness=", set);
    hash_after(4, stiff);
    assert_string_not_equal(first, stiff);
    change("body.0.size", "set body 0 size=", set);
    double size[3], mass;
    assert_int_equal(sscanf(strchr(set, '=') + 1, "%lf %lf %lf", &size[0], &size[1], &size[2]), 3);
    assert_true(size[0] != 1 || size[1] != 1 || size[2] != 1);
    hash_after(4, sized);
    change("body.0.mass", "set body 0 mass=", set);
    mass = strtod(strchr(set, '=') + 1, NULL);
    assert_true(mass != 10);
    press_key("5"); // another method
    press_key("r"); // other colours
    hash_after(4, tuned);

    // saved: the file says all of it
    press_key("BackSpace");
    listen_from_here();
    tool("key ctrl+s");
    expect("note saved cube-001.json");
    char *text = read_text(in_folder("cube-001.json"));
    assert_contains(text, "leapfrog");
    assert_contains(text, "\"colour\": \"speed\"");
    assert_contains(text, "structural");
    free(text);

    // back and forth: colours, method, mass
    for (int i = 0; i < 3; i++) press_key("ctrl+z");
    hash_after(4, again);
    assert_string_equal(again, sized);
    press_key("ctrl+z");
    hash_after(4, again);
    assert_string_equal(again, stiff);
    press_key("ctrl+z");
    hash_after(4, again);
    assert_string_equal(again, first);
    press_key("ctrl+z");
    assert_true(told("frame") == 4); // there was nothing to undo
    for (int i = 0; i < 5; i++) press_key("ctrl+y");
    hash_after(4, again);
    assert_string_equal(again, tuned);
    press_key("ctrl+r");
    hash_after(4, again);
    assert_string_equal(again, first);
    close_window();

    const char *const saved[] = {in_folder("cube-001.json"), "--size", "640x360", "--samples", "1", "--paused", NULL};
    open_window(saved);
    expect("opened particles=64 ");
    hash_after(4, again);
    assert_string_equal(again, tuned);
    close_window();
}

/* The pointer leads a particle also where nothing has a velocity, and the constraint comes back to its length. */
static void leads_where_nothing_has_a_velocity(void **state) {
    double x, y, at[3];
    int picked;
    char words[256];
    (void)state;
    const char *const arguments[] = {
        SKEIN_SOURCE_DIR "/scenes/one_spring_live.json", "--size", "640x360", "--no-panels", "--samples", "1", NULL};
    open_window(arguments);
    expect("opened particles=2 ");
    ask_state();
    press_key("space");
    for (int i = 0; i < 3; i++) press_key("period");
    pixel_of((const double[]){2.75, 0, 0}, &x, &y);
    press_key("space");
    listen_from_here();
    snprintf(words, sizeof words,
             "mousemove %.0f %.0f sleep 0.1 mousedown 1 sleep 0.1 mousemove %.0f %.0f sleep 0.05 "
             "mousemove %.0f %.0f",
             x, y, x + 10, y - 20, x + 20, y - 60);
    tool(words);
    expect("picked ");
    assert_int_equal(sscanf(screen.line, "picked %d", &picked), 1);
    assert_int_equal(picked, 1);
    ask_state();
    double begun = told("frame");
    do ask_state();
    while (told("frame") < begun + 40);
    tool("mouseup 1");
    expect("released 1 at ");
    assert_int_equal(sscanf(screen.line, "released 1 at %lf %lf %lf", &at[0], &at[1], &at[2]), 3);
    assert_true(at[1] > 0.5); // it was led upwards
    close_window();
}

/* A scene with a fault opens as soon as it is mended. */
static void waits_for_a_mended_scene(void **state) {
    (void)state;
    write_text(in_folder("broken.json"), "{ \"bodies\": [ { \"type\": \"clot\" } ] }");
    const char *const arguments[] = {in_folder("broken.json"), "--size", "640x360", "--paused", NULL};
    open_window(arguments);
    expect("warning ");
    assert_contains(screen.line, "bodies.0.type: there is no body 'clot'; did you mean 'cloth'?");
    expect("cannot open ");
    write_scene(in_folder("broken.json"), hanging);
    expect("opened particles=81 ");
    close_window();
}

/* Two worlds, in step; and without the focus they wait, if they are asked to. */
static void compares_and_waits_for_the_focus(void **state) {
    const char *const arguments[] = {in_folder("scenes/sheet.json"),
                                     "--size",
                                     "640x360",
                                     "--unfocused",
                                     "pause",
                                     "--compare",
                                     "method.type=pbd",
                                     NULL};
    (void)state;
    mkdir(in_folder("scenes"), 0777);
    write_scene(in_folder("scenes/sheet.json"), hanging);
    open_window(arguments);
    expect("note side by side");
    ask_state();
    assert_true(told("sides") == 2);
    // each has its name over it, in its half of the picture
    double first[4], second[4], middle = 0.5 * (left + 640);
    assert_true(find_box("label 0 xpbd", 0, first, patience_seconds));
    assert_true(find_box("label 1 method.type=pbd", 0, second, patience_seconds));
    assert_true(first[0] >= left && first[0] + first[2] < middle && second[0] > middle && second[0] + second[2] < 640);
    listen_from_here();
    focus_elsewhere(true);
    expect("paused");
    focus_elsewhere(false);
    expect("plays");
    press_key("space");
    listen_from_here();
    tool("key x");
    expect("note saved sheet-");
    close_window();
}

/* In a flock the arrows, Home and End change its rules, the mouse is the predator, and it waits for the focus. */
static void steers_a_flock(void **state) {
    static const struct {
        const char *key, *field;
        int way;
    } rows[] = {{"Up", "separation", 1},   {"Down", "separation", -1}, {"Right", "alignment", 1},
                {"Left", "alignment", -1}, {"Home", "cohesion", 1},    {"End", "cohesion", -1}};
    const char *const arguments[] = {
        SKEIN_SOURCE_DIR "/scenes/birds.json", "--size", "640x360", "--samples", "1", "--paused", NULL};
    double before = 0, after;
    (void)state;
    open_window(arguments);
    expect("opened ");
    for (size_t r = 0; r < COUNT(rows); r++) {
        char words[64], format[64];
        snprintf(words, sizeof words, "key %s", rows[r].key);
        snprintf(format, sizeof format, "note %s %%lf", rows[r].field);
        for (int turn = 0; turn < 2; turn++) {
            listen_from_here();
            tool(words);
            snprintf(words, sizeof words, "note %s ", rows[r].field);
            expect(words);
            assert_int_equal(sscanf(screen.line, format, &after), 1);
            if (turn == 1) assert_true(rows[r].way * (after - before) > 0);
            before = after;
            snprintf(words, sizeof words, "key %s", rows[r].key);
        }
    }
    // feathers of their own, by direction, by speed, and round again
    static const double colours[] = {RENDER_BY_DIRECTION, RENDER_BY_SPEED, RENDER_BY_MATERIAL};
    for (size_t i = 0; i < COUNT(colours); i++) {
        press_key("r");
        assert_true(told("colour") == colours[i]);
    }
    // a ride on a bird, and back to where the camera was
    double home[3], riding[3], back[3];
    eye_of(home);
    press_key("b");
    press_key("period");
    press_key("x"); // which draws it
    eye_of(riding);
    assert_true(distance(home, riding) > 1);
    press_key("b");
    eye_of(back);
    assert_true(distance(home, back) < 1e-3);
    listen_from_here();
    tool("mousemove 450 180 sleep 0.2 mousemove 460 190");
    expect("hunts");
    tool("mousemove 60 180 sleep 0.2 mousemove 61 180"); // over the panel
    expect("rests");
    press_key("space");
    listen_from_here();
    focus_elsewhere(true);
    expect("paused");
    focus_elsewhere(false);
    expect("plays");
    close_window();
}

static bool with_card; /* a real one */

/* The picture of a flock after some frames, in a file of that name. */
static void shoot_flock(const char *device, const char *name) {
    const char *const arguments[] = {SKEIN_SOURCE_DIR "/scenes/birds.json",
                                     "--size",
                                     "480x270",
                                     "--samples",
                                     "1",
                                     "--paused",
                                     "--no-panels",
                                     "--device",
                                     device,
                                     NULL};
    tool("mousemove 900 700"); // a pointer in the picture would hunt them
    open_window(arguments);
    expect("opened ");
    screen.seen = 0; // it was said before
    if (!strcmp(device, "gpu")) {
        bool here = hear("warning there is no graphics card; the processor plays one", 2);
        screen.seen = here ? screen.seen : 0;
        with_card = !here && hear("log runs on ", 2);
        assert_true(here || with_card);
    }
    for (int i = 0; i < 6; i++) {
        if (i) press_key("period");
        assert_true(!i || told("frame") == i);
        // each is drawn, the first one, too, so that wings beat alike
        listen_from_here();
        tool("key x");
        expect("note saved ");
    }
    assert_int_equal(rename(in_folder(strrchr(screen.line, ' ') + 1), in_folder(name)), 0);
    press_key("comma"); // what is on a card is not kept frame by frame
    assert_true(told("frame") == (strcmp(device, "gpu") ? 4 : 5));
    close_window();
}

/* A card's birds are drawn in the window from its buffers, and where the processor has them. */
static void a_card_steps_what_is_shown(void **state) {
    (void)state;
    shoot_flock("cpu", "by-processor.png");
    shoot_flock("gpu", "by-card.png");
    shoot_flock("auto", "by-any.png");
    assert_true(difference(in_folder("by-processor.png"), in_folder("by-any.png")) == 0 || with_card);
    double apart = difference_over(in_folder("by-processor.png"), in_folder("by-card.png"), 40);
    assert_true(apart < 0.001);
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

/* Mesa is told to be an older one. */
static void says_what_to_do_without_opengl_4_5(void **state) {
    (void)state;
    setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
    outcome said = SKEIN("view", "scenes/flag.json");
    unsetenv("MESA_GL_VERSION_OVERRIDE");
    assert_status(said, 1);
    assert_contains(said.err, "no window with OpenGL 4.5");
    assert_contains(said.err, "apt-get install libgl1-mesa-dri");
    outcome_free(&said);
}

static void refuses_bad_arguments(void **state) {
    (void)state;
    assert_says(2, "", "skein view: --size 12: expected two whole numbers from 64 to 16384, as in 1280x720\n", "view",
                "--size", "12");
    assert_says(2, "", "skein view: --unfocused often: expected scene, pause or play\n", "view", "--unfocused", "often");
    assert_says(2, "", "skein view: --scale big: expected a number from 0.5 to 8\n", "view", "--scale", "big");
    assert_says(2, "", "skein view: no/such.json: cannot read: No such file or directory\n", "view", "no/such.json");
    outcome help = SKEIN("view", "--help");
    assert_status(help, 0);
    assert_contains(help.out, "Backspace    puts the scene back to its start");
    outcome_free(&help);
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    setenv("XDG_CONFIG_HOME", in_folder("settings"), 1);
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
        cmocka_unit_test(says_what_to_do_without_opengl_4_5),
        cmocka_unit_test(opens_from_the_gallery),
        cmocka_unit_test(plays_and_pauses),
        cmocka_unit_test(steps_goes_back_and_branches),
        cmocka_unit_test(switches_methods_and_colours),
        cmocka_unit_test(drags_a_slider),
        cmocka_unit_test(orbits_pans_and_zooms),
        cmocka_unit_test(moves_by_keys_and_flies),
        cmocka_unit_test(pulls_a_corner),
        cmocka_unit_test(pins_and_frees),
        cmocka_unit_test(frames_returns_and_follows),
        cmocka_unit_test(saves_pictures_and_meshes),
        cmocka_unit_test(records_a_film),
        cmocka_unit_test(reads_a_changed_file_again),
        cmocka_unit_test(takes_a_dropped_mesh),
        cmocka_unit_test(changes_its_size),
        cmocka_unit_test(opens_panels_by_keys),
        cmocka_unit_test(keeps_its_theme),
        cmocka_unit_test(closes_cleanly),
        cmocka_unit_test(pictures_agree_with_the_offscreen_path),
        cmocka_unit_test(solves_by_keys),
        cmocka_unit_test(keeps_what_was_changed),
        cmocka_unit_test(leads_where_nothing_has_a_velocity),
        cmocka_unit_test(waits_for_a_mended_scene),
        cmocka_unit_test(compares_and_waits_for_the_focus),
        cmocka_unit_test(steers_a_flock),
        cmocka_unit_test(a_card_steps_what_is_shown),
    };
    int failed = cmocka_run_group_tests(alone, make_folder, remove_folder);
    if (!can_open_screen()) return failed;
    return failed + cmocka_run_group_tests(sitting, begin, end);
}
