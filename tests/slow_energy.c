/* Energy over a long time: symplectic Euler and leapfrog keep that of an undamped oscillator, the others grow and
 * decay as theory says. */
#include "helpers.h"

static const double z = 0.01; /* omega h; omega = 1 */

static skein_world *oscillator(const char *method, int substeps) {
    skein_world *world = new_world(method, substeps);
    uint32_t held = add_particle(world, 0, 0, 0, 0), free_one = add_particle(world, 1, 1, 0, 0);
    add_spring(world, held, free_one, 1, 0);
    place_particle(world, free_one, 1.2, 0, 0);
    return world;
}

static double energy_of(const skein_world *world) {
    double x = position_of(world, 1).x - 1, v = velocity_of(world, 1).x;
    return (x * x + v * v) / 2;
}

static void energy_is_kept_for_ten_thousand_periods(void **state) {
    (void)state;
    static const char *const methods[] = {"symplectic_euler", "leapfrog"};
    enum { SUBSTEPS = 500 };
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = oscillator(methods[m], SUBSTEPS);
        double start = energy_of(world), low = start, high = start;
        int count = (int)ceil(10000 * 2 * PI / (z * SUBSTEPS));
        for (int n = 0; n < count; n++) {
            steps(world, 1, z * SUBSTEPS);
            double now = energy_of(world);
            low = fmin(low, now), high = fmax(high, now);
        }
        print_message("%s: from %.6f to %.6f of the start\n", methods[m], low / start, high / start);
        assert_true(low > 0.99 * start && high < 1.01 * start);
        skein_world_destroy(world);
    }
}

/* By how much the logarithm of the energy goes up a substep. */
static void energy_grows_and_decays_as_theory_says(void **state) {
    (void)state;
    const struct {
        const char *method;
        double rate;
    } rows[] = {
        {"explicit_euler", log(1 + z * z)},
        {"backward_euler", -log(1 + z * z)},
        {"lookahead_euler", log(1 - z * z + z * z * z * z)},
    };
    enum { SUBSTEPS = 20000 };
    for (size_t m = 0; m < COUNT(rows); m++) {
        skein_world *world = oscillator(rows[m].method, SUBSTEPS);
        double start = energy_of(world);
        steps(world, 1, z * SUBSTEPS);
        assert_share(log(energy_of(world) / start) / SUBSTEPS, rows[m].rate, 0.05);
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(energy_is_kept_for_ten_thousand_periods),
        cmocka_unit_test(energy_grows_and_decays_as_theory_says),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
