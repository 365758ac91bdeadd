/* What is drawn about a flock besides its birds, and the ride on one of them: against what the rules say. */
#include "pictures.h"

#include "render/world_flock.h"
#include "render/world_frame.h"
#include "viewer/flock.h"

#define OK(call) assert_int_equal((call), SKEIN_OK)

static skein_world *rows(size_t count, const double (*x)[3], const double (*v)[3]) {
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    OK(skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", (double)count)), NULL));
    OK(skein_positions_set(world, 0, count, x[0]));
    OK(skein_velocities_set(world, 0, count, v[0]));
    return world;
}

static const double somewhere[6][3] = {{0, 0, 0}, {1, 0, 0}, {0, 4, 0}, {0, 0, -6}, {9, 0, 0}, {0, 0, 6.2}};
static const double onwards[6][3] = {{0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}};

/* The line to each neighbour of the first bird, after the rings. */
static const render_lines *zones_of(render_world_frame *made, skein_world *world, size_t *rings) {
    enum { SIDES = 48, BALL = 3 * SIDES };
    render_world_frame_choose_bird(made, 0);
    OK(render_world_frame_update(made, world, NULL, NULL));
    *rings = 3 * BALL;
    return &render_world_frame_get(made)->lines[RENDER_ZONES];
}

/* Each neighbour has its line in the zone's colour; those that are not seen, too far or not among the nearest have none. */
static void a_chosen_birds_neighbours_are_those_of_the_rule(void **state) {
    (void)state;
    skein_world *world = rows(6, somewhere, onwards);
    skein_handle flocking;
    size_t rings;
    OK(skein_force_add(
        world, "flocking",
        SKEIN_SETTINGS(SKEIN_REAL("separation", 3), SKEIN_REAL("alignment", 2), SKEIN_REAL("cohesion", 2)), &flocking));
    render_world_frame *made = render_world_frame_create(NULL);
    OK(render_world_frame_update(made, world, NULL, NULL));
    assert_int_equal(render_world_frame_get(made)->lines[RENDER_ZONES].count, 0); // nobody is chosen
    const render_lines *lines = zones_of(made, world, &rings);
    assert_int_equal(lines->count, rings + 4);
    static const int nearest_first[] = {1, 2, 3, 5}, colours[] = {0, 1, 2, 2};
    for (size_t i = 0; i < 4; i++) {
        const double *to = &lines->positions[6 * (rings + i) + 3];
        const float *colour = &lines->colours[3 * (rings + i)];
        for (int k = 0; k < 3; k++) {
            assert_float_equal(to[k], somewhere[nearest_first[i]][k], 1e-6);
            if (k != colours[i]) assert_true(colour[colours[i]] > colour[k]);
        }
    }
    // rings as far as zones reach, around the bird
    static const double radii[] = {3, 5, 7};
    for (size_t i = 0; i < rings; i++) {
        const double *p = &lines->positions[6 * i];
        assert_float_equal(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), radii[i * 3 / rings], 1e-6);
    }
    OK(skein_set(world, flocking, "nearest", skein_number(2)));
    assert_int_equal(zones_of(made, world, &rings)->count, rings + 2);
    OK(skein_set(world, flocking, "nearest", skein_number(0)));
    OK(skein_set(world, flocking, "view", skein_number(200))); // not who is straight behind
    assert_int_equal(zones_of(made, world, &rings)->count, rings + 3);
    render_world_frame_destroy(made);
    skein_world_destroy(world);
}

/* By the square, zones are shares of the squared reach: sqrt(3 x 12), sqrt(9 x 12), 12. */
static void zones_by_the_square_are_shares_of_it(void **state) {
    (void)state;
    skein_world *world = rows(6, somewhere, onwards);
    skein_handle flocking;
    double radii[3];
    OK(skein_force_add(
        world, "flocking",
        SKEIN_SETTINGS(SKEIN_REAL("separation", 3), SKEIN_REAL("alignment", 6), SKEIN_REAL("cohesion", 3)), &flocking));
    assert_true(render_flock_zones(world, flocking, radii));
    assert_true(radii[0] == 3 && radii[1] == 9 && radii[2] == 12);
    OK(skein_set(world, flocking, "measure", skein_number(1)));
    assert_true(render_flock_zones(world, flocking, radii));
    assert_float_equal(radii[0], 6, 1e-9);
    assert_float_equal(radii[1], sqrt(108), 1e-9);
    assert_float_equal(radii[2], 12, 1e-9);
    OK(skein_set(world, flocking, "enabled", skein_number(0)));
    assert_false(render_flock_zones(world, flocking, radii));
    skein_world_destroy(world);
}

