/* The lesson of the one spring, as a user has it in the window: any constraint's value and derivatives before and after
 * each solve, its text over it, which can be changed, its formula operation by operation, and its balls to be dragged. */
#include "window.h"

#include <math.h>

#include "render/camera.h"
#include "render/linear.h"

enum { WIDE = 1000, TALL = 700 };

static int begin(void **state) {
    if (make_folder(state)) return 1;
    open_screen();
    return 0;
}

static int end(void **state) {
    end_process(&screen.skein, SIGKILL);
    end_process(&screen.xvfb, SIGTERM);
    return remove_folder(state);
}

static void close_window(void) {
    listen_from_here();
    tool("key ctrl+q");
    expect("opengl stage errors=0 warnings=0");
    expect("closed");
    assert_int_equal(await_end(), 0);
}

/* A key that only asks for the state, also where keys solve. */
static void ask_state(void) {
    press_key("Shift_L");
}

/* The scene may have been there before the window was. */
static void await_scene(void) {
    screen.seen = 0;
    expect("opened ");
    ask_state();
}

static void open_scene(const char *name, const char *text, const char *const *more) {
    char path[512];
    const char *arguments[16] = {path, "--size", "1000x700", "--samples", "1"};
    size_t count = 5;
    snprintf(path, sizeof path, "%s", in_folder(name));
    write_scene(path, text);
    while (more && *more) arguments[count++] = *more++;
    arguments[count] = NULL;
    open_window(arguments);
    await_scene();
}

/* Where a control is once the window has come to rest. */
static void settled_place_of(const char *name, double *x, double *y) {
    double before[2];
    place_of(name, x, y);
    do {
        before[0] = *x, before[1] = *y;
        pause_for(0.4);
        place_of(name, x, y);
    } while (before[0] != *x || before[1] != *y);
}

/* ---- What a solve says ------------------------------------------------------------------------------ */

typedef struct told_look {
    double value, derivative[24], place[24];
    int derivatives;
} told_look;

/* "log solve N NAME WHEN: C 1; derivatives 1 2 3 4 5 6; at (1, 2, 3) (4, 5, 6)" */
static told_look heard(const char *begin) {
    told_look l = {0};
    if (!expect(begin)) return l;
    const char *at = strstr(screen.line, ": C ");
    assert_non_null(at);
    l.value = strtod(at + 4, NULL);
    at = strstr(at, "derivatives");
    assert_non_null(at);
    at += strlen("derivatives");
    for (char *next; *at == ' '; at = next) l.derivative[l.derivatives++] = strtod(at, &next);
    at = strstr(at, "; at ");
    assert_non_null(at);
    for (int i = 0; i < l.derivatives / 3; i++) {
        at = strchr(at, '(');
        assert_non_null(at);
        assert_int_equal(sscanf(at, "(%lf, %lf, %lf)", &l.place[3 * i], &l.place[3 * i + 1], &l.place[3 * i + 2]), 3);
        at++;
    }
    return l;
}

/* Presses a key, which solves, and hears of the constraint named so before and after it. */
static void solve(const char *key, int number, const char *name, told_look *before, told_look *after) {
    char words[64], line[120];
    listen_from_here();
    snprintf(words, sizeof words, "key %s", key);
    tool(words);
    snprintf(line, sizeof line, "log solve %d %s before", number, name);
    *before = heard(line);
    snprintf(line, sizeof line, "log solve %d %s after", number, name);
    *after = heard(line);
}

static void expect_derivatives(const told_look *l, double x) {
    assert_int_equal(l->derivatives, 6);
    for (int i = 0; i < 6; i++)
        if (fabs(l->derivative[i] - (i == 0 ? -x : i == 3 ? x : 0)) > 2e-6)
            fail_msg("derivative %d is %g, not +-%g", i, l->derivative[i], x);
}

