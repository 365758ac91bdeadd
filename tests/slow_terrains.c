/* The scenes of cubes: what each of them says that it shows, under force and position methods. */
#include "helpers.h"
#include "io/scene.h"

static const double edge = 0.5;

typedef struct track {
    vec3 at[481];
    size_t count;
    skein_statistics last;
} track;

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

/* Runs a scene for its frames and notes where the middle of its particles is after each. */
static track *run_scene(const char *scene, const char *const *sets) {
    static const skein_kind *const none[] = {NULL};
    char path[256];
    snprintf(path, sizeof path, "%s/scenes/%s.json", SKEIN_SOURCE_DIR, scene);
    io_faults faults = {report, NULL, 0};
    io_scene *read = io_scene_read(path, sets, none, &faults);
    assert_non_null(read);
    skein_world *world = io_scene_build(read, NULL, &faults);
    assert_true(world && !faults.count);
    track *t = calloc(1, sizeof *t);
    assert_non_null(t);
    for (int frame = 0; frame <= io_scene_get(read)->frames; frame++) {
        if (frame) steps(world, 1, 1 / io_scene_get(read)->fps);
        vec3 sum = {0, 0, 0};
        size_t count = skein_particle_count(world);
        for (size_t i = 0; i < count; i++) {
            vec3 p = position_of(world, i);
            sum.x += p.x / (double)count, sum.y += p.y / (double)count, sum.z += p.z / (double)count;
        }
        t->at[t->count++] = sum;
    }
    t->last = statistics_of(world);
    assert_int_equal(t->last.nonfinite, 0);
    assert_true(t->last.max_penetration < 1e-4);
    skein_world_destroy(world);
    io_scene_free(read);
    return t;
}

static track *run_under(const char *scene, size_t method, const char *more) {
    char set[64];
    snprintf(set, sizeof set, "method.type=%s", method_names[method]);
    return run_scene(scene, (const char *const[]){set, more, NULL});
}

/* How far the middle rises above where it was before. */
static double rise_of(const track *t) {
    double lowest = INFINITY, rise = 0;
    for (size_t i = 0; i < t->count; i++) {
        lowest = fmin(lowest, t->at[i].y);
        rise = fmax(rise, t->at[i].y - lowest);
    }
    return rise;
}

/* On the plane and in the bowl the cube comes to rest, at the same place under every method. */
static void cubes_come_to_rest(void **state) {
    (void)state;
    static const char *const scenes[] = {"cube_plane", "cube_bowl"};
    for (size_t s = 0; s < COUNT(scenes); s++) {
        vec3 first = {0, 0, 0};
        for (size_t m = 0; m < COUNT(method_names); m++) {
            track *t = run_under(scenes[s], m, NULL);
            vec3 end = t->at[t->count - 1];
            assert_true(t->last.kinetic_energy < 1e-5);
            assert_under(hypot(end.x, end.z), 0.02 * edge);
            if (m) assert_under(length3(minus(end, first)), 0.02 * edge);
            else first = end;
            if (s == 1) assert_true(rise_of(t) < 0.05 * edge);
            free(t);
        }
    }
}

static void a_cube_slides_down_the_slope(void **state) {
    (void)state;
    double slope = 25 * PI / 180, ought = 9.81 * (sin(slope) - 0.3 * cos(slope));
    for (size_t m = 0; m < COUNT(method_names); m++) {
        track *t = run_under("cube_slope", m, NULL);
        double down[3];
        for (size_t k = 0; k < 3; k++) down[k] = t->at[60 + 60 * k].x * cos(slope) - t->at[60 + 60 * k].y * sin(slope);
        assert_share(down[2] - 2 * down[1] + down[0], ought, 0.05);
        free(t);
        // and stays where friction is more than the slope
        t = run_under("cube_slope", m, "colliders.slope.friction=0.55");
        assert_under(length3(minus(t->at[180], t->at[90])), 0.002);
        free(t);
    }
}

/* The paths agree until the cube leaves the ball. */
static void a_cube_slides_off_the_ball(void **state) {
    (void)state;
    track *first = run_under("cube_sphere", 0, NULL);
    for (size_t m = 1; m < COUNT(method_names); m++) {
        track *t = run_under("cube_sphere", m, NULL);
        for (size_t i = 0; i < 50; i++) assert_under(length3(minus(t->at[i], first->at[i])), 0.05 * edge);
        assert_true(t->at[t->count - 1].x > 0.9 && t->at[t->count - 1].y < 0.3); // beside the ball, on the ground
        free(t);
    }
    free(first);
}

/* Masses let it hop; without them the same cube does not. */
static void masses_let_a_cube_hop(void **state) {
    (void)state;
    track *hops = run_scene("bowl_masses", NULL),
          *rests = run_scene("bowl_masses", (const char *const[]){"colliders.bowl.mass=0", NULL});
    assert_true(rise_of(hops) > 0.3 * edge);
    assert_true(rise_of(rests) < 0.05 * edge);
    assert_true(rests->last.kinetic_energy < 0.01);
    free(hops);
    free(rests);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_come_to_rest),
        cmocka_unit_test(a_cube_slides_down_the_slope),
        cmocka_unit_test(a_cube_slides_off_the_ball),
        cmocka_unit_test(masses_let_a_cube_hop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
