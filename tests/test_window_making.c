/* Making and moving things in the window: copies, pieces of the palette, other kinds, meshes of grids. What is made is
 * undone, done again, saved, and opens to the same bits. */
#define SCREEN_SIZE "720x1500"
#include "window.h"

#include <math.h>

#include "io/scene.h"
#include "render/view.h"

/* ---- Actions, which are counted ----------------------------------------------------------------------- */

static int actions;

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
    actions++;
}

/* Types a number; keys are the window's again once it is laid out. */
static void type_value(const char *name, int k, int n, const char *number, const char *said) {
    settle();
    for (int turn = 0; turn < 3; turn++) {
        listen_from_here();
        type_number(name, k, n, number);
        if (hear(said, 5)) break;
        if (turn == 2) fail_msg("typed into %s: nobody says '%s'", name, said);
    }
    char line[sizeof screen.line];
    memcpy(line, screen.line, sizeof line);
    settle();
    memcpy(screen.line, line, sizeof line);
    actions++;
}

static void use_key(const char *key, const char *said) {
    listen_from_here();
    hand("key %s", key);
    expect(said);
    actions++;
}

static void hash_now(char hash[32]) {
    const char *at = strstr(screen.line, " hash=");
    assert_non_null(at);
    snprintf(hash, 32, "%.16s", at + 6);
}

/* Some frames from the start. */
static void hash_after(int frames, char hash[32]) {
    press_key("BackSpace");
    for (int i = 0; i < frames; i++) press_key("period");
    assert_true(told("frame") == frames); // it has not blown up
    hash_now(hash);
}

static void close_window(void) {
    settle(); // what was typed is done, and keys are the window's
    listen_from_here();
    tool("key ctrl+q");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

static void open_scene(const char *path) {
    const char *const arguments[] = {path, "--size", "700x1500", "--scale", "1", "--samples", "1", "--paused", NULL};
    open_window(arguments);
    screen.seen = 0;
    expect("opened ");
}

/* ---- The saved scene, read here ------------------------------------------------------------------------ */

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

/* ---- A sitting of a user -------------------------------------------------------------------------------- */

/* Two cubes fall from 2 m into the bowl, turned by 30 degrees, stiffer, under the midpoint method: in less than 20 actions,
 * and the saved file opens to the same bits. */
static void drops_two_cubes_into_the_bowl(void **state) {
    char hash[32], again[32];
    (void)state;
    const char *const arguments[] = {
        "--scenes", SKEIN_SOURCE_DIR "/scenes", "--size", "700x1500", "--scale", "1", "--samples", "1", "--paused",
        NULL};
    open_window(arguments);
    screen.seen = 0;
    expect("gallery ");
    actions = 0;
    press_button("card cube_bowl", "opened particles=216 ");
    type_value("body.0.position", 1, 3, "2", "set body 0 position=");
    assert_non_null(strstr(screen.line, " 2 "));
    type_value("body.0.rotation", 0, 3, "30", "set body 0 rotation=30 0 -30");
    type_value("body.0.structural.stiffness", 0, 1, "3000", "set body 0 structural.stiffness=3000");
    press_button("duplicate body.0", "copied body 1");
    use_key("4", "state paused=1 frame=0 time=0 method=midpoint");
    use_key("ctrl+s", "note saved cube_bowl-001.json");
    hash_after(5, hash);
    listen_from_here();
    drop_file(in_folder("cube_bowl-001.json"));
    actions++;
    expect("opened particles=432 bodies=2 ");
    hash_after(5, again);
    assert_string_equal(hash, again);
    assert_true(actions < 20);
    close_window();
    // and the file says it
    skein_world *world = world_of(in_folder("cube_bowl-001.json"));
    skein_value position[2], rotation[2], stiffness[2];
    for (uint32_t b = 0; b < 2; b++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, b);
        assert_int_equal(skein_get(world, body, "position", &position[b]), SKEIN_OK);
        assert_int_equal(skein_get(world, body, "rotation", &rotation[b]), SKEIN_OK);
        assert_int_equal(skein_get(world, body, "structural.stiffness", &stiffness[b]), SKEIN_OK);
        assert_true(position[b].number[1] == 2 && rotation[b].number[0] == 30 && stiffness[b].number[0] == 3000);
    }
    assert_true(position[1].number[0] - position[0].number[0] > 0.5);
    skein_world_destroy(world);
}