/* findings/formula_key.json */
static const char squares[] =
    "{ 'name': 'squares', 'frames': 2, 'fps': 1, 'step': 1, 'advance': 'key',"
    "  'view': { 'surface': false, 'particles': 'all', 'particle_radius': 0.05, 'constraints': true },"
    "  'method': { 'type': 'pbd', 'substeps': 1, 'inertia': false },"
    "  'bodies': [ { 'type': 'rope', 'name': 'points', 'count': 2, 'from': [-0.5, 0, 0], 'to': [0.5, 0, 0],"
    "    'density': 2, 'stretch': { 'stiffness': 0, 'tether': 'infinite' } } ],"
    "  'constraints': [ { 'type': 'formula', 'name': 'spring', 'constraint': '0.5*(dot(p0-p1,p0-p1) - L^2)',"
    "    'parameters': { 'L': 0.5 }, 'stiffness': 'infinite', 'particles': [[0, 1]] } ] }";

/* C = (d^2 - L^2)/2 from d = 1, L = 1/2: each solve takes d to d - C/d, whose gradient is +-d. */
static void the_formula_is_what_is_told(void **state) {
    (void)state;
    open_scene("squares.json", squares, NULL);
    told_look before, after;
    double distance = 1;
    static const char *const keys[3] = {"Return", "m", "i"}; // any key that means nothing else
    for (int n = 0; n < 3; n++) {
        solve(keys[n], n + 1, "spring", &before, &after);
        assert_true(fabs(before.value - 0.5 * (distance * distance - 0.25)) < 1e-6);
        expect_derivatives(&before, distance);
        distance -= before.value / distance;
        expect_derivatives(&after, distance);
        assert_true(fabs(after.value - 0.5 * (distance * distance - 0.25)) < 1e-6);
        if (n == 0) assert_true(fabs(distance - 0.625) < 1e-12);
        assert_true(fabs(after.place[3] - after.place[0] - distance) < 1e-5);
    }
    close_window();
    // the note, too: in the second solve +-0.625
    char *all = read_text(screen.events);
    assert_contains(all, "\nnote solve 2 spring: C 0.0703125; derivatives -0.625 0 0 0.625 0 0; then C 0.0");
    free(all);
}

/* A note that is longer than the picture is wide goes on in another line, and not beyond the window's edge. */
static void a_long_note_wraps(void **state) {
    double box[4], x, y;
    (void)state;
    open_scene("squares.json", squares, (const char *const[]){"--size", "520x420", "--scale", "1", NULL});
    listen_from_here();
    tool("key Return");
    expect("note solve 1 spring: ");
    assert_true(strlen(screen.line) > 70); // of letters that are 5 pixels wide or more, beside a panel of 230
    settled_place_of("note", &x, &y);
    assert_true(find_box("note", 0, box, patience_seconds));
    if (!(box[0] > 0 && box[0] + box[2] <= 520 && box[3] > 36 && box[1] + box[3] <= 420))
        fail_msg("it is at %g %g, %g x %g", box[0], box[1], box[2], box[3]);
    close_window();
}

/* findings/formula_loose.json, and a constraint of four: however it was made. */
static void any_constraint_is_told(void **state) {
    (void)state;
    open_scene(
        "loose.json",
        "{ 'advance': 'key', 'frames': 3, 'step': 1, 'method': { 'type': 'pbd', 'substeps': 1, 'inertia': false },"
        "  'bodies': [ { 'type': 'flock', 'name': 'points', 'count': 4, 'spread': [1, 1, 1], 'speed': 0 } ],"
        "  'constraints': [ { 'type': 'formula', 'constraint': 'length(p0-p1)-L', 'parameters': { 'L': 0.5 },"
        "                     'stiffness': 'infinite', 'particles': [[0, 1]] },"
        "                   { 'type': 'volume', 'name': 'inside', 'particles': [[0, 1, 2, 3]] } ] }",
        NULL);
    told_look before, after;
    listen_from_here();
    tool("key Return");
    before = heard("log solve 1 inside before");
    assert_int_equal(before.derivatives, 12);
    for (int k = 0; k < 3; k++) {
        double sum = 0, most = 0;
        for (int i = 0; i < 4; i++)
            sum += before.derivative[3 * i + k], most = fmax(most, fabs(before.derivative[3 * i + k]));
        assert_true(most > 0 && fabs(sum) < 1e-4 * most); // moving all alike changes no volume
    }
    before = heard("log solve 1 formula before"), after = heard("log solve 1 formula after");
    double off[3], length = 0;
    for (int k = 0; k < 3; k++) off[k] = before.place[k] - before.place[3 + k], length += off[k] * off[k];
    length = sqrt(length);
    assert_true(length > 0 && fabs(before.value - (length - 0.5)) < 1e-5 && fabs(after.value) < fabs(before.value));
    for (int k = 0; k < 3; k++) {
        assert_true(fabs(before.derivative[k] - off[k] / length) < 1e-4);
        assert_true(before.derivative[3 + k] == -before.derivative[k]);
    }
    close_window();
}

