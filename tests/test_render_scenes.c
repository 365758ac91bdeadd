/* A picture of every scene in scenes/, 640 x 360, checked for what it must contain; and the "view" of scenes. */
#include "pictures.h"

#include <glob.h>
#include <unistd.h>

#include "io/scene.h"

/* ---- Reading scenes --------------------------------------------------------------------------- */

static char last_fault[sizeof(skein_error)];

static void note_fault(void *user, const skein_error *error) {
    (void)user;
    snprintf(last_fault, sizeof last_fault, "%s: %s", error->where, error->message);
}

static const skein_kind *kinds[2];

/* JSON that has ' in the place of ". */
static io_scene *read_text(const char *text, const char *const *sets, io_faults *faults) {
    char *copy = strdup(text);
    for (char *at = copy; (at = strchr(at, '\'')) != NULL;) *at = '"';
    kinds[0] = render_view_kind();
    io_scene *scene = io_scene_read_text(copy, strlen(copy), "some/where/memory.json", sets, kinds, faults);
    free(copy);
    return scene;
}

static void a_scene_has_a_view(void **state) {
    (void)state;
    const char *const sets[] = {"view.springs=true", "view.camera.from=[1, 2, 3]", NULL};
    io_faults faults = {note_fault, NULL, 0, NULL};
    io_scene *scene = read_text("{'view': {'wireframe': true, 'colour': 'strain', 'image': 'a.png',"
                                " 'camera': {'fov': 50}}}",
                                sets, &faults);
    assert_int_equal(faults.count, 1); // there is no such picture
    assert_non_null(strstr(last_fault, "view.image"));
    faults.count = 0;
    const render_view *view = io_scene_view(scene);
    assert_true(view->wireframe && view->springs && view->surface);
    assert_int_equal(view->colour, RENDER_BY_STRAIN);
    assert_true(view->camera.fov == 50 && view->camera.from[1] == 2);
    assert_string_equal(view->image, "some/where/a.png");
    io_scene_free(scene);

    // without one, and with an absolute path
    scene = read_text("{}", NULL, &faults);
    view = io_scene_view(scene);
    render_view standard = render_view_default();
    assert_string_equal(view->image, "");
    render_view same = *view;
    assert_string_equal(view->camera.follow, "");
    same.camera.follow = standard.camera.follow;
    assert_memory_equal(&same.camera, &standard.camera, sizeof same.camera);
    assert_true(same.line_width == standard.line_width && same.surface == standard.surface);
    io_scene_free(scene);
    scene = read_text("{'view': {'image': '/a.png'}}", NULL, &faults);
    assert_string_equal(((const render_view *)io_scene_view(scene))->image, "/a.png");
    io_scene_free(scene);
    assert_int_equal(faults.count, 1);
    faults.count = 0;

    // a program that draws nothing passes the view over, but it must be an object
    kinds[0] = NULL;
    const char *text = "{\"view\": {\"anything\": 1}}";
    scene = io_scene_read_text(text, strlen(text), "x.json", NULL, kinds, &faults);
    assert_null(io_scene_view(scene));
    assert_int_equal(faults.count, 0);
    io_scene_free(scene);
}

static void assert_fault(const char *text, const char *part) {
    io_faults faults = {note_fault, NULL, 0, NULL};
    last_fault[0] = 0;
    io_scene *scene = read_text(text, NULL, &faults);
    io_scene_free(scene);
    assert_int_equal(faults.count, 1);
    if (!strstr(last_fault, part)) fail_msg("'%s' is not in '%s'", part, last_fault);
}

static void faults_of_a_view_are_told(void **state) {
    (void)state;
    assert_fault("{'view': {'sprigns': true}}", "view.sprigns: view has no field 'sprigns'; did you mean 'springs'?");
    assert_fault("{'view': {'springs': 3}}", "view.springs: expected true or false, not the number 3");
    assert_fault("{'view': {'colour': 'pink'}}", "view.colour: 'pink' is none of material|body|speed|strain");
    assert_fault("{'view': {'camera': {'fov': 0}}}", "view.camera.fov: 0 is out of range: expected from 1 to 150");
    assert_fault("{'view': {'sun': [1, 2]}}", "view.sun: expected three numbers");
    assert_fault("{'view': ['springs']}", "view: expected an object");
}

/* ---- Every scene ------------------------------------------------------------------------------ */

/* What can be told apart by its colour alone, as parts of the picture, of its rows and columns. */
typedef struct parts {
    double warm;                     /* red, orange and yellow: cloth, jelly, ropes */
    double left, right, top, bottom; /* the box around that */
    double dark_blue;                /* colliders' paint */
    double pale;                     /* a bowl's inside: lighter than the ground and yellower than the sky */
    double shade, shade_x;           /* of the ground, and its middle across */
} parts;

