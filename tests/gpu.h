/* For tests of the graphics card: worlds there and on the processor, held against each other. Mesa's llvmpipe plays a
 * card where there is none. */
#ifndef SKEIN_TESTS_GPU_H
#define SKEIN_TESTS_GPU_H

#include "gpu/device.h"
#include "helpers.h"

static const double dt = 1.0 / 60;
/* The card computes in float, so a processor that computes in double is farther off it by its own rounding. */
#define FLOAT_OFF (sizeof(skein_real) == sizeof(double) ? 2 : 1)

static const char *const explicit_methods[] = {
    "explicit_euler", "symplectic_euler", "lookahead_euler", "midpoint", "leapfrog", "rk4", "xpbd", "pbd"};

/* The world on a card; skips the test where there is none. */
static inline void to_card(skein_world *world) {
    if (!skein_world_device_set(world, SKEIN_DEVICE_GPU)) return;
    fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
    skein_world_destroy(world);
    skip();
}

/* The farthest that any particle's position or velocity is off, the sizes being about 1. */
static inline double difference(const skein_world *a, const skein_world *b) {
    size_t count = skein_particle_count(a);
    double *x = calloc(count * 12, sizeof *x), worst = 0;
    OK(a, skein_positions_copy(a, 0, count, x));
    OK(a, skein_velocities_copy(a, 0, count, x + 3 * count));
    OK(b, skein_positions_copy(b, 0, count, x + 6 * count));
    OK(b, skein_velocities_copy(b, 0, count, x + 9 * count));
    for (size_t i = 0; i < 6 * count; i++) {
        double off = fabs(x[i] - x[6 * count + i]);
        if (!(off <= worst)) worst = off;
    }
    free(x);
    return worst;
}

static inline void scatter(skein_world *world, size_t count, double size, uint64_t seed) {
    double *x = calloc(count * 7, sizeof *x), *v = x + 3 * count, *m = x + 6 * count;
    for (size_t i = 0; i < 3 * count; i++) {
        x[i] = random_between(&seed, -size / 2, size / 2);
        v[i] = random_between(&seed, -1, 1);
    }
    for (size_t i = 0; i < count; i++) m[i] = i % 17 == 5 ? 0 : random_between(&seed, 0.5, 2);
    OK(world, skein_particles_add(world, count, x, v, m, NULL));
    free(x);
}

/* Steps both worlds, on either device, and holds them against each other. */
static inline void assert_agree(skein_world *cpu, skein_world *gpu, int steps, double most, const char *what) {
    to_card(gpu);
    for (int i = 0; i < steps; i++) {
        OK(cpu, skein_world_step(cpu, dt));
        OK(gpu, skein_world_step(gpu, dt));
    }
    double off = difference(cpu, gpu);
    most *= FLOAT_OFF;
    if (!(off <= most)) fprintf(stderr, "%s is off by %g\n", what, off);
    assert_true(off <= most);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

#endif
