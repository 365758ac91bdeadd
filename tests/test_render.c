/* Tests of render/: frames made by hand, drawn small, and looked at pixel by pixel.
 *
 * One context and one renderer serve all tests, as in a film; the last test looks at whether the driver
 * had anything to say. Pictures are 640 x 360 with a plain camera, so that what must be seen can be
 * computed. */
#include "pictures.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- Helpers -------------------------------------------------------------------------------- */

/* A square of half-width 1 that faces +z. */
static const double square_positions[12] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
static const uint32_t square_triangles[6] = {0, 1, 2, 0, 2, 3};

static render_surface square(void) {
    render_surface surface = {.positions = square_positions,
                              .vertex_count = 4,
                              .triangles = square_triangles,
                              .triangle_count = 2,
                              .shape = 1,
                              .material = render_default_material(0)};
    surface.material.pattern = RENDER_PLAIN;
    return surface;
}

/* ---- What is drawn, and where --------------------------------------------------------------- */

static void a_square_covers_what_it_must(void **state) {
    (void)state;
    render_surface surface = square();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 0);
    frame.surfaces = &surface, frame.surface_count = 1;

    double side = 1 / (6 * tan(20 * pi / 180)); // of half the picture's height
    assert_near(coverage(&frame, &camera), side * side * height / width, 0.004);

    // its own colour in the middle, the sky at the rim
    render_image image = shoot(&frame, &camera);
    const uint8_t *middle = render_image_pixel(&image, width / 2, height / 2), *rim = render_image_pixel(&image, 5, 5);
    assert_true(middle[0] > middle[1] + 60 && middle[0] > middle[2] + 60);
    assert_true(rim[2] > rim[0] && rim[2] > 120);
    render_image_release(&image);
}

static void both_sides_are_drawn(void **state) {
    (void)state;
    render_surface surface = square();
    render_frame frame = render_default_frame();
    frame.surfaces = &surface, frame.surface_count = 1;
    frame.look.sun[0] = 0, frame.look.sun[1] = 0.3, frame.look.sun[2] = 1;
    const float green[3] = {0.1f, 0.6f, 0.1f};
    memcpy(surface.material.lining, green, sizeof green);

    render_camera front = camera_in_front(6, 0), back = front;
    back.eye[2] = -6;
    render_image seen = shoot(&frame, &front), behind = shoot(&frame, &back);
    const uint8_t *p = render_image_pixel(&seen, width / 2, height / 2);
    const uint8_t *q = render_image_pixel(&behind, width / 2, height / 2);
    assert_true(p[0] > p[1] + 60);
    assert_true(q[1] > q[0] + 20);
    // the sun is in front
    assert_true(brightness(&seen, width / 2, height / 2) > brightness(&behind, width / 2, height / 2));
    render_image_release(&seen);
    render_image_release(&behind);
}

static void a_pattern_follows_uv(void **state) {
    static const float uv[8] = {0, 0, 0, 1, 1, 1, 1, 0};
    (void)state;
    render_surface surface = square();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 0);
    frame.surfaces = &surface, frame.surface_count = 1;
    surface.uv = uv;
    surface.shape = 2;
    surface.material.pattern = RENDER_CHECKER;
    surface.material.repeats[0] = surface.material.repeats[1] = 1;

    // two squares each way: neighbours differ, those across are alike
    render_image image = shoot(&frame, &camera);
    int cx = width / 2, cy = height / 2, d = 20;
    int a = brightness(&image, cx - d, cy - d), b = brightness(&image, cx + d, cy - d);
    int c = brightness(&image, cx - d, cy + d), e = brightness(&image, cx + d, cy + d);
    assert_true(abs(a - b) > 80 && abs(a - c) > 80);
    assert_true(abs(a - e) < 20 && abs(b - c) < 20);
    render_image_release(&image);
}

