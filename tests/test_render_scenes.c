/* A picture of every scene in scenes/, checked for what it must contain; and the "view" of scenes. */
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
    io_faults faults = {note_fault, NULL, 0};
    io_scene *scene = read_text("{'view': {'wireframe': true, 'colour': 'strain', 'image': 'a.png',"
                                " 'camera': {'fov': 50}}}",
                                sets, &faults);
    assert_int_equal(faults.count, 0);
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
    same.image = standard.image;
    assert_memory_equal(&same.camera, &standard.camera, sizeof same.camera);
    assert_true(same.line_width == standard.line_width && same.surface == standard.surface);
    io_scene_free(scene);
    scene = read_text("{'view': {'image': '/a.png'}}", NULL, &faults);
    assert_string_equal(((const render_view *)io_scene_view(scene))->image, "/a.png");
    io_scene_free(scene);
    assert_int_equal(faults.count, 0);

    // a program that draws nothing passes the view over, but it must be an object
    kinds[0] = NULL;
    const char *text = "{\"view\": {\"anything\": 1}}";
    scene = io_scene_read_text(text, strlen(text), "x.json", NULL, kinds, &faults);
    assert_null(io_scene_view(scene));
    assert_int_equal(faults.count, 0);
    io_scene_free(scene);
}

static void assert_fault(const char *text, const char *part) {
    io_faults faults = {note_fault, NULL, 0};
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

/* The scene's world after some frames; NULL where it needs a mesh that was not fetched. */
static skein_world *world_of(const char *path, int frames) {
    static const char *const sets[] = {"method.substeps=5", NULL}; // it need not be stiff to be seen
    io_faults faults = {note_fault, NULL, 0};
    kinds[0] = render_view_kind();
    io_scene *scene = io_scene_read(path, sets, kinds, &faults);
    assert_non_null(scene);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    if (!world && !strstr(last_fault, "meshes/fetched")) fail_msg("%s", last_fault);
    double dt;
    int steps = io_scene_steps_per_frame(io_scene_get(scene), &dt);
    for (int i = 0; i < frames * steps && world; i++) assert_int_equal(skein_world_step(world, dt), SKEIN_OK);
    io_scene_free(scene);
    return world;
}

static bool is_warm(const uint8_t *p) {
    return p[0] > p[1] + 50 && p[0] > p[2] + 50;
}

/* The part of a row's pixels that are darker than `most`. */
static double dark_part(const render_image *image, int from, int to, int most) {
    size_t dark = 0, all = 0;
    for (int y = height / 3; y < height; y++) {
        for (int x = from; x < to; x++, all++) dark += brightness(image, x, y) < most;
    }
    return (double)dark / (double)all;
}

static void check_scene(const char *path) {
    skein_error error = {0};
    skein_world *world = world_of(path, 30);
    if (!world) return;
    render_world_frame *made = render_world_frame_create(&error);
    assert_int_equal(render_world_frame_update(made, world, NULL, &error), SKEIN_OK);
    render_world_frame_settle(made);
    const render_frame *frame = render_world_frame_get(made);
    render_camera camera = render_world_frame_camera(made, (double)width / height);
    render_image image = shoot(frame, &camera);

    // cloth, neither a speck nor everything; all of it inside the picture's rim
    size_t warm = 0, rim = 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            bool is = is_warm(render_image_pixel(&image, x, y));
            warm += is;
            rim += is && (x < 10 || y < 10 || x >= width - 10 || y >= height - 10);
        }
    }
    if (warm < width * height / 200 || warm > width * height / 2) fail_msg("%s: %zu pixels of cloth", path, warm);
    assert_int_equal(rim, 0);

    // blue sky above, the ground's warm grey below, and a horizon between them without a jump
    const uint8_t *sky = render_image_pixel(&image, 8, 4), *ground = render_image_pixel(&image, 8, height - 5);
    assert_true(sky[2] > sky[0] + 20);
    assert_true(ground[0] > ground[2] + 5 && ground[0] > 130);
    int least = 765;
    for (int y = 1; y < height; y++) {
        least = brightness(&image, 8, y) < least ? brightness(&image, 8, y) : least;
        assert_true(abs(brightness(&image, 8, y) - brightness(&image, 8, y - 1)) < 45);
    }
    assert_true(brightness(&image, 8, height / 4) > brightness(&image, 8, height - 5) + 20); // haze far out

    // the sun stands on the left: the shadow is on the right
    double left = dark_part(&image, 0, width / 4, least - 60), right = dark_part(&image, width / 2, width, least - 60);
    if (!(right > 0.01 && left == 0)) fail_msg("%s: shadows left %g, right %g", path, left, right);

    // with a sun on the right it is on the left
    render_frame mirrored = *frame;
    mirrored.look.sun[0] = -mirrored.look.sun[0];
    render_image other = shoot(&mirrored, &camera);
    assert_true(dark_part(&other, 0, width / 2, least - 60) > dark_part(&image, 0, width / 2, least - 60));
    render_image_release(&image);
    render_image_release(&other);
    render_world_frame_destroy(made);
    skein_world_destroy(world);
}

static void every_scene_has_what_it_must(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob("scenes/*.json", 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= 4);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        fprintf(stderr, "%s\n", found.gl_pathv[i]);
        check_scene(found.gl_pathv[i]);
    }
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
        cmocka_unit_test(every_scene_has_what_it_must),
        cmocka_unit_test(the_driver_had_nothing_to_say),
    };
    if (!mkdtemp(directory)) return 1;
    int failed = cmocka_run_group_tests_name("render, scenes", tests, set_up, tear_down);
    return failed + (rmdir(directory) != 0);
}
