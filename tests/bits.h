/* A scenario whose hash must be the same everywhere: for test_bits.c, and for elsewhere/bits.c, which has no
 * cmocka because it is built for another processor. */
#ifndef SKEIN_TESTS_BITS_H
#define SKEIN_TESTS_BITS_H

#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>

static void must(const skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "%s: %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    abort();
}

/* A grid in strips, a mesh in groups, loose particles, tethers, contact: every wide kernel has a part. */
static uint64_t hash_of_run(const char *method, int substeps, const char *isa, int threads) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    if (!world) abort();
    static const double corners[] = {0, 0, 0, 0.4, 0, 0.1, 0.1, 0.1, 0.5, 0.6, 0.1, 0.6, 0.3, 0.2, 0.9};
    static const uint32_t sizes[] = {3, 3, 3}, faces[] = {0, 1, 2, 1, 3, 2, 2, 3, 4};
    skein_mesh mesh = {corners, 5, sizes, 3, faces, 9};
    must(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    must(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 53, 70), SKEIN_VEC3("position", 0.1, 0.6, 0), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 30), SKEIN_REAL("shear.stiffness", 10),
                                            SKEIN_REAL("bend.stiffness", 1), SKEIN_REAL("stretch.damping", 0.001)),
                             NULL));
    must(world, skein_body_add(world, "cloth", &mesh,
                             SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_REAL("stretch.stiffness", 30), SKEIN_TEXT("pins", "0"),
                                            SKEIN_REAL("bend.stiffness", 1)),
                             NULL));
    for (int i = 0; i < 37; i++) {
        double x[] = {0.03 * i - 0.5, 0.55, 0.01 * i}, v[] = {0.1, -0.5, 0.02 * i}, mass = 0.01 + 0.001 * i;
        must(world, skein_particles_add(world, 1, x, v, &mass, NULL));
    }
    must(world, skein_force_add(world, "gravity", NULL, NULL));
    must(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5), SKEIN_REAL("quadratic", 1e-5)), NULL));
    must(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1e-5, 0, 2e-5)), NULL));
    must(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0, 1)), NULL));
    must(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.5), SKEIN_REAL("motion.spin", 3)), NULL));
    must(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", 0.3), SKEIN_REAL("restitution", 0.5)), NULL));
    for (int i = 0; i < 30; i++) must(world, skein_world_step(world, 1.0 / 90));
    skein_statistics s;
    must(world, skein_world_statistics(world, &s));
    if (s.nonfinite || s.contacts < 10) abort();
    skein_world_destroy(world);
    return s.state_hash;
}

/* Any compiler and machine must come to these; they change only when the arithmetic or its order does. */
static const struct {
    const char *method;
    int substeps; /* that are stable, or nearly */
} bits_methods[] = {{"symplectic_euler", 8}, {"xpbd", 8}, {"explicit_euler", 64}, {"lookahead_euler", 24}, {"midpoint", 24},
                    {"leapfrog", 12},        {"rk4", 8},  {"backward_euler", 1},  {"pbd", 8}};
#ifdef SKEIN_DOUBLE
static const uint64_t golden[] = {0x5f2798cfc873b035, 0x1ce74f269b1f9eeb, 0x60a3b998c911f679, 0xc95421b28670e7f6, 0x369b5689ba56962c,
                                  0x8682bf3954114461, 0x05f59713b328492a, 0x6b73b006106aea1d, 0x7dad2274ef835af3};
#else
static const uint64_t golden[] = {0x73c8917842164c7c, 0xbaf261c092f09567, 0x34b914534f0a8825, 0xbee0aba8001aec09, 0x00d989125188b8f4,
                                  0x06a3c6074ca5a6af, 0x492e31662b3b87bf, 0x04c86f0725e79893, 0xf4ad1466aedaffb8};
#endif

#endif