static const char one_cube[] =
    "{ 'name': 'one', 'method': { 'type': 'xpbd', 'substeps': 5 }, 'bodies': [ { 'type': 'lattice', 'name': 'cube',"
    "  'grid': [4, 4, 4], 'size': [0.5, 0.5, 0.5], 'position': [0, 1, 0] } ], 'forces': [ { 'type': 'gravity' } ],"
    "  'colliders': [ { 'type': 'plane', 'name': 'ground', 'offset': 0 } ] }";

/* One cube becomes three on another ground in four clicks; each is undone and done again. */
static void makes_three_cubes_of_one(void **state) {
    char first[32], last[32], again[32];
    (void)state;
    write_scene(in_folder("one.json"), one_cube);
    open_scene(in_folder("one.json"));
    hash_after(3, first);
    actions = 0;
    press_button("duplicate body.0", "copied body 1");
    press_button("duplicate body.0", "copied body 2");
    press_button("Make", "takes Make");
    press_button("make bowl", "made bowl 0");
    assert_true(actions <= 4);
    hash_after(30, last);
    use_key("ctrl+s", "note saved one-001.json");
    for (int i = 0; i < 3; i++) use_key("ctrl+z", "note undone: ");
    hash_after(3, again);
    assert_string_equal(first, again);
    for (int i = 0; i < 3; i++) use_key("ctrl+y", "note done again: ");
    hash_after(30, again);
    assert_string_equal(last, again);
    skein_world *world = world_of(in_folder("one-001.json"));
    assert_int_equal(skein_object_count(world, SKEIN_BODY), 3);
    assert_int_equal(skein_object_count(world, SKEIN_COLLIDER), 1);
    skein_handle bowl = skein_object_at(world, SKEIN_COLLIDER, 0);
    assert_string_equal(skein_object_kind(world, bowl)->name, "bowl");
    // no cube stands in another, and all are inside the bowl and stay there
    skein_value centre, radius;
    assert_int_equal(skein_get(world, bowl, "centre", &centre), SKEIN_OK);
    assert_int_equal(skein_get(world, bowl, "radius", &radius), SKEIN_OK);
    for (int i = 0; i < 2; i++) {
        for (uint32_t p = 0; p < skein_particle_count(world); p++) {
            double x[3];
            assert_int_equal(skein_positions_copy(world, p, 1, x), SKEIN_OK);
            double off = hypot(hypot(x[0] - centre.number[0], x[1] - centre.number[1]), x[2] - centre.number[2]);
            assert_true(off < radius.number[0]);
        }
        for (int step = 0; step < 60; step++) assert_int_equal(skein_world_step(world, 1.0 / 60), SKEIN_OK);
    }
    skein_world_destroy(world);
}

