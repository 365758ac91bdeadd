/* Tests of what a view shows: every setting changes the picture as it says. Worlds are made by hand, so that what
 * must be seen can be computed. */
#include "pictures.h"

#include <skein/cut.h>

#include "render/world_lines.h"
#include "render/world_points.h"
#include <unistd.h>

#define OK(call_) assert_int_equal((call_), SKEIN_OK)

/* ---- Helpers ---------------------------------------------------------------------------------- */

static render_world_frame *made;
static render_view view;

static int set_up_view(void **state) {
    view = render_view_default();
    made = render_world_frame_create(NULL);
    assert_non_null(made);
    (void)state;
    return 0;
}

static int tear_down_view(void **state) {
    render_world_frame_destroy(made);
    (void)state;
    return 0;
}

/* A cloth of 9 x 17 that stands upright, 2 m wide and 1 m high, its middle 1.2 m up. */
static skein_world *upright_cloth(void) {
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 17), SKEIN_PAIR("size", 2, 1),
                                     SKEIN_VEC3("position", 0, 1.2, 0), SKEIN_VEC3("rotation", 90, 0, 0),
                                     SKEIN_TEXT("pins", "top corners")),
                      NULL));
    return world;
}

/* From straight in front of it, 4 m off; the cloth is then 2 x 1 of 2.57 x 1.45 half pictures... */
static void look_from_the_front(void) {
    const double from[3] = {0, 1.2, 4}, at[3] = {0, 1.2, 0};
    memcpy(view.camera.from, from, sizeof from);
    memcpy(view.camera.at, at, sizeof at);
}

static const render_frame *update(skein_world *world) {
    skein_error error = {0};
    if (render_world_frame_update(made, world, &view, &error) != SKEIN_OK)
        fail_msg("%s: %s", error.where, error.message);
    return render_world_frame_get(made);
}

static render_image picture_of(skein_world *world) {
    const render_frame *frame = update(world);
    render_camera camera = render_world_frame_camera(made, (double)width / height);
    return shoot(frame, &camera);
}

/* The pixel where a point of the plane z = 0 is seen from the front. */
static const uint8_t *pixel_at(const render_image *image, double x, double y) {
    double scale = 0.5 * height / (4 * tan(0.5 * view.camera.fov * pi / 180));
    return render_image_pixel(image, (int)lround(width / 2 + x * scale), (int)lround(height / 2 - (y - 1.2) * scale));
}

static bool is_red(const uint8_t *p) {
    return p[0] > p[1] + 60 && p[0] > p[2] + 60;
}
static bool is_green(const uint8_t *p) {
    return p[1] > p[0] + 40 && p[1] > p[2] + 40;
}
static bool is_blue(const uint8_t *p) {
    return p[2] > p[0] + 40 && p[2] > p[1] + 20;
}
static bool is_pale(const uint8_t *p) {
    return abs(p[0] - p[1]) < 40 && abs(p[1] - p[2]) < 40 && p[0] > 120;
}

/* The part of the pixels for which `is` holds. */
static double part_that(const render_image *image, bool (*is)(const uint8_t *)) {
    size_t count = 0, total = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < total; i++) count += is(&image->pixels[3 * i]);
    return (double)count / (double)total;
}

/* ---- The table -------------------------------------------------------------------------------- */

static void the_view_is_described(void **state) {
    (void)state;
    const skein_kind *kind = render_view_kind();
    assert_int_equal(kind->category, SKEIN_VIEW);
    assert_int_equal(kind->params_size, sizeof(render_view));
    for (size_t i = 0; i < kind->field_count; i++) {
        const skein_field *field = &kind->fields[i];
        static const int numbers[] = {[SKEIN_FIELD_BOOL] = 1, [SKEIN_FIELD_INT] = 1,    [SKEIN_FIELD_INT2] = 2,
                                      [SKEIN_FIELD_INT3] = 3, [SKEIN_FIELD_REAL] = 1,   [SKEIN_FIELD_REAL2] = 2,
                                      [SKEIN_FIELD_VEC3] = 3, [SKEIN_FIELD_CHOICE] = 1, [SKEIN_FIELD_TEXT] = 0};
        skein_value value = {
            numbers[field->type], {field->initial[0], field->initial[1], field->initial[2]}, field->text};
        assert_int_equal(skein_field_check(field, &value, NULL), SKEIN_OK);
        assert_ptr_equal(skein_field_find(kind, field->name, NULL), field);
        for (size_t j = 0; j < i; j++) assert_int_not_equal(kind->fields[j].offset, field->offset);
    }
    assert_true(view.surface && view.pins && view.colliders && view.ground && view.grid);
    assert_false(view.constraints || view.gradients);
    assert_false(view.wireframe || view.springs || view.normals || view.velocities || view.contacts || view.axes);
    assert_true(view.shading == RENDER_BEAUTIFUL && view.colour == RENDER_BY_MATERIAL);
    assert_true(view.exposure == 1 && view.camera.zoom == 1 && view.image[0] == 0);
}

