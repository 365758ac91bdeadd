/* PBD without inertia: constraints move positions and nothing else does. The scenes of one spring, and random starts.
 */
#include "helpers.h"
#include "io/scene.h"

typedef struct stage {
    io_scene *scene;
    skein_world *world;
    double dt;
} stage;

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static stage set_stage(const char *name) {
    static const skein_kind *const none[] = {NULL};
    char path[256];
    snprintf(path, sizeof path, "%s/scenes/%s.json", SKEIN_SOURCE_DIR, name);
    io_faults faults = {report, NULL, 0, NULL};
    stage s = {.scene = io_scene_read(path, NULL, none, &faults)};
    assert_non_null(s.scene);
    s.world = io_scene_build(s.scene, NULL, &faults);
    assert_true(s.world && !faults.count);
    io_scene_steps_per_frame(io_scene_get(s.scene), &s.dt);
    return s;
}

static void clear_stage(stage *s) {
    skein_world_destroy(s->world);
    io_scene_free(s->scene);
}

static double distance_of(const skein_world *world) {
    return length3(minus(position_of(world, 0), position_of(world, 1)));
}

static void expect_at(const skein_world *world, double x0, double x1) {
    vec3 a = position_of(world, 0), b = position_of(world, 1);
    assert_near(a.x, x0, 0);
    assert_near(b.x, x1, 0);
    assert_true(a.y == 0 && a.z == 0 && b.y == 0 && b.z == 0);
}

/* As examples/one_spring_dual.c says: by a quarter of a metre each, exactly, and then no more. */
static void one_solve_is_enough(void **state) {
    (void)state;
    stage s = set_stage("one_spring");
    assert_int_equal(io_scene_get(s.scene)->advance, IO_BY_KEY);
    expect_at(s.world, -0.5, 0.5);
    for (int solve = 0; solve < 3; solve++) {
        steps(s.world, 1, s.dt);
        expect_at(s.world, -0.25, 0.25);
    }
    clear_stage(&s);
}

/* Points that are moved between the frames are back at rest length in the next, about the middle that they had. */
static void points_come_back_in_the_next_frame(void **state) {
    (void)state;
    stage s = set_stage("one_spring_live");
    uint64_t seed = 3;
    steps(s.world, 1, s.dt);
    expect_at(s.world, -2.75, 2.75);
    for (int frame = 0; frame < 100; frame++) {
        vec3 p[2] = {position_of(s.world, 0), position_of(s.world, 1)};
        for (size_t k = 0; k < 2; k++)
            if (frame % 3 != (int)k) {
                p[k] = (vec3){random_between(&seed, -10, 10), random_between(&seed, -10, 10), p[k].z};
                place_particle(s.world, k, p[k].x, p[k].y, p[k].z);
            }
        steps(s.world, 1, s.dt);
        assert_share(distance_of(s.world), 5.5, 1e-6);
        vec3 a = position_of(s.world, 0), b = position_of(s.world, 1);
        assert_near(a.x + b.x, p[0].x + p[1].x, 20 * EPSILON);
        assert_near(a.y + b.y, p[0].y + p[1].y, 20 * EPSILON);
    }
    clear_stage(&s);
}

/* A rigid constraint between particles of these masses, that is `length` long: as a formula, or as the built-in kind.
 */
static skein_world *two_points(double mass_a, double mass_b, double length, bool formula, double stiffness,
                               double damping) {
    skein_world *world = new_world("pbd", 1);
    OK(world, skein_set_path(world, "method.inertia", skein_number(0)));
    add_particle(world, mass_a, 0, 0, 0);
    add_particle(world, mass_b, length, 0, 0);
    if (!formula) add_spring(world, 0, 1, stiffness, damping);
    else
        OK(world,
           skein_constraint_add(world, "formula", (const uint32_t[]){0, 1}, 1,
                                SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - rest(length(p0 - p1))"),
                                               SKEIN_REAL("stiffness", stiffness), SKEIN_REAL("damping", damping)),
                                NULL));
    return world;
}

/* To 1e-6 of its length. A tape has some roundings more than the built-in kind, of the length that it starts from. */
static void from_any_start_it_is_at_rest_length(void **state) {
    (void)state;
    static const double masses[][2] = {{1, 1}, {0, 2}, {0.1, 50}};
    uint64_t seed = 17;
    for (size_t m = 0; m < COUNT(masses); m++)
        for (int formula = 0; formula < 2; formula++) {
            skein_world *world = two_points(masses[m][0], masses[m][1], 0.5, formula, INFINITY, 0);
            for (int start = 0; start < 10000; start++) {
                double p[6];
                for (size_t k = 0; k < 6; k++) p[k] = random_between(&seed, -1, 1);
                OK(world, skein_positions_set(world, 0, 2, p));
                double before = distance_of(world);
                steps(world, 1, 0.01);
                assert_near(distance_of(world), 0.5, 1e-6 * (formula ? fmax(before, 0.5) : 0.5));
            }
            skein_world_destroy(world);
        }
}

/* Neither velocity nor force moves anything; colliders and limits still do. */
static void nothing_else_moves(void **state) {
    (void)state;
    skein_world *world = new_world("pbd", 3);
    OK(world, skein_set_path(world, "method.inertia", skein_number(0)));
    add_gravity(world);
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1, 0, 0)), NULL));
    OK(world, skein_collider_add(world, "plane",
                                 SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.25), SKEIN_REAL("recovery", 1e6)), NULL));
    add_moving(world, 1, 0, 1, 0, 1, 2, 3);
    add_moving(world, 1, 5, 0.125, 0, 1, -2, 3);
    for (int n = 0; n < 3; n++) {
        steps(world, 1, 0.1);
        vec3 above = position_of(world, 0), inside = position_of(world, 1);
        assert_true(above.x == 0 && above.y == 1 && above.z == 0);
        assert_true(inside.x == 5 && inside.y == 0.25 && inside.z == 0);
    }
    assert_share(skein_world_time(world), 0.3, 1e-12);
    // what would be carried along starts from rest once inertia is back
    OK(world, skein_set_path(world, "method.inertia", skein_number(1)));
    steps(world, 1, 0.1);
    assert_true(position_of(world, 0).x > 0.1);
    skein_world_destroy(world);
}

/* A soft one comes closer by K/(1 + K + b), K = k h^2 w and b = c h w, at every solve. */
static void a_soft_one_comes_closer(void **state) {
    (void)state;
    const double h = 0.1, k = 30, w = 1.5;
    for (int formula = 0; formula < 2; formula++)
        for (double c = 0; c < 5; c += 4) {
            skein_world *world = two_points(1, 2, 0.5, formula, k, c);
            place_particle(world, 1, 1.5, 0, 0);
            double off = 1;
            for (int solve = 0; solve < 4; solve++) {
                steps(world, 1, h);
                off *= 1 - k * h * h * w / (1 + k * h * h * w + c * h * w);
                assert_near(distance_of(world) - 0.5, off, 1e-6);
            }
            skein_world_destroy(world);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_solve_is_enough),
        cmocka_unit_test(points_come_back_in_the_next_frame),
        cmocka_unit_test(from_any_start_it_is_at_rest_length),
        cmocka_unit_test(nothing_else_moves),
        cmocka_unit_test(a_soft_one_comes_closer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
