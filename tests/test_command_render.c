/* Tests of `skein render` but for films: pictures, arguments, and what is said where it cannot draw. */
#include "test_command.h"

#include <math.h>

#include "render/image.h"

static render_image read_png(const char *path) {
    render_image image = {0};
    skein_error error = {SKEIN_OK, "", ""};
    if (render_image_read(&image, path, &error)) fail_msg("%s: %s", error.where, error.message);
    return image;
}

/* The part of the pixels that differ. */
static double difference(const render_image *a, const render_image *b) {
    size_t count = 0, total = (size_t)a->width * (size_t)a->height;
    assert_true(a->width == b->width && a->height == b->height);
    for (size_t i = 0; i < 3 * total; i += 3) count += memcmp(a->pixels + i, b->pixels + i, 3) != 0;
    return (double)count / (double)total;
}

#define SMALL "--size", "64x36", "--samples", "1", "--no-progress"

/* ---- Pictures ----------------------------------------------------------------------------------------- */

static void a_picture_shows_the_frame_that_was_asked_for(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600], *first = in_folder("first.png"), *third = in_folder("third.png"), *last = in_folder("last.png");
    outcome o = SKEIN("render", s, "-o", first, "--frame", "0", SMALL);
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    snprintf(words, sizeof words, "wrote %s: 64 x 36, frame 0, at 0.00 s\n", first);
    assert_string_equal(o.out, words);
    outcome_free(&o);
    o = SKEIN("render", s, "--frame=30", "-o", third, SMALL);
    snprintf(words, sizeof words, "wrote %s: 64 x 36, frame 30, at 0.50 s\n", third);
    assert_string_equal(o.out, words);
    outcome_free(&o);
    // without a frame it is the last of the scene's, or of those that were asked for
    o = SKEIN("render", s, "-o", last, SMALL);
    assert_contains(o.out, ", frame 4, at 0.07 s\n");
    outcome_free(&o);
    o = SKEIN("render", s, "-o", last, "--frames", "60", "--fps", "120", SMALL);
    assert_contains(o.out, ", frame 60, at 0.50 s\n");
    outcome_free(&o);
    // half a second is half a second, and not the start; the same command draws the same picture
    render_image a = read_png(first), b = read_png(third);
    assert_true(a.width == 64 && a.height == 36);
    assert_true(difference(&a, &b) > 0.02);
    outcome_free((outcome[]){SKEIN("render", s, "--frame", "30", "-o", last, "--threads", "2", SMALL)});
    render_image c = read_png(last);
    assert_true(difference(&b, &c) == 0);
    // and what the exporter of a run draws after as many frames
    o = SKEIN("run", s, "--out", in_folder("out"), "--frames", "30", "--no-progress", "--set",
              "output=[{\"type\":\"png\",\"size\":[64,36],\"samples\":1}]");
    assert_status(o, 0);
    render_image d = read_png(in_folder("out/my_scene_1.png"));
    assert_true(difference(&b, &d) == 0);
    outcome_free(&o);
    render_image_release(&a);
    render_image_release(&b);
    render_image_release(&c);
    render_image_release(&d);
}

static void sets_reach_the_picture(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome_free((outcome[]){SKEIN("render", s, "-o", in_folder("a.png"), "--frame", "0", SMALL)});
    outcome o =
        SKEIN("render", s, "-o", in_folder("b.png"), "--frame", "0", SMALL, "--set", "colliders.ball.visible=false");
    assert_status(o, 0);
    render_image a = read_png(in_folder("a.png")), b = read_png(in_folder("b.png"));
    assert_true(difference(&a, &b) > 0.02);
    render_image_release(&a);
    render_image_release(&b);
    outcome_free(&o);
}