static void colour_maps_are_even(void **state) {
    (void)state;
    float low[3], high[3], middle[3], beyond[3];
    // from dark blue to bright yellow, ever lighter
    double before = -1;
    for (int i = 0; i <= 32; i++) {
        render_map_colour(RENDER_LITTLE_TO_MUCH, i / 32.0, middle);
        double luma = 0.2126 * middle[0] + 0.7152 * middle[1] + 0.0722 * middle[2];
        assert_true(luma > before);
        before = luma;
    }
    // from blue over grey to red
    render_map_colour(RENDER_LESS_TO_MORE, 0, low);
    render_map_colour(RENDER_LESS_TO_MORE, 0.5, middle);
    render_map_colour(RENDER_LESS_TO_MORE, 1, high);
    assert_true(low[2] > low[0] + 0.3f && high[0] > high[2] + 0.3f);
    assert_true(middle[0] == middle[1] && middle[1] == middle[2]);
    render_map_colour(RENDER_LESS_TO_MORE, 7, beyond);
    assert_memory_equal(beyond, high, sizeof high);
    render_map_colour(RENDER_LESS_TO_MORE, (double)NAN, beyond);
    assert_memory_equal(beyond, low, sizeof low);
}

/* ---- Constraints ---------------------------------------------------------------------------------- */

static void expect_line(const render_lines *lines, size_t i, double x0, double x1) {
    const double *p = &lines->positions[6 * i];
    const double ought[6] = {x0, 0, 0, x1, 0, 0};
    for (int k = 0; k < 6; k++) assert_near(p[k], ought[k], 1e-6);
}

/* Of two loose particles under a formula: a line, and arrows as long as the gradient is; shown by the view, or because
 * it is the one that is pointed at. */
static void constraints_have_lines_and_gradients(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    const double positions[6] = {-0.5, 0, 0, 0.5, 0, 0}, masses[2] = {1, 1};
    const uint32_t pair[2] = {0, 1};
    skein_handle spring;
    OK(skein_particles_add(world, 2, positions, NULL, masses, NULL));
    OK(skein_constraint_add(world, "formula", pair, 1,
                            SKEIN_SETTINGS(SKEIN_TEXT("constraint", "0.5*(dot(p0-p1,p0-p1) - 0.25)")), &spring));
    view.particle_radius = 0.1;
    view.gradient_scale = 0.25;
    assert_int_equal(update(world)->lines[RENDER_CONSTRAINTS].count, 0);
    assert_int_equal(update(world)->lines[RENDER_GRADIENTS].count, 0);
    view.constraints = true;
    assert_int_equal(update(world)->lines[RENDER_CONSTRAINTS].count, 1);
    expect_line(&update(world)->lines[RENDER_CONSTRAINTS], 0, -0.5, 0.5);
    view.gradients = true;
    assert_int_equal(update(world)->lines[RENDER_GRADIENTS].count, 10); // with four barbs each
    expect_line(&update(world)->lines[RENDER_GRADIENTS], 0, -0.6, -0.85);
    expect_line(&update(world)->lines[RENDER_GRADIENTS], 5, 0.6, 0.85);
    // half the distance, half the gradient
    const double closer[6] = {-0.25, 0, 0, 0.25, 0, 0};
    OK(skein_positions_set(world, 0, 2, closer));
    expect_line(&update(world)->lines[RENDER_GRADIENTS], 0, -0.35, -0.475);
    // by the picture's size: the same in proportion, as long as a power of two is not passed
    double length[2];
    view.gradient_scale = 0;
    for (int i = 0; i < 2; i++) {
        const double at[6] = {i ? -0.26 : -0.5, 0, 0, i ? 0.26 : 0.5, 0, 0}; // gradients of 1 and 0.52
        OK(skein_positions_set(world, 0, 2, at));
        double radius = i ? 0.36 : 0.6; // the balls' box along x, about
        length[i] = (-0.1 + at[0] - update(world)->lines[RENDER_GRADIENTS].positions[3]) / radius;
        assert_true(length[i] > 0.05);
    }
    assert_near(length[1] / length[0], 0.52, 0.06);
    view.constraints = view.gradients = false;
    assert_int_equal(update(world)->lines[RENDER_CONSTRAINTS].count, 0);
    render_world_frame_choose(made, &(render_chosen){true, spring, 0});
    assert_int_equal(update(world)->lines[RENDER_CONSTRAINTS].count, 1);
    assert_int_equal(update(world)->lines[RENDER_GRADIENTS].count, 10);
    OK(skein_remove(world, spring)); // what is pointed at may go
    assert_int_equal(update(world)->lines[RENDER_GRADIENTS].count, 0);
    skein_world_destroy(world);
}

/* ---- What is shown ---------------------------------------------------------------------------- */

static void a_surface_is_shown_or_not(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    view.pattern = 3;
    render_image with = picture_of(world);
    view.surface = false;
    render_image without = picture_of(world);
    double scale = 0.5 * height / (4 * tan(17 * pi / 180));
    assert_near(part_that(&with, is_red), 2 * scale * scale / (width * height), 0.01);
    assert_true(part_that(&without, is_red) == 0);
    assert_int_equal(update(world)->points[RENDER_PINS].count, 2);
    view.pins = false;
    assert_int_equal(update(world)->points[RENDER_PINS].count, 0);
    render_image_release(&with);
    render_image_release(&without);
    skein_world_destroy(world);
}

static void a_wireframe_has_every_edge_once(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    view.pattern = 3, view.wireframe = true, view.line_width = 4;
    const render_frame *frame = update(world);
    assert_int_equal(frame->lines[RENDER_WIREFRAME].count, 9 * 16 + 17 * 8);
    // on a line of the grid there is ink, in the middle of a square there is cloth
    render_image image = picture_of(world);
    const uint8_t *on = pixel_at(&image, 0.25, 1.2), *between = pixel_at(&image, 0.3125, 1.2625);
    assert_true(on[0] < 110 && on[0] < between[0] - 70);
    assert_true(is_red(between));
    render_image_release(&image);
    skein_world_destroy(world);
}

