/* Solids that are formulas over a body's tetrahedra: scenes/neo_hookean.json against the energy that the textbook has for
 * each deformation (Bonet and Wood), W = mu/2 (I1 - 3 - 2 log J) + lambda/2 (log J)^2. */
#include "helpers.h"
#include "io/scene.h"

static void complain(void *user, const skein_error *error) {
    (void)user;
    fprintf(stderr, "%s: %s\n", error->where, error->message);
}

static skein_world *build(const char *const *sets) {
    static const skein_kind *const no_exporters[] = {NULL};
    io_faults faults = {complain, NULL, 0, NULL};
    io_scene *scene = io_scene_read(SKEIN_SOURCE_DIR "/scenes/neo_hookean.json", sets, no_exporters, &faults);
    assert_non_null(scene);
    skein_world *world = io_scene_build(scene, NULL, &faults);
    assert_non_null(world);
    io_scene_free(scene);
    return world;
}

static double determinant(const double f[9]) {
    return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) + f[2] * (f[3] * f[7] - f[4] * f[6]);
}

/* m3, of all tetrahedra of the only body. */
static double volume_of(skein_world *world) {
    static uint32_t corners[1000][4];
    size_t count;
    double volume = 0;
    OK(world, skein_body_elements(world, skein_object_at(world, SKEIN_BODY, 0), SKEIN_TETRAHEDRA, corners[0],
                                  COUNT(corners), &count));
    assert_int_equal(count, 560);
    for (size_t t = 0; t < count; t++) {
        double edges[9];
        vec3 p = position_of(world, corners[t][0]);
        for (size_t i = 0; i < 3; i++) {
            vec3 q = position_of(world, corners[t][i + 1]);
            edges[3 * i] = q.x - p.x, edges[3 * i + 1] = q.y - p.y, edges[3 * i + 2] = q.z - p.z;
        }
        volume += fabs(determinant(edges)) / 6;
    }
    return volume;
}

static void its_energy_is_the_closed_form(void **state) {
    (void)state;
    static const double deformations[][9] = {
        {1, 0, 0, 0, 1, 0, 0, 0, 1},                 // as it was made
        {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1},        // turned
        {1.3, 0, 0, 0, 1.3, 0, 0, 0, 1.3},           // blown up
        {1.5, 0, 0, 0, 0.8, 0, 0, 0, 0.9},           // drawn
        {1, 0.7, 0, 0, 1, 0, 0, 0, 1},               // sheared
        {0.7, 0.2, -0.1, 0.3, 0.9, 0.2, 0.1, 0, 0.6} // anyhow
    };
    const double mu = 2e4, lambda = 8e4;
    skein_world *world =
        build((const char *const[]){"constraints.0.parameters.mu=2e4", "constraints.0.parameters.lambda=8e4", NULL});
    double volume = volume_of(world), unit = volume * mu;
    size_t count = skein_particle_count(world);
    double(*x)[3] = malloc(2 * count * sizeof *x), (*y)[3] = x + count;
    OK(world, skein_positions_copy(world, 0, count, x[0]));
    for (size_t d = 0; d < COUNT(deformations); d++) {
        const double *f = deformations[d], j = determinant(f), l = log(j);
        double i1 = 0;
        for (int i = 0; i < 9; i++) i1 += f[i] * f[i];
        for (size_t p = 0; p < count; p++)
            for (size_t k = 0; k < 3; k++)
                y[p][k] = f[3 * k] * x[p][0] + f[3 * k + 1] * x[p][1] + f[3 * k + 2] * x[p][2];
        OK(world, skein_positions_set(world, 0, count, y[0]));
        double energy = volume * (mu / 2 * (i1 - 3 - 2 * l) + lambda / 2 * l * l);
        assert_near(statistics_of(world).elastic_energy, energy, 1e-3 * fabs(energy) + 1e-4 * unit);
    }
    free(x);
    skein_world_destroy(world);
}

/* Let go where it was made, without weight, it stays; dropped, it comes back to its shape. */
static void it_comes_back_to_its_shape(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    skein_world *world = build((const char *const[]){"forces.0=null", "forces.0.rate=20", "colliders.0=null", NULL});
    double volume = volume_of(world);
    size_t count = skein_particle_count(world);
    double(*x)[3] = malloc(count * sizeof *x);
    OK(world, skein_positions_copy(world, 0, count, x[0]));
    for (size_t p = 0; p < count; p++) x[p][1] *= 1.3, x[p][0] *= 0.9;
    OK(world, skein_positions_set(world, 0, count, x[0]));
    assert_share(volume_of(world), 1.17 * volume, 1e-3);
    double before = statistics_of(world).elastic_energy;
    steps(world, 120, 1.0 / 60);
    assert_share(volume_of(world), volume, 2e-3);
    assert_true(statistics_of(world).elastic_energy < 1e-3 * before);
    free(x);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(its_energy_is_the_closed_form),
                                       cmocka_unit_test(it_comes_back_to_its_shape)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