static void numbered_pictures_show_frame_by_frame(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    assert_int_equal(mkdir(in_folder("out"), 0777), 0);
    write_text(in_folder("out/p-02.png"), "old");
    write_text(in_folder("out/p-09.png"), "not ours");
    outcome o = SKEIN("render", s, "-o", in_folder("out/p-%02d.png"), SMALL);
    assert_status(o, 0);
    assert_string_equal(o.err, "");
    snprintf(words, sizeof words, "wrote %s: 4 pictures of 64 x 36, 0.07 s at 60 a second; in ",
             in_folder("out/p-%02d.png"));
    assert_contains(o.out, words);
    outcome_free(&o);
    assert_int_equal(count_entries(in_folder("out")), 5);
    char *kept = read_text(in_folder("out/p-09.png"));
    assert_string_equal(kept, "not ours");
    free(kept);
    o = SKEIN("render", s, "-o", in_folder("out/q##.png"), "--frames", "31", SMALL);
    assert_status(o, 0);
    assert_int_equal(count_entries(in_folder("out")), 5 + 31);
    // something moved, and the background stood still, to the last bit
    render_image a = read_png(in_folder("out/q00.png")), b = read_png(in_folder("out/q30.png"));
    double moved = difference(&a, &b);
    if (moved < 0.02 || moved > 0.4) fail_msg("%g of the picture changed", moved);
    render_image_release(&a);
    render_image_release(&b);
    outcome_free(&o);
}

/* ---- Arguments ---------------------------------------------------------------------------------------- */

/* The middle of what is red, in shares of the picture; and whether any of it touches the picture's edge. */
static bool find_red(const char *path, double middle[2]) {
    render_image image = read_png(path);
    size_t count = 0;
    bool at_edge = false;
    middle[0] = middle[1] = 0;
    for (int y = 0; y < image.height; y++)
        for (int x = 0; x < image.width; x++) {
            const unsigned char *p = image.pixels + 3 * ((size_t)y * (size_t)image.width + (size_t)x);
            if (p[0] < p[2] + 40 || p[0] < p[1] + 40) continue;
            middle[0] += (x + 0.5) / image.width, middle[1] += (y + 0.5) / image.height;
            at_edge |= x == 0 || y == 0 || x == image.width - 1 || y == image.height - 1;
            count++;
        }
    for (int k = 0; k < 2 && count; k++) middle[k] /= (double)count;
    bool whole = count > 30 && !at_edge;
    render_image_release(&image);
    return whole;
}

