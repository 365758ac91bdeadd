/* Boxes, capsules, bowls and ropes in pictures: each pixel is held against the shape's own formula. */
#include "pictures.h"

#include "render/body_mesh.h"
#include "render/linear.h"

#define OK(call_) assert_int_equal(call_, SKEIN_OK)

static render_world_frame *made;
static render_view view;

static int set_up_view(void **state) {
    const double from[3] = {1.5, 2.2, 4}, at[3] = {0, 0.8, 0};
    (void)state;
    made = render_world_frame_create(NULL);
    view = render_view_default();
    memcpy(view.camera.from, from, sizeof from);
    memcpy(view.camera.at, at, sizeof at);
    view.ground = false;
    return made == NULL;
}

static int tear_down_view(void **state) {
    (void)state;
    render_world_frame_destroy(made);
    return 0;
}

static const render_frame *update(skein_world *world) {
    OK(render_world_frame_update(made, world, &view, NULL));
    return render_world_frame_get(made);
}

static render_image picture_of(skein_world *world) {
    const render_frame *frame = update(world);
    render_camera camera = render_world_frame_camera(made, (double)width / height);
    return shoot(frame, &camera);
}

static skein_world *world_with(const char *kind, const skein_setting *settings, skein_handle *collider) {
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(skein_collider_add(world, kind, settings, collider));
    return world;
}

/* ---- Shapes ----------------------------------------------------------------------------------- */

/* A shape where the library says that it stands: the distance of a point, negative inside. */
typedef struct shape {
    skein_pose pose;
    double half[3]; /* of a box */
    double radius;  /* of a capsule, whose line is half[0] to either side along x, of a bowl */
} shape;

typedef double distance(const shape *s, const double p[3]);

static void into_own_axes(const shape *s, const double p[3], double own[3]) {
    for (int c = 0; c < 3; c++) {
        own[c] = 0;
        for (int r = 0; r < 3; r++) own[c] += s->pose.rotation[3 * r + c] * (p[r] - s->pose.position[r]);
    }
}

static double box_distance(const shape *s, const double p[3]) {
    double own[3], sum = 0, most = -INFINITY;
    into_own_axes(s, p, own);
    for (int k = 0; k < 3; k++) {
        double over = fabs(own[k]) - s->half[k];
        sum += over > 0 ? over * over : 0;
        most = fmax(most, over);
    }
    return most > 0 ? sqrt(sum) : most;
}

static double capsule_distance(const shape *s, const double p[3]) {
    double own[3];
    into_own_axes(s, p, own);
    own[0] -= fmin(fmax(own[0], -s->half[0]), s->half[0]);
    return sqrt(render_dot(own, own)) - s->radius;
}

/* Whether the ray through a pixel meets the shape: it goes on by the distance until that is nothing. */
static bool meets(const shape *s, distance *far_off, const render_camera *camera, const double ray[3]) {
    double way = 0;
    for (int i = 0; i < 200 && way < 20; i++) {
        double p[3], d;
        for (int k = 0; k < 3; k++) p[k] = camera->eye[k] + way * ray[k];
        d = far_off(s, p);
        if (d < 1e-4) return true;
        way += d;
    }
    return false;
}

/* A bowl's wall: the sphere, up to the rim. */
static bool meets_bowl(const shape *s, const render_camera *camera, const double ray[3]) {
    double off[3];
    for (int k = 0; k < 3; k++) off[k] = camera->eye[k] - s->pose.position[k];
    double half = render_dot(off, ray), under = half * half - render_dot(off, off) + s->radius * s->radius;
    for (int sign = -1; sign <= 1 && under > 0; sign += 2) {
        double y = off[1] + (-half + sign * sqrt(under)) * ray[1];
        if (y < (render_bowl_height - 1) * s->radius) return true;
    }
    return false;
}

