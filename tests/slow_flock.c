/* What a flock does in a minute: it circles in a ring, keeps away from a predator, and its order follows the zones. */
#include "helpers.h"
#include "io/scene.h"

static void report(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

/* scenes/birds.json with these values set. */
static skein_world *birds(const char *const *sets) {
    static const skein_kind *const none[] = {NULL};
    io_faults faults = {report, NULL, 0, NULL};
    io_scene *scene = io_scene_read(SKEIN_SOURCE_DIR "/scenes/birds.json", sets, none, &faults);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_non_null(world);
    io_scene_free(scene);
    return world;
}

static const double centre[3] = {0, 0, 0};

static skein_order order_of(skein_world *world) {
    skein_order o;
    OK(world, skein_order_measure(world, 0, skein_particle_count(world), centre, 6.6666, &o));
    return o;
}

static void an_undisturbed_flock_circles_in_a_ring(void **state) {
    (void)state;
    for (int seed = 1; seed <= 3; seed++) {
        char set[64];
        snprintf(set, sizeof set, "bodies.0.seed=%d", seed);
        skein_world *world = birds((const char *const[]){set, NULL});
        assert_int_equal(skein_particle_count(world), 1024);
        double milling = 0, radius = 0, farthest = 0;
        int count = 0;
        for (int second = 1; second <= 60; second++) {
            steps(world, 60, 1.0 / 60);
            if (second < 20) continue;
            skein_order o = order_of(world);
            milling += o.milling, radius += o.radius, count++;
            farthest = fmax(farthest, o.farthest);
        }
        assert_true(milling / count > 0.9); // over 0.6 is asked for
        assert_true(farthest < 2 * radius / count);
        skein_world_destroy(world);
    }
}

static void nobody_stays_near_the_predator(void **state) {
    (void)state;
    skein_world *world = birds((const char *const[]){"forces.hawk.enabled=true", NULL});
    skein_value radius;
    OK(world, skein_get_path(world, "forces.hawk.radius", &radius));
    steps(world, 600, 1.0 / 60);
    int near = 0;
    for (int i = 0; i < 50 * 60; i++) {
        steps(world, 1, 1.0 / 60);
        for (size_t p = 0; p < 1024; p++) {
            vec3 x = position_of(world, p);
            near += hypot(x.x, x.y) < 0.5 * radius.number[0]; // as seen along z, its line of sight
        }
    }
    assert_int_equal(near, 0);
    skein_world_destroy(world);
}

/* Polarization and the distance to the nearest from 10 s to 30 s, of 400 birds. */
static void measure(const char *start, const char *set, int seed, double *polarization, double *nearest) {
    char seeded[64];
    snprintf(seeded, sizeof seeded, "bodies.0.seed=%d", seed);
    bool swirls = start[0] == 's';
    skein_world *world = birds((const char *const[]){
        "bodies.0.side=20", "forces.0.measure=distance", seeded, set, swirls ? "bodies.0.swirl=4" : "bodies.0.swirl=0",
        swirls ? "bodies.0.spread=[30,12,30]" : "bodies.0.spread=[20,8,20]", NULL});
    *polarization = *nearest = 0;
    for (int second = 1; second <= 30; second++) {
        steps(world, 60, 1.0 / 60);
        if (second < 10) continue;
        skein_order o = order_of(world);
        *polarization += o.polarization / 21, *nearest += o.nearest / 21;
    }
    skein_world_destroy(world);
}

static void order_follows_the_zones(void **state) {
    (void)state;
    for (int seed = 1; seed <= 3; seed++) {
        double p[2], d[2];
        for (int k = 0; k < 2; k++)
            measure("swirling", k ? "forces.0.separation=4" : "forces.0.separation=2", seed, &p[k], &d[k]);
        assert_true(d[1] > 1.1 * d[0]);
        for (int k = 0; k < 2; k++)
            measure("at random", k ? "forces.0.alignment=3" : "forces.0.alignment=0.5", seed, &p[k], &d[k]);
        assert_true(p[1] > 1.1 * p[0]);
        // more cohesion weakens both
        for (int k = 0; k < 2; k++)
            measure("at random", k ? "forces.0.cohesion=6" : "forces.0.cohesion=1", seed, &p[k], &d[k]);
        assert_true(p[1] < 0.9 * p[0]);
        for (int k = 0; k < 2; k++)
            measure("swirling", k ? "forces.0.cohesion=6" : "forces.0.cohesion=1", seed, &p[k], &d[k]);
        assert_true(d[1] < 0.9 * d[0]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_undisturbed_flock_circles_in_a_ring),
        cmocka_unit_test(nobody_stays_near_the_predator),
        cmocka_unit_test(order_follows_the_zones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