/* A cube rolls 20 m down a slope: the camera goes along with it if that is asked, by the scene or here. */
static void a_rolling_cube_stays_in_the_picture(void **state) {
    (void)state;
    const char *s = in_folder("roll.json"), *const follows[] = {"--follow=cube", "--follow=0",
                                                                "--set=view.camera.follow=cube"};
    write_scene(s, "{ 'name': 'roll', 'frames': 36, 'fps': 12, 'method': { 'type': 'xpbd', 'substeps': 20 },"
                   "  'bodies': [ { 'type': 'lattice', 'name': 'cube', 'grid': [3, 3, 3], 'size': [0.5, 0.5, 0.5],"
                   "                'position': [0, 0.6, 0], 'velocity': [4, 0, 0], 'visible': true } ],"
                   "  'forces': [ { 'type': 'gravity' } ],"
                   "  'colliders': [ { 'type': 'plane', 'normal': [0.6, 1, 0], 'friction': 0.4 } ] }");
    double first[2], middle[2];
    char path[600];
    for (size_t i = 0; i < sizeof follows / sizeof *follows; i++) {
        outcome o = SKEIN("render", s, "-o", in_folder("roll-%03d.png"), "--size", "160x90", "--samples", "1",
                          "--no-progress", follows[i]);
        assert_status(o, 0);
        outcome_free(&o);
        for (int k = 0; k < 36; k += i ? 35 : 5) {
            snprintf(path, sizeof path, "%s/roll-%03d.png", folder, k);
            if (!find_red(path, middle)) fail_msg("%s: the cube is not whole in picture %d", follows[i], k);
            if (!k) memcpy(first, middle, sizeof first);
            assert_true(hypot(middle[0] - first[0], middle[1] - first[1]) < 0.05);
        }
    }
    // a picture that stands alone is of where it is by then
    outcome o = SKEIN("render", s, "-o", in_folder("one.png"), "--frame", "30", "--follow", "all", "--size", "160x90",
                      "--samples", "1", "--no-progress", "--set", "view.camera.from=[0, 1, 3]");
    assert_status(o, 0);
    outcome_free(&o);
    assert_true(find_red(in_folder("one.png"), middle));
    // else it stands where it sees all of the way, and the cube goes through the picture
    o = SKEIN("render", s, "-o", in_folder("roll-%03d.png"), "--size", "160x90", "--samples", "1", "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    find_red(in_folder("roll-000.png"), first);
    find_red(in_folder("roll-012.png"), middle);
    assert_true(hypot(middle[0] - first[0], middle[1] - first[1]) > 0.2);

    o = SKEIN("check", s, "--set", "view.camera.follow=ball");
    assert_status(o, 2);
    assert_contains(
        o.err, "view.camera.follow: there is no body 'ball': expected a body's name, its number from 0, or \"all\"");
    outcome_free(&o);
    o = SKEIN("check", s, "--set", "view.camera.follow=true");
    assert_status(o, 2);
    assert_contains(o.err, "view.camera.follow: expected a text or its number, not true");
    outcome_free(&o);
}

/* A sheet is led 18 m away from a ball that stays: the camera of a film sees all of that. */
static void what_is_led_stays_in_the_film(void **state) {
    (void)state;
    const char *s = in_folder("led.json");
    write_scene(
        s,
        "{ 'name': 'led', 'frames': 48, 'fps': 4, 'method': { 'type': 'xpbd', 'substeps': 20 }, 'view': { 'pattern': 'none' },"
        "  'bodies': [ { 'type': 'cloth', 'name': 'sheet', 'grid': [8, 8], 'size': [1, 1], 'rotation': [90, 0, 0],"
        "                'position': [0, 1, 0.6], 'pins': 'top edge' } ],"
        "  'forces': [ { 'type': 'gravity' } ],"
        "  'motions': [ { 'type': 'keys', 'on': 'sheet', 'keys': [[0, 0, 0, 0], [12, 18, 0, 0]] } ],"
        "  'colliders': [ { 'type': 'sphere', 'radius': 0.5 } ] }");
    outcome o =
        SKEIN("render", s, "-o", in_folder("led-%02d.png"), "--size", "640x360", "--samples", "1", "--no-progress");
    assert_status(o, 0);
    outcome_free(&o);
    double first[2], middle[2];
    char path[600];
    for (int k = 0; k < 48; k += 47) {
        snprintf(path, sizeof path, "%s/led-%02d.png", folder, k);
        if (!find_red(path, middle)) fail_msg("the sheet is not whole in picture %d", k);
        if (!k) memcpy(first, middle, sizeof first);
    }
    assert_true(middle[0] - first[0] > 0.4);
}

static void wrong_arguments_are_told(void **state) {
    static const struct {
        const char *arguments[6], *words;
    } cases[] = {
        {{"scenes/flag.json"}, "skein render: where to? -o film.mp4, .webm or .gif; -o picture.png; -o many-%04d.png\n"},
        {{"-o", "a.png"}, "skein render: which scene? usage: skein render SCENE -o FILE [options]\n"},
        {{"scenes/flag.json", "-o"}, "skein render: -o takes FILE\n"},
        {{"scenes/flag.json", "--output", "a.png"},
         "skein render: there is no option --output; did you mean --out? `skein render --help` shows all\n"},
        {{"scenes/flag.json", "-o", "a.png", "--sice", "64x36"},
         "skein render: there is no option --sice; did you mean --size? `skein render --help` shows all\n"},
        {{"scenes/flag.json", "-o", "a.png", "--quality", "50"},
         "skein render: --quality: is for films; a PNG loses nothing\n"},
        {{"scenes/flag.json", "-o", "a-##.png", "--frame", "3"},
         "skein render: --frame: is for one picture, -o picture.png; a film takes --frames\n"},
        {{"scenes/flag.json", "-o", "a.png", "--frame", "-1"},
         "skein render: --frame -1: -1 is out of range: expected from 0 to 1e+08\n"},
        {{"scenes/flag.json", "-o", "a.png", "--frame", "now"}, "skein render: --frame now: expected a whole number"},
        {{"scenes/flag.json", "-o", "a.png", "--size", "0x9"}, "skein render: --size 0x9: 0 is out of range: "},
        {{"scenes/flag.json", "-o", "a.png", "--size", "640"}, "skein render: --size 640: expected "},
        {{"scenes/flag.json", "-o", "a.png", "--size", "6x4x2"}, ", as in 1920x1080\n"},
        {{"scenes/flag.json", "-o", "a.png", "--samples", "0"}, "skein render: --samples 0: 0 is out of range: "},
        {{"scenes/flag.json", "-o", "a.png", "--fps", "0"}, "skein render: --fps 0: 0 is out of range: "},
        {{"scenes/flag.json", "-o", "a.png", "--threads", "65"}, "skein render: --threads 65: "},
        {{"scenes/flag.json", "-o", "a.avi"},
         "skein render: -o a.avi: unknown ending '.avi'; can be written here: .mp4, .webm, .gif, .png\n"},
        {{"scenes/flag.json", "-o", "film"}, "skein render: -o film: a name with an ending is needed; can be written"},
        {{"scenes/flag.json", "-o", "a.png", "--set", "frame=3"}, "frames"},
        {{"scenes/none.json", "-o", "a.png"}, "skein: scenes/none.json: cannot read: no such file or directory\n"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT(cases); i++) {
        const char *const *a = cases[i].arguments;
        outcome o = SKEIN("render", a[0], a[1], a[2], a[3], a[4], a[5]);
        const char *words = cases[i].words;
        if (!strstr(words, ".webm, .gif, .png\n") || strstr(o.err, ".webm, .gif, ")) assert_contains(o.err, words);
        assert_string_equal(o.out, "");
        assert_status(o, 2);
        outcome_free(&o);
        assert_false(exists("a.png"));
    }
}

static void help_teaches(void **state) {
    static const char *const options[] = {"-o FILE",     "--out FILE",    "--frames N",      "--frame N",
                                          "--fps N",     "--size WxH",    "--samples N",     "--quality N",
                                          "--threads N", "--no-progress", "--set PATH=VALUE"};
    (void)state;
    outcome o = SKEIN("render", "--help");
    assert_status(o, 0);
    for (size_t i = 0; i < COUNT(options); i++) {
        char words[64];
        snprintf(words, sizeof words, "\n  %s ", options[i]);
        assert_contains(o.out, words);
    }
    assert_contains(o.out, "\n  skein render scenes/flag.json -o flag.mp4 --frames 240\n");
    assert_true(longest_line(o.out) <= 120);
    outcome_free(&o);
}

/* ---- Trouble ------------------------------------------------------------------------------------------ */

/* Said before the first step, which here would take for ever. */
static void a_place_that_cannot_be_written_is_told_at_once(void **state) {
    (void)state;
    const char *s = tiny_scene();
    char words[600];
    outcome o = SKEIN("render", s, "-o", in_folder("no/such/a.png"), "--frame", "100000000", SMALL);
    assert_status(o, 1);
    snprintf(words, sizeof words, "skein: %s: cannot write: its directory does not exist, create it first\n",
             in_folder("no/such/a.png"));
    assert_string_equal(o.err, words);
    assert_string_equal(o.out, "");
    outcome_free(&o);
    assert_int_equal(mkdir(in_folder("dir.png"), 0777), 0);
    o = SKEIN("render", s, "-o", in_folder("dir.png"), "--frame", "100000000", SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "dir.png: cannot write: Is a directory\n");
    outcome_free(&o);
    o = SKEIN("render", s, "-o", in_folder("tiny.json/a.png"), "--frame", "100000000", SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "a.png: cannot write: Not a directory\n");
    outcome_free(&o);
    o = SKEIN("render", s, "-o", in_folder("no/such/a-##.png"), SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "a-00.png: cannot create the file: No such file or directory; make the directory first\n");
    outcome_free(&o);
}

static void a_folder_that_may_not_be_written_is_told(void **state) {
    (void)state;
    if (geteuid() == 0) skip(); // the superuser may write everywhere
    const char *s = tiny_scene();
    assert_int_equal(mkdir(in_folder("closed"), 0555), 0);
    outcome o = SKEIN("render", s, "-o", in_folder("closed/a.png"), "--frame", "100000000", SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "a.png: cannot write: Permission denied\n");
    outcome_free(&o);
}

static void a_full_disk_leaves_the_old_picture(void **state) {
    (void)state;
    const char *s = tiny_scene();
    write_text(in_folder("a.png"), "old");
    outcome o = SKEIN_IN((surroundings){.file_limit = 500}, "render", s, "-o", in_folder("a.png"), SMALL);
    assert_status(o, 1);
    assert_contains(o.err, "a.png: cannot write the file: File too large\n");
    assert_string_equal(o.out, "");
    outcome_free(&o);
    char *kept = read_text(in_folder("a.png"));
    assert_string_equal(kept, "old");
    free(kept);
    assert_int_equal(count_entries(folder), 4); // with the scene and the two captured streams
}

/* Mesa can be told to have less; a driver that cannot is not tested. */
static void without_opengl_it_says_what_to_do(void **state) {
    (void)state;
    const char *s = tiny_scene();
    static const char *const names[] = {"a.png", "a-##.png"};
    for (size_t i = 0; i < COUNT(names); i++) {
        setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
        outcome o = SKEIN("render", s, "-o", in_folder(names[i]), SMALL);
        unsetenv("MESA_GL_VERSION_OVERRIDE");
        if (o.status == 0) {
            outcome_free(&o);
            skip();
        }
        assert_status(o, 1);
        assert_contains(o.err, "skein: EGL: no OpenGL 4.5 to draw with (");
        assert_contains(o.err, "install Mesa's drivers (Debian: apt-get install libegl1 libgl1-mesa-dri)\n");
        assert_int_equal(count_entries(folder), 3); // the scene and the two captured streams
        outcome_free(&o);
    }
}

static void an_interrupted_picture_is_none(void **state) {
    (void)state;
    const struct timespec pause = {0, 300000000};
    pid_t child = start_skein((surroundings){0}, (const char *const[]){"render", tiny_scene(), "-o", in_folder("a.png"),
                                                                       "--frame", "100000000", SMALL, NULL});
    nanosleep(&pause, NULL);
    kill(child, SIGINT);
    outcome o = finish_skein(child);
    assert_true(o.status == 130 || o.status == -SIGINT); // if it had not yet begun
    if (o.status == 130) assert_contains(o.err, "a.png: interrupted in frame ");
    assert_false(exists(in_folder("a.png")));
    outcome_free(&o);
}

static void what_blows_up_is_told(void **state) {
    (void)state;
    const char *s = tiny_scene();
    outcome o = SKEIN("render", s, "-o", in_folder("a.png"), "--frames", "400", SMALL, "--set",
                      "method={\"type\":\"symplectic_euler\",\"substeps\":1}", "--set",
                      "bodies.0.stretch={\"stiffness\":1e7,\"limit\":\"infinite\",\"tether\":\"infinite\"}");
    assert_status(o, 1);
    assert_contains(o.err, "tiny.json: blew up in frame ");
    assert_false(exists(in_folder("a.png")));
    outcome_free(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, make_folder, remove_folder)
        TEST(a_picture_shows_the_frame_that_was_asked_for),
        TEST(sets_reach_the_picture),
        TEST(numbered_pictures_show_frame_by_frame),
        TEST(a_rolling_cube_stays_in_the_picture),
        TEST(what_is_led_stays_in_the_film),
        TEST(wrong_arguments_are_told),
        TEST(help_teaches),
        TEST(a_place_that_cannot_be_written_is_told_at_once),
        TEST(a_folder_that_may_not_be_written_is_told),
        TEST(a_full_disk_leaves_the_old_picture),
        TEST(without_opengl_it_says_what_to_do),
        TEST(an_interrupted_picture_is_none),
        TEST(what_blows_up_is_told),
    };
    return cmocka_run_group_tests_name("command render", tests, NULL, NULL);
}