/* The part of the pixels where the picture and the formula do not agree on whether something is there. */
static double disagreement(skein_world *world, const shape *s, distance *far_off) {
    double right[3], up[3], back[3], tall = tan(0.5 * view.camera.fov * pi / 180), count = 0, there = 0;
    view.colliders = false;
    render_image without = picture_of(world);
    view.colliders = true;
    render_image with = picture_of(world);
    render_camera camera = render_world_frame_camera(made, (double)width / height);
    render_camera_axes(&camera, right, up, back);
    for (int y = 0; y < height; y += 2)
        for (int x = 0; x < width; x += 2) {
            double across = (2 * (x + 0.5) / width - 1) * tall * width / height,
                   rise = (1 - 2 * (y + 0.5) / height) * tall, ray[3];
            for (int k = 0; k < 3; k++) ray[k] = across * right[k] + rise * up[k] - back[k];
            render_normalise(ray);
            bool is = false, ought = far_off ? meets(s, far_off, &camera, ray) : meets_bowl(s, &camera, ray);
            for (int k = 0; k < 3; k++)
                is |= abs(render_image_pixel(&with, x, y)[k] - render_image_pixel(&without, x, y)[k]) > 6;
            count += is != ought, there += ought;
        }
    assert_true(there > 0.01 * width * height / 4 && there < 0.5 * width * height / 4);
    render_image_release(&with);
    render_image_release(&without);
    return count / (width * height / 4.0);
}

/* ---- Colliders -------------------------------------------------------------------------------- */

static void a_box_is_where_it_stands(void **state) {
    (void)state;
    skein_handle box;
    shape s = {.half = {0.4, 0.3, 0.5}};
    skein_world *world =
        world_with("box",
                   SKEIN_SETTINGS(SKEIN_VEC3("centre", 0.2, 0.8, -0.3), SKEIN_VEC3("size", 0.8, 0.6, 1.0),
                                  SKEIN_VEC3("rotation", 20, 40, -15), SKEIN_VEC3("motion.axis", 0, 1, 0),
                                  SKEIN_REAL("motion.spin", 1), SKEIN_VEC3("motion.velocity", 0.3, 0, 0)),
                   &box);
    OK(skein_collider_pose(world, box, &s.pose));
    assert_near(disagreement(world, &s, box_distance), 0, 0.004);
    // it moves
    for (int i = 0; i < 30; i++) OK(skein_world_step(world, SKEIN_DEFAULT_STEP));
    OK(skein_collider_pose(world, box, &s.pose));
    assert_near(s.pose.position[0], 0.2 + 0.3 * skein_world_time(world), 1e-5);
    assert_near(disagreement(world, &s, box_distance), 0, 0.004);
    // and is changed, with no step in between
    OK(skein_set(world, box, "size", skein_vector(0.3, 1.2, 0.2)));
    OK(skein_set(world, box, "rotation", skein_vector(0, 0, 30)));
    OK(skein_collider_pose(world, box, &s.pose));
    s.half[0] = 0.15, s.half[1] = 0.6, s.half[2] = 0.1;
    assert_near(disagreement(world, &s, box_distance), 0, 0.004);
    skein_world_destroy(world);
}

static void a_capsule_is_where_it_stands(void **state) {
    (void)state;
    skein_handle rod;
    shape s = {.half = {0.5, 0, 0}, .radius = 0.2};
    skein_world *world = world_with("capsule",
                                    SKEIN_SETTINGS(SKEIN_VEC3("from", -0.5, 0.8, 0), SKEIN_VEC3("to", 0.5, 0.8, 0),
                                                   SKEIN_REAL("radius", 0.2), SKEIN_VEC3("motion.axis", 0, 0.6, 0.8),
                                                   SKEIN_REAL("motion.spin", 1.5)),
                                    &rod);
    for (int i = 0; i < 3; i++) {
        OK(skein_collider_pose(world, rod, &s.pose));
        assert_near(disagreement(world, &s, capsule_distance), 0, 0.004);
        for (int k = 0; k < 20; k++) OK(skein_world_step(world, SKEIN_DEFAULT_STEP));
    }
    OK(skein_set(world, rod, "to", skein_vector(0.1, 0.8, 0)));
    OK(skein_set(world, rod, "radius", skein_number(0.3)));
    OK(skein_collider_pose(world, rod, &s.pose));
    s.half[0] = 0.3, s.radius = 0.3;
    assert_near(disagreement(world, &s, capsule_distance), 0, 0.004);
    // without a length it is a ball
    OK(skein_set(world, rod, "to", skein_vector(-0.5, 0.8, 0)));
    OK(skein_collider_pose(world, rod, &s.pose));
    s.half[0] = 0;
    assert_near(disagreement(world, &s, capsule_distance), 0, 0.004);
    skein_world_destroy(world);
}