/* ---- Another text ----------------------------------------------------------------------------------- */

static void write_formula(const char *text) {
    double x, y;
    char words[400];
    settled_place_of("lesson text", &x, &y);
    click(x, y);
    tool("sleep 0.6 keydown ctrl sleep 0.3 keydown a sleep 0.4 keyup a sleep 0.2 keyup ctrl sleep 0.3");
    listen_from_here();
    snprintf(words, sizeof words, "type --delay 20 '%s'", text);
    tool(words);
    tool("sleep 0.5 keydown Return sleep 0.5 keyup Return"); // as long as a finger takes
}

static void its_text_can_be_changed(void **state) {
    (void)state;
    open_scene("text.json", squares, NULL);
    told_look before, after;
    write_formula("length(p0 - p1) - 2*L");
    expect("note spring: length(p0 - p1) - 2*L");
    solve("Return", 1, "spring", &before, &after);
    assert_true(fabs(before.value) < 1e-6); // 1 m apart, and 1 m is what it wants
    expect_derivatives(&before, 1);
    // a fault is told with its place, and the old one stays
    write_formula("length(p0 - q1) - L");
    expect("warning line 1, column 13: ");
    assert_contains(screen.line, "the old one stays");
    write_formula("length(p0 - p1) - K");
    expect("warning line 1, column 19: ");
    solve("Return", 2, "spring", &before, &after);
    assert_true(fabs(before.value) < 1e-6);
    // what a living constraint cannot take is built anew, where everything stands
    write_formula("length(p0 - p1) - 0.75*rest(length(p0 - p1)) + 0*L");
    expect("reopened ");
    expect("note spring: length(p0 - p1) - 0.75*rest");
    solve("Return", 3, "spring", &before, &after);
    assert_true(fabs(before.value - 0.25) < 1e-6 && fabs(after.value) < 1e-6);
    // and undone as every change
    press_key("ctrl+z");
    press_key("ctrl+z");
    solve("Return", 4, "spring", &before, &after);
    expect_derivatives(&before, before.place[3] - before.place[0]);
    assert_true(fabs(before.value - 0.5 * (0.75 * 0.75 - 0.25)) < 1e-5);
    close_window();
}

/* ---- Operation by operation ------------------------------------------------------------------------- */

static void press_control(const char *name) {
    double x, y;
    settled_place_of(name, &x, &y);
    click(x, y);
}

/* Each operation has a value and six derivatives; the last is C with its gradient. */
static void the_tape_is_gone_through(void **state) {
    (void)state;
    open_scene("tape.json", squares, NULL);
    int number, last = 2;
    double value = 0, d[6] = {0};
    for (int n = 1; n <= last; n++) {
        listen_from_here();
        press_control("lesson on");
        if (!expect("operation ")) break;
        assert_int_equal(sscanf(screen.line, "operation %d of %d", &number, &last), 2);
        assert_int_equal(number, n);
        const char *at = strstr(screen.line, " value=");
        assert_non_null(at);
        assert_int_equal(sscanf(at, " value=%lf derivatives %lf %lf %lf %lf %lf %lf", &value, &d[0], &d[1], &d[2],
                                &d[3], &d[4], &d[5]),
                         7);
        // the first is a difference of coordinates: its derivatives are 1, -1 and 0
        if (n == 1) {
            double sum = 0, size = 0;
            for (int i = 0; i < 6; i++) sum += d[i], size += fabs(d[i]);
            assert_true(sum == 0 && size == 2);
            assert_contains(screen.line, "x1 = p0.");
        }
    }
    assert_true(last >= 6 && fabs(value - 0.375) < 1e-6);
    for (int i = 0; i < 6; i++) assert_true(fabs(d[i] - (i == 0 ? -1 : i == 3 ? 1 : 0)) < 1e-6);
    listen_from_here();
    press_control("lesson back");
    expect("operation ");
    assert_int_equal(sscanf(screen.line, "operation %d", &number), 1);
    assert_int_equal(number, last - 1);
    close_window();
}

