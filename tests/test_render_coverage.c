/* What pictures are about fills them: in every scene the bodies' particles cover a quarter of the picture's width and
 * height, at the moment of the scene's own still and some seconds before.
 *
 * Particles are projected here by the camera's matrices; nothing is drawn, so that no driver is needed. */
#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "helpers.h"
#include "io/scene.h"
#include "render/world_frame.h"

static const double aspect = 16.0 / 9, quarter = 0.25;

/* ---- Coverage ------------------------------------------------------------------------------- */

typedef struct covered {
    double share[2]; /* of the picture's width and height, between the outermost particles that are in it */
    double inside;   /* part of all particles */
} covered;

static covered measure(const skein_world *world, const render_camera *camera) {
    double view[16], projection[16], least[2] = {1, 1}, most[2] = {-1, -1};
    size_t count = skein_particle_count(world), inside = 0;
    double *x = malloc(3 * count * sizeof *x + 1);
    assert_non_null(x);
    assert_int_equal(skein_positions_copy(world, 0, count, x), SKEIN_OK);
    render_camera_view(camera, view);
    render_camera_projection(camera, aspect, projection);
    for (size_t p = 0; p < count; p++) {
        double v[3], screen[2];
        for (int r = 0; r < 3; r++)
            v[r] = view[r] * x[3 * p] + view[4 + r] * x[3 * p + 1] + view[8 + r] * x[3 * p + 2] + view[12 + r];
        if (!(v[2] < -camera->near)) continue;
        screen[0] = projection[0] * v[0] / -v[2], screen[1] = projection[5] * v[1] / -v[2];
        if (fabs(screen[0]) > 1 || fabs(screen[1]) > 1) continue;
        inside++;
        for (int k = 0; k < 2; k++) least[k] = fmin(least[k], screen[k]), most[k] = fmax(most[k], screen[k]);
    }
    free(x);
    return (covered){{fmax(0.5 * (most[0] - least[0]), 0), fmax(0.5 * (most[1] - least[1]), 0)},
                     (double)inside / (double)count};
}

static void check_moment(const char *path, const io_scene *scene, skein_world *world, int frame, double *low) {
    skein_error error = {0};
    render_world_frame *made = render_world_frame_create(&error);
    assert_non_null(made);
    if (render_world_frame_update(made, world, io_scene_view(scene), &error)) fail_msg("%s: %s", path, error.message);
    render_world_frame_settle(made);
    render_camera camera = render_world_frame_camera(made, aspect);
    covered c = measure(world, &camera);
    fprintf(stderr, "%s, frame %d: %.0f %% of the width, %.0f %% of the height, %.1f %% of the particles\n", path, frame,
            100 * c.share[0], 100 * c.share[1], 100 * c.inside);
    if (c.share[0] < quarter || c.share[1] < quarter || c.inside < 0.9) *low += 1;
    render_world_frame_destroy(made);
}

static void ignore_fault(void *user, const skein_error *fault) {
    snprintf(user, 400, "%.100s: %.280s", fault->where, fault->message);
}

/* After two seconds, and at the end: where `skein render` takes its picture. */
static void check_scene(const char *path, double *low) {
    static const skein_kind *kinds[2];
    char fault[400] = "";
    io_faults faults = {ignore_fault, fault, 0};
    kinds[0] = render_view_kind();
    io_scene *scene = io_scene_read(path, NULL, kinds, &faults);
    if (!scene) fail_msg("%s", fault);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    if (!world && !strstr(fault, "meshes/fetched")) fail_msg("%s", fault);
    const io_scene_settings *settings = io_scene_get(scene);
    double dt;
    int steps = io_scene_steps_per_frame(settings, &dt), early = (int)(2 * settings->fps);
    for (int frame = 1; world && frame <= settings->frames; frame++) {
        for (int s = 0; s < steps; s++) assert_int_equal(skein_world_step(world, dt), SKEIN_OK);
        if (frame == early || frame == settings->frames) check_moment(path, scene, world, frame, low);
    }
    skein_world_destroy(world);
    io_scene_free(scene);
}

static void bodies_cover_a_quarter_of_every_scenes_picture(void **state) {
    (void)state;
    glob_t found;
    double low = 0;
    assert_int_equal(glob("scenes/*.json", 0, NULL, &found), 0);
#ifdef __SANITIZE_ADDRESS__ // a twentieth of the speed: some will do
    enum { STRIDE = 5 };
#else
    enum { STRIDE = 1 };
#endif
    for (size_t i = 0; i < found.gl_pathc; i += STRIDE) check_scene(found.gl_pathv[i], &low);
    globfree(&found);
    assert_true(low == 0);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hulls_reach_as_far_as_what_is_in_them),
        cmocka_unit_test(surroundings_make_room_for_what_a_picture_is_about),
        cmocka_unit_test(bodies_cover_a_quarter_of_every_scenes_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