static void a_sphere_covers_what_its_radius_says(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 0);
    frame.spheres = &sphere, frame.sphere_count = 1;
    for (double radius = 0.4; radius < 1.7; radius += 0.4) {
        sphere.radius = radius;
        double disc = tan(asin(radius / 6)) / tan(20 * pi / 180); // of half the picture's height
        double part = pi * disc * disc * height / (4.0 * width);
        assert_near(coverage(&frame, &camera), part, 0.02 * part + 0.001);
    }
}

static void a_spin_shows(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(4, 1);
    frame.spheres = &sphere, frame.sphere_count = 1;
    render_image before = shoot(&frame, &camera);
    const double turns[3][9] = {{0.94, 0, 0.342, 0, 1, 0, -0.342, 0, 0.94},
                                {1, 0, 0, 0, 0.94, -0.342, 0, 0.342, 0.94},
                                {0.94, -0.342, 0, 0.342, 0.94, 0, 0, 0, 1}};
    for (int axis = 0; axis < 3; axis++) {
        memcpy(sphere.rotation, turns[axis], sizeof sphere.rotation);
        render_image after = shoot(&frame, &camera);
        assert_true(difference(&before, &after, 40) > 0.005);
        render_image_release(&after);
    }
    render_image_release(&before);
}

static void particles_and_lines_are_drawn(void **state) {
    static const double places[6] = {-1, 0, 0, 1, 0, 0};
    (void)state;
    render_points points = {.positions = places, .count = 2, .radius = 0.05, .colour = {0.2f, 0.4f, 0.8f}};
    render_lines lines = {.positions = places, .count = 1, .width = 2, .colour = {0.1f, 0.1f, 0.1f}};
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 0);
    frame.points = &points, frame.points_count = 1;
    assert_true(coverage(&frame, &camera) > 0.0002);
    frame.lines = &lines, frame.lines_count = 1;
    render_image image = shoot(&frame, &camera);
    assert_true(brightness(&image, width / 2, height / 2) < 300);
    assert_true(brightness(&image, width / 2, height / 2 - 6) > 500);
    render_image_release(&image);
}

/* ---- Ground, sky and light ------------------------------------------------------------------ */

static const render_plane ground = {{0, 0, 0}, {0, 2, 0}};

static void there_is_ground_and_a_horizon(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame(), bare;
    render_camera camera = camera_in_front(8, 2.2);
    sphere.centre[1] = 1;
    camera.target[1] = 1;
    frame.spheres = &sphere, frame.sphere_count = 1;
    bare = frame;
    frame.planes = &ground, frame.plane_count = 1;

    // with the ground the lower part differs, the sky does not
    render_image with = shoot(&frame, &camera), without = shoot(&bare, &camera);
    size_t above = 0, below = 0;
    for (int x = 0; x < 200; x++) {
        above += abs(brightness(&with, x, 4) - brightness(&without, x, 4)) > 6;
        below += abs(brightness(&with, x, height - 4) - brightness(&without, x, height - 4)) > 6;
    }
    assert_int_equal(above, 0);
    assert_true(below > 150);
    // the sky is bluer than the ground, and they meet without an edge
    const uint8_t *sky = render_image_pixel(&with, 20, 2), *floor = render_image_pixel(&with, 20, height - 10);
    assert_true(sky[2] - sky[0] > floor[2] - floor[0] + 10);
    for (int y = 1; y < height / 2; y++) assert_true(abs(brightness(&with, 20, y) - brightness(&with, 20, y - 1)) < 24);
    render_image_release(&with);
    render_image_release(&without);
}