/* Three springs side by side: a third longer, at rest, a third shorter. */
static void springs_are_coloured_by_strain(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    const double rest[18] = {-0.6, 1, 0, -0.6, 1.6, 0, 0, 1, 0, 0, 1.6, 0, 0.6, 1, 0, 0.6, 1.6, 0};
    const double masses[6] = {1, 1, 1, 1, 1, 1};
    const uint32_t pairs[6] = {0, 1, 2, 3, 4, 5};
    double moved[18];
    OK(skein_particles_add(world, 6, rest, NULL, masses, NULL));
    OK(skein_constraint_add(world, "distance", pairs, 3, NULL, NULL));
    memcpy(moved, rest, sizeof rest);
    moved[4] = 1.8, moved[16] = 1.4;
    OK(skein_positions_set(world, 0, 6, moved));
    look_from_the_front();
    view.springs = true, view.line_width = 6, view.particles = RENDER_NO_PARTICLES;
    render_image image = picture_of(world);
    const uint8_t *longer = pixel_at(&image, -0.6, 1.3), *same = pixel_at(&image, 0, 1.3),
                  *shorter = pixel_at(&image, 0.6, 1.2);
    assert_true(is_red(longer) && is_blue(shorter));
    assert_true(is_pale(same));
    assert_near(render_world_frame_range(made), 1.0 / 3, 1e-5);
    render_image_release(&image);

    // a wider range makes them paler
    view.range = 100;
    image = picture_of(world);
    assert_true(is_pale(pixel_at(&image, -0.6, 1.3)) && is_pale(pixel_at(&image, 0.6, 1.2)));
    render_image_release(&image);
    skein_world_destroy(world);
}

static void particles_are_coloured_by_speed(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    // the faster the further right
    double velocities[9 * 17 * 3] = {0};
    for (int i = 0; i < 9 * 17; i++) velocities[3 * i + 2] = 2.0 * (i % 17) / 16;
    OK(skein_velocities_set(world, 0, 9 * 17, velocities));
    view.surface = false, view.particles = RENDER_ALL_PARTICLES, view.colour = RENDER_BY_SPEED;
    const render_frame *frame = update(world);
    assert_int_equal(frame->points[RENDER_PARTICLES].count, 9 * 17);
    assert_near(render_world_frame_range(made), 2, 1e-6);
    render_image image = picture_of(world);
    const uint8_t *slow = pixel_at(&image, -1, 1.2), *fast = pixel_at(&image, 1, 1.2),
                  *between = pixel_at(&image, 0.0625, 1.2625);
    assert_true(slow[2] > slow[1] + 15 && slow[2] > 40);           // purple
    assert_true(fast[0] > fast[2] + 60 && fast[1] > fast[2] + 60); // yellow
    assert_true(brightness(&image, width / 2, height / 2) < between[0] + between[1] + between[2] - 60);
    render_image_release(&image);
    view.particles = RENDER_LOOSE_PARTICLES;
    assert_int_equal(update(world)->points[RENDER_PARTICLES].count, 0);
    skein_world_destroy(world);
}

/* Many particles are drawn in another way than few: they must look alike. */
static void many_particles_look_like_few(void **state) {
    (void)state;
    look_from_the_front();
    view.surface = false, view.particles = RENDER_ALL_PARTICLES, view.particle_radius = 0.02;
    render_image images[2];
    for (int i = 0; i < 2; i++) {
        skein_world *world = skein_world_create(NULL, NULL);
        int side = i ? 31 : 7; // 961 or 49, those in the same places among them
        OK(skein_body_add(world, "cloth", NULL,
                          SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_VEC3("position", 0, 1.2, 0),
                                         SKEIN_VEC3("rotation", 90, 0, 0)),
                          NULL));
        images[i] = picture_of(world);
        skein_world_destroy(world);
    }
    for (int i = -2; i <= 2; i++) {
        const uint8_t *few = pixel_at(&images[0], i / 6.0, 1.2), *many = pixel_at(&images[1], i / 6.0, 1.2);
        for (int k = 0; k < 3; k++) assert_near(many[k], few[k], 40);
        assert_true(many[0] > many[2] + 50);
    }
    const uint8_t *between = pixel_at(&images[1], 1 / 60.0, 1.2 + 1 / 60.0);
    assert_false(between[0] > between[2] + 50);
    assert_near(part_that(&images[1], is_red) / part_that(&images[0], is_red), 961.0 / 49, 5);
    render_image_release(&images[0]);
    render_image_release(&images[1]);
}

static void a_surface_is_coloured_by_strain_and_speed(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    // the right half is a fifth wider than it was
    double positions[9 * 17 * 3];
    OK(skein_positions_copy(world, 0, 9 * 17, positions));
    for (int i = 0; i < 9 * 17; i++)
        if (positions[3 * i] > 0) positions[3 * i] *= 1.2;
    OK(skein_positions_set(world, 0, 9 * 17, positions));
    view.colour = RENDER_BY_STRAIN;
    render_image image = picture_of(world);
    assert_true(is_pale(pixel_at(&image, -0.5, 1.2)));
    const uint8_t *wide = pixel_at(&image, 0.6, 1.2);
    assert_true(wide[0] > wide[2] + 50);
    assert_near(render_world_frame_range(made), 0.4 / 3, 1e-5); // two of three edges on the border are a fifth longer
    render_image_release(&image);

    view.colour = RENDER_BY_SPEED; // all at rest: the dark end
    image = picture_of(world);
    const uint8_t *still = pixel_at(&image, 0.3, 1.3);
    assert_true(still[2] > still[1] + 20 && still[1] < 90);
    render_image_release(&image);
    skein_world_destroy(world);
}

