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
static uint64_t hash_of_run(const char *method, int step_count, int substeps, const char *isa, int threads) {
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
    for (int i = 0; i < step_count; i++) must(world, skein_world_step(world, 1.0 / 90));
    skein_statistics s;
    must(world, skein_world_statistics(world, &s));
    if (s.nonfinite || s.contacts < 10) abort();
    skein_world_destroy(world);
    return s.state_hash;
}

/* Any compiler and machine must come to these; they change only when the arithmetic or its order does. */
static const struct {
    const char *method;
    int steps, substeps; /* that are stable, or nearly */
} bits_methods[] = {{"symplectic_euler", 30, 8}, {"xpbd", 30, 8},    {"explicit_euler", 20, 64},
                    {"lookahead_euler", 20, 24},  {"midpoint", 20, 24}, {"leapfrog", 20, 12},
                    {"rk4", 20, 8},               {"backward_euler", 15, 1}, {"pbd", 20, 8}};
#ifdef SKEIN_DOUBLE
static const uint64_t golden[] = {0x5f2798cfc873b035, 0x1ce74f269b1f9eeb, 0xe37523475bc87630,
                                  0x5640b779fc757e73, 0x4aa29b8533b27745, 0x133283055278d1c5,
                                  0xd1393ace40a9beec, 0xb80f432d8917ffd5, 0xdf9e7ab1f727a0e5};
#else
static const uint64_t golden[] = {0x73c8917842164c7c, 0xbaf261c092f09567, 0xb7f6c6d978abc032,
                                  0x61609ab19cb2f4d7, 0xdd94f813d1d6c66b, 0xe6151e6a5564dd0b,
                                  0xcfe5c95156bdd18c, 0x4da4f06419af6712, 0x2e54497952bf47a9};
#endif

#endif