/* Each piece of the palette is made, moves or is met, and can be removed. */
static void makes_each_piece(void **state) {
    static const char *const pieces[] = {"cloth", "cube", "rope", "flock", "plane", "slope", "bowl", "ball", "box"};
    char before[32], after[32], said[64], button[64], type[300];
    double box[4];
    (void)state;
    for (size_t i = 0; i < COUNT(pieces); i++) {
        listen_from_here();
        drop_file(in_folder("one.json"));
        expect("opened particles=64 ");
        hash_after(40, before);
        snprintf(button, sizeof button, "make %s", pieces[i]);
        snprintf(said, sizeof said, "made %s %d", pieces[i], i < 4);
        press_button(button, said);
        hash_after(40, after);
        if (strcmp(pieces[i], "plane") != 0) assert_string_not_equal(before, after);
    }
    // a mesh from the disk, by its path
    listen_from_here();
    drop_file(in_folder("one.json"));
    expect("opened particles=64 ");
    snprintf(type, sizeof type, "%s/meshes/ball.obj", SKEIN_SOURCE_DIR);
    for (int turn = 0; turn < 3; turn++) {
        settle();
        assert_true(find_box("make mesh", 0, box, patience_seconds));
        listen_from_here();
        type_into("make mesh", box, type, 0.1 + 0.2 * turn);
        if (hear("made mesh 1", 5)) break;
        assert_true(turn < 2);
    }
    close_window();
}

/* Two numbers that are entered one after the other are two changes, though of one field. */
static void undoes_each_entry(void **state) {
    skein_value stiffness;
    (void)state;
    write_scene(in_folder("one.json"), one_cube);
    open_scene(in_folder("one.json"));
    type_value("body.0.structural.stiffness", 0, 1, "3000", "set body 0 structural.stiffness=3000");
    type_value("body.0.structural.stiffness", 0, 1, "4000", "set body 0 structural.stiffness=4000");
    use_key("ctrl+z", "note undone: bodies.0.structural.stiffness=4000");
    use_key("ctrl+s", "note saved one-");
    char name[128];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(screen.line + 11, ":"), screen.line + 11);
    use_key("ctrl+z", "note undone: bodies.0.structural.stiffness=3000");
    use_key("ctrl+z", "note there is nothing to undo");
    close_window();
    skein_world *world = world_of(in_folder(name));
    assert_int_equal(skein_get(world, skein_object_at(world, SKEIN_BODY, 0), "structural.stiffness", &stiffness),
                     SKEIN_OK);
    assert_true(stiffness.number[0] == 3000);
    skein_world_destroy(world);
}

/* ---- A camera that goes along ------------------------------------------------------------------------------ */

static const char rolling[] =
    "{ 'name': 'roll', 'method': { 'type': 'xpbd', 'substeps': 10 }, 'forces': [ { 'type': 'gravity' } ],"
    "  'bodies': [ { 'type': 'lattice', 'name': 'cube', 'grid': [3, 3, 3], 'size': [0.5, 0.5, 0.5], 'position': [0, 0.6, 0],"
    "                'velocity': [3, 0, 0] },"
    "              { 'type': 'cloth', 'grid': [3, 3], 'position': [0, 2, -1] } ],"
    "  'colliders': [ { 'type': 'plane', 'normal': [0.6, 1, 0], 'friction': 0.4 } ] }";

/* Where it looks once a picture was made of what there is. */
static void ask_target(double target[3]) {
    settle();
    press_key("Shift_L");
    const char *at = strstr(screen.line, " target=");
    assert_non_null(at);
    assert_int_equal(sscanf(at, " target=%lf,%lf,%lf", &target[0], &target[1], &target[2]), 3);
}

/* The middle of a body, which is first in its world, after some frames. */
static void middle_after(int frames, size_t count, double middle[3]) {
    skein_world *world = world_of(in_folder("roll.json"));
    for (int i = 0; i < frames; i++) assert_int_equal(skein_world_step(world, 1.0 / 60), SKEIN_OK);
    middle[0] = middle[1] = middle[2] = 0;
    for (size_t p = 0; p < count; p++) {
        double x[3];
        assert_int_equal(skein_positions_copy(world, p, 1, x), SKEIN_OK);
        for (int k = 0; k < 3; k++) middle[k] += x[k] / (double)count;
    }
    skein_world_destroy(world);
}

/* What is looked at goes as far as the cube does, from where it was at the start, also by "0"; T ends that, undo takes the
 * wish back, and a saved scene has it. */