static void bodies_differ_by_colour(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    OK(skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3), SKEIN_PAIR("size", 0.5, 0.5),
                                     SKEIN_VEC3("position", 0, 1.2, 0.2), SKEIN_VEC3("rotation", 90, 0, 0)),
                      NULL));
    look_from_the_front();
    view.colour = RENDER_BY_BODY;
    render_image image = picture_of(world);
    const uint8_t *back = pixel_at(&image, 0.7, 1.2), *front = pixel_at(&image, 0, 1.2);
    assert_true(is_red(back));
    assert_true(front[1] > back[1] + 30 && front[0] > front[2] + 40); // saffron
    render_image_release(&image);
    skein_world_destroy(world);
}

static void normals_and_velocities_are_lines(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    const double up[3] = {0, 2, 0};
    OK(skein_velocities_set(world, 5, 1, up));
    view.normals = view.velocities = true;
    view.velocity_scale = 0.25;
    const render_frame *frame = update(world);
    const render_lines *normals = &frame->lines[RENDER_NORMALS], *velocities = &frame->lines[RENDER_VELOCITIES];
    assert_int_equal(normals->count, 9 * 17);
    for (size_t i = 0; i < normals->count; i++) {
        const double *line = &normals->positions[6 * i];
        assert_near(line[3] - line[0], 0, 1e-6);
        assert_near(line[4] - line[1], 0, 1e-6);
        assert_true(fabs(line[5] - line[2]) > 0.01);
    }
    assert_int_equal(velocities->count, 9 * 17);
    assert_near(velocities->positions[6 * 5 + 4] - velocities->positions[6 * 5 + 1], 0.5, 1e-6);
    // neither makes the camera step back
    render_camera with = render_world_frame_camera(made, 1.5);
    view.normals = view.velocities = false;
    update(world);
    render_camera without = render_world_frame_camera(made, 1.5);
    assert_memory_equal(&with, &without, sizeof with);
    skein_world_destroy(world);
}

/* Every third line is an arrow's shaft: along the field where it begins, as long as the field is strong. */
static void fields_are_arrows(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    const double corners[6] = {-1, 0, -1, 1, 1, 1}, masses[2] = {1, 1};
    skein_handle whirl;
    OK(skein_particles_add(world, 2, corners, NULL, masses, NULL));
    OK(skein_force_add(world, "gravity", NULL, NULL)); // is no field
    assert_int_equal(update(world)->lines[RENDER_FIELDS].count, 0);
    OK(skein_force_add(world, "force_field", SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(-3*p.z, 0, 3*p.x)")), &whirl));
    const render_lines *lines = &update(world)->lines[RENDER_FIELDS];
    assert_true(lines->count > 100 && lines->count % 3 == 0);
    double longest = 0, strongest = 0;
    for (size_t i = 0; i < lines->count; i += 3) {
        const double *from = &lines->positions[6 * i];
        longest = fmax(longest, hypot(from[3] - from[0], from[5] - from[2]));
        strongest = fmax(strongest, hypot(from[0], from[2]));
    }
    assert_true(longest > 0.1 && longest < 0.4);
    for (size_t i = 0; i < lines->count; i += 3) {
        const double *from = &lines->positions[6 * i];
        double share = longest / strongest;
        assert_near(from[3] - from[0], -from[2] * share, 1e-9);
        assert_near(from[4] - from[1], 0, 1e-9);
        assert_near(from[5] - from[2], from[0] * share, 1e-9);
    }
    size_t one = lines->count;
    OK(skein_force_add(world, "potential", SKEIN_SETTINGS(SKEIN_TEXT("energy", "dot(p, p)")), NULL));
    assert_true(update(world)->lines[RENDER_FIELDS].count > one + 100);
    OK(skein_set(world, whirl, "visible", skein_number(0)));
    assert_true(update(world)->lines[RENDER_FIELDS].count < 2 * one);
    view.fields = false;
    assert_int_equal(update(world)->lines[RENDER_FIELDS].count, 0);
    skein_world_destroy(world);
}

/* A body that is disabled or removed leaves no surface, no particle and no arrow. */
static void what_is_not_there_is_not_drawn(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle cloth, birds;
    const double positions[3] = {5, 5, 5}, fast[3] = {1, 0, 0}, mass = 1;
    OK(skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 4)), &cloth));
    OK(skein_body_add(world, "flock", NULL, SKEIN_SETTINGS(SKEIN_REAL("count", 7)), &birds));
    OK(skein_particles_add(world, 1, positions, fast, &mass, NULL));
    view.particles = view.velocities = true;
    for (int turn = 0; turn < 3; turn++) {
        const render_frame *frame = update(world);
        assert_int_equal(frame->surface_count, turn == 0);
        assert_int_equal(frame->points[RENDER_PARTICLES].count, turn == 0 ? 16 + 1 : 1);
        if (turn == 0) OK(skein_set(world, cloth, "enabled", skein_number(0)));
        if (turn == 0) OK(skein_set(world, birds, "enabled", skein_number(0)));
        if (turn == 1) OK(skein_remove(world, cloth));
        if (turn == 1) OK(skein_remove(world, birds));
    }
    skein_world_destroy(world);
}

