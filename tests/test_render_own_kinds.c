/* What programs register is seen in pictures without another line: a collider by its distance, one with a shape of its
 * own, a body as rods, a force as arrows. */
#include <skein/kinds.h>

#include "pictures.h"

#define OK(call_) assert_int_equal(call_, SKEIN_OK)
#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

/* ---- the kinds: a ball by its distance, with and without a shape, and a peanut, which no shape is like ---- */

typedef struct ball_params {
    double centre[3], radius;
} ball_params;
static const skein_field fields[] = {
    SKEIN_FIELD_OF_VEC3(ball_params, centre, "centre", "m", 0, 0, 0, "the middle"),
    SKEIN_FIELD_OF_REAL(ball_params, radius, "radius", "m", 0.5, 1e-9, 1e9, "the radius"),
};

static void place(const void *data, double position[3]) {
    memcpy(position, ((const ball_params *)data)->centre, 3 * sizeof *position);
}

static double ball_distance(const void *data, double time, const double p[3], double normal[3]) {
    (void)time;
    memcpy(normal, p, 3 * sizeof *normal);
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - ((const ball_params *)data)->radius;
}

static void ball_shape(const void *data, skein_shape *shape) {
    shape->sort = SKEIN_SHAPE_BALL;
    shape->radius = ((const ball_params *)data)->radius;
}

static const skein_collider_type meshed = {
    .kind = {"meshed_ball", "a ball", SKEIN_COLLIDER, fields, COUNT(fields), sizeof(ball_params)},
    .place = place,
    .distance = ball_distance,
};
static const skein_collider_type shaped = {
    .kind = {"shaped_ball", "a ball that says so", SKEIN_COLLIDER, fields, COUNT(fields), sizeof(ball_params)},
    .place = place,
    .distance = ball_distance,
    .shape = ball_shape,
};

static skein_status build_string(skein_builder *builder, const void *params, const skein_mesh *mesh) {
    static const double x[] = {-0.5, 0.5, 0, 0, 0.5, 0, 0.5, 0.5, 0}, masses[] = {1, 1, 1};
    (void)params, (void)mesh;
    return skein_build_particles(builder, 3, x, NULL, masses);
}
static const skein_body_type string = {
    .kind = {"string", "three particles", SKEIN_BODY, NULL, 0, 0},
    .build = build_string,
    .shape = SKEIN_SHAPE_CHAIN,
};
static const skein_force_type outward = {
    .kind = {"outward", "away from the middle", SKEIN_FORCE, NULL, 0, 0},
    .formula = "p",
};

static skein_kinds *kinds;
static render_world_frame *made;

static int set_up_kinds(void **state) {
    static const skein_kind *const all[] = {&meshed.kind, &shaped.kind, &string.kind, &outward.kind};
    int failed = set_up(state);
    kinds = skein_kinds_create(NULL);
    for (size_t i = 0; i < COUNT(all); i++) failed |= skein_kind_register(kinds, all[i], NULL) != SKEIN_OK;
    made = render_world_frame_create(NULL);
    return failed || !made;
}

static int tear_down_kinds(void **state) {
    render_world_frame_destroy(made);
    skein_kinds_destroy(kinds);
    return tear_down(state);
}

static skein_world *make_world(void) {
    skein_world_desc desc = skein_default_world_desc();
    desc.kinds = kinds;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    return world;
}

/* The world goes. A body besides, for a picture of a collider alone has no size. */
static render_image picture_of(skein_world *world) {
    render_view view = render_view_default();
    const render_camera camera = {.eye = {0, 1, 4}, .target = {0, 0.5, 0}, .up = {0, 1, 0}, .fov = 40, .near = 0.1};
    view.ground = false;
    OK(render_world_frame_update(made, world, &view, NULL));
    render_image image = shoot(render_world_frame_get(made), &camera);
    skein_world_destroy(world);
    return image;
}

static render_image picture_with(const char *kind) {
    skein_world *world = make_world();
    OK(skein_body_add(
        world, "cloth", NULL,
        SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_PAIR("size", 0.2, 0.2), SKEIN_VEC3("position", 1, 1, 0)), NULL));
    if (kind) OK(skein_collider_add(world, kind, SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.5, 0)), NULL));
    return picture_of(world);
}

/* ---- tests ---- */

/* All of its outline: as many pixels as a sphere of ours, and nearly the same ones. */
static void a_collider_is_seen_by_its_distance(void **state) {
    (void)state;
    render_image none = picture_with(NULL), ours = picture_with("sphere");
    double covered = difference(&none, &ours, 12);
    assert_true(covered > 0.05);
    static const char *const own[] = {"meshed_ball", "shaped_ball"};
    for (size_t i = 0; i < 2; i++) {
        render_image image = picture_with(own[i]);
        assert_near(difference(&none, &image, 12), covered, 0.1 * covered);
        // where ours is not the empty picture, this one is not, and the other way round
        size_t wrong = 0, count = (size_t)image.width * (size_t)image.height;
        for (size_t p = 0; p < count; p++) {
            int by_ours = 0, by_own = 0;
            for (size_t k = 0; k < 3; k++) {
                by_ours |= abs((int)ours.pixels[3 * p + k] - (int)none.pixels[3 * p + k]) > 12;
                by_own |= abs((int)image.pixels[3 * p + k] - (int)none.pixels[3 * p + k]) > 12;
            }
            wrong += by_ours != by_own;
        }
        assert_true((double)wrong / (double)count < 0.1 * covered);
        if (i) assert_true(difference(&ours, &image, 2) == 0); // who says that it is a ball is drawn as one
        render_image_release(&image);
    }
    render_image_release(&none);
    render_image_release(&ours);
}

static void a_body_is_seen_as_rods(void **state) {
    (void)state;
    skein_world *world = make_world();
    render_view view = render_view_default();
    OK(skein_body_add(world, "string", NULL, NULL, NULL));
    OK(render_world_frame_update(made, world, &view, NULL));
    const render_frame *frame = render_world_frame_get(made);
    assert_int_equal(frame->rod_count, 2);
    assert_near(frame->rods[1].centre[0], 0.25, 1e-6);
    skein_world_destroy(world);
}

static void a_force_is_seen_as_arrows(void **state) {
    (void)state;
    size_t lines[2];
    for (int with = 0; with < 2; with++) {
        skein_world *world = make_world();
        render_view view = render_view_default();
        view.fields = true;
        OK(skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5)), NULL));
        if (with) OK(skein_force_add(world, "outward", NULL, NULL));
        OK(render_world_frame_update(made, world, &view, NULL));
        const render_frame *frame = render_world_frame_get(made);
        lines[with] = 0;
        for (size_t l = 0; l < frame->lines_count; l++) lines[with] += frame->lines[l].count;
        skein_world_destroy(world);
    }
    assert_true(lines[1] > lines[0] + 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_collider_is_seen_by_its_distance),
        cmocka_unit_test(a_body_is_seen_as_rods),
        cmocka_unit_test(a_force_is_seen_as_arrows),
    };
    return cmocka_run_group_tests(tests, set_up_kinds, tear_down_kinds);
}
