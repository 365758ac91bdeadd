/* The scenes of cubes: what each of them says that it shows, under every method, by `--set method.type=...` alone. */
#include "all_methods.h"
#include "helpers.h"
#include "io/scene.h"

static const double edge = 0.5;

typedef struct track {
    vec3 at[481];
    size_t count;
    size_t left; /* the first frame after which nothing touched the last collider any more */
    skein_statistics last;
} track;

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

/* Whether anything touches the collider that was made last. */
static bool touches_last(const skein_world *world) {
    skein_handle last = skein_object_at(world, SKEIN_COLLIDER, skein_object_count(world, SKEIN_COLLIDER) - 1);
    skein_contact contacts[256];
    size_t count;
    OK(world, skein_contacts_copy(world, contacts, COUNT(contacts), &count));
    for (size_t i = 0; i < count && i < COUNT(contacts); i++)
        if (!memcmp(&contacts[i].collider, &last, sizeof last)) return true;
    return false;
}

/* Runs a scene for its frames and notes where the middle of its particles is after each. */
static track *run_scene(const char *scene, const char *const *sets) {
    static const skein_kind *const none[] = {NULL};
    char path[256];
    snprintf(path, sizeof path, "%s/scenes/%s.json", SKEIN_SOURCE_DIR, scene);
    io_faults faults = {report, NULL, 0, NULL};
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
        if (touches_last(world)) t->left = t->count;
    }
    t->last = statistics_of(world);
    assert_int_equal(t->last.nonfinite, 0);
    assert_true(t->last.max_penetration < 1e-4);
    skein_world_destroy(world);
    io_scene_free(read);
    return t;
}

/* Runs under a method, with up to three more settings. */
static track *run_under(const char *scene, const char *method, const char *const *more) {
    char set[64];
    const char *sets[5] = {set};
    snprintf(set, sizeof set, "method.type=%s", method);
    for (size_t i = 0; more && more[i]; i++) sets[1 + i] = more[i];
    return run_scene(scene, sets);
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
        track *like = run_under(scenes[s], "rk4", NULL);
        for (size_t m = 0; m < COUNT(all_methods); m++) {
            track *t = run_under(scenes[s], all_methods[m], NULL);
            vec3 end = t->at[t->count - 1], off = minus(end, like->at[like->count - 1]);
            print_message("%s, %s: rests at %.4f %.4f %.4f, off by %.4f\n", scenes[s], all_methods[m], end.x, end.y,
                          end.z, length3(off));
            assert_true(t->last.kinetic_energy < 1e-4); // of 30 J that it fell by
            assert_under(length3(off), 0.02 * edge);
            assert_under(hypot(end.x, end.z), 0.02 * edge);
            if (s == 1) assert_true(rise_of(t) < 0.05 * edge);
            free(t);
        }
        free(like);
    }
}

/* How much room there is inside a body's surface: a sum over fans of its faces, each with the origin a tetrahedron. */
static double volume_of(const skein_world *world) {
    skein_surface s;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &s));
    double sum = 0;
    const uint32_t *corner = s.face_vertices;
    for (size_t f = 0; f < s.face_count; corner += s.face_sizes[f++])
        for (size_t k = 2; k < s.face_sizes[f]; k++) {
            vec3 a = position_of(world, s.particle_of_vertex[corner[0]]),
                 b = position_of(world, s.particle_of_vertex[corner[k - 1]]),
                 c = position_of(world, s.particle_of_vertex[corner[k]]);
            sum += (a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x)) / 6;
        }
    return sum;
}

/* How high the cube is, over all of its particles. */
static double height_of(const skein_world *world) {
    double least = INFINITY, most = -INFINITY;
    for (size_t i = 0; i < skein_particle_count(world); i++) {
        least = fmin(least, position_of(world, i).y);
        most = fmax(most, position_of(world, i).y);
    }
    return most - least;
}

/* Where it falls on the plane it is squeezed by a tenth, gets as long as it was and longer, and so again and less, as
 * jelly does; and all the time it is as large as it was. */
static void a_jelly_wobbles_and_keeps_its_volume(void **state) {
    (void)state;
    static const skein_kind *const none[] = {NULL};
    io_faults faults = {report, NULL, 0, NULL};
    io_scene *read = io_scene_read(SKEIN_SOURCE_DIR "/scenes/cube_plane.json", NULL, none, &faults);
    assert_non_null(read);
    skein_world *world = io_scene_build(read, NULL, &faults);
    assert_non_null(world);
    double volume = volume_of(world), least = 1, most = 0, high[241];
    assert_near(volume, edge * edge * edge, 1e-6);
    for (int frame = 1; frame <= 240; frame++) {
        steps(world, 1, 1.0 / 60);
        least = fmin(least, volume_of(world) / volume), most = fmax(most, volume_of(world) / volume);
        high[frame] = height_of(world) / edge;
    }
    int swings = 0;
    double shortest = 1;
    for (int i = 2; i < 240; i++) { // where it is shorter than just before and after, and than at rest
        swings += high[i] < high[i - 1] && high[i] <= high[i + 1] && high[i] < high[240] - 0.002;
        shortest = fmin(shortest, high[i]);
    }
    print_message("squeezed to %.3f, %d swings, volume from %.3f to %.3f\n", shortest, swings, least, most);
    assert_true(shortest < 0.92 && swings >= 4);
    assert_true(least > 0.97 && most < 1.01);
    assert_near(high[240], high[220], 1e-3);
    skein_world_destroy(world);
    io_scene_free(read);
}

static void a_cube_slides_down_the_slope(void **state) {
    (void)state;
    double slope = 25 * PI / 180, ought = 9.81 * (sin(slope) - 0.3 * cos(slope));
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        track *t = run_under("cube_slope", all_methods[m], NULL);
        double down[3];
        for (size_t k = 0; k < 3; k++) down[k] = t->at[60 + 60 * k].x * cos(slope) - t->at[60 + 60 * k].y * sin(slope);
        print_message("%s: slides at %.4f m/s2\n", all_methods[m], down[2] - 2 * down[1] + down[0]);
        assert_share(down[2] - 2 * down[1] + down[0], ought, 0.05);
        free(t);
        // and stays where friction is more than the slope
        t = run_under("cube_slope", all_methods[m], (const char *const[]){"colliders.slope.friction=0.55", NULL});
        assert_under(length3(minus(t->at[180], t->at[90])), 0.002);
        free(t);
    }
}

/* The paths agree until the cube leaves the ball. */
static void a_cube_slides_off_the_ball(void **state) {
    (void)state;
    track *like = run_under("cube_sphere", "rk4", NULL);
    assert_true(like->left > 40 && like->left < 80);
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        track *t = run_under("cube_sphere", all_methods[m], NULL);
        double off = 0;
        for (size_t i = 0; i < like->left; i++) off = fmax(off, length3(minus(t->at[i], like->at[i])));
        print_message("%s: leaves at frame %zu of %zu, off by %.4f until then\n", all_methods[m], t->left, like->left,
                      off);
        assert_under(off, 0.05 * edge);
        assert_true(t->at[t->count - 1].x > 0.9 && t->at[t->count - 1].y < 0.3); // beside the ball, on the ground
        free(t);
    }
    free(like);
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
        cmocka_unit_test(cubes_come_to_rest),           cmocka_unit_test(a_jelly_wobbles_and_keeps_its_volume),
        cmocka_unit_test(a_cube_slides_down_the_slope), cmocka_unit_test(a_cube_slides_off_the_ball),
        cmocka_unit_test(masses_let_a_cube_hop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