static void a_bowl_is_the_lower_part_of_its_sphere(void **state) {
    (void)state;
    skein_handle bowl;
    shape s = {.radius = 0.8};
    skein_world *world =
        world_with("bowl", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0.1, 1.2, 0), SKEIN_REAL("radius", 0.8)), &bowl);
    OK(skein_collider_pose(world, bowl, &s.pose));
    assert_near(disagreement(world, &s, NULL), 0, 0.004);
    OK(skein_set(world, bowl, "centre", skein_vector(-0.3, 1, 0.2)));
    OK(skein_set(world, bowl, "radius", skein_number(0.5)));
    OK(skein_collider_pose(world, bowl, &s.pose));
    s.radius = 0.5;
    assert_near(disagreement(world, &s, NULL), 0, 0.004);
    skein_world_destroy(world);
}

/* It has no inside, and is there from above and from below. */
static void an_open_mesh_is_seen_from_both_sides(void **state) {
    (void)state;
    static const double places[] = {-0.5, 0, -0.4, 0.5, 0, -0.4, 0.5, 0, 0.4, -0.5, 0, 0.4};
    static const uint32_t size[] = {4}, corners[] = {3, 2, 1, 0};
    const skein_mesh sheet = {places, 4, size, 1, corners, 4};
    shape s = {.half = {0.5, 0, 0.4}};
    skein_handle collider;
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_collider_add_mesh(world, "mesh", &sheet,
                               SKEIN_SETTINGS(SKEIN_VEC3("position", 0.2, 0.8, 0), SKEIN_VEC3("rotation", 10, 20, -5)),
                               &collider));
    OK(skein_collider_pose(world, collider, &s.pose));
    for (int side = -1; side <= 1; side += 2) {
        view.camera.from[1] = 0.8 + 3 * side;
        assert_near(disagreement(world, &s, box_distance), 0, 0.004);
    }
    skein_world_destroy(world);
}

static bool is_red(const uint8_t *p) {
    return p[0] > p[1] + 30 && p[0] > p[2] + 30;
}

static double red_part(skein_world *world) {
    render_image image = picture_of(world);
    double count = 0;
    for (size_t i = 0; i < (size_t)width * height; i++) count += is_red(&image.pixels[3 * i]);
    render_image_release(&image);
    return count / (width * height);
}

static void what_lies_in_a_bowl_is_seen(void **state) {
    (void)state;
    skein_world *world =
        world_with("bowl", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 1, 0), SKEIN_REAL("radius", 1)), NULL);
    OK(skein_body_add(world, "lattice", NULL,
                      SKEIN_SETTINGS(SKEIN_VEC3("grid", 3, 3, 3), SKEIN_VEC3("size", 0.3, 0.3, 0.3),
                                     SKEIN_VEC3("position", 0, 0.2, 0)),
                      NULL));
    // from the side, where the near wall hides all of it, and from above the rim
    for (double height_now = 0.3; height_now < 4; height_now += 1.2) {
        view.camera.from[1] = height_now;
        view.colliders = false;
        double bare = red_part(world);
        view.colliders = true;
        assert_true(bare > 0.005);
        assert_near(red_part(world) / bare, 1, 0.12);
    }
    skein_world_destroy(world);
}