static void contacts_are_lines_on_the_collider(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    const double positions[6] = {0, 1.003, 0, 3, 3, 3}, masses[2] = {1, 1};
    OK(skein_particles_add(world, 2, positions, NULL, masses, NULL));
    OK(skein_collider_add(
        world, "sphere",
        SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.5, 0), SKEIN_REAL("radius", 0.5), SKEIN_REAL("thickness", 0.01)),
        NULL));
    view.contacts = true;
    const render_lines *contacts = &update(world)->lines[RENDER_CONTACTS];
    assert_int_equal(contacts->count, 1);
    assert_near(contacts->positions[1], 1, 1e-6);
    assert_true(contacts->positions[4] > 1.05);
    skein_world_destroy(world);
}

/* ---- Surroundings ----------------------------------------------------------------------------- */

static void colliders_follow_at_once(void **state) {
    (void)state;
    skein_handle ball;
    skein_world *world = upright_cloth();
    OK(skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 1.2, 0.5), SKEIN_REAL("radius", 0.2)),
                          &ball));
    look_from_the_front();
    view.pattern = 3;
    render_image image = picture_of(world);
    assert_false(is_red(pixel_at(&image, 0, 1.2)));
    assert_true(is_red(pixel_at(&image, 0.6, 1.2)));
    render_image_release(&image);
    // no step in between
    OK(skein_set(world, ball, "centre", skein_vector(0.6, 1.2, 0)));
    OK(skein_set(world, ball, "radius", skein_number(0.1)));
    image = picture_of(world);
    assert_true(is_red(pixel_at(&image, 0, 1.2)));
    assert_false(is_red(pixel_at(&image, 0.6, 1.2)));
    render_image_release(&image);
    view.colliders = false;
    image = picture_of(world);
    assert_true(is_red(pixel_at(&image, 0.6, 1.2)));
    render_image_release(&image);
    skein_world_destroy(world);
}

static void ground_grid_and_axes(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    OK(skein_collider_add(world, "plane", NULL, NULL));
    const double from[3] = {0, 6, 0.01};
    memcpy(view.camera.from, from, sizeof from);
    view.surface = view.pins = false;
    view.axes = true;
    render_image all = picture_of(world);
    assert_true(part_that(&all, is_red) > 1e-4 && part_that(&all, is_blue) > 1e-4);
    view.axes = false;
    render_image bare = picture_of(world);
    assert_true(part_that(&bare, is_red) == 0);
    view.grid = false;
    render_image smooth = picture_of(world);
    double lines = difference(&bare, &smooth, 3);
    assert_true(lines > 0.005 && lines < 0.2);
    view.ground = false;
    render_image nothing = picture_of(world);
    assert_true(difference(&smooth, &nothing, 8) > 0.9);
    render_image_release(&all);
    render_image_release(&bare);
    render_image_release(&smooth);
    render_image_release(&nothing);
    skein_world_destroy(world);
}

static void the_plain_light_casts_no_shadow(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    OK(skein_collider_add(world, "plane", NULL, NULL));
    OK(skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 1, 0), SKEIN_REAL("radius", 0.5)),
                          NULL));
    const double from[3] = {0, 8, 0.01}, sun[3] = {-1, 1, 0};
    memcpy(view.camera.from, from, sizeof from);
    memcpy(view.sun, sun, sizeof sun);
    view.surface = view.pins = view.grid = false;
    double metre = 0.5 * height / (8 * tan(17 * pi / 180));
    int x = (int)lround(1.1 * metre);
    for (int plain = 0; plain < 2; plain++) {
        view.shading = plain;
        render_image image = picture_of(world);
        int shaded = brightness(&image, width / 2 + x, height / 2), lit = brightness(&image, width / 2 - x, height / 2);
        if (plain) assert_true(abs(shaded - lit) < 12);
        else assert_true(shaded < lit - 120);
        render_image_release(&image);
    }
    // the view's sun on the other side: so is the shadow
    view.shading = RENDER_BEAUTIFUL, view.sun[0] = 1;
    render_image image = picture_of(world);
    assert_true(brightness(&image, width / 2 - x, height / 2) < brightness(&image, width / 2 + x, height / 2) - 120);
    render_image_release(&image);
    skein_world_destroy(world);
}

/* ---- Patterns and images ---------------------------------------------------------------------- */

/* A picture whose quarters are red and green above, blue and white below. */
static void write_quarters(char path[256]) {
    static const uint8_t colours[4][3] = {{230, 20, 20}, {20, 200, 20}, {20, 20, 230}, {240, 240, 240}};
    render_image image = {0};
    OK(render_image_resize(&image, 64, 64, NULL));
    for (int i = 0; i < 64 * 64; i++) memcpy(&image.pixels[3 * i], colours[2 * (i / 64 / 32) + (i % 64) / 32], 3);
    path_in(path, "quarters.png");
    OK(render_image_write_png(&image, path, NULL));
    render_image_release(&image);
}

static void assert_quarters(skein_world *world) {
    render_world_frame_destroy(made); // a frame is for one world
    made = render_world_frame_create(NULL);
    look_from_the_front();
    render_image image = picture_of(world);
    assert_true(is_red(pixel_at(&image, -0.25, 1.45)));
    assert_true(is_green(pixel_at(&image, 0.25, 1.45)));
    assert_true(is_blue(pixel_at(&image, -0.25, 0.95)));
    assert_true(is_pale(pixel_at(&image, 0.25, 0.95)));
    render_image_release(&image);
}