/* ---- In the picture --------------------------------------------------------------------------------- */

static double left;

static void pixel_of(const double point[3], double *x, double *y) {
    render_camera lens = {.up = {0, 1, 0}, .fov = render_view_default().camera.fov};
    double right[3], up[3], back[3], off[3], tall = tan(0.5 * lens.fov * 0.017453292519943295);
    assert_int_equal(sscanf(strstr(screen.line, " eye="), " eye=%lf,%lf,%lf", &lens.eye[0], &lens.eye[1], &lens.eye[2]),
                     3);
    assert_int_equal(sscanf(strstr(screen.line, " target="), " target=%lf,%lf,%lf", &lens.target[0], &lens.target[1],
                            &lens.target[2]),
                     3);
    render_camera_axes(&lens, right, up, back);
    for (int k = 0; k < 3; k++) off[k] = point[k] - lens.eye[k];
    double depth = -render_dot(off, back);
    *x = left + 0.5 * (WIDE - left) + 0.5 * TALL * render_dot(off, right) / depth / tall;
    *y = 0.5 * TALL - 0.5 * TALL * render_dot(off, up) / depth / tall;
}

static size_t reds(const render_image *image) {
    size_t count = 0;
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++) {
        const uint8_t *p = &image->pixels[3 * i];
        count += p[0] > 120 && p[1] < 70 && p[2] < 80;
    }
    return count;
}

static void save_picture(render_image *image) {
    skein_error error;
    pause_for(1); // what moves is drawn smaller, and then sharp
    listen_from_here();
    tool("key x");
    expect("note saved ");
    assert_int_equal(render_image_read(image, in_folder(screen.line + strlen("note saved ")), &error), SKEIN_OK);
}

/* The text stands over the balls, and the arrows come and go with the panel. */
static void its_text_and_arrows_are_over_it(void **state) {
    double a[2], b[2], x, y;
    (void)state;
    open_scene("over.json", squares, NULL);
    settled_place_of("lesson text", &x, &y);
    render_image with = {0}, without = {0};
    save_picture(&with);
    left = WIDE - with.width;
    ask_state();
    pixel_of((const double[]){-0.5, 0, 0}, &a[0], &a[1]);
    pixel_of((const double[]){0.5, 0, 0}, &b[0], &b[1]);
    assert_true(x > fmin(a[0], b[0]) && x < fmax(a[0], b[0]));
    assert_true(y < fmin(a[1], b[1]) && y > fmin(a[1], b[1]) - 0.5 * TALL);
    press_key("F6");
    save_picture(&without);
    assert_int_equal(reds(&without), 0);
    assert_true(reds(&with) > 40);
    render_image_release(&with);
    render_image_release(&without);
    close_window();
}

/* ---- By hand ---------------------------------------------------------------------------------------- */

