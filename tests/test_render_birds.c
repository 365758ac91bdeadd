/* Tests of drawn birds: they fly where their velocities point, their wings beat as they should, and a card's birds look
 * like the processor's without being read back. */
#include "pictures.h"

#include "render/birds.h"
#include "world/world.h"

#include <epoxy/gl.h>

#define OK(call_) assert_int_equal((call_), SKEIN_OK)

/* ---- Wings -------------------------------------------------------------------------------------- */

/* Three birds: one that stands, one that flies straight, one that flies a circle. */
static const double speed = 8, turn = 1.5; /* m/s, rad/s */

static void place_birds(double time, float positions[3][4], float velocities[3][4]) {
    memset(positions, 0, 12 * sizeof(float));
    memset(velocities, 0, 12 * sizeof(float));
    positions[1][2] = (float)(speed * time);
    velocities[1][2] = (float)speed;
    velocities[2][0] = (float)(speed * sin(turn * time)); // to the left: from +z towards +x
    velocities[2][2] = (float)(speed * cos(turn * time));
}

static void bring_at(render_flight *flight, double time, float postures[3][4]) {
    float positions[3][4], velocities[3][4];
    skein_error error = {0};
    place_birds(time, positions, velocities);
    const render_birds birds = {.count = 3, .positions = positions[0], .velocities = velocities[0], .span = 1};
    render_frame frame = render_default_frame();
    frame.birds = &birds, frame.bird_count = 1, frame.time = time;
    OK(render_flight_bring(flight, &frame, &error));
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(flight->postures, 0, 12 * sizeof(float), postures);
}

static double turned(double from, double to) {
    double by = to - from;
    return by - 2 * pi * floor(by / (2 * pi));
}

static void wings_beat_with_the_speed_and_birds_lean_into_turns(void **state) {
    (void)state;
    skein_error error = {0};
    render_flight flight = {0};
    float before[3][4], now[3][4];
    OK(render_flight_create(&flight, &error));
    bring_at(&flight, 0, before);
    for (int i = 0; i < 3; i++) assert_true(before[i][2] == 0);
    assert_true(before[0][1] != before[1][1] && before[1][1] != before[2][1]); // not all at once
    const double dt = 1.0 / 60;
    bring_at(&flight, dt, now);
    assert_float_equal(turned(before[0][1], now[0][1]), 2 * pi * dt * 2, 1e-4);
    assert_float_equal(turned(before[1][1], now[1][1]), 2 * pi * dt * (2 + 0.25 * speed), 1e-4);
    for (int i = 2; i <= 120; i++) bring_at(&flight, i * dt, now);
    assert_float_equal(now[0][2], 0, 1e-6);
    assert_float_equal(now[1][2], 0, 1e-6);
    assert_float_equal(now[2][2], atan(speed * turn / 9.81), 1e-2); // weight and turn in balance
    // after a cut the wings stand as they did, and nobody leans otherwise
    memcpy(before, now, sizeof before);
    bring_at(&flight, 500, now);
    for (int i = 0; i < 3; i++) assert_true(before[i][1] == now[i][1] && before[i][2] == now[i][2]);
    render_flight_destroy(&flight);
}

/* ---- Pictures ----------------------------------------------------------------------------------- */

static double flock_range; /* of speeds */

static render_image picture_of_birds(float positions[][4], float velocities[][4], size_t count, render_feathers paint) {
    const render_birds birds = {.count = count,
                                .positions = positions[0],
                                .velocities = velocities[0],
                                .span = 2,
                                .paint = paint,
                                .range = flock_range,
                                .least = {-3, -1, -3},
                                .most = {3, 1, 3}};
    render_frame frame = render_default_frame();
    frame.birds = &birds, frame.bird_count = 1;
    render_camera camera = camera_in_front(0.01, 8);
    return shoot(&frame, &camera);
}

/* Pixels that are redder than blue by far, or the other way round, in the half of the picture. */
static size_t count_tinted(const render_image *image, bool left, bool red) {
    size_t count = 0;
    for (int y = 0; y < height; y++)
        for (int x = left ? 0 : width / 2; x < (left ? width / 2 : width); x++) {
            const unsigned char *p = &image->pixels[3 * (size_t)(y * width + x)];
            int more = red ? p[0] - p[2] : p[2] - p[0];
            count += more > 60;
        }
    return count;
}

static void colours_tell_where_birds_fly(void **state) {
    (void)state;
    float positions[2][4] = {{-2, 0, 0, 0}, {2, 0, 0, 0}}, velocities[2][4] = {{0, 0, 5, 0}, {0, 0, -5, 0}};
    render_image image = picture_of_birds(positions, velocities, 2, RENDER_BY_DIRECTION_FEATHERS);
    assert_true(count_tinted(&image, true, true) > 300 && count_tinted(&image, true, false) == 0);
    assert_true(count_tinted(&image, false, false) > 300 && count_tinted(&image, false, true) == 0);
    render_image_release(&image);
}

/* Pixels that are greener than blue by far, in the half of the picture. */
static size_t count_greener(const render_image *image, bool left) {
    size_t count = 0;
    for (int y = 0; y < height; y++)
        for (int x = left ? 0 : width / 2; x < (left ? width / 2 : width); x++) {
            const unsigned char *p = &image->pixels[3 * (size_t)(y * width + x)];
            count += p[1] - p[2] > 60; // the end of the map is yellow, its begin is violet, the sky is blue
        }
    return count;
}