/* A square metre that faces +z, as a mesh. */
static skein_world *square_mesh(const float *corner_uv) {
    static const double positions[12] = {-0.5, 0.7, 0, 0.5, 0.7, 0, 0.5, 1.7, 0, -0.5, 1.7, 0};
    static const uint32_t sizes[2] = {3, 3}, corners[6] = {0, 1, 2, 0, 2, 3};
    const skein_mesh mesh = {positions, 4, sizes, 2, corners, 6};
    skein_handle body;
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_body_add(world, "cloth", &mesh, NULL, &body));
    if (corner_uv) OK(skein_body_uv_set(world, body, corner_uv, 6));
    return world;
}

/* What a mesh without coordinates shows is laid on its first shape, whatever shape it has when it is drawn first. */
static void a_pattern_is_laid_on_the_first_shape(void **state) {
    (void)state;
    float flat[2 * 6];
    size_t count = 0;
    for (int folded = 0; folded < 2; folded++) {
        skein_world *world = square_mesh(NULL);
        const double place[6] = {0.5, 0.8, 1, -0.5, 0.9, 1};
        if (folded) OK(skein_positions_set(world, 2, 2, place));
        const render_surface *surface = &update(world)->surfaces[0];
        assert_true(surface->vertex_count <= 6);
        if (folded) assert_true(surface->vertex_count == count && !memcmp(surface->uv, flat, 2 * count * sizeof *flat));
        memcpy(flat, surface->uv, 2 * (count = surface->vertex_count) * sizeof *flat);
        skein_world_destroy(world);
    }
}

static void an_image_lies_the_right_way_up(void **state) {
    (void)state;
    char path[256];
    write_quarters(path);
    view.image = path;
    // a grid: row 0 is the top, column 0 the left
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_body_add(
        world, "cloth", NULL,
        SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_VEC3("position", 0, 1.2, 0), SKEIN_VEC3("rotation", 90, 0, 0)),
        NULL));
    assert_quarters(world);
    const render_surface *surface = &update(world)->surfaces[0];
    for (size_t v = 0; v < surface->vertex_count; v++) {
        const double *p = &surface->positions[3 * v];
        assert_near(surface->uv[2 * v], 1.7 - p[1], 1e-5);
        assert_near(surface->uv[2 * v + 1], p[0] + 0.5, 1e-5);
    }
    skein_world_destroy(world);

    // a mesh's own coordinates, v upwards; and a mesh without any, on to which it is projected
    const float uv[12] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1};
    world = square_mesh(uv);
    assert_quarters(world);
    skein_world_destroy(world);
    world = square_mesh(NULL);
    assert_quarters(world);
    assert_int_equal(update(world)->surfaces[0].rows_first, 0);
    // coordinates that come later count from then on: all of it is the red quarter
    const float corner[12] = {0, 0.9f, 0.1f, 0.9f, 0.1f, 1, 0, 0.9f, 0.1f, 1, 0, 1};
    OK(skein_body_uv_set(world, skein_object_at(world, SKEIN_BODY, 0), corner, 6));
    render_image image = picture_of(world);
    assert_true(is_red(pixel_at(&image, 0.25, 0.95)));
    render_image_release(&image);
    skein_world_destroy(world);
    assert_int_equal(unlink(path), 0);
}

static void a_seam_has_its_vertices_twice(void **state) {
    (void)state;
    // the second triangle has a place of its own in the image
    const float uv[12] = {0, 0, 1, 0, 1, 1, 0.5f, 0, 0.75f, 1, 0.5f, 1};
    skein_world *world = square_mesh(uv);
    const render_surface *surface = &update(world)->surfaces[0];
    assert_int_equal(surface->vertex_count, 6);
    assert_int_equal(surface->triangle_count, 2);
    for (size_t c = 0; c < 6; c++) assert_memory_equal(&surface->uv[2 * surface->triangles[c]], &uv[2 * c], 8);
    // vertices of one particle share a normal
    assert_int_equal(surface->weld[surface->triangles[3]], surface->weld[surface->triangles[0]]);
    assert_int_equal(surface->weld[surface->triangles[4]], surface->weld[surface->triangles[2]]);
    skein_world_destroy(world);
}

static void a_checker_repeats_as_often_as_asked(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    view.pattern = 2;
    for (int repeats = 2; repeats < 9; repeats *= 2) {
        view.repeats = repeats;
        render_image image = picture_of(world);
        // along a row of squares there are two changes a repeat
        int changes = 0;
        bool before = false;
        for (int i = 0; i < 1000; i++) {
            bool red = is_red(pixel_at(&image, -0.99 + 1.98 * i / 1000, 1.2 + 0.25 / repeats));
            changes += i > 0 && red != before;
            before = red;
        }
        assert_int_equal(changes, 2 * repeats - 1);
        render_image_release(&image);
    }
    skein_world_destroy(world);
}

