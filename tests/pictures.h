/* What the tests of pictures share: a place to draw in, and ways to look at what was drawn.
 *
 * One context and one renderer serve all tests of a program, as in a film. Pictures are 640 x 360. */
#ifndef SKEIN_TESTS_PICTURES_H
#define SKEIN_TESTS_PICTURES_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "render/camera.h"
#include "render/context.h"
#include "render/draw.h"
#include "render/image.h"
#include "render/meshes.h"
#include "render/picture.h"
#include "render/planes.h"
#include "render/target.h"
#include "render/world_frame.h"

enum { width = 640, height = 360 };

static const double pi = 3.141592653589793;

static render_context *context;
static render_draw *draw;
static render_target target;
static char directory[] = "/tmp/test_render_XXXXXX";

static inline int set_up(void **state) {
    skein_error error = {0};
    (void)state;
    context = render_context_create(&error);
    if (!context) fprintf(stderr, "%s: %s\n", error.where, error.message);
    assert_non_null(context);
    draw = render_draw_create(&error);
    if (!draw) fprintf(stderr, "%s: %s\n", error.where, error.message);
    assert_non_null(draw);
    assert_int_equal(render_target_create(&target, width, height, 4, &error), SKEIN_OK);
    assert_true(target.samples >= 1 && target.samples <= 4);
    return 0;
}

static inline int tear_down(void **state) {
    (void)state;
    render_target_destroy(&target);
    render_draw_destroy(draw);
    render_context_destroy(context);
    return 0;
}

/* Draws with one renderer or another, and returns the picture; release it. */
static inline render_image shoot_with(render_draw *with, const render_frame *frame, const render_camera *camera) {
    render_image image = {0};
    skein_error error = {0};
    assert_int_equal(render_draw_frame(with, frame, camera, target.framebuffer, width, height, &error), SKEIN_OK);
    assert_int_equal(render_target_read(&target, &image, &error), SKEIN_OK);
    return image;
}

static inline render_image shoot(const render_frame *frame, const render_camera *camera) {
    return shoot_with(draw, frame, camera);
}

/* From `distance` in front of the origin and `above` it, looking at the origin. */
static inline render_camera camera_in_front(double distance, double above) {
    return (render_camera){.eye = {0, above, distance}, .up = {0, 1, 0}, .fov = 40, .near = 0.1};
}

/* The light that a pixel stands for, 0 to 3 x 255, as sRGB numbers. */
static inline int brightness(const render_image *image, int x, int y) {
    const uint8_t *p = render_image_pixel(image, x, y);
    return p[0] + p[1] + p[2];
}

/* The part of the pixels in which one picture differs from another by more than `least` somewhere. */
static inline double difference(const render_image *a, const render_image *b, int least) {
    size_t count = 0, total = (size_t)a->width * (size_t)a->height;
    for (size_t i = 0; i < total; i++) {
        bool differs = false;
        for (size_t k = 0; k < 3; k++) differs |= abs((int)a->pixels[3 * i + k] - (int)b->pixels[3 * i + k]) > least;
        count += differs;
    }
    return (double)count / (double)total;
}

/* The part of the picture that a thing covers: where it differs from the empty picture. */
static inline double coverage(const render_frame *frame, const render_camera *camera) {
    render_frame empty = render_default_frame();
    empty.look = frame->look;
    render_image with = shoot(frame, camera), without = shoot(&empty, camera);
    double part = difference(&with, &without, 6);
    render_image_release(&with);
    render_image_release(&without);
    return part;
}

static inline void assert_near(double is, double ought, double off) {
    if (fabs(is - ought) > off) fprintf(stderr, "%g is not %g +- %g\n", is, ought, off);
    assert_true(fabs(is - ought) <= off);
}

static inline void path_in(char path[256], const char *name) {
    snprintf(path, 256, "%s/%s", directory, name);
}

#endif