typedef struct expectation {
    const char *name;
    int frame;
    double warm;      /* at least so much of the picture */
    double dark_blue; /* at least so much without bodies; 0: none at all */
    double hidden;    /* at least so much of that the bodies hide */
    double pale;      /* at least */
    double azimuth;   /* from where it is the same left and right, or NOT_SYMMETRIC */
} expectation;

#define NOT_SYMMETRIC NAN

/* A scene that is new here must show something warm, sky, ground and a shadow. */
static const expectation expectations[] = {
    {"bowl_masses", 60, 0.015, 0.004, 0, 0.03, 90},
    {"cube_bowl", 40, 0.015, 0.004, 0, 0.03, 90},
    {"cube_plane", 60, 0.06, 0, 0, 0, 20},
    {"cube_slope", 40, 0.06, 0, 0, 0, 90},
    {"cube_sphere", 40, 0.015, 0.05, 0, 0, 90},
    {"drape", 70, 0.06, 0.03, 0.4, 0, NOT_SYMMETRIC},
    {"elephant", 20, 0.006, 0.03, 0, 0, NOT_SYMMETRIC},
    {"flag", 60, 0.06, 0, 0, 0, NOT_SYMMETRIC},
    {"hanging", 60, 0.02, 0, 0, 0, 0},
    {"heap", 4, 0.05, 0, 0, 0, NOT_SYMMETRIC}, // later it lies on its own shadow
    {"orbits", 60, 0.03, 0, 0, 0, NOT_SYMMETRIC},
    {"rope", 45, 0.003, 0.001, 0, 0, NOT_SYMMETRIC},
    {"torus", 90, 0.04, 0.03, 0.3, 0, NOT_SYMMETRIC},
    {"turntable", 60, 0.02, 0.03, 0.15, 0, NOT_SYMMETRIC}, // its folds grow from rounding: in double they differ
    {"wave", 60, 0.01, 0, 0, 0.03, NOT_SYMMETRIC},
    {"whirl", 200, 0.005, 0, 0, 0, NOT_SYMMETRIC},
};

/* One spring that lives: two balls and a line, as the one that is stepped; it was one thick rod. */
static void one_spring_is_two_balls_and_a_line(void **state) {
    static const char *const names[] = {"scenes/one_spring.json", "scenes/one_spring_live.json"};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        io_faults faults = {note_fault, NULL, 0, NULL};
        kinds[0] = render_view_kind();
        io_scene *scene = io_scene_read(names[i], NULL, kinds, &faults);
        skein_world *world = io_scene_build(scene, NULL, &faults);
        skein_error error = {SKEIN_OK, "", ""};
        render_world_frame *made = render_world_frame_create(&error);
        assert_non_null(world);
        assert_int_equal(render_world_frame_update(made, world, io_scene_view(scene), &error), SKEIN_OK);
        const render_frame *frame = render_world_frame_get(made);
        size_t balls = 0, lines = 0;
        for (size_t p = 0; p < frame->points_count; p++) balls += frame->points[p].count;
        for (size_t l = 0; l < frame->lines_count; l++) lines += frame->lines[l].count;
        assert_int_equal(balls, 2);
        assert_int_equal(frame->rod_count, 0);
        assert_true(lines >= 1);
        render_world_frame_destroy(made);
        skein_world_destroy(world);
        io_scene_free(scene);
    }
}

static bool is_warm(const uint8_t *p) {
    return p[0] > p[2] + 60 && p[0] > p[1] + 30;
}

static parts look_at(const render_image *image) {
    parts seen = {.left = 1, .top = 1};
    const double all = width * height;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            const uint8_t *p = render_image_pixel(image, x, y);
            int light = p[0] + p[1] + p[2];
            seen.dark_blue += (p[2] > p[0] + 30 && light < 330) / all;
            seen.pale += (y > height / 6 && p[0] > 222 && p[0] > p[2] + 12 && !is_warm(p)) / all;
            if (y > height / 3 && light < 520 && light > 200 && abs(p[0] - p[2]) < 30)
                seen.shade += 1 / all, seen.shade_x += x / all / width;
            if (!is_warm(p)) continue;
            seen.warm += 1 / all;
            seen.left = fmin(seen.left, (double)x / width), seen.right = fmax(seen.right, (double)x / width);
            seen.top = fmin(seen.top, (double)y / height), seen.bottom = fmax(seen.bottom, (double)y / height);
        }
    seen.shade_x /= seen.shade > 0 ? seen.shade : 1;
    return seen;
}

/* A scene as it stands after some frames, and all that draws it. */
typedef struct stage {
    skein_world *world;
    render_world_frame *made;
    render_camera camera;
} stage;

