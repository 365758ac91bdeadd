/* What pictures are about fills them: in every scene the bodies cover a quarter of the picture's width and height, in
 * stills, in the gallery and in the window.
 *
 * They are drawn and taken away again, without shadows: what differs is what they cover. Particles that are projected
 * by the camera's matrices tell how many of them are in the picture at all. */
#include "pictures.h"

#include <glob.h>

#include "helpers.h"
#include "io/scene.h"
#include "sparing.h"

enum { small_width = 160, small_height = 90, beside_panel = 112 };

static const double aspect = 16.0 / 9, quarter = 0.25;

/* ---- Coverage ------------------------------------------------------------------------------- */

typedef struct covered {
    double share[2]; /* of the picture's width and height, between the outermost pixels of the bodies */
    double inside;   /* part of all particles */
} covered;

static double part_inside(const skein_world *world, const render_camera *camera, double ratio) {
    double view[16], projection[16];
    size_t count = skein_particle_count(world), inside = 0;
    double *x = malloc(3 * count * sizeof *x + 1);
    assert_non_null(x);
    assert_int_equal(skein_positions_copy(world, 0, count, x), SKEIN_OK);
    render_camera_view(camera, view);
    render_camera_projection(camera, ratio, projection);
    for (size_t p = 0; p < count; p++) {
        double v[3];
        for (int r = 0; r < 3; r++)
            v[r] = view[r] * x[3 * p] + view[4 + r] * x[3 * p + 1] + view[8 + r] * x[3 * p + 2] + view[12 + r];
        inside += v[2] < -camera->near && fabs(projection[0] * v[0]) <= -v[2] && fabs(projection[5] * v[1]) <= -v[2];
    }
    free(x);
    return (double)inside / (double)count;
}

static render_image draw_small(const render_frame *frame, const render_camera *camera, int wide) {
    render_image image = {0};
    skein_error error = {0};
    render_target small = {0};
    assert_int_equal(render_target_create(&small, wide, small_height, 4, &error), SKEIN_OK);
    assert_int_equal(render_draw_frame(draw, frame, camera, small.framebuffer, wide, small_height, &error), SKEIN_OK);
    assert_int_equal(render_target_read(&small, &image, &error), SKEIN_OK);
    render_target_destroy(&small);
    return image;
}

/* The box around the pixels that differ. */
static covered compare(const render_image *a, const render_image *b) {
    int least[2] = {a->width, a->height}, most[2] = {-1, -1};
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            const uint8_t *p = render_image_pixel(a, x, y), *q = render_image_pixel(b, x, y);
            int off = 0;
            for (int k = 0; k < 3; k++) off += abs(p[k] - q[k]);
            if (off < 24) continue;
            least[0] = x < least[0] ? x : least[0], most[0] = x > most[0] ? x : most[0];
            least[1] = y < least[1] ? y : least[1], most[1] = y > most[1] ? y : most[1];
        }
    covered c = {{0, 0}, 0};
    if (most[0] < 0) return c;
    c.share[0] = (most[0] - least[0] + 1) / (double)a->width;
    c.share[1] = (most[1] - least[1] + 1) / (double)a->height;
    return c;
}

static size_t count_formulas(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_COLLIDER); i++)
        count += !strcmp(skein_object_kind(world, skein_object_at(world, SKEIN_COLLIDER, i))->name, "formula");
    return count;
}

/* What bodies cover, or, with `around`, they and the colliders that are no ground. */
static covered measure(const skein_world *world, const render_frame *frame, const render_camera *camera, int wide,
                       bool around) {
    render_frame with = *frame;
    with.look.plain = true; // no shadows, and ground and haze of one measure
    render_bounds bounds = render_frame_bounds(frame);
    with.radius = fmax(render_bounds_radius(&bounds), 1e-3);
    render_bounds_centre(&bounds, with.middle);
    render_frame bare = with;
    size_t formulas = count_formulas(world), own = frame->surface_count - formulas; // their surfaces come last
    while (around && own < frame->surface_count && !frame->surfaces[own].scenery) own++;
    bare.surfaces += own, bare.surface_count -= own;
    bare.rod_count = bare.points_count = bare.bird_count = bare.lines_count = 0;
    if (around) bare.sphere_count = bare.solid_count = bare.bowl_count = 0;
    render_image full = draw_small(&with, camera, wide), empty = draw_small(&bare, camera, wide);
    covered c = compare(&full, &empty);
    c.inside = part_inside(world, camera, (double)wide / small_height);
    render_image_release(&full);
    render_image_release(&empty);
    return c;
}