/* At the range's end a bird is yellow, at rest violet; another range makes the same speed a slow one. */
static void colours_tell_how_fast_birds_fly(void **state) {
    (void)state;
    float positions[2][4] = {{-2, 0, 0, 0}, {2, 0, 0, 0}}, velocities[2][4] = {{0, 0, 8, 0}, {0, 0, 0.1f, 0}};
    flock_range = 8;
    render_image image = picture_of_birds(positions, velocities, 2, RENDER_BY_SPEED_FEATHERS);
    assert_true(count_greener(&image, true) > 300);
    assert_int_equal(count_greener(&image, false), 0);
    render_image_release(&image);
    flock_range = 800;
    image = picture_of_birds(positions, velocities, 2, RENDER_BY_SPEED_FEATHERS);
    assert_int_equal(count_greener(&image, true), 0);
    render_image_release(&image);
}

/* Birds that stand, that fly straight up, and that are nowhere: nothing is drawn astray. */
static void odd_birds_are_drawn_or_left_out(void **state) {
    (void)state;
    float positions[4][4] = {{-2, 0, 0, 0}, {2, 0, 0, 0}, {NAN, 0, 0, 0}, {0, 0, 0, 0}};
    float velocities[4][4] = {{0, 0, 0, 0}, {0, 5, 0, 0}, {0, 0, -5, 0}, {NAN, INFINITY, 0, 0}};
    render_image image = picture_of_birds(positions, velocities, 4, RENDER_BY_DIRECTION_FEATHERS);
    assert_true(count_tinted(&image, true, true) + count_tinted(&image, true, false) > 300);
    assert_true(count_tinted(&image, false, true) + count_tinted(&image, false, false) > 50);
    render_image_release(&image);
}

static skein_world *flock(void) {
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    OK(skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 200), SKEIN_VEC3("spread", 8, 8, 8)),
                      NULL));
    OK(skein_force_add(
        world, "flocking",
        SKEIN_SETTINGS(SKEIN_REAL("separation", 1), SKEIN_REAL("alignment", 1), SKEIN_REAL("cohesion", 1)), NULL));
    OK(skein_force_add(world, "attraction", NULL, NULL));
    return world;
}

/* A picture after some steps, each of which has been in a picture, too. */
static render_image film_of(skein_world *world, bool card) {
    skein_error error = {0};
    render_world_frame *made = render_world_frame_create(&error);
    render_image image = {0};
    render_camera camera = camera_in_front(10, 0);
    render_view view = render_view_default();
    view.particle_radius = 0.25;
    view.colour = RENDER_BY_DIRECTION;
    for (int i = 0; i < 5; i++) {
        OK(skein_world_step(world, 1.0 / 60));
        OK(render_world_frame_update(made, world, &view, &error));
        if (i == 0) camera = render_world_frame_camera(made, (double)width / height);
        assert_int_equal(render_world_frame_get(made)->bird_count, 1);
        render_image_release(&image);
        image = shoot(render_world_frame_get(made), &camera);
        if (card && i) assert_true(world->device->ahead); // nobody has asked for the numbers
    }
    render_world_frame_destroy(made);
    return image;
}

static void a_cards_birds_are_drawn_from_its_buffers(void **state) {
    (void)state;
    skein_world *cpu = flock(), *gpu = flock();
    if (skein_world_device_set(gpu, SKEIN_DEVICE_CURRENT_GL)) {
        fprintf(stderr, "skipped: %s\n", skein_world_error(gpu)->message);
        skein_world_destroy(cpu);
        skein_world_destroy(gpu);
        skip();
    }
    render_image ought = film_of(cpu, false), is = film_of(gpu, true);
    assert_true(count_tinted(&ought, true, true) > 100);
    assert_true(difference(&ought, &is, 24) < 2e-4);
    render_image_release(&ought);
    render_image_release(&is);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* What the card has not got yet, or no more, is drawn from the world's numbers. */
static void a_card_that_is_behind_is_not_drawn_from(void **state) {
    (void)state;
    skein_world *world = flock();
    if (skein_world_device_set(world, SKEIN_DEVICE_CURRENT_GL)) {
        fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
        skein_world_destroy(world);
        skip();
    }
    render_world_frame *made = render_world_frame_create(NULL);
    OK(skein_world_explain(world, 1.0 / 60, NULL, NULL)); // a plan, and buffers with nothing in them
    for (int time = 0; time < 2; time++) {
        OK(render_world_frame_update(made, world, NULL, NULL));
        const render_birds *birds = render_world_frame_get(made)->birds;
        assert_int_equal(birds->position_buffer, 0);
        double x[3];
        OK(skein_positions_copy(world, 7, 1, x));
        for (int k = 0; k < 3; k++) assert_float_equal(birds->positions[28 + k], x[k], 1e-6);
        OK(skein_world_step(world, 1.0 / 60));
        OK(render_world_frame_update(made, world, NULL, NULL));
        assert_true(render_world_frame_get(made)->birds->position_buffer != 0);
        skein_world_reset(world);
    }
    render_world_frame_destroy(made);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wings_beat_with_the_speed_and_birds_lean_into_turns),
        cmocka_unit_test(colours_tell_where_birds_fly),
        cmocka_unit_test(colours_tell_how_fast_birds_fly),
        cmocka_unit_test(odd_birds_are_drawn_or_left_out),
        cmocka_unit_test(a_cards_birds_are_drawn_from_its_buffers),
        cmocka_unit_test(a_card_that_is_behind_is_not_drawn_from),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