static void the_shadow_falls_away_from_the_sun(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(0.01, 12);
    sphere.radius = 0.5, sphere.centre[1] = 1;
    frame.spheres = &sphere, frame.sphere_count = 1;
    frame.planes = &ground, frame.plane_count = 1;

    // from above: a sun at 45 degrees on the left moves the shadow one height to the right, and so on round
    const double per_metre = 0.5 * height / (12 * tan(20 * pi / 180));
    const double suns[4][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (int i = 0; i < 4; i++) {
        frame.look.sun[0] = suns[i][0], frame.look.sun[1] = 1, frame.look.sun[2] = suns[i][1];
        render_image image = shoot(&frame, &camera);
        int x = (int)lround(1.1 * per_metre * suns[i][0]), y = (int)lround(1.1 * per_metre * suns[i][1]);
        int shaded = brightness(&image, width / 2 - x, height / 2 - y);
        int lit = brightness(&image, width / 2 + x, height / 2 + y);
        assert_true(shaded < lit - 150);
        render_image_release(&image);
    }
}

static void a_shadow_has_a_soft_edge(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(0.01, 8);
    sphere.radius = 0.5, sphere.centre[1] = 1.5;
    frame.spheres = &sphere, frame.sphere_count = 1;
    frame.planes = &ground, frame.plane_count = 1;
    frame.look.sun[0] = -1, frame.look.sun[1] = 1, frame.look.sun[2] = 0;

    // out of the shadow along its axis: brightness climbs over several pixels; a wider sun makes it more
    int widths[2] = {0, 0};
    for (int i = 0; i < 2; i++) {
        frame.look.sun_spread = i ? 4 : 1.5;
        render_image image = shoot(&frame, &camera);
        int dark = brightness(&image, width / 2 + 93, height / 2 + 3),
            light = brightness(&image, width - 60, height / 2 + 3);
        for (int x = width / 2 + 93; x < width - 60; x++) {
            int here = brightness(&image, x, height / 2 + 3);
            widths[i] += here > dark + (light - dark) / 8 && here < light - (light - dark) / 8;
        }
        render_image_release(&image);
    }
    assert_true(widths[0] >= 3);
    assert_true(widths[1] > widths[0]);
}

static void a_flat_sheet_has_no_shadow_of_its_own(void **state) {
    (void)state;
    render_surface surface = square();
    render_frame frame = render_default_frame();
    frame.surfaces = &surface, frame.surface_count = 1;
    for (double tilt = 0.15; tilt < 1.6; tilt += 0.35) {
        frame.look.sun[0] = -cos(tilt), frame.look.sun[1] = 0.2 * cos(tilt), frame.look.sun[2] = sin(tilt);
        render_camera camera = camera_in_front(4, 0);
        render_image image = shoot(&frame, &camera);
        int least = 765, most = 0;
        for (int y = height / 2 - 80; y < height / 2 + 80; y++) {
            for (int x = width / 2 - 80; x < width / 2 + 80; x++) {
                int here = brightness(&image, x, y);
                least = here < least ? here : least, most = here > most ? here : most;
            }
        }
        assert_true(most - least < 24);
        render_image_release(&image);
    }
}

static void a_symmetric_scene_gives_a_symmetric_picture(void **state) {
    (void)state;
    render_surface surface = square();
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(7, 2);
    frame.surfaces = &surface, frame.surface_count = 1;
    frame.spheres = &sphere, frame.sphere_count = 1;
    frame.planes = &ground, frame.plane_count = 1;
    frame.look.sun[0] = 0;
    sphere.radius = 0.6, sphere.centre[1] = 0.6, sphere.centre[2] = 1.5;
    memcpy(sphere.marking, sphere.colour, sizeof sphere.colour);

    render_image image = shoot(&frame, &camera), mirror = {0};
    assert_int_equal(render_image_resize(&mirror, width, height, NULL), SKEIN_OK);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            memcpy(&mirror.pixels[3 * (y * width + x)], render_image_pixel(&image, width - 1 - x, y), 3);
        }
    }
    assert_true(difference(&image, &mirror, 24) < 0.004);
    render_image_release(&image);
    render_image_release(&mirror);
}

static void a_tilted_plane_is_a_slab(void **state) {
    (void)state;
    render_sphere sphere = render_default_sphere();
    const render_plane slope = {{0, 0, 0}, {0.3, 1, 0.2}};
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 2);
    frame.spheres = &sphere, frame.sphere_count = 1;
    double alone = coverage(&frame, &camera);
    frame.planes = &slope, frame.plane_count = 1;
    double together = coverage(&frame, &camera);
    assert_true(together > alone + 0.03 && together < 0.6);
}