static void follows_a_rolling_cube(void **state) {
    enum { FRAMES = 30, PARTICLES = 27 };
    double from[3], to[3], before[3], after[3], home[3];
    char hash[32], again[32];
    (void)state;
    write_scene(in_folder("roll.json"), rolling);
    middle_after(0, PARTICLES, from);
    middle_after(FRAMES, PARTICLES, to);
    assert_true(to[0] - from[0] > 1 && to[1] - from[1] < -0.5);
    open_scene(in_folder("roll.json"));
    press_button("follow body.0", "set view 0 camera.follow=cube");
    press_key("BackSpace");
    ask_target(before);
    for (int i = 0; i < FRAMES; i++) press_key("period");
    ask_target(after);
    press_key("0");
    ask_target(home);
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(after[k] - before[k] - (to[k] - from[k])) < 1e-3);
        assert_true(fabs(home[k] - after[k]) < 1e-3);
    }
    use_key("ctrl+s", "note saved roll-001.json");
    use_key("t", "note the view stands still");
    use_key("t", "note the view goes along with cube");
    press_button("follow body.0", "note the view stands still");
    use_key("ctrl+z", "note undone: view.camera.follow");
    use_key("ctrl+z", "note undone: view.camera.follow");
    hash_after(FRAMES, again);
    close_window();
    // back at its start it rolls as from the file: what moved then moves again
    skein_world *world = world_of(in_folder("roll.json"));
    for (int i = 0; i < FRAMES; i++) assert_int_equal(skein_world_step(world, 1.0 / 60), SKEIN_OK);
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)skein_world_hash(world));
    assert_string_equal(hash, again);
    skein_world_destroy(world);
    char *saved = read_text(in_folder("roll-001.json"));
    assert_non_null(strstr(saved, "\"follow\": \"cube\""));
    free(saved);
}

/* ---- A grid becomes a mesh --------------------------------------------------------------------------------- */

static const char sheet[] =
    "{ 'name': 'sheet', 'method': { 'type': 'xpbd', 'substeps': 4 }, 'bodies': [ { 'type': 'cloth', 'name': 'sheet',"
    "  'grid': [5, 5], 'size': [1, 2], 'position': [0, 1, 0.5], 'rotation': [90, 0, 0], 'pins': 'top corners' } ],"
    "  'forces': [ { 'type': 'gravity' } ] }";

static void turns_a_grid_into_a_mesh(void **state) {
    char name[128], hash[32], again[32];
    (void)state;
    write_scene(in_folder("sheet.json"), sheet);
    open_scene(in_folder("sheet.json"));
    press_button("to mesh body.0", "meshed mesh-001.obj");
    assert_true(exists(in_folder("mesh-001.obj")));
    use_key("ctrl+s", "key ");
    screen.seen = 0;
    while (hear("note saved ", 0.5)) snprintf(name, sizeof name, "%s", screen.line + strlen("note saved "));
    name[strcspn(name, ":")] = 0;
    hash_after(10, hash);
    skein_world *grid = world_of(in_folder("sheet.json")), *mesh = world_of(in_folder(name));
    skein_surface s;
    assert_int_equal(skein_body_surface(mesh, skein_object_at(mesh, SKEIN_BODY, 0), &s), SKEIN_OK);
    assert_int_equal(s.vertex_count, 25);
    assert_int_equal(s.grid_rows, 0);
    // each vertex stands where it stood, and the same two are held
    for (uint32_t v = 0; v < 25; v++) {
        double a[3], b[3];
        assert_int_equal(skein_positions_copy(grid, v, 1, a), SKEIN_OK);
        assert_int_equal(skein_positions_copy(mesh, s.particle_of_vertex[v], 1, b), SKEIN_OK);
        for (int k = 0; k < 3; k++) assert_true(fabs(a[k] - b[k]) < 1e-6);
        skein_view p = skein_position_view(grid), q = skein_position_view(mesh);
        assert_true((p.xyzw[4 * p.slot_of[v] + 3] > 0) == (q.xyzw[4 * q.slot_of[s.particle_of_vertex[v]] + 3] > 0));
    }
    skein_world_destroy(grid);
    skein_world_destroy(mesh);
    listen_from_here();
    drop_file(in_folder(name));
    expect("opened particles=25 ");
    hash_after(10, again);
    assert_string_equal(hash, again);
    close_window();
}