/* ---- Moments of scenes ---------------------------------------------------------------------- */

/* A picture as stills and cards have it, which is `settled`, or as a window has it when it opens there. */
static void check_picture(const char *path, const io_scene *scene, skein_world *world, int frame, bool window,
                          int *low) {
    skein_error error = {0};
    int wide = window ? beside_panel : small_width;
    render_world_frame *made = render_world_frame_create(&error);
    assert_non_null(made);
    if (render_world_frame_update(made, world, io_scene_view(scene), &error)) fail_msg("%s: %s", path, error.message);
    if (!window) render_world_frame_settle(made);
    render_camera camera = render_world_frame_camera(made, (double)wide / small_height);
    const render_frame *drawn = render_world_frame_get(made);
    covered bodies = measure(world, drawn, &camera, wide, false), all = bodies;
    // a sheet that was not let go yet is low, however high the eye: what it is to fall on counts as well
    bool sheet = render_world_frame_subject(made).has_sheet;
    if (sheet) all = measure(world, drawn, &camera, wide, true);
    bool good = all.share[0] >= quarter && all.share[1] >= (sheet && window ? 0.2 : quarter) &&
                bodies.share[0] >= quarter && bodies.share[1] >= (sheet ? 0.1 : quarter) && bodies.inside >= 0.85;
    // a band that is several times as long as wide fills the picture along itself
    double along = fmax(bodies.share[0], bodies.share[1]), across = fmin(bodies.share[0], bodies.share[1]);
    good |= along >= 0.65 && across >= 0.1 && bodies.inside >= 0.85;
    fprintf(stderr, "%s, frame %d%s: %.0f %% of the width, %.0f %% of the height, %.1f %% of the particles%s\n", path,
            frame, window ? ", window" : "", 100 * bodies.share[0], 100 * bodies.share[1], 100 * bodies.inside,
            good ? "" : ": too small");
    *low += !good;
    render_world_frame_destroy(made);
}

static void ignore_fault(void *user, const skein_error *fault) {
    snprintf(user, 400, "%.100s: %.280s", fault->where, fault->message);
}

/* The window's first picture; the gallery's card; what is seen after two seconds; and `skein render`'s still. */
static void check_scene(const char *path, int *low) {
    static const skein_kind *kinds[2];
    char fault[400] = "";
    io_faults faults = {ignore_fault, fault, 0, NULL};
    kinds[0] = render_view_kind();
    io_scene *scene = io_scene_read(path, NULL, kinds, &faults);
    if (!scene) fail_msg("%s", fault);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    if (!world && !strstr(fault, "meshes/fetched")) fail_msg("%s", fault);
    const io_scene_settings *settings = io_scene_get(scene);
    double dt;
    int steps = io_scene_steps_per_frame(settings, &dt), early = (int)(2 * settings->fps), last = settings->frames;
    int card = (int)fmin(fmax(0.3 * last, 1), 150);
    for (int frame = 0; world && frame <= last; frame++) {
        for (int s = 0; s < steps && frame; s++) assert_int_equal(skein_world_step(world, dt), SKEIN_OK);
        if (frame == 0) check_picture(path, scene, world, frame, true, low);
        if (frame == 0 || frame == card || frame == early || frame == last)
            check_picture(path, scene, world, frame, false, low);
    }
    skein_world_destroy(world);
    io_scene_free(scene);
}

static void bodies_cover_a_quarter_of_every_scenes_picture(void **state) {
    (void)state;
    glob_t found;
    int low = 0;
    assert_int_equal(glob("scenes/*.json", 0, NULL, &found), 0);
    // a twentieth of the speed: some will do
    for (size_t i = 0; i < found.gl_pathc; i += SPARING ? 14 : 1) check_scene(found.gl_pathv[i], &low);
    globfree(&found);
    assert_int_equal(low, 0);
}

/* ---- Choosing the camera -------------------------------------------------------------------- */