/* ---- Drawing again -------------------------------------------------------------------------- */

static void the_same_frame_gives_the_same_picture(void **state) {
    (void)state;
    render_surface surface = square();
    render_sphere sphere = render_default_sphere();
    render_frame frame = render_default_frame(), other = render_default_frame();
    render_camera camera = camera_in_front(7, 2);
    frame.surfaces = &surface, frame.surface_count = 1;
    frame.spheres = &sphere, frame.sphere_count = 1;
    frame.planes = &ground, frame.plane_count = 1;

    // with another frame between, and by a new renderer
    render_image first = shoot(&frame, &camera), between = shoot(&other, &camera), again = shoot(&frame, &camera);
    render_draw *fresh = render_draw_create(NULL);
    assert_non_null(fresh);
    render_image anew = shoot_with(fresh, &frame, &camera);
    size_t size = (size_t)width * height * 3;
    assert_memory_equal(first.pixels, again.pixels, size);
    assert_memory_equal(first.pixels, anew.pixels, size);
    render_draw_destroy(fresh);
    render_image_release(&first);
    render_image_release(&between);
    render_image_release(&again);
    render_image_release(&anew);
}

static void what_moved_is_drawn_where_it_is(void **state) {
    (void)state;
    double moved[12];
    render_surface surface = square();
    render_frame frame = render_default_frame();
    render_camera camera = camera_in_front(6, 0);
    frame.surfaces = &surface, frame.surface_count = 1;
    render_image before = shoot(&frame, &camera);
    for (int i = 0; i < 12; i++) moved[i] = square_positions[i] + (i % 3 == 0 ? 1.5 : 0);
    surface.positions = moved;
    render_image after = shoot(&frame, &camera);
    render_draw *fresh = render_draw_create(NULL);
    assert_non_null(fresh);
    render_image anew = shoot_with(fresh, &frame, &camera);
    assert_true(difference(&before, &after, 20) > 0.05);
    assert_memory_equal(after.pixels, anew.pixels, (size_t)width * height * 3);
    render_draw_destroy(fresh);
    render_image_release(&before);
    render_image_release(&after);
    render_image_release(&anew);
}

static void numbers_that_are_none_do_no_harm(void **state) {
    (void)state;
    double broken[12];
    memcpy(broken, square_positions, sizeof broken);
    broken[0] = (double)NAN, broken[4] = (double)INFINITY;
    render_surface surface = square();
    render_frame frame = render_default_frame();
    frame.surfaces = &surface, frame.surface_count = 1;
    surface.positions = broken;
    render_bounds bounds = render_frame_bounds(&frame);
    assert_true(isfinite(render_bounds_radius(&bounds)));
    render_camera camera = render_camera_framing(&bounds, 16.0 / 9);
    render_image image = shoot(&frame, &camera);
    render_image_release(&image);
}

static void an_empty_frame_is_sky(void **state) {
    (void)state;
    render_frame frame = render_default_frame();
    render_bounds bounds = render_frame_bounds(&frame);
    assert_true(render_bounds_empty(&bounds));
    render_camera camera = render_camera_framing(&bounds, 16.0 / 9);
    render_image image = shoot(&frame, &camera);
    assert_true(brightness(&image, 3, 3) > 400);
    render_image_release(&image);
}

/* ---- Geometry ------------------------------------------------------------------------------- */

static void flat_normals_are_exact(void **state) {
    static const double positions[12] = {0, 3, 0, 1, 3, 0, 0.3, 3, 0.7, 1.9, 3, 1.1};
    static const uint32_t triangles[6] = {0, 2, 1, 1, 2, 3};
    (void)state;
    float normals[12];
    render_surface surface = {.positions = positions, .vertex_count = 4, .triangles = triangles, .triangle_count = 2};
    render_surface_normals(&surface, normals);
    for (int v = 0; v < 4; v++) {
        assert_true(normals[3 * v] == 0 && normals[3 * v + 1] == 1 && normals[3 * v + 2] == 0);
    }
}