/* False where the scene needs a mesh that was not fetched. */
static bool set_stage(stage *s, const char *path, int frames) {
    io_faults faults = {note_fault, NULL, 0, NULL};
    skein_error error = {0};
    kinds[0] = render_view_kind();
    io_scene *scene = io_scene_read(path, NULL, kinds, &faults);
    assert_non_null(scene);
    s->world = io_scene_build(scene, NULL, &faults);
    if (!s->world && !strstr(last_fault, "meshes/fetched")) fail_msg("%s", last_fault);
    double dt;
    int steps = io_scene_steps_per_frame(io_scene_get(scene), &dt);
    for (int i = 0; i < frames * steps && s->world; i++) assert_int_equal(skein_world_step(s->world, dt), SKEIN_OK);
    s->made = render_world_frame_create(&error);
    assert_non_null(s->made);
    if (s->world) {
        assert_int_equal(render_world_frame_update(s->made, s->world, io_scene_view(scene), &error), SKEIN_OK);
        render_world_frame_settle(s->made);
        s->camera = render_world_frame_camera(s->made, (double)width / height);
    }
    io_scene_free(scene);
    return s->world != NULL;
}

static void clear_stage(stage *s) {
    render_world_frame_destroy(s->made);
    skein_world_destroy(s->world);
}

/* Blue sky above, the ground's warm grey below, and between them a horizon without a jump. */
static void check_surroundings(const stage *s) {
    render_frame frame = *render_world_frame_get(s->made);
    // nothing stands before them, as in the midst of a bowl
    frame.bowl_count = frame.sphere_count = frame.solid_count = frame.surface_count = frame.points_count = 0;
    render_image image = shoot(&frame, &s->camera);
    const uint8_t *sky = render_image_pixel(&image, 8, 4), *ground = render_image_pixel(&image, 8, height - 5);
    double off[3], half = 0.5 * s->camera.fov * pi / 180;
    for (int k = 0; k < 3; k++) off[k] = s->camera.eye[k] - s->camera.target[k];
    bool horizon = atan2(off[1], hypot(off[0], off[2])) < 0.9 * half; // else it is above the picture
    assert_true(!horizon || sky[2] > sky[0] + 20);
    assert_true(ground[0] > ground[2] + 5 && ground[0] > 130);
    assert_true(!horizon ||
                brightness(&image, width - 9, height / 7) > brightness(&image, 8, height - 5) + 20); // haze far out
    for (int y = 1; y < height / 3; y++)
        assert_true(abs(brightness(&image, width - 9, y) - brightness(&image, width - 9, y - 1)) < 45);
    render_image_release(&image);
}

/* The shadow lies on the sun's far side: where the sun stands on the right, on the left. */
static void check_shadow(const stage *s, const parts *seen) {
    double right[3], up[3], back[3];
    render_frame frame = *render_world_frame_get(s->made);
    render_camera_axes(&s->camera, right, up, back);
    double across = frame.look.sun[0] * right[0] + frame.look.sun[2] * right[2];
    for (int k = 0; k < 3; k += 2) frame.look.sun[k] -= 2 * across * right[k];
    render_image image = shoot(&frame, &s->camera);
    parts other = look_at(&image);
    assert_true(across < -0.2); // the sun stands on the left
    assert_true(seen->shade > 0.002 && other.shade > 0.002);
    if (!(seen->shade_x > other.shade_x + 0.05)) fail_msg("shadows at %g and %g", seen->shade_x, other.shade_x);
    render_image_release(&image);
}

/* From its plane of symmetry, under a sun in that plane, in one colour and without marks, left is as right. */
static void check_symmetry(stage *s, double azimuth) {
    skein_error error = {0};
    render_view view = render_view_default();
    render_bounds bounds = render_frame_bounds(render_world_frame_get(s->made));
    double side = azimuth * pi / 180, away = 4 * render_bounds_radius(&bounds);
    render_bounds_centre(&bounds, view.camera.at);
    view.camera.from[0] = view.camera.at[0] + away * sin(side);
    view.camera.from[1] = view.camera.at[1] + 0.3 * away;
    view.camera.from[2] = view.camera.at[2] + away * cos(side);
    view.colliders = view.grid = false;
    view.colour = RENDER_BY_BODY;
    view.sun[0] = sin(side), view.sun[1] = 1.5, view.sun[2] = cos(side);
    assert_int_equal(render_world_frame_update(s->made, s->world, &view, &error), SKEIN_OK);
    render_camera camera = render_world_frame_camera(s->made, (double)width / height);
    render_image image = shoot(render_world_frame_get(s->made), &camera), mirrored = {0};
    assert_int_equal(render_image_resize(&mirrored, width, height, &error), SKEIN_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            memcpy(&mirrored.pixels[3 * (y * width + x)], render_image_pixel(&image, width - 1 - x, y), 3);
    double off = difference(&image, &mirrored, 24);
    if (off > 0.005) fail_msg("left and right differ in %g of the picture", off);
    render_image_release(&image);
    render_image_release(&mirrored);
}

/* What the picture holds beside what it holds without bodies. */
static void check_parts(const expectation *e, const parts *seen, const parts *bare) {
    assert_true(seen->warm > e->warm && seen->warm < 0.6 && bare->warm < seen->warm / 4);
    assert_true(e->dark_blue > 0 ? bare->dark_blue > e->dark_blue : bare->dark_blue < 0.001);
    assert_true(seen->dark_blue <= (1 - e->hidden) * bare->dark_blue + 0.001);
    assert_true(seen->pale >= e->pale && (e->pale > 0 || bare->pale < 0.02));
}

static size_t count_formulas(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_COLLIDER); i++)
        count += !strcmp(skein_object_kind(world, skein_object_at(world, SKEIN_COLLIDER, i))->name, "formula");
    return count;
}