/* ---- Colliders ------------------------------------------------------------------------------------------------ */

/* A collider that is moved while nothing runs stands where it was put: the next step is the same as if it always had. */
static void puts_a_collider_elsewhere(void **state) {
    char moved[32], again[32];
    static const char ball[] =
        "{ 'name': 'ball', 'method': { 'type': 'xpbd' }, 'bodies': [ { 'type': 'lattice', 'grid': [4, 4, 4] } ],"
        "  'colliders': [ { 'type': 'sphere', 'centre': [-3, 0, 0], 'radius': 0.5 } ] }";
    (void)state;
    write_scene(in_folder("ball.json"), ball);
    open_scene(in_folder("ball.json"));
    press_button("Colliders", "takes Colliders");
    press_button("sphere", "takes sphere");
    // through the block, to its other side
    type_value("collider.0.centre", 0, 3, "3", "set collider 0 centre=3 0 0");
    press_key("period");
    hash_now(moved);
    hash_after(1, again);
    assert_string_equal(moved, again);
    close_window();
}

/* ---- Stability ------------------------------------------------------------------------------------------------- */

static const char stiff[] =
    "{ 'name': 'stiff', 'method': { 'type': 'symplectic_euler', 'substeps': 1 }, 'bodies': [ { 'type': 'lattice',"
    "  'name': 'block', 'grid': [3, 3, 3], 'size': [0.5, 0.5, 0.5], 'position': [0, 1, 0], 'mass': 1,"
    "  'structural': { 'stiffness': 20000 } } ], 'forces': [ { 'type': 'gravity' } ],"
    "  'colliders': [ { 'type': 'plane', 'offset': 0 } ] }";

/* What blows up stops at the last good frame and says what went first; one button takes as many substeps as are needed, and
 * then it holds. */
static void says_what_blew_up_and_what_holds_it(void **state) {
    char hash[32];
    double frame;
    (void)state;
    write_scene(in_folder("stiff.json"), stiff);
    open_scene(in_folder("stiff.json"));
    listen_from_here();
    hand("key space");
    expect("warning it blew up: first particle ");
    assert_non_null(strstr(screen.line, " of body 0, block"));
    assert_non_null(strstr(screen.line, "the spring from particle "));
    assert_non_null(strstr(screen.line, " substeps would hold it"));
    frame = strtod(strstr(screen.line, "Back at frame ") + 14, NULL);
    press_key("i");
    assert_true(told("paused") == 1);
    assert_true(told("frame") == frame);
    press_button("take substeps", "set method 0 substeps=");
    assert_true(strtod(strchr(screen.line, '=') + 1, NULL) > 1);
    hash_after(60, hash);
    close_window();
}

/* ---- What is kept between sittings ------------------------------------------------------------------------------ */

static void remembers_scenes(void **state) {
    (void)state;
    write_scene(in_folder("one.json"), one_cube);
    mkdir(in_folder("none"), 0777);
    open_scene(in_folder("one.json"));
    close_window();
    const char *const arguments[] = {"--scenes", in_folder("none"), "--size", "700x700",  "--scale",
                                     "1",        "--samples",       "1",      "--paused", NULL};
    open_window(arguments);
    screen.seen = 0;
    press_button("recent one.json", "opened particles=64 ");
    close_window();
}