static void welded_vertices_share_a_normal(void **state) {
    // a roof: two slopes that meet at a ridge with vertices of their own
    static const double positions[18] = {-1, 0, 0, 0, 1, 0, 0, 1, 1, 0, 1, 0, 1, 0, 0, 0, 1, 1};
    static const uint32_t triangles[6] = {0, 2, 1, 3, 5, 4}, weld[6] = {0, 1, 2, 1, 4, 2};
    (void)state;
    float apart[18], joined[18];
    render_surface surface = {.positions = positions, .vertex_count = 6, .triangles = triangles, .triangle_count = 2};
    render_surface_normals(&surface, apart);
    surface.weld = weld;
    render_surface_normals(&surface, joined);
    assert_true(apart[3] < -0.5f && apart[9] > 0.5f);
    assert_memory_equal(&joined[3], &joined[9], 3 * sizeof(float));
    assert_true(fabsf(joined[3]) < 1e-6f && joined[4] > 0.99f);
}

static void the_camera_holds_the_whole_box(void **state) {
    static const render_bounds boxes[4] = {
        {{-1, 0, -1}, {1, 2, 1}}, {{-50, 0, -1}, {50, 0.1, 1}}, {{0, 0, 0}, {0.001, 30, 0.001}}, {{7, 7, 7}, {7, 7, 7}}};
    static const double aspects[3] = {16.0 / 9, 1, 0.5};
    (void)state;
    for (int b = 0; b < 4; b++) {
        for (int a = 0; a < 3; a++) {
            render_camera camera = render_camera_framing(&boxes[b], aspects[a]);
            double view[16], projection[16];
            render_camera_view(&camera, view);
            render_camera_projection(&camera, aspects[a], projection);
            assert_true(camera.near > 0 && camera.eye[1] > boxes[b].least[1]);
            for (int c = 0; c < 8; c++) {
                double p[4] = {0, 0, 0, 1}, v[4], w[4];
                for (int k = 0; k < 3; k++) p[k] = c >> k & 1 ? boxes[b].most[k] : boxes[b].least[k];
                for (int r = 0; r < 4; r++)
                    v[r] = view[r] * p[0] + view[4 + r] * p[1] + view[8 + r] * p[2] + view[12 + r];
                for (int r = 0; r < 4; r++) {
                    w[r] = projection[r] * v[0] + projection[4 + r] * v[1] + projection[8 + r] * v[2] +
                           projection[12 + r] * v[3];
                }
                assert_true(fabs(w[0]) < 0.9 * w[3] && fabs(w[1]) < 0.9 * w[3]);
                assert_true(w[2] > 0 && w[2] < w[3]);
            }
        }
    }
}

/* ---- Files ---------------------------------------------------------------------------------- */

static render_image noise(void) {
    render_image image = {0};
    assert_int_equal(render_image_resize(&image, 200, 100, NULL), SKEIN_OK);
    uint32_t random = 1;
    for (size_t i = 0; i < 200 * 100 * 3; i++) {
        random = random * 1664525u + 1013904223u;
        image.pixels[i] = (uint8_t)(random >> 24);
    }
    return image;
}

static void a_png_comes_back_as_it_was(void **state) {
    (void)state;
    char path[256];
    render_image image = noise(), back = {0};
    skein_error error = {0};
    path_in(path, "noise.png");
    assert_int_equal(render_image_write_png(&image, path, &error), SKEIN_OK);
    assert_int_equal(render_image_write_png(&image, path, &error), SKEIN_OK); // over what is there
    assert_int_equal(render_image_read(&back, path, &error), SKEIN_OK);
    assert_int_equal(back.width, 200);
    assert_int_equal(back.height, 100);
    assert_memory_equal(back.pixels, image.pixels, 200 * 100 * 3);
    render_image_release(&image);
    render_image_release(&back);
    assert_int_equal(unlink(path), 0);
}

