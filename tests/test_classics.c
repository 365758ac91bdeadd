/* The scenes of textbooks, as ropes and lattices, against their formulas: pendulum, oscillator, chain, cantilever. */
#include "helpers.h"
#include "io/scene.h"

static const double g = 9.81;

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

/* From one end to the other end of its swing and back: 2 pi sqrt(L/g) over the mean (of Gauss) of 1 and cos(a/2). */
static void a_pendulum_swings_as_its_amplitude_says(void **state) {
    (void)state;
    stage s = set_stage("pendulum");
    double p = 1, q = cos(PI / 6), crossed[2], last = 1;
    for (int i = 0; i < 5; i++) {
        double mean = (p + q) / 2;
        q = sqrt(p * q), p = mean;
    }
    for (int n = 1, count = 0; count < 2; n++) {
        steps(s.world, 1, s.dt);
        double x = position_of(s.world, 1).x;
        if (x * last < 0) crossed[count++] = (n - x / (x - last)) * s.dt;
        last = x;
        assert_true(n < 1000);
    }
    assert_share(2 * (crossed[1] - crossed[0]), 2 * PI * sqrt(0.9 / g) / p, 2e-3);
    assert_share(crossed[0], (crossed[1] - crossed[0]) / 2, 5e-3);
    clear_stage(&s);
}

static void an_oscillator_goes_as_a_sine(void **state) {
    (void)state;
    stage s = set_stage("oscillator");
    double omega = sqrt(10 / 0.25), amplitude = 1.58114 / omega;
    for (int n = 1; n <= io_scene_get(s.scene)->frames; n++) {
        steps(s.world, 1, s.dt);
        vec3 x = position_of(s.world, 1);
        assert_near(x.x, 0.3 + amplitude * sin(omega * n * s.dt), 2e-3 * amplitude);
        assert_under(hypot(x.y - 0.25, x.z), 1e-6);
    }
    clear_stage(&s);
}

/* y = a cosh(x/a) of the chain's length, once it has come to rest. */
static void a_chain_hangs_as_a_catenary(void **state) {
    (void)state;
    stage s = set_stage("hanging_chain");
    steps(s.world, io_scene_get(s.scene)->frames, s.dt);
    double low = 0.1, high = 10; // 2 a sinh(0.8/a) = 2.2
    for (int i = 0; i < 60; i++) {
        double a = (low + high) / 2;
        *(2 * a * sinh(0.8 / a) > 2.2 ? &low : &high) = a;
    }
    for (size_t i = 0; i < 49; i++) {
        vec3 x = position_of(s.world, i);
        assert_near(x.y, 1.4 + low * (cosh(x.x / low) - cosh(0.8 / low)), 0.005);
        assert_under(x.z, 0.005);
    }
    assert_true(statistics_of(s.world).kinetic_energy < 1e-5);
    clear_stage(&s);
}

/* Four chords of springs, a long each, d apart. In bending the upper ones get longer and the lower ones shorter. The
 * crossed diagonals above and below pull with them, in series with the springs across; those of the sides do not, but
 * they bear the shear:
 *
 *   EI = K a d^2/2, K = 2 k + k s/(k + s);   GA = 2 s a (d = a)
 *
 * and each column's weight bends and shears what is between it and the wall. */
static void a_cantilever_sags_as_a_beam(void **state) {
    (void)state;
    stage s = set_stage("cantilever");
    const double a = 0.06, k = 3e5, shear = 1.5e5, weight = g / 25, length = 24 * a;
    double stiffness = (2 * k + k * shear / (k + shear)) * a * a * a / 2, sag = 0, sheared = 0;
    for (int column = 1; column <= 24; column++) {
        double x = column * a;
        sag += weight * x * x * (3 * length - x) / (6 * stiffness);
        sheared += weight * x / (2 * shear * a);
    }
    steps(s.world, io_scene_get(s.scene)->frames, s.dt);
    skein_statistics end = statistics_of(s.world);
    double is = 0;
    for (size_t i = 96; i < 100; i++) is += (0.5 - position_of(s.world, i).y) / 4;
    print_message("the tip sags by %.5f m; bending %.5f, shear %.5f\n", is, sag, sheared);
    assert_true(sag < 0.05 * length && sheared < 0.02 * sag);
    assert_share(is, sag + sheared, 0.02);
    assert_true(end.kinetic_energy < 1e-6);
    clear_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pendulum_swings_as_its_amplitude_says),
        cmocka_unit_test(an_oscillator_goes_as_a_sine),
        cmocka_unit_test(a_chain_hangs_as_a_catenary),
        cmocka_unit_test(a_cantilever_sags_as_a_beam),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