/* The part of the picture where a collider changes the ground, at pixels that do not show the collider. */
static void colliders_cast_shadows(void **state) {
    static const char *const kinds[] = {"box", "capsule", "bowl", "sphere"};
    (void)state;
    view.camera.from[0] = 0, view.camera.from[1] = 12, view.camera.from[2] = 0.01; // from above
    view.ground = true;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        skein_handle plane, other;
        skein_world *world = world_with("plane", NULL, &plane);
        OK(skein_collider_add(world, kinds[i], NULL, &other));
        if (i != 1) OK(skein_set(world, other, "centre", skein_vector(0, 1, 0)));
        else OK(skein_set(world, other, "from", skein_vector(-0.5, 1, 0)));
        if (i != 0) OK(skein_set(world, other, "radius", skein_number(0.5)));
        render_image lit = picture_of(world);
        int dark[2] = {0, 0};
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                const uint8_t *p = render_image_pixel(&lit, x, y);
                dark[x > width / 2] += brightness(&lit, x, y) < 400 && abs(p[0] - p[2]) < 25;
            }
        // the sun stands on the left
        if (!(dark[1] > 1000 && dark[1] > 3 * dark[0])) fail_msg("%s: %d and %d", kinds[i], dark[0], dark[1]);
        render_image_release(&lit);
        skein_world_destroy(world);
    }
}

/* ---- Bodies ----------------------------------------------------------------------------------- */

static void a_rope_is_a_rod_from_particle_to_particle(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    OK(skein_body_add(
        world, "rope", NULL,
        SKEIN_SETTINGS(SKEIN_REAL("count", 9), SKEIN_VEC3("from", -0.8, 1, 0), SKEIN_VEC3("to", 0.8, 1, 0)), NULL));
    view.particle_radius = 0.1;
    const render_frame *frame = update(world);
    assert_true(frame->rod_count == 8 && frame->rods[7].radius == 0.1);
    assert_int_equal(frame->points[0].count, 0);
    for (size_t i = 0; i < 8; i++) {
        assert_near(frame->rods[i].centre[0], -0.7 + 0.2 * (double)i, 1e-6);
        assert_near(frame->rods[i].extent[0], 0.1, 1e-6);
        assert_true(frame->rods[i].extent[1] == 0 && frame->rods[i].extent[2] == 0);
    }
    render_camera camera = camera_in_front(6, 0);
    camera.eye[1] = camera.target[1] = 1;
    double unit = height / (2 * tan(20 * pi / 180) * 6), area = (1.6 * 0.2 + pi * 0.01) * unit * unit;
    area += 0.5 * (3.2 + 0.2 * pi) * unit; // pixels that the rim crosses
    assert_near(coverage(frame, &camera) * width * height, area, 0.04 * area);
    // without surfaces its particles are what is left
    view.surface = false;
    frame = update(world);
    assert_int_equal(frame->rod_count, 0);
    assert_int_equal(frame->points[0].count, 9);
    skein_world_destroy(world);
}