static void file_errors_say_what_and_where(void **state) {
    (void)state;
    char path[256];
    render_image image = noise();
    skein_error error = {0};
    path_in(path, "no/such/directory.png");
    assert_int_equal(render_image_write_png(&image, path, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.where, path);
    assert_non_null(strstr(error.message, "directory"));

    assert_int_equal(render_image_write_png(&image, directory, &error), SKEIN_ERROR_FILE);
    assert_non_null(strstr(error.message, strerror(EISDIR)));
    assert_int_equal(render_image_write_png(&image, "/dev/full", &error), SKEIN_ERROR_FILE);
    assert_non_null(strstr(error.message, strerror(ENOSPC)));

    path_in(path, "none.png");
    assert_int_equal(render_image_read(&image, path, &error), SKEIN_ERROR_FILE);
    assert_int_equal(render_image_read(&image, "/dev/null", &error), SKEIN_ERROR_FILE);
    assert_non_null(strstr(error.message, "it is a device"));
    // nobody writes into this pipe: whoever waits for that waits for ever
    path_in(path, "pipe");
    assert_int_equal(mkfifo(path, 0666), 0);
    assert_int_equal(render_image_read(&image, path, &error), SKEIN_ERROR_FILE);
    assert_non_null(strstr(error.message, "it is a pipe"));
    assert_int_equal(unlink(path), 0);
    render_image_release(&image);
}

/* What a file of a few bytes says about its size is not taken for memory. */
static void a_picture_is_measured_before_it_is_unpacked(void **state) {
    (void)state;
    static const uint8_t huge[] = {
        0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n', 0, 0, 0, 13, 'I', 'H', 'D', 'R', 0,
        0,    46,  224, 0,   0,    46,   224,  8,    2, 0, 0, 0,  0,   0,   0,   0}; // 12,000^2
    char path[256];
    render_image image = {0};
    skein_error error = {0};
    path_in(path, "huge.png");
    FILE *file = fopen(path, "wb");
    assert_int_equal(fwrite(huge, 1, sizeof huge, file), sizeof huge);
    fclose(file);
    assert_int_equal(render_image_read(&image, path, &error), SKEIN_ERROR_LIMIT);
    assert_non_null(strstr(error.message, "the picture has 12000 x 12000 pixels, and at most 33554432 are read"));
    assert_null(image.pixels);
    assert_int_equal(unlink(path), 0);
}

static void a_full_disk_leaves_nothing(void **state) {
    (void)state;
    char path[256];
    render_image image = noise();
    skein_error error = {0};
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before;
    small.rlim_cur = 4096;
    signal(SIGXFSZ, SIG_IGN);
    path_in(path, "full.png");
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    skein_status status = render_image_write_png(&image, path, &error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    assert_int_equal(status, SKEIN_ERROR_FILE);
    assert_string_equal(error.where, path);
    assert_int_equal(access(path, F_OK), -1); // and main() finds the directory empty
    render_image_release(&image);
}

static void sizes_that_cannot_be_are_refused(void **state) {
    (void)state;
    render_target none = {0};
    skein_error error = {0};
    assert_int_equal(render_target_create(&none, 0, 10, 4, &error), SKEIN_ERROR_VALUE);
    assert_int_equal(render_target_create(&none, 10, 1 << 30, 4, &error), SKEIN_ERROR_VALUE);
    assert_string_equal(error.where, "size");
    assert_non_null(strstr(error.message, "1073741824"));
}

/* ---- Worlds --------------------------------------------------------------------------------- */

static skein_world *cloth_on_a_ball(void) {
    skein_error error = {0};
    skein_world *world = skein_world_create(NULL, &error);
    assert_non_null(world);
    assert_int_equal(skein_body_add(world, "cloth", NULL,
                                    SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 17), SKEIN_PAIR("size", 2, 1),
                                                   SKEIN_VEC3("position", 0, 1.6, 0), SKEIN_VEC3("rotation", 50, 0, 0),
                                                   SKEIN_TEXT("pins", "corners")),
                                    NULL),
                     SKEIN_OK);
    assert_int_equal(skein_collider_add(world, "sphere",
                                        SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.5, 0), SKEIN_REAL("radius", 0.5)),
                                        NULL),
                     SKEIN_OK);
    assert_int_equal(skein_collider_add(world, "plane", NULL, NULL), SKEIN_OK);
    return world;
}