static void images_that_cannot_be_read_are_told(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    skein_error error = {0};
    char path[256];
    path_in(path, "none.png");
    view.image = path;
    assert_int_equal(render_world_frame_update(made, world, &view, &error), SKEIN_ERROR_FILE);
    assert_string_equal(error.where, path);
    assert_non_null(strstr(error.message, "; give the path of a PNG or JPEG"));
    view.image = (char[]){"CMakeLists.txt"};
    assert_int_equal(render_world_frame_update(made, world, &view, &error), SKEIN_ERROR_SYNTAX);
    assert_non_null(strstr(error.message, "PNG or JPEG"));
    // and the next picture without one is as good as ever
    view.image = (char[]){""};
    OK(render_world_frame_update(made, world, &view, &error));
    skein_world_destroy(world);
}

/* ---- The camera ------------------------------------------------------------------------------- */

static double distance_between(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void the_camera_stands_where_it_is_told(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    look_from_the_front();
    update(world);
    render_camera camera = render_world_frame_camera(made, 1.5);
    assert_memory_equal(camera.eye, view.camera.from, sizeof camera.eye);
    assert_memory_equal(camera.target, view.camera.at, sizeof camera.target);

    // a quarter turn in two seconds
    view.camera.orbit = 45;
    for (int i = 0; i < 120; i++) OK(skein_world_step(world, 1.0 / 60));
    update(world);
    camera = render_world_frame_camera(made, 1.5);
    const double side[3] = {4, 1.2, 0};
    assert_true(distance_between(camera.eye, side) < 1e-6);

    // one that frames by itself turns as well: from its azimuth on
    memcpy(view.camera.from, view.camera.at, sizeof view.camera.at);
    view.camera.azimuth = 0;
    update(world);
    camera = render_world_frame_camera(made, 1.5);
    assert_near(camera.eye[2] - camera.target[2], 0, 1e-6);
    assert_true(camera.eye[0] > camera.target[0] + 1);

    // straight from above
    const double above[3] = {0, 9, 0}, below[3] = {0, 0, 0};
    memcpy(view.camera.from, above, sizeof above);
    memcpy(view.camera.at, below, sizeof below);
    render_image image = picture_of(world);
    render_image_release(&image);
    skein_world_destroy(world);
}

static void a_camera_that_frames_by_itself_can_be_turned_and_zoomed(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    view.pattern = 3;
    view.camera.azimuth = 0, view.camera.elevation = 5;
    render_image front = picture_of(world);
    render_camera first = render_world_frame_camera(made, 1.5);
    view.camera.zoom = 0.5;
    render_image small = picture_of(world);
    view.camera.zoom = 1, view.camera.azimuth = 90;
    render_image side = picture_of(world);
    render_camera turned = render_world_frame_camera(made, 1.5);
    double whole = part_that(&front, is_red);
    assert_true(whole > 0.1);
    assert_near(part_that(&small, is_red) / whole, 0.25, 0.06);
    assert_true(part_that(&side, is_red) < 0.05 * whole); // edge on
    assert_near(first.eye[0] - first.target[0], 0, 1e-6);
    assert_near(turned.eye[2] - turned.target[2], 0, 1e-6);
    assert_true(turned.eye[0] > turned.target[0]);
    render_image_release(&front);
    render_image_release(&small);
    render_image_release(&side);
    skein_world_destroy(world);
}

/* ---- The driver, last of all ------------------------------------------------------------------ */

/* Faces that are cut are not drawn, nor the lines that only they have; mended they are there again. A cloth of which all
 * is cut is a cloud of particles. */
static void what_is_cut_is_gone(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    skein_handle cloth = skein_object_at(world, SKEIN_BODY, 0);
    look_from_the_front();
    view.ground = view.grid = false;
    view.wireframe = true;
    skein_surface surface;
    OK(skein_body_surface(world, cloth, &surface));
    assert_int_equal(surface.face_count, 128);
    render_image whole = picture_of(world);
    const render_frame *frame = update(world);
    assert_int_equal(frame->surfaces[0].triangle_count, 256);
    size_t lines = frame->lines[RENDER_WIREFRAME].count;
    assert_int_equal(lines, 9 * 16 + 8 * 17);
    // a band of 8 x 4 faces in the middle: all that is seen between x = -0.25 and 0.25
    uint32_t band[32], count = 0, all[128];
    for (uint32_t f = 0, c = 0; f < surface.face_count; c += surface.face_sizes[f++]) {
        double p[3], middle = 0;
        for (uint32_t k = 0; k < 4; k++) {
            OK(skein_positions_copy(world, surface.particle_of_vertex[surface.face_vertices[c + k]], 1, p));
            middle += p[0] / 4;
        }
        all[f] = f;
        if (fabs(middle) < 0.25) band[count++] = f;
    }
    assert_int_equal(count, 32);
    OK(skein_cut_faces(world, cloth, band, count));
    uint64_t shape = frame->surfaces[0].shape;
    render_image cut = picture_of(world);
    frame = update(world);
    assert_int_equal(frame->surfaces[0].triangle_count, 192);
    assert_true(frame->surfaces[0].shape != shape);
    assert_int_equal(frame->lines[RENDER_WIREFRAME].count, lines - 9 * 4 - 8 * 3);
    // where the band was the sky is, as it is beside the cloth
    for (int column = -2; column <= 2; column++)
        for (int row = -3; row <= 3; row++) {
            const uint8_t *p = pixel_at(&cut, 0.1 * column, 1.2 + 0.13 * row),
                          *q = pixel_at(&whole, 0.1 * column, 1.2 + 0.13 * row);
            const uint8_t *sky = pixel_at(&whole, 1.2, 1.2 + 0.13 * row);
            assert_true(abs(p[0] - q[0]) + abs(p[1] - q[1]) + abs(p[2] - q[2]) > 60);
            for (int k = 0; k < 3; k++) assert_true(abs(p[k] - sky[k]) <= 6);
        }
    // beside it all is as it was
    for (int row = -3; row <= 3; row++)
        assert_memory_equal(pixel_at(&cut, 0.6, 1.2 + 0.13 * row), pixel_at(&whole, 0.6, 1.2 + 0.13 * row), 3);
    OK(skein_cut_mend(world, cloth));
    render_image mended = picture_of(world);
    assert_memory_equal(mended.pixels, whole.pixels, 3u * width * height);
    assert_int_equal(update(world)->surfaces[0].shape, shape);
    OK(skein_cut_faces(world, cloth, all, 128));
    frame = update(world);
    assert_int_equal(frame->surface_count, 0);
    assert_int_equal(frame->points[RENDER_PARTICLES].count, 9 * 17);
    render_image_release(&whole);
    render_image_release(&cut);
    render_image_release(&mended);
    skein_world_destroy(world);
}

static void the_driver_had_nothing_to_say(void **state) {
    (void)state;
    const render_messages *messages = render_context_messages(context);
    if (messages->errors + messages->warnings > 0) fprintf(stderr, "driver: %s\n", messages->last);
    assert_int_equal(messages->errors, 0);
    assert_int_equal(messages->warnings, 0);
}

/* A cloth with its springs, birds, a ball, a glass bowl, walls and ground: of each, more than one part, or a band. */
static void a_picture_drawn_in_parts_is_the_same(void **state) {
    (void)state;
    skein_world *world = upright_cloth();
    OK(skein_body_add(world, "flock", NULL,
                      SKEIN_SETTINGS(SKEIN_REAL("count", 90), SKEIN_VEC3("spread", 3, 2, 2), SKEIN_REAL("speed", 1)),
                      NULL));
    OK(skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_VEC3("centre", 1, 0.4, 0.5), SKEIN_REAL("radius", 0.3)),
                          NULL));
    OK(skein_collider_add(world, "bowl",
                          SKEIN_SETTINGS(SKEIN_VEC3("centre", -0.8, 0.6, 0.5), SKEIN_REAL("radius", 0.5)), NULL));
    OK(skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", 0)), NULL));
    OK(skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_VEC3("normal", 0, 0.2, 1), SKEIN_REAL("offset", -2)),
                          NULL));
    view.springs = view.wireframe = view.axes = true;
    render_image whole = picture_of(world);
    static const size_t parts[] = {1000, 7, 1};
    for (size_t i = 0; i < 3; i++) {
        render_draw_in_parts(draw, parts[i]);
        render_image image = picture_of(world);
        assert_memory_equal(whole.pixels, image.pixels, (size_t)width * height * 3);
        render_image_release(&image);
    }
    render_draw_in_parts(draw, 0);
    // what was drawn is there: without the birds, and without the springs, it is another picture
    view.birds = false;
    render_image other = picture_of(world);
    assert_true(difference(&whole, &other, 20) > 1e-3);
    render_image_release(&other);
    view.birds = true, view.springs = view.wireframe = false;
    other = picture_of(world);
    assert_true(difference(&whole, &other, 20) > 1e-3);
    render_image_release(&other);
    render_image_release(&whole);
    skein_world_destroy(world);
}