static bool has_flock(const skein_world *world) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++)
        if (!strcmp(skein_object_kind(world, skein_object_at(world, SKEIN_BODY, i))->name, "flock")) return true;
    return false;
}

static void check_scene(const char *path) {
    expectation e = {NULL, 30, 0.001, -1, 0, 0, NOT_SYMMETRIC};
    stage s;
    const char *name = strrchr(path, '/') + 1;
    for (size_t i = 0; i < sizeof expectations / sizeof *expectations; i++)
        if (strlen(expectations[i].name) == strcspn(name, ".") &&
            !strncmp(name, expectations[i].name, strcspn(name, ".")))
            e = expectations[i];
    if (!set_stage(&s, path, e.frame)) {
        fprintf(stderr, "%s: its mesh was not fetched\n", path);
        clear_stage(&s);
        return;
    }
    if (has_flock(s.world)) { // birds cast their shadows from high up: test_render_birds.c looks at them
        clear_stage(&s);
        return;
    }
    render_frame without = *render_world_frame_get(s.made);
    size_t formulas = count_formulas(s.world); // their surfaces come last
    without.surfaces += without.surface_count - formulas;
    without.surface_count = formulas;
    without.rod_count = without.points_count = 0;
    render_image image = shoot(render_world_frame_get(s.made), &s.camera), empty = shoot(&without, &s.camera);
    parts seen = look_at(&image), bare = look_at(&empty);
    fprintf(stderr, "%s: warm %.4f (%.4f without), dark blue %.4f (%.4f), pale %.4f (%.4f), shade %.4f at %.2f\n", path,
            seen.warm, bare.warm, seen.dark_blue, bare.dark_blue, seen.pale, bare.pale, seen.shade, seen.shade_x);
    if (e.name) check_parts(&e, &seen, &bare);
    // all of it is there, and not at the rim
    assert_true(seen.warm > 0.001);
    assert_true(seen.left > 0.02 && seen.right < 0.98 && seen.top > 0.02 && seen.bottom < 0.98);
    check_surroundings(&s);
    // slopes and walls are dark, too, away from the sun
    bool terrain = (without.surface_count && without.surfaces[0].scenery) || without.bowl_count;
    if (!terrain) check_shadow(&s, &seen);
    if (!isnan(e.azimuth)) check_symmetry(&s, e.azimuth);
    render_image_release(&image);
    render_image_release(&empty);
    clear_stage(&s);
}

static void every_scene_has_what_it_must(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob("scenes/*.json", 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= sizeof expectations / sizeof *expectations);
#ifdef __SANITIZE_ADDRESS__ // a twentieth of the speed: some will do
    enum { STRIDE = 4 };
#else
    enum { STRIDE = 1 };
#endif
    for (size_t i = 0; i < found.gl_pathc; i += STRIDE) check_scene(found.gl_pathv[i]);
    globfree(&found);
}

static void the_driver_had_nothing_to_say(void **state) {
    (void)state;
    const render_messages *messages = render_context_messages(context);
    if (messages->errors + messages->warnings > 0) fprintf(stderr, "driver: %s\n", messages->last);
    assert_int_equal(messages->errors + messages->warnings, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_has_a_view),
        cmocka_unit_test(faults_of_a_view_are_told),
        cmocka_unit_test(one_spring_is_two_balls_and_a_line),
        cmocka_unit_test(every_scene_has_what_it_must),
        cmocka_unit_test(the_driver_had_nothing_to_say),
    };
    if (!mkdtemp(directory)) return 1;
    int failed = cmocka_run_group_tests_name("render, scenes", tests, set_up, tear_down);
    return failed + (rmdir(directory) != 0);
}