static void a_world_becomes_a_frame(void **state) {
    (void)state;
    skein_error error = {0};
    skein_world *world = cloth_on_a_ball();
    render_world_frame *made = render_world_frame_create(&error);
    assert_int_equal(render_world_frame_update(made, world, NULL, &error), SKEIN_OK);
    const render_frame *frame = render_world_frame_get(made);
    assert_int_equal(frame->surface_count, 1);
    assert_int_equal(frame->surfaces[0].vertex_count, 9 * 17);
    assert_int_equal(frame->surfaces[0].triangle_count, 2 * 8 * 16);
    assert_non_null(frame->surfaces[0].uv);
    assert_true(frame->surfaces[0].uv[2 * (9 * 17 - 1)] == 1 && frame->surfaces[0].uv[2 * (9 * 17 - 1) + 1] == 1);
    assert_int_equal(frame->sphere_count, 1);
    assert_true(frame->spheres[0].centre[1] == 0.5 && frame->spheres[0].radius == 0.5);
    assert_int_equal(frame->plane_count, 1);
    assert_true(render_plane_level(&frame->planes[0]) && !frame->look.floor);
    assert_int_equal(frame->points[1].count, 4); // pins

    // what is hidden is not there; without a plane there is a floor of no effect
    assert_int_equal(skein_set(world, skein_object_at(world, SKEIN_BODY, 0), "visible", skein_number(0)), SKEIN_OK);
    assert_int_equal(skein_set(world, skein_object_at(world, SKEIN_COLLIDER, 1), "visible", skein_number(0)), SKEIN_OK);
    assert_int_equal(render_world_frame_update(made, world, NULL, &error), SKEIN_OK);
    assert_int_equal(frame->surface_count, 0);
    assert_int_equal(frame->points[0].count + frame->points[1].count, 0);
    assert_int_equal(frame->plane_count, 0);
    assert_true(frame->look.floor);
    render_world_frame_destroy(made);
    skein_world_destroy(world);
}

static void a_world_becomes_a_picture(void **state) {
    (void)state;
    char path[256];
    skein_error error = {0};
    skein_world *world = cloth_on_a_ball();
    render_picture_options options = {{320, 180}, 4};
    render_image image = {0};
    path_in(path, "world.png");
    assert_int_equal(render_picture(world, path, &options, NULL, &error), SKEIN_OK);
    assert_int_equal(render_image_read(&image, path, &error), SKEIN_OK);
    assert_int_equal(image.width, 320);
    assert_int_equal(image.height, 180);

    // the cloth is warm, the ball is not, and both are there
    size_t warm = 0, cold = 0;
    for (size_t i = 0; i < 320 * 180; i++) {
        const uint8_t *p = &image.pixels[3 * i];
        warm += p[0] > p[2] + 70;
        cold += p[2] > p[0] + 30 && p[0] < 110;
    }
    assert_true(warm > 300 && cold > 600);
    render_image_release(&image);
    assert_int_equal(unlink(path), 0);

    path_in(path, "no/such/world.png");
    assert_int_equal(render_picture(world, path, &options, NULL, &error), SKEIN_ERROR_FILE);
    options.size[0] = 0;
    assert_int_equal(render_picture(world, path, &options, NULL, &error), SKEIN_ERROR_VALUE);
    skein_world_destroy(world);
}