int main(void) {
#define VIEW_TEST(f_) cmocka_unit_test_setup_teardown(f_, set_up_view, tear_down_view)
    const struct CMUnitTest tests[] = {
        VIEW_TEST(the_view_is_described),
        VIEW_TEST(colour_maps_are_even),
        VIEW_TEST(a_surface_is_shown_or_not),
        VIEW_TEST(constraints_have_lines_and_gradients),
        VIEW_TEST(a_wireframe_has_every_edge_once),
        VIEW_TEST(springs_are_coloured_by_strain),
        VIEW_TEST(particles_are_coloured_by_speed),
        VIEW_TEST(many_particles_look_like_few),
        VIEW_TEST(a_surface_is_coloured_by_strain_and_speed),
        VIEW_TEST(bodies_differ_by_colour),
        VIEW_TEST(normals_and_velocities_are_lines),
        VIEW_TEST(fields_are_arrows),
        VIEW_TEST(what_is_not_there_is_not_drawn),
        VIEW_TEST(contacts_are_lines_on_the_collider),
        VIEW_TEST(colliders_follow_at_once),
        VIEW_TEST(ground_grid_and_axes),
        VIEW_TEST(the_plain_light_casts_no_shadow),
        VIEW_TEST(a_pattern_is_laid_on_the_first_shape),
        VIEW_TEST(an_image_lies_the_right_way_up),
        VIEW_TEST(a_seam_has_its_vertices_twice),
        VIEW_TEST(a_checker_repeats_as_often_as_asked),
        VIEW_TEST(images_that_cannot_be_read_are_told),
        VIEW_TEST(the_camera_stands_where_it_is_told),
        VIEW_TEST(a_camera_that_frames_by_itself_can_be_turned_and_zoomed),
        VIEW_TEST(a_picture_drawn_in_parts_is_the_same),
        VIEW_TEST(what_is_cut_is_gone),
        cmocka_unit_test(the_driver_had_nothing_to_say),
    };
    if (!mkdtemp(directory)) return 1;
    int failed = cmocka_run_group_tests_name("render, views", tests, set_up, tear_down);
    return failed + (rmdir(directory) != 0);
}
