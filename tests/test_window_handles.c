/* Handles and the brush in the window: what is dragged in the picture changes the scene as a field of the panel would, as
 * one change, and nothing else; it is seen while it is dragged. */
#define SCREEN_SIZE "1010x1110"
#include "window.h"

#include <math.h>

#include "io/scene.h"
#include "render/view.h"

/* ---- Words and places ------------------------------------------------------------------------------------ */

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

static void close_window(void) {
    settle(); // what was typed is done, and keys are the window's
    listen_from_here();
    tool("key ctrl+q");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

static void open_with(const char *path, const char *compare) {
    const char *arguments[16] = {path, "--size", "1000x1100", "--scale", "1", "--samples", "1", "--paused", NULL};
    if (compare) arguments[8] = "--compare", arguments[9] = compare;
    open_window(arguments);
    screen.seen = 0;
    expect(compare ? "note side by side" : "opened ");
}

/* A key that says this. */
static void use_key(const char *key, const char *said) {
    listen_from_here();
    hand("key %s", key);
    expect(said);
}

static void press_button(const char *name, const char *said) {
    double x, y;
    for (int turn = 0; turn < 4; turn++) {
        settle();
        place_of(name, &x, &y);
        listen_from_here();
        press(x, y, 0.05 + 0.1 * turn);
        if (hear(said, turn ? 10 : 4)) break;
        if (turn == 3) fail_msg("after a press on '%s' nobody says '%s'", name, said);
    }
}

/* Into the k-th of n numbers; false where a busy machine has not let it be taken. */
static bool try_number(const char *name, int k, int n, const char *number) {
    double box[4];
    assert_true(find_box(name, 0, box, patience_seconds));
    double wide = (box[2] - 4 * (n - 1)) / n;
    hand("keydown ctrl");
    hand("sleep 0.2");
    bool taken = take(name, box[0] + k * (wide + 4) + 0.4 * wide, box[1] + 0.5 * box[3]);
    if (taken) let_go(0.05);
    hand("keyup ctrl");
    // until the next picture keys are still the window's, and a digit would choose a method
    for (int turn = 0; taken && turn < 10; turn++) {
        await_hands();
        listen_from_here();
        hand("key Shift_L");
        await_hands();
        if (!hear("key 340 ", 1)) break;
    }
    if (taken) hand("type --delay 2 \"%s\"", number);
    hand("sleep 0.1");
    if (taken) hold_key("Return", 0.05);
    await_hands();
    return taken;
}

/* Types a number; keys are the window's again once it is laid out. */
static void type_value(const char *name, int k, int n, const char *number, const char *said) {
    for (int turn = 0; turn < 3; turn++) {
        settle();
        listen_from_here();
        if (try_number(name, k, n, number) && hear(said, 10)) break;
        if (turn == 2) fail_msg("typed into %s: nobody says '%s'", name, said);
    }
    char line[sizeof screen.line];
    memcpy(line, screen.line, sizeof line);
    settle();
    memcpy(screen.line, line, sizeof line);
}

static void hash_now(char hash[32]) {
    const char *at = strstr(screen.line, " hash=");
    assert_non_null(at);
    snprintf(hash, 32, "%.16s", at + 6);
}

static void hash_after(int frames, char hash[32]) {
    press_key("BackSpace");
    for (int i = 0; i < frames; i++) press_key("period");
    if (told("frame") != frames) fail_msg("%d frames were asked for: %s", frames, screen.line);
    hash_now(hash);
}

/* The pointer goes to the picture's middle, as nobody looks at it yet, and a tool is taken for what is there. */
static void take_tool(const char *key, const char *said) {
    use_key(key, said);
    settle();
}

/* Takes hold of a handle and brings it there, by so many pixels; it is not let go. */
static void hold_handle(const char *name, double dx, double dy, double *x, double *y) {
    settle();
    place_of(name, x, y);
    listen_from_here();
    if (!take(name, *x, *y)) fail_msg("%s is not taken", name);
    hand("mousemove %.0f %.0f", *x + 0.5 * dx, *y + 0.5 * dy);
    hand("mousemove %.0f %.0f", *x + dx, *y + dy);
    await_hands();
    expect("holds "); // a key may be faster than the pointer
}

static void drag_handle(const char *name, double dx, double dy, const char *said) {
    double x, y;
    hold_handle(name, dx, dy, &x, &y);
    hand("mouseup 1");
    expect(said);
}

/* Numbers after "=" of the line that was heard last. */
static void told_vector(double v[3]) {
    const char *at = strchr(screen.line, '=');
    assert_non_null(at);
    assert_int_equal(sscanf(at + 1, "%lf %lf %lf", &v[0], &v[1], &v[2]), 3);
}

/* ---- Scenes ---------------------------------------------------------------------------------------------- */

static void tell_fault(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static skein_world *world_of(const char *path) {
    const skein_kind *const kinds[] = {render_view_kind(), NULL};
    io_faults faults = {tell_fault, NULL, 0, NULL};
    io_scene *scene = io_scene_read(path, NULL, kinds, &faults);
    assert_non_null(scene);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_non_null(world);
    io_scene_free(scene);
    return world;
}

/* Saves the scene and opens it here. */
static skein_world *saved(void) {
    char name[300];
    use_key("ctrl+s", "note saved ");
    snprintf(name, sizeof name, "%s", screen.line + strlen("note saved "));
    name[strcspn(name, ":")] = 0;
    return world_of(in_folder(name));
}

static void get(skein_world *world, const char *path, double v[3]) {
    skein_value value;
    assert_int_equal(skein_get_path(world, path, &value), SKEIN_OK);
    memcpy(v, value.number, 3 * sizeof *v);
}

static const char cube[] =
    "{ 'name': 'one', 'method': { 'type': 'xpbd', 'substeps': 5 }, 'bodies': [ { 'type': 'lattice', 'name': 'cube',"
    "  'grid': [4, 4, 4], 'size': [0.5, 0.5, 0.5], 'position': [0, 1, 0], 'rotation': [0, 30, 0] } ],"
    "  'forces': [ { 'type': 'gravity' }, { 'type': 'predator', 'name': 'hawk', 'position': [-0.1, 0.5, 0.5], 'radius': 0.5 } ],"
    "  'colliders': [ { 'type': 'sphere', 'name': 'ball', 'centre': [0.1, 0, 0.2], 'radius': 0.5 } ] }";

/* ---- Bodies ---------------------------------------------------------------------------------------------- */

/* A body that has fallen for a while is moved by an arrow: that is one change of its position, along x alone, and what was
 * changed before stays. The arrow's point goes with the pointer. */
static void moves_a_body(void **state) {
    char before[32], after[32], again[32];
    double x, y, now_x, now_y, v[3], stiffness[3];
    (void)state;
    write_scene(in_folder("one.json"), cube);
    open_with(in_folder("one.json"), NULL);
    type_value("body.0.structural.stiffness", 0, 1, "3000", "set body 0 structural.stiffness=3000");
    hash_after(8, before);
    press_button("move body.0", "tool move body 0, cube");
    hold_handle("handle move x", 70, 6, &x, &y);
    listen_from_here();
    hand("mouseup 1");
    expect("set body 0 position=");
    told_vector(v);
    assert_true(v[0] > 0.02 && v[1] == 1 && v[2] == 0);
    expect("handled move");
    settle();
    place_of("handle move x", &now_x, &now_y);
    assert_true(fabs(now_x - x - 70) < 12 && fabs(now_y - y) < 25);
    hash_after(8, after);
    assert_string_not_equal(before, after);
    use_key("ctrl+z", "note undone: bodies.0.position");
    hash_after(8, again);
    assert_string_equal(before, again);
    use_key("ctrl+y", "note done again: bodies.0.position");
    hash_after(8, again);
    assert_string_equal(after, again);
    skein_world *world = saved();
    double position[3];
    get(world, "bodies.0.position", position);
    get(world, "bodies.0.structural.stiffness", stiffness);
    for (int k = 0; k < 3; k++) assert_true(fabs(position[k] - v[k]) < 1e-9);
    assert_true(stiffness[0] == 3000);
    skein_world_destroy(world);
    close_window();
}

/* Turned about the vertical by a ring, then made larger by the middle box: each is one change; a change that is given up by
 * Esc is none, and the picture is what it was. */
static void turns_and_sizes_a_body(void **state) {
    double x, y, v[3];
    (void)state;
    write_scene(in_folder("one.json"), cube);
    open_with(in_folder("one.json"), NULL);
    press_button("turn body.0", "tool turn body 0, cube");
    settle();
    use_key("x", "note saved one-001.png");
    hold_handle("handle turn y", 60, 10, &x, &y);
    use_key("x", "note saved one-002.png"); // it is seen while it is held
    use_key("Escape", "note it stays as it was");
    hand("mouseup 1");
    settle();
    use_key("x", "note saved one-003.png");
    char first[300], second[300], third[300];
    snprintf(first, sizeof first, "%s", in_folder("one-001.png"));
    snprintf(second, sizeof second, "%s", in_folder("one-002.png"));
    snprintf(third, sizeof third, "%s", in_folder("one-003.png"));
    assert_true(difference(first, second) > 0.005);
    assert_true(difference(first, third) < 0.001);
    drag_handle("handle turn y", 60, 10, "set body 0 rotation=");
    told_vector(v);
    // about the vertical: what remains of the other two is how rings are rounded
    assert_true(fabs(v[0]) < 0.02 && fabs(v[2]) < 0.02 && fabs(v[1] - 30) > 5);
    expect("handled turn");
    take_tool("l", "tool size body 0, cube");
    drag_handle("handle size all", 60, -60, "set body 0 size=");
    told_vector(v);
    assert_true(v[0] > 0.7 && v[0] == v[1] && v[1] == v[2]);
    expect("handled size");
    drag_handle("handle size y", 0, -30, "set body 0 size=");
    double w[3];
    told_vector(w);
    assert_true(w[0] == v[0] && w[1] > 1.05 * v[1] && w[2] == v[2]);
    use_key("ctrl+z", "note undone: bodies.0.size");
    use_key("ctrl+z", "note undone: bodies.0.size");
    use_key("ctrl+z", "note undone: bodies.0.rotation");
    use_key("ctrl+z", "note there is nothing to undo");
    use_key("Escape", "tool nothing");
    close_window();
}

/* ---- Rules ------------------------------------------------------------------------------------------------ */

/* A collider and a force follow at once, while the world runs: the ball in its way to the pointer is one change to undo, to
 * the number that it had. Time goes on, and nothing is built anew. */
static void moves_rules_that_run(void **state) {
    double v[3], w[3];
    (void)state;
    write_scene(in_folder("one.json"), cube);
    open_with(in_folder("one.json"), NULL);
    press_key("n"); // the cube
    press_key("n"); // the ball
    press_key("n"); // gravity has no place: the hawk
    listen_from_here();
    use_key("n", "tool move body 0, cube");
    use_key("n", "tool move collider 0, ball");
    press_key("space");
    assert_true(told("paused") == 0);
    drag_handle("handle move x", 60, 5, "set collider 0 centre=");
    told_vector(v);
    assert_true(v[0] > 0.12 && v[1] == 0 && v[2] == 0.2);
    drag_handle("handle move xz", 30, 20, "set collider 0 centre=");
    told_vector(w);
    assert_true(w[1] == 0 && w[2] != v[2]);
    press_key("space");
    assert_true(told("paused") == 1 && told("frame") > 0);
    screen.seen = 0;
    assert_false(hear("reopened", 0.2));
    skein_world *world = saved();
    get(world, "colliders.0.centre", v);
    for (int k = 0; k < 3; k++) assert_true(fabs(v[k] - w[k]) < 1e-9);
    skein_world_destroy(world);
    use_key("ctrl+z", "note undone: colliders.0.centre"); // two drags are two changes
    use_key("ctrl+z", "note undone: colliders.0.centre");
    use_key("ctrl+z", "note there is nothing to undo");
    world = saved();
    get(world, "colliders.0.centre", v);
    assert_true(v[0] == 0.1 && v[1] == 0 && v[2] == 0.2);
    skein_world_destroy(world);
    // its radius, and the hawk's place
    take_tool("l", "tool size collider 0, ball");
    drag_handle("handle size all", 40, 0, "set collider 0 radius=");
    assert_true(strtod(strchr(screen.line, '=') + 1, NULL) > 0.55);
    take_tool("n", "tool size force 1, hawk");
    drag_handle("handle size all", -30, 0, "set force 1 radius=");
    assert_true(strtod(strchr(screen.line, '=') + 1, NULL) < 0.49);
    close_window();
}

/* A plane is moved along its normal and turned about any axis: two fields, and one change. A rope has two ends. */
static void moves_planes_and_ropes(void **state) {
    static const char scene[] =
        "{ 'name': 'two', 'bodies': [ { 'type': 'rope', 'name': 'rope', 'from': [-0.5, 1, 0], 'to': [0.5, 1, 0.1] } ],"
        "  'colliders': [ { 'type': 'plane', 'name': 'ground', 'normal': [0, 1, 0], 'offset': 0.1 } ] }";
    double v[3];
    skein_world *world;
    (void)state;
    write_scene(in_folder("two.json"), scene);
    open_with(in_folder("two.json"), NULL);
    press_button("move body.0", "tool move body 0, rope");
    drag_handle("handle move y", 0, -50, "set body 0 from=");
    told_vector(v);
    assert_true(v[0] == -0.5 && v[1] > 1.02 && v[2] == 0);
    expect("handled move");
    world = saved();
    double from[3], to[3];
    get(world, "bodies.0.from", from);
    get(world, "bodies.0.to", to);
    assert_true(fabs(from[1] - to[1]) < 1e-9 && fabs(to[0] - from[0] - 1) < 1e-9 && fabs(to[2] - 0.1) < 1e-9);
    skein_world_destroy(world);
    use_key("ctrl+z", "note undone: bodies.0.from");
    use_key("ctrl+z", "note there is nothing to undo");
    world = saved();
    get(world, "bodies.0.from", from);
    get(world, "bodies.0.to", to);
    assert_true(from[1] == 1 && to[1] == 1);
    skein_world_destroy(world);
    use_key("n", "tool move collider 0, ground");
    drag_handle("handle move y", 0, -40, "set collider 0 offset=");
    assert_true(strtod(strchr(screen.line, '=') + 1, NULL) > 0.11);
    take_tool("h", "tool turn collider 0, ground");
    drag_handle("handle turn z", 30, 30, "set collider 0 normal=");
    told_vector(v);
    assert_true(fabs(v[0]) > 0.05 && fabs(v[2]) < 1e-4 && fabs(v[0] * v[0] + v[1] * v[1] - 1) < 1e-4);
    expect("handled turn");
    use_key("ctrl+z", "note undone: colliders.0.normal");
    world = saved();
    get(world, "colliders.0.normal", v);
    assert_true(v[0] == 0 && v[1] == 1);
    skein_world_destroy(world);
    close_window();
}

/* ---- Beside each other, and in flight ---------------------------------------------------------------------- */

/* Handles are over both worlds, and what is dragged in the second moves in both; a particle beside them is pulled as ever,
 * and what is beside a body turns the view. In flight a handle is taken hold of, too. */
static void works_beside_other_tools(void **state) {
    double x, y, v[3], box[4];
    (void)state;
    write_scene(in_folder("one.json"), cube);
    open_with(in_folder("one.json"), "method.type=pbd");
    press_key("n");
    use_key("n", "tool move collider 0, ball");
    settle();
    assert_true(find_box("handle move y", 0, box, patience_seconds));
    drag_handle("other handle move y", 0, -40, "set collider 0 centre=");
    told_vector(v);
    assert_true(v[1] > 0.02);
    expect("handled move");
    use_key("ctrl+z", "note undone: colliders.0.centre");
    use_key("ctrl+y", "note done again: colliders.0.centre");
    use_key("ctrl+s", "note saved ");
    char name[300];
    expect("note saved ");
    screen.seen = 0;
    for (int file = 0; file < 2; file++) {
        expect("note saved ");
        snprintf(name, sizeof name, "%s", screen.line + strlen("note saved "));
        name[strcspn(name, ":")] = 0;
        skein_world *world = world_of(in_folder(name));
        double centre[3];
        get(world, "colliders.0.centre", centre);
        for (int k = 0; k < 3; k++) assert_true(fabs(centre[k] - v[k]) < 1e-9);
        skein_world_destroy(world);
    }
    // beside the handles
    listen_from_here();
    drag(960, 60, 930, 80, 1);
    expect("picked -1");
    expect("camera ");
    settle();
    press_key("c");
    assert_true(told("flying") == 1);
    hold_handle("handle move y", 0, 30, &x, &y);
    listen_from_here();
    hand("mouseup 1");
    expect("handled move");
    close_window();
}

/* ---- Pins -------------------------------------------------------------------------------------------------- */

static const char sheet[] =
    "{ 'name': 'sheet', 'method': { 'type': 'xpbd', 'substeps': 4 }, 'bodies': [ { 'type': 'cloth', 'name': 'sheet',"
    "  'grid': [9, 9], 'size': [1, 1], 'position': [0, 1, 0], 'rotation': [90, 0, 0], 'pins': 'top corners' } ],"
    "  'forces': [ { 'type': 'gravity' } ],"
    "  'view': { 'camera': { 'from': [0, 1, 3], 'at': [0, 1, 0] } } }";

/* How many of the world's particles are held. */
static size_t held_in(const skein_world *world) {
    skein_view view = skein_position_view(world);
    size_t held = 0;
    for (size_t i = 0; i < view.count; i++) held += !(view.xyzw[4 * (size_t)view.slot_of[i] + 3] > 0);
    return held;
}

/* A stroke over the picture from one place to another. */
static void stroke(double x, double y, double to_x, double to_y, const char *said) {
    hand("mousemove %.0f %.0f", x, y);
    hand("sleep 0.1");
    listen_from_here();
    hand("mousedown 1");
    for (int i = 1; i <= 8; i++) hand("mousemove %.0f %.0f", x + (to_x - x) * i / 8, y + (to_y - y) * i / 8);
    hand("mouseup 1");
    expect(said);
}

/* The brush goes over the sheet's lower part: those under it are held at once, as one change, in the saved scene, over a
 * step and a rebuild; with Shift they are freed. A sheet of other particles has none of them. */
static void paints_pins(void **state) {
    char before[32], after[32], again[32];
    double box[4], wheel;
    skein_value pins;
    skein_world *world;
    (void)state;
    write_scene(in_folder("sheet.json"), sheet);
    open_with(in_folder("sheet.json"), NULL);
    hash_after(6, before);
    press_key("BackSpace");
    press_button("pins body.0", "tool pins");
    assert_true(find_box("brush", 0, box, patience_seconds));
    // the picture is to the right of the panel; its middle is the sheet's
    double mid_x = 300 + 350, mid_y = 550;
    hand("mousemove %.0f %.0f", mid_x, mid_y);
    listen_from_here();
    hand("click 4");
    expect("brush ");
    wheel = strtod(screen.line + 6, NULL);
    assert_true(wheel > 24);
    stroke(mid_x - 80, mid_y + 60, mid_x + 80, mid_y + 60, "painted ");
    size_t changed = 0, held = 0;
    assert_int_equal(sscanf(screen.line, "painted %zu held %zu", &changed, &held), 2);
    assert_true(changed >= 2 && changed < 40 && held == changed + 2);
    world = saved();
    assert_int_equal(held_in(world), held);
    skein_world_destroy(world);
    hash_after(6, after);
    assert_string_not_equal(before, after);
    // what is built anew keeps them, and where it stands is where it would be
    type_value("body.0.density", 0, 1, "0.3", "set body 0 density=0.3");
    world = saved();
    assert_int_equal(held_in(world), held);
    skein_world_destroy(world);
    use_key("ctrl+z", "note undone: bodies.0.density");
    hash_after(6, again);
    assert_string_equal(after, again);
    use_key("ctrl+z", "note undone: bodies.0.pins");
    hash_after(6, again);
    assert_string_equal(before, again);
    use_key("ctrl+y", "note done again: bodies.0.pins");
    hash_after(6, again);
    assert_string_equal(after, again);
    // freed again
    press_key("BackSpace");
    hand("keydown shift");
    stroke(mid_x - 80, mid_y + 60, mid_x + 80, mid_y + 60, "painted ");
    hand("keyup shift");
    assert_int_equal(sscanf(screen.line, "painted %zu held %zu", &changed, &held), 2);
    assert_int_equal(held, 2);
    use_key("ctrl+z", "note undone: bodies.0.pins");
    // another grid: the numbers mean nothing there
    type_value("body.0.grid", 0, 2, "7", "note built anew with bodies.0.grid=");
    assert_non_null(strstr(screen.line, "they are gone"));
    world = saved();
    assert_int_equal(held_in(world), 2);
    assert_int_equal(skein_get_path(world, "bodies.0.pins", &pins), SKEIN_OK);
    assert_string_equal(pins.text, "top corners");
    skein_world_destroy(world);
    use_key("ctrl+z", "note undone: bodies.0.grid");
    hash_after(6, again);
    assert_string_equal(after, again);
    close_window();
}

/* ---- The knife --------------------------------------------------------------------------------------------- */

/* The mesh that is saved now has so many faces. */
static void saves_faces(int faces) {
    char words[40];
    snprintf(words, sizeof words, ": 81 vertices, %d faces", faces);
    use_key("o", "note saved ");
    if (!strstr(screen.line, words)) fail_msg("expected%s, not %s", words, screen.line);
}

/* A stroke across the sheet cuts a row of its faces, which meshes lack then; what hung below falls. A frame back it is still
 * cut, two frames back, before the stroke, whole. A field that builds it anew where it stands leaves it cut. The recording
 * holds all of it. Beside the sheet nothing is cut, and looking around is with the right button. */
static void cuts_a_sheet(void **state) {
    char hash[32], words[80];
    (void)state;
    write_scene(in_folder("sheet.json"), sheet);
    open_with(in_folder("sheet.json"), NULL);
    double mid_x = 300 + 350, mid_y = 550;
    use_key("j", "recording ");
    press_key("period");
    press_key("period");
    use_key("k", "tool knife");
    stroke(mid_x - 330, mid_y - 330, mid_x + 330, mid_y - 330, "knife 0"); // above it
    saves_faces(64);
    stroke(mid_x - 330, mid_y + 30, mid_x + 330, mid_y + 30, "knife 8");
    stroke(mid_x - 330, mid_y + 30, mid_x + 330, mid_y + 30, "knife 0"); // there is nothing any more
    saves_faces(56);
    press_key("period");
    press_key("period");
    press_key("comma");
    saves_faces(56);
    press_key("comma");
    assert_true(told("frame") == 2);
    saves_faces(64);
    stroke(mid_x, mid_y + 330, mid_x, mid_y + 5, "knife 4"); // upwards, up to the middle
    for (int i = 0; i < 2; i++) press_key("period");
    hash_now(hash);
    use_key("j", "recorded ");
    double steps = told("steps");
    assert_true(steps == 6);
    char name[64];
    assert_int_equal(sscanf(screen.line, "recorded %63s", name), 1);
    outcome o = SKEIN("verify", in_folder(name));
    assert_status(o, 0);
    snprintf(words, sizeof words, "6 steps, the same to the bit; state hash %s\n", hash);
    assert_contains(o.out, words);
    outcome_free(&o);
    listen_from_here();
    drag(mid_x, mid_y, mid_x + 40, mid_y, 3);
    expect("camera ");
    saves_faces(60);
    use_key("k", "tool nothing");
    // pins that are painted build it anew, where it stands
    use_key("p", "tool pins");
    stroke(mid_x - 80, mid_y - 100, mid_x + 80, mid_y - 100, "painted ");
    saves_faces(60);
    press_key("BackSpace");
    saves_faces(64);
    close_window();
}

/* ---- The hawk ---------------------------------------------------------------------------------------------- */

/* The pointer that leads a predator gives it back: where the scene has it, and whether it hunts. */
static void gives_the_hawk_back(void **state) {
    char before[32], after[32];
    double box[4];
    (void)state;
    static const char scene[] =
        "{ 'name': 'birds', 'bodies': [ { 'type': 'flock', 'count': 40, 'spread': [2, 2, 2], 'speed': 1 } ], 'forces':"
        "  [ { 'type': 'predator', 'name': 'hawk', 'position': [0.5, 0.25, -0.5], 'radius': 1, 'strength': 10 } ] }";
    write_scene(in_folder("birds.json"), scene);
    open_with(in_folder("birds.json"), NULL);
    assert_true(find_box("Reset", 0, box, patience_seconds));
    hand("mousemove %.0f %.0f", box[0] + 5, box[1] + 5);
    await_hands();
    settle();
    hash_after(5, before);
    listen_from_here();
    hand("mousemove 650 500");
    expect("hunts");
    hand("mousemove 660 520");
    listen_from_here();
    hand("mousemove %.0f %.0f", box[0] + 5, box[1] + 5);
    expect("rests");
    hash_after(5, after); // it stands where it stood, and is feared as before
    assert_string_equal(before, after);
    close_window();
}

/* ---- A name that a formula does not know ------------------------------------------------------------------- */

/* The window offers to make it a parameter: it is one then, with a slider, and saved; and that is one change. */
static void makes_a_parameter(void **state) {
    static const char scene[] =
        "{ 'name': 'field', 'bodies': [ { 'type': 'lattice', 'grid': [2, 2, 2] } ], 'forces': [ { 'type': 'force_field',"
        "  'name': 'lift', 'force': 'vec3(0, 1, 0)' } ] }";
    double box[4], v[3];
    (void)state;
    write_scene(in_folder("field.json"), scene);
    open_with(in_folder("field.json"), NULL);
    press_button("Forces", "takes Forces");
    press_button("lift", "takes lift");
    for (int turn = 0; turn < 3; turn++) {
        settle();
        assert_true(find_box("force.0.force", 0, box, patience_seconds));
        listen_from_here();
        type_into("force.0.force", box, "vec3(m, k*t, 0)", 0.1 + 0.2 * turn);
        if (hear("offers parameter m", 10)) break;
        assert_true(turn < 2);
    }
    expect("offers parameter k");
    press_button("side make parameter", "made parameter m");
    type_value("force.0.parameters.k", 0, 1, "3", "set force 0 parameters.k=3");
    skein_world *world = saved();
    get(world, "forces.0.parameters.k", v);
    assert_true(v[0] == 3);
    get(world, "forces.0.parameters.m", v);
    assert_true(v[0] == 1);
    skein_world_destroy(world);
    use_key("ctrl+z", "note undone: forces.0.parameters.k=");
    use_key("ctrl+z", "note undone: forces.0.force=");
    use_key("ctrl+z", "note there is nothing to undo");
    close_window();
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    open_screen();
    // a key that a busy machine keeps down for long is still one key
    Display *display = XOpenDisplay(screen.display);
    if (display) XAutoRepeatOff(display), XSync(display, False), XCloseDisplay(display);
    patience_seconds = 60;
    return 0;
}

static int end(void **state) {
    drop_hands();
    end_process(&screen.skein, SIGKILL);
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

/* A window that a failed test left open would keep the next one waiting. */
static int leave(void **state) {
    (void)state;
    end_process(&screen.skein, SIGKILL);
    return 0;
}

#define SITTING(test) cmocka_unit_test_teardown(test, leave)

int main(void) {
    const struct CMUnitTest sitting[] = {
        SITTING(moves_a_body),           SITTING(turns_and_sizes_a_body),   SITTING(moves_rules_that_run),
        SITTING(moves_planes_and_ropes), SITTING(works_beside_other_tools), SITTING(paints_pins),
        SITTING(gives_the_hawk_back),    SITTING(makes_a_parameter),        SITTING(cuts_a_sheet),
    };
    if (!can_open_screen()) return 0;
    if (getenv("SKEIN_TEST_ONLY")) cmocka_set_test_filter(getenv("SKEIN_TEST_ONLY"));
    return cmocka_run_group_tests(sitting, begin, end);
}