/* A large thing beside a small one is cut off before the small one is lost; one that leaves it large is all there. */
static void surroundings_make_room_for_what_a_picture_is_about(void **state) {
    (void)state;
    const double from[3] = {0.3, 0.2, 1}, small[3] = {0, 0, 0}, beside[3] = {1.2, 0, 0};
    for (int large = 0; large < 2; large++) {
        render_subject subject = render_subject_nothing();
        double shares[2], all[2];
        render_hull_add(&subject.bodies, small, 0.5);
        subject.all = subject.bodies;
        render_hull_add(&subject.all, beside, large ? 4 : 0.2);
        render_camera camera = render_camera_hold(&subject, from, 34, 1, aspect);
        render_camera_share(&camera, &subject.bodies, aspect, shares);
        render_camera_share(&camera, &subject.all, aspect, all);
        assert_true(fmin(shares[0], shares[1]) >= 0.3 || !large);
        assert_true(fmax(all[0], all[1]) > 0.6 && (fmax(all[0], all[1]) > 1) == large);
    }
}

/* What was put together is as far as the farther of both, along any direction. */
static void hulls_reach_as_far_as_what_is_in_them(void **state) {
    (void)state;
    render_hull a = render_hull_nothing(), b = render_hull_nothing();
    const double p[3] = {-1, 2, 5}, q[3] = {4, -3, 0.5}, lost[3] = {NAN, 0, 0};
    assert_true(render_hull_empty(&a));
    render_hull_add(&a, lost, 1);
    assert_true(render_hull_empty(&a));
    render_hull_add(&a, p, 0.5);
    render_hull_add(&b, q, 1);
    render_hull_join(&a, &b);
    render_bounds bounds = render_hull_bounds(&a);
    const double least[3] = {-1.5, -4, -0.5}, most[3] = {5, 2.5, 5.5};
    for (int k = 0; k < 3; k++) {
        assert_near(bounds.least[k], least[k], 1e-12);
        assert_near(bounds.most[k], most[k], 1e-12);
    }
    render_hull middle = render_hull_between(&b, &a, 0.5);
    bounds = render_hull_bounds(&middle);
    assert_near(bounds.least[0], 0.5 * (3 - 1.5), 1e-12);
}

/* The eye goes up until a sheet that lies high is not seen on its edge, in a film, too, that begins with it; where a
 * scene says how high the eye is to be, it is there. */
static void a_level_sheet_is_seen_from_above(void **state) {
    (void)state;
    static const uint32_t triangles[6] = {0, 1, 2, 2, 1, 3};
    static const double sheet[12] = {-1, 2, -1, 1, 2, -1, -1, 2, 1, 1, 2, 1};
    static const double hanging[12] = {-1, 2, -1, 1, 2, -1, -1, 0, 0, 1, 0, 0};
    const render_surface surface = {.positions = sheet, .vertex_count = 4, .triangles = triangles, .triangle_count = 2};
    render_surface later = surface;
    render_frame frame = render_default_frame(), after = frame;
    render_sphere ball = render_default_sphere();
    frame.surfaces = &surface, frame.surface_count = 1, frame.spheres = &ball, frame.sphere_count = 1;
    later.positions = hanging;
    after.surfaces = &later, after.surface_count = 1;
    render_view view = render_view_default();
    render_subject both = render_subject_of(&after), level = render_subject_of(&frame);
    assert_true(level.has_sheet && !both.has_sheet);
    render_subject_join(&both, &level);
    assert_true(both.has_sheet && both.sheet[1] == 2);
    for (int given = 0; given < 2; given++) {
        if (given) view.camera.elevation = 5;
        render_camera camera = render_camera_of_view(&view.camera, &both, 0, aspect);
        double seen = atan2(camera.eye[1] - 2, hypot(camera.eye[0], camera.eye[2])) * 180 / pi;
        double pitch = atan2(camera.eye[1] - camera.target[1],
                             hypot(camera.eye[0] - camera.target[0], camera.eye[2] - camera.target[2])) *
                       180 / pi;
        if (given) assert_near(pitch, 5, 1e-6);
        else assert_true(seen > 6.5 && pitch < 40);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hulls_reach_as_far_as_what_is_in_them),
        cmocka_unit_test(surroundings_make_room_for_what_a_picture_is_about),
        cmocka_unit_test(a_level_sheet_is_seen_from_above),
        cmocka_unit_test(bodies_cover_a_quarter_of_every_scenes_picture),
    };
    if (!mkdtemp(directory)) return 1;
    int failed = cmocka_run_group_tests_name("render, coverage", tests, set_up, tear_down);
    return failed + (rmdir(directory) != 0);
}