static void a_cube_has_edges_and_a_cloth_has_none(void **state) {
    (void)state;
    float normals[3 * 100];
    skein_world *world = skein_world_create(NULL, NULL);
    skein_handle block, sheet;
    OK(skein_body_add(
        world, "lattice", NULL,
        SKEIN_SETTINGS(SKEIN_VEC3("grid", 3, 3, 3), SKEIN_VEC3("size", 1, 1, 1), SKEIN_TEXT("look", "plain")), &block));
    OK(skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 7)), &sheet));
    const render_frame *frame = update(world);
    assert_int_equal(frame->surface_count, 2);
    // nine vertices for each side of the cube, each with that side's normal
    const render_surface *cube = &frame->surfaces[0];
    assert_int_equal(cube->vertex_count, 6 * 9);
    render_surface_normals(cube, normals);
    for (size_t v = 0; v < cube->vertex_count; v++) {
        int axes = 0;
        for (size_t k = 0; k < 3; k++) axes += fabsf(normals[3 * v + k]) > 0.9999f;
        assert_int_equal(axes, 1);
    }
    assert_false(cube->material.glazed);
    assert_int_equal(cube->material.pattern, RENDER_PLAIN);
    assert_int_equal(frame->surfaces[1].vertex_count, 35);
    assert_false(frame->surfaces[1].material.glazed);
    assert_int_equal(frame->surfaces[1].material.pattern, RENDER_WEAVE);

    // jelly is smooth and has round edges: each of its corners has one normal; and so has cloth that is to look so
    OK(skein_set(world, block, "look", skein_text("jelly")));
    OK(skein_set(world, sheet, "look", skein_text("jelly")));
    frame = update(world);
    cube = &frame->surfaces[0];
    assert_true(cube->material.glazed && frame->surfaces[1].material.glazed);
    render_surface_normals(cube, normals);
    for (size_t v = 0; v < cube->vertex_count; v++)
        for (size_t w = 0; w < cube->vertex_count; w++)
            if (!memcmp(&cube->positions[3 * v], &cube->positions[3 * w], 3 * sizeof(double)))
                assert_memory_equal(&normals[3 * v], &normals[3 * w], 3 * sizeof(float));
    // woven only if asked for
    view.pattern = 1;
    assert_false(update(world)->surfaces[0].material.glazed);
    view.pattern = 0;
    skein_world_destroy(world);
}

/* A roof's two sides meet in an edge if it is steep, else in a smooth ridge; a seam there changes neither. */
static void creases_are_steep(void **state) {
    (void)state;
    static const uint32_t faces[2][4] = {{0, 1, 2, 3}, {3, 2, 4, 5}};
    for (int steep = 0; steep < 2; steep++) {
        double h = steep ? 1.0 : 0.5; // two slopes of 45 degrees, or of 27
        const double x[6][3] = {{0, 0, 1}, {1, 0, 1}, {1, h, 0}, {0, h, 0}, {1, 0, -1}, {0, 0, -1}};
        static const uint32_t sizes[2] = {4, 4}, particle_of_vertex[6] = {0, 1, 2, 3, 4, 5};
        static const float uv[16] = {0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1};
        skein_surface surface = {.particle_count = 6,
                                 .particle_of_vertex = particle_of_vertex,
                                 .vertex_count = 6,
                                 .face_sizes = sizes,
                                 .face_count = 2,
                                 .face_vertices = &faces[0][0],
                                 .face_vertex_count = 8,
                                 .corner_uv = uv};
        render_body_mesh mesh = {0};
        assert_true(render_body_mesh_make(&mesh, &surface, &x[0][0], false));
        assert_int_equal(mesh.vertex_count, 8);
        assert_int_equal(mesh.edge_count, 7);
        int alone = 0;
        for (size_t v = 0; v < mesh.vertex_count; v++) alone += mesh.weld[v] == v;
        assert_int_equal(alone, steep ? 8 : 6);
        render_body_mesh_release(&mesh);
    }
}

static void the_driver_had_nothing_to_say(void **state) {
    (void)state;
    const render_messages *messages = render_context_messages(context);
    if (messages->errors + messages->warnings > 0) fprintf(stderr, "driver: %s\n", messages->last);
    assert_int_equal(messages->errors + messages->warnings, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
#define TEST(name_) cmocka_unit_test_setup_teardown(name_, set_up_view, tear_down_view)
        TEST(a_box_is_where_it_stands),
        TEST(a_capsule_is_where_it_stands),
        TEST(a_bowl_is_the_lower_part_of_its_sphere),
        TEST(an_open_mesh_is_seen_from_both_sides),
        TEST(what_lies_in_a_bowl_is_seen),
        TEST(colliders_cast_shadows),
        TEST(a_rope_is_a_rod_from_particle_to_particle),
        TEST(a_cube_has_edges_and_a_cloth_has_none),
        TEST(creases_are_steep),
        TEST(the_driver_had_nothing_to_say),
    };
    return cmocka_run_group_tests_name("render, solids", tests, set_up, tear_down);
}