static void the_exporter_is_described(void **state) {
    (void)state;
    const skein_kind *kind = render_exporter_at(0);
    render_picture_options options = render_default_picture_options();
    assert_non_null(kind);
    assert_null(render_exporter_at(1));
    assert_string_equal(kind->name, "png");
    assert_int_equal(kind->category, SKEIN_EXPORTER);
    assert_int_equal(kind->field_count, 2);
    assert_int_equal(kind->params_size, sizeof options);
    assert_true(options.size[0] == 1280 && options.size[1] == 720 && options.samples == 4);
}

/* ---- The driver, last of all ---------------------------------------------------------------- */

static void the_driver_had_nothing_to_say(void **state) {
    (void)state;
    const render_messages *messages = render_context_messages(context);
    if (messages->errors + messages->warnings > 0) fprintf(stderr, "driver: %s\n", messages->last);
    assert_int_equal(messages->errors, 0);
    assert_int_equal(messages->warnings, 0);
    assert_true(strlen(render_context_name(context)) > 10);
}

/* In a process of its own, because a display remembers what it can; 3 stands for a driver that is not
 * Mesa's and cannot be made to lack anything. */
static void without_opengl_4_5_it_says_what_to_do(void **state) {
    (void)state;
    int result = 0;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        skein_error error = {0};
        setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
        if (render_context_create(&error)) _exit(3);
        fprintf(stderr, "%s: %s\n", error.where, error.message);
        _exit(strstr(error.message, "OpenGL 4.5") && strstr(error.message, "install") ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &result, 0), child);
    assert_true(WIFEXITED(result));
    if (WEXITSTATUS(result) == 3) skip();
    assert_int_equal(WEXITSTATUS(result), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_square_covers_what_it_must),
        cmocka_unit_test(both_sides_are_drawn),
        cmocka_unit_test(a_pattern_follows_uv),
        cmocka_unit_test(a_sphere_covers_what_its_radius_says),
        cmocka_unit_test(a_spin_shows),
        cmocka_unit_test(particles_and_lines_are_drawn),
        cmocka_unit_test(there_is_ground_and_a_horizon),
        cmocka_unit_test(the_shadow_falls_away_from_the_sun),
        cmocka_unit_test(a_shadow_has_a_soft_edge),
        cmocka_unit_test(a_flat_sheet_has_no_shadow_of_its_own),
        cmocka_unit_test(a_symmetric_scene_gives_a_symmetric_picture),
        cmocka_unit_test(a_tilted_plane_is_a_slab),
        cmocka_unit_test(the_same_frame_gives_the_same_picture),
        cmocka_unit_test(what_moved_is_drawn_where_it_is),
        cmocka_unit_test(numbers_that_are_none_do_no_harm),
        cmocka_unit_test(an_empty_frame_is_sky),
        cmocka_unit_test(flat_normals_are_exact),
        cmocka_unit_test(welded_vertices_share_a_normal),
        cmocka_unit_test(the_camera_holds_the_whole_box),
        cmocka_unit_test(a_png_comes_back_as_it_was),
        cmocka_unit_test(file_errors_say_what_and_where),
        cmocka_unit_test(a_picture_is_measured_before_it_is_unpacked),
        cmocka_unit_test(a_full_disk_leaves_nothing),
        cmocka_unit_test(sizes_that_cannot_be_are_refused),
        cmocka_unit_test(a_world_becomes_a_frame),
        cmocka_unit_test(the_exporter_is_described),
        cmocka_unit_test(the_driver_had_nothing_to_say),
    };
    // these make contexts of their own; the first must come before any other
    const struct CMUnitTest alone[] = {
        cmocka_unit_test(without_opengl_4_5_it_says_what_to_do),
        cmocka_unit_test(a_world_becomes_a_picture),
    };
    if (!mkdtemp(directory)) return 1;
    int failed = cmocka_run_group_tests_name("render, alone", alone, NULL, NULL);
    failed += cmocka_run_group_tests_name("render", tests, set_up, tear_down);
    return failed + (rmdir(directory) != 0);
}