/* A predator is a bird of its own, where its rule has it, three times as large; one that rests is not there. */
static void a_predator_is_seen_where_it_is(void **state) {
    (void)state;
    skein_world *world = rows(6, somewhere, onwards);
    skein_handle hawk;
    OK(skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_VEC3("position", 3, 20, 5), SKEIN_REAL("radius", 4)),
                       &hawk));
    render_world_frame *made = render_world_frame_create(NULL);
    for (int what = 0; what < 4; what++) {
        // in a place; along a line straight down, which passes the flock's middle level; a bird itself; resting
        static const double ought[3][3] = {{3, 20, 5}, {3, 2, 5}, {0, 4, 0}};
        if (what == 1) OK(skein_set(world, hawk, "line", skein_vector(0, -2, 0)));
        if (what == 2) OK(skein_set(world, hawk, "particle", skein_number(2)));
        if (what == 3) OK(skein_set(world, hawk, "enabled", skein_number(0)));
        OK(render_world_frame_update(made, world, NULL, NULL));
        const render_frame *frame = render_world_frame_get(made);
        assert_int_equal(frame->bird_count, what < 3 ? 2 : 1);
        assert_true((frame->lines[RENDER_ZONES].count > 0) == (what < 3));
        if (what == 3) break;
        assert_float_equal(frame->birds[1].span, 3 * frame->birds[0].span, 1e-9);
        for (int k = 0; k < 3; k++) assert_float_equal(frame->birds[1].positions[k], ought[what][k], 1e-5);
        for (size_t i = 0; i < frame->lines[RENDER_ZONES].count && what != 1; i++) {
            const double *p = &frame->lines[RENDER_ZONES].positions[6 * i], *c = ought[what];
            assert_float_equal(hypot(hypot(p[0] - c[0], p[1] - c[1]), p[2] - c[2]), 4, 1e-5);
        }
    }
    render_world_frame_destroy(made);
    skein_world_destroy(world);
}

/* The eye is at the bird's beak and looks where it flies; after the ride the camera is where it was. */
static void a_rider_sees_what_the_bird_sees(void **state) {
    (void)state;
    static const double turning[6][3] = {{0, 0, 2}, {3, 0, 0}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}};
    skein_world *world = rows(6, somewhere, turning);
    viewer_camera camera = {.lens = {.eye = {1, 0, 20}, .target = {1, 0, 0}, .up = {0, 1, 0}, .fov = 34, .near = 0.1}};
    viewer_ride ride = {.bird = UINT32_MAX};
    const render_camera before = camera.lens;
    viewer_ride_move(&ride, world, &camera, 1, 2); // nobody rides
    assert_memory_equal(&before, &camera.lens, sizeof before);
    assert_true(viewer_ride_toggle(&ride, world, &camera));
    assert_int_equal(ride.bird, 1); // the one that the camera looks at
    viewer_ride_move(&ride, world, &camera, 1, 2);
    const double eye[3] = {1 + 0.3 * 2, 0, 0};
    for (int k = 0; k < 3; k++) assert_float_equal(camera.lens.eye[k], eye[k], 1e-6);
    assert_true(camera.lens.target[0] > eye[0] + 1);
    for (int k = 1; k < 3; k++) assert_float_equal(camera.lens.target[k], 0, 1e-6);
    assert_true(viewer_ride_toggle(&ride, world, &camera));
    assert_memory_equal(&before, &camera.lens, sizeof before);
    // straight up there is no upright: the view is not quite
    OK(skein_velocities_set(world, 1, 1, (const double[]){0, 5, 0}));
    assert_true(viewer_ride_toggle(&ride, world, &camera));
    viewer_ride_move(&ride, world, &camera, 1, 2);
    double right[3], up[3], back[3];
    render_camera_axes(&camera.lens, right, up, back);
    assert_true(back[1] < -0.99 && fabs(right[0]) > 0.99);
    assert_true(viewer_is_bird(world, 5) && !viewer_is_bird(world, 6));
    skein_world_destroy(world);
}

/* A flock that all flies one way, and a ring that mills, as the plots have them: 1 and 0, 0 and 1. */
static void order_is_what_its_definition_says(void **state) {
    (void)state;
    enum { COUNT_OF_RING = 24 };
    double x[COUNT_OF_RING][3], v[COUNT_OF_RING][3];
    for (int i = 0; i < COUNT_OF_RING; i++) {
        double a = 2 * 3.14159265358979323846 * i / COUNT_OF_RING;
        x[i][0] = 7 + 5 * cos(a), x[i][1] = 3, x[i][2] = 5 * sin(a);
        v[i][0] = -2 * sin(a), v[i][1] = 0, v[i][2] = 2 * cos(a);
    }
    skein_world *world = rows(COUNT_OF_RING, (const double(*)[3])x, (const double(*)[3])v);
    skein_order order;
    OK(skein_force_add(world, "attraction", SKEIN_SETTINGS(SKEIN_VEC3("centre", 7, 3, 0)), NULL));
    assert_true(viewer_flock_measure(world, &order));
    assert_float_equal(order.milling, 1, 1e-5);
    assert_float_equal(order.polarization, 0, 1e-5);
    for (size_t i = 0; i < COUNT_OF_RING; i++) OK(skein_velocities_set(world, i, 1, (const double[]){1, 2, -2}));
    assert_true(viewer_flock_measure(world, &order));
    assert_float_equal(order.milling, 0, 1e-5);
    assert_float_equal(order.polarization, 1, 1e-5);
    skein_world_destroy(world);
    world = skein_world_create(NULL, NULL);
    assert_false(viewer_flock_measure(world, &order));
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_chosen_birds_neighbours_are_those_of_the_rule),
        cmocka_unit_test(zones_by_the_square_are_shares_of_it),
        cmocka_unit_test(a_predator_is_seen_where_it_is),
        cmocka_unit_test(a_rider_sees_what_the_bird_sees),
        cmocka_unit_test(order_is_what_its_definition_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
