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

typedef struct bits_case {
    const char *method;
    int steps, substeps; /* that are stable, or nearly */
    bool plain;          /* only forces that XPBD takes in with its prediction */
} bits_case;

/* A grid in strips, a mesh in groups, loose particles, tethers, contact: every wide kernel has a part. */
static uint64_t hash_of_run(const bits_case *c, const char *isa, int threads) {
    bool plain = c->plain;
    setenv("SKEIN_SIMD", isa, 1);
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    if (!world) abort();
    static const double corners[] = {0, 0, 0, 0.4, 0, 0.1, 0.1, 0.1, 0.5, 0.6, 0.1, 0.6, 0.3, 0.2, 0.9};
    static const uint32_t sizes[] = {3, 3, 3}, faces[] = {0, 1, 2, 1, 3, 2, 2, 3, 4};
    skein_mesh mesh = {corners, 5, sizes, 3, faces, 9};
    must(world, skein_method_set(world, c->method, SKEIN_SETTINGS(SKEIN_REAL("substeps", c->substeps))));
    must(world, skein_body_add(world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_PAIR("grid", 53, 70), SKEIN_VEC3("position", 0.1, 0.6, 0),
                                              SKEIN_TEXT("pins", "top corners"), SKEIN_REAL("stretch.stiffness", 30),
                                              SKEIN_REAL("shear.stiffness", 10), SKEIN_REAL("bend.stiffness", 1),
                                              SKEIN_REAL("stretch.damping", 0.001)),
                               NULL));
    must(world, skein_body_add(world, "cloth", &mesh,
                               SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_REAL("stretch.stiffness", 30),
                                              SKEIN_TEXT("pins", "0"), SKEIN_REAL("bend.stiffness", 1)),
                               NULL));
    for (int i = 0; i < 37; i++) {
        double x[] = {0.03 * i - 0.5, 0.55, 0.01 * i}, v[] = {0.1, -0.5, 0.02 * i}, mass = 0.01 + 0.001 * i;
        must(world, skein_particles_add(world, 1, x, v, &mass, NULL));
    }
    must(world, skein_force_add(world, "gravity", NULL, NULL));
    must(world,
         skein_force_add(world, "drag",
                         SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5), SKEIN_REAL("quadratic", plain ? 0 : 1e-5)), NULL));
    must(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1e-5, 0, 2e-5)), NULL));
    if (!plain)
        must(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0, 1)), NULL));
    must(world, skein_collider_add(world, "sphere",
                                   SKEIN_SETTINGS(SKEIN_REAL("radius", 0.5), SKEIN_REAL("motion.spin", 3)), NULL));
    must(world, skein_collider_add(
                    world, "plane",
                    SKEIN_SETTINGS(SKEIN_REAL("offset", 0.3), SKEIN_REAL("restitution", plain ? 0 : 0.5)), NULL));
    for (int i = 0; i < c->steps; i++) must(world, skein_world_step(world, 1.0 / 90));
    skein_statistics s;
    must(world, skein_world_statistics(world, &s));
    if (s.nonfinite || s.contacts < 10) abort();
    skein_world_destroy(world);
    return s.state_hash;
}

/* Any compiler and machine must come to these; they change only when the arithmetic or its order does. */
enum { BITS_CASES = 10 };
static const bits_case bits_cases[BITS_CASES] = {{"symplectic_euler", 30, 12, false},
                                                 {"xpbd", 30, 8, false},
                                                 {"xpbd", 30, 8, true},
                                                 {"explicit_euler", 20, 64, false},
                                                 {"lookahead_euler", 20, 24, false},
                                                 {"midpoint", 20, 24, false},
                                                 {"leapfrog", 20, 12, false},
                                                 {"rk4", 20, 8, false},
                                                 {"backward_euler", 16, 1, false},
                                                 {"pbd", 20, 8, false}};
#ifdef SKEIN_DOUBLE
static const uint64_t golden[BITS_CASES] = {
    0xd669ca863258fa8d, 0x0e932173063dbebc, 0xe957ba44f09eeb9a, 0xbfa455587297eea6, 0x644a89e8fcb51a72,
    0x317a1e4bfbe1901f, 0xaf9456b5b5bc08a6, 0x68aadf2fa596f1bc, 0xbb79a8a860a8fac7, 0x4cb7a0f0d91237a5};
#else
static const uint64_t golden[BITS_CASES] = {
    0x34918a6d0a786181, 0x731925b4ddc4a345, 0x01499e1a73b30952, 0x1a45190a2529c379, 0xafa3efefc6e2d2b7,
    0x66d5a2a8c0fc5a23, 0xe743f4387164090d, 0x32e987a795e3b2a3, 0xc026842f5b5870ff, 0x9c768ac2a4c5cb3a};
#endif

#endif