/* Takes the second ball where it is now and leads it so many pixels while the scene plays. */
static void lead(const double at[3], double dx, double dy, double to[3]) {
    double x, y;
    char words[300];
    pixel_of(at, &x, &y);
    listen_from_here();
    snprintf(words, sizeof words,
             "mousemove %.0f %.0f sleep 0.1 mousedown 1 sleep 0.1 mousemove %.0f %.0f sleep 0.05 mousemove %.0f %.0f",
             x, y, x + 0.3 * dx, y + 0.3 * dy, x + dx, y + dy);
    tool(words);
    expect("picked 1 ");
    ask_state();
    double begun = told("frame");
    do ask_state();
    while (told("frame") < begun + 60);
    listen_from_here();
    tool("mouseup 1");
    expect("released 1 at ");
    assert_int_equal(sscanf(screen.line, "released 1 at %lf %lf %lf", &to[0], &to[1], &to[2]), 3);
    // where the pointer is
    char released[2048];
    memcpy(released, screen.line, sizeof released);
    ask_state();
    double px, py;
    pixel_of(to, &px, &py);
    if (hypot(px - x - dx, py - y - dy) > 15)
        fail_msg("%s: it is at %.0f %.0f, the pointer at %.0f %.0f", released, px, py, x + dx, y + dy);
}

/* The running scene: the ball follows the pointer, the other one is drawn along, and let go both are 5.5 apart. */
static void a_ball_of_the_running_spring_follows(void **state) {
    double to[3], value;
    (void)state;
    const char *const arguments[] = {
        SKEIN_SOURCE_DIR "/scenes/one_spring_live.json", "--size", "1000x700", "--no-panels", "--samples", "1", NULL};
    open_window(arguments);
    await_scene();
    do ask_state();
    while (told("frame") < 3);
    left = 0;
    lead((const double[]){2.75, 0, 0}, -60, -120, to);
    assert_true(to[1] > 0.5);
    double frame = told("frame");
    do ask_state();
    while (told("frame") < frame + 3);
    press_key("space");
    press_key("F6");
    press_control("lesson all");
    expect("operation ");
    const char *at = strstr(screen.line, " value=");
    assert_non_null(at);
    value = strtod(at + 7, NULL);
    if (!(fabs(value) < 1e-3)) fail_msg("they are off by %g m", value);
    close_window();
}

/* The same with a soft spring, under every method by its key. */
static void a_ball_follows_under_every_method(void **state) {
    (void)state;
    open_scene(
        "soft.json",
        "{ 'name': 'soft', 'view': { 'surface': false, 'particles': 'all', 'particle_radius': 0.3 },"
        "  'method': { 'type': 'xpbd', 'substeps': 20 },"
        "  'bodies': [ { 'type': 'rope', 'count': 2, 'from': [-2, 0, 0], 'to': [2, 0, 0], 'density': 0.5,"
        "    'stretch': { 'stiffness': 0, 'tether': 'infinite' } } ], 'forces': [ { 'type': 'drag', 'rate': 2 } ],"
        "  'constraints': [ { 'type': 'formula', 'constraint': 'length(p0 - p1) - 4', 'stiffness': 50,"
        "    'damping': 2, 'particles': [[0, 1]] } ] }",
        (const char *const[]){"--paused", "--no-panels", NULL});
    left = 0;
    for (int m = 0; m < 9; m++) {
        char key[8], at[64];
        double to[3];
        snprintf(key, sizeof key, "%d", m + 1);
        press_key(key);
        snprintf(at, sizeof at, " method=%s ", skein_kind_at(SKEIN_METHOD, (size_t)m)->name);
        if (!strstr(screen.line, at)) fail_msg("no%sin: %s", at, screen.line);
        press_key("BackSpace");
        press_key("space");
        lead((const double[]){2, 0, 0}, -40, -60, to);
        press_key("space");
    }
    close_window();
}

int main(void) {
    const struct CMUnitTest sitting[] = {
        cmocka_unit_test(the_formula_is_what_is_told),
        cmocka_unit_test(a_long_note_wraps),
        cmocka_unit_test(any_constraint_is_told),
        cmocka_unit_test(its_text_can_be_changed),
        cmocka_unit_test(the_tape_is_gone_through),
        cmocka_unit_test(its_text_and_arrows_are_over_it),
        cmocka_unit_test(a_ball_of_the_running_spring_follows),
        cmocka_unit_test(a_ball_follows_under_every_method),
    };
    if (!can_open_screen()) return 0;
    if (getenv("SKEIN_TEST_ONLY")) cmocka_set_test_filter(getenv("SKEIN_TEST_ONLY"));
    return cmocka_run_group_tests(sitting, begin, end);
}