/* Changes of the second world are its own: they outlast a rebuild of both, and are saved beside the first. */
static void saves_both_of_two(void **state) {
    (void)state;
    char named[sizeof one_cube + 8] = "{ 'name': 'pair'";
    strcat(named, strchr(one_cube, ','));
    write_scene(in_folder("pair.json"), named);
    const char *const arguments[] = {
        in_folder("pair.json"), "--size", "700x1500", "--scale", "1", "--samples", "1", "--paused", "--compare",
        "method.type=pbd",      NULL};
    open_window(arguments);
    screen.seen = 0;
    expect("note side by side");
    press_key("i");
    type_value("other body.0.structural.stiffness", 0, 1, "4321", "set body 0 structural.stiffness=4321");
    type_value("body.0.mass", 0, 1, "7", "set body 0 mass=7");
    use_key("ctrl+s", "note saved pair-other-001.json");
    expect("note saved pair-001.json");
    skein_world *first = world_of(in_folder("pair-001.json")), *other = world_of(in_folder("pair-other-001.json"));
    skein_value stiffness[2], mass;
    assert_int_equal(skein_get_path(first, "bodies.0.structural.stiffness", &stiffness[0]), SKEIN_OK);
    assert_int_equal(skein_get_path(other, "bodies.0.structural.stiffness", &stiffness[1]), SKEIN_OK);
    assert_int_equal(skein_get_path(other, "bodies.0.mass", &mass), SKEIN_OK);
    assert_true(stiffness[0].number[0] == 2000 && stiffness[1].number[0] == 4321 && mass.number[0] == 7);
    assert_string_equal(skein_object_kind(other, skein_object_at(other, SKEIN_METHOD, 0))->name, "pbd");
    skein_world_destroy(first);
    skein_world_destroy(other);
    close_window();
}

/* A field that another one is given instead of says so. */
static void says_what_is_ignored(void **state) {
    static const char flock[] = "{ 'name': 'flock', 'bodies': [ { 'type': 'flock', 'count': 9, 'side': 3 } ] }",
                      block[] = "{ 'name': 'block', 'bodies': [ { 'type': 'lattice', 'density': 3 } ] }";
    double box[4];
    (void)state;
    write_scene(in_folder("flock.json"), flock);
    write_scene(in_folder("block.json"), block);
    open_scene(in_folder("flock.json"));
    assert_true(find_box("body.0.count is ignored", 0, box, patience_seconds));
    type_value("body.0.side", 0, 1, "0", "set body 0 side=0");
    settle();
    listen_from_here();
    long from = screen.seen;
    drop_file(in_folder("block.json"));
    expect("opened ");
    assert_true(find_box("body.0.mass is ignored", from, box, patience_seconds));
    assert_false(find_box("body.0.count is ignored", from, box, 0.1));
    close_window();
}

static int begin(void **state) {
    if (make_folder(state)) return -1;
    open_screen();
    patience_seconds = 30;
    return 0;
}

static int end(void **state) {
    drop_hands();
    end_process(&screen.skein, SIGKILL);
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

int main(void) {
    const struct CMUnitTest sitting[] = {
        cmocka_unit_test(drops_two_cubes_into_the_bowl),
        cmocka_unit_test(makes_three_cubes_of_one),
        cmocka_unit_test(makes_each_piece),
        cmocka_unit_test(turns_a_grid_into_a_mesh),
        cmocka_unit_test(puts_a_collider_elsewhere),
        cmocka_unit_test(says_what_blew_up_and_what_holds_it),
        cmocka_unit_test(remembers_scenes),
        cmocka_unit_test(saves_both_of_two),
        cmocka_unit_test(says_what_is_ignored),
        cmocka_unit_test(follows_a_rolling_cube),
        cmocka_unit_test(undoes_each_entry),
    };
    if (!can_open_screen()) return 0;
    if (getenv("SKEIN_TEST_ONLY")) cmocka_set_test_filter(getenv("SKEIN_TEST_ONLY"));
    return cmocka_run_group_tests(sitting, begin, end);
}
