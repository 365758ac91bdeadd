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
    int soon, steps; /* when to look: early, which is all that slow builds and emulators have time for, and late */
    int substeps;    /* that are stable, or nearly */
    bool plain;      /* only forces that XPBD takes in with its prediction */
} bits_case;

/* What SKEIN_SIMD takes on x86-64; for one that the processor lacks, sse is taken. */
static const char *const bits_isas[] = {"sse", "avx2", "avx512"};

/* A grid in strips, a mesh in groups, loose particles, tethers, contact: every wide kernel has a part. */
static uint64_t hash_of_run(const bits_case *c, const char *isa, int threads, int steps) {
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
                                              SKEIN_REAL("shear.stiffness", 10), SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 1),
                                              SKEIN_REAL("stretch.damping", 0.001)),
                               NULL));
    must(world, skein_body_add(world, "cloth", &mesh,
                               SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_REAL("stretch.stiffness", 30),
                                              SKEIN_TEXT("pins", "0"), SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 1)),
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
    for (int i = 0; i < steps; i++) must(world, skein_world_step(world, 1.0 / 90));
    skein_statistics s;
    must(world, skein_world_statistics(world, &s));
    if (s.nonfinite || s.contacts < (steps == c->steps ? 10 : 1)) abort();
    skein_world_destroy(world);
    return s.state_hash;
}

/* A sheet that hangs in thick air until nothing moves: what is left of its swinging fades through the smallest numbers,
 * which some machines know and others take for zero (base/float_mode.h). */
static uint64_t hash_when_settled(const char *isa) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = skein_world_create(NULL, NULL);
    unsetenv("SKEIN_SIMD");
    if (!world) abort();
    must(world, skein_body_add(world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9), SKEIN_TEXT("pins", "top corners")), NULL));
    must(world, skein_force_add(world, "gravity", NULL, NULL));
    must(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 8)), NULL));
    for (int i = 0; i < 1000; i++) must(world, skein_world_step(world, 1.0 / 60));
    skein_view v = skein_velocity_view(world);
    for (size_t i = 0; i < 4 * v.count && sizeof(skein_real) == sizeof(float); i++) {
        skein_real speed = v.xyzw[4 * v.slot_of[i / 4] + i % 4];
        if (speed != 0 && speed < (skein_real)1e-18 && speed > (skein_real)-1e-18) abort(); // not at rest, nor moving
    }
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

/* Any compiler and machine must come to these; they change only when the arithmetic or its order does. */
enum { BITS_CASES = 10 };
static const bits_case bits_cases[BITS_CASES] = {{"symplectic_euler", 6, 30, 12, false},
                                                 {"xpbd", 6, 30, 8, false},
                                                 {"xpbd", 6, 30, 8, true},
                                                 {"explicit_euler", 6, 20, 64, false},
                                                 {"lookahead_euler", 6, 20, 24, false},
                                                 {"midpoint", 6, 20, 24, false},
                                                 {"leapfrog", 6, 20, 12, false},
                                                 {"rk4", 6, 20, 8, false},
                                                 {"backward_euler", 6, 16, 1, false},
                                                 {"pbd", 6, 20, 8, false}};
#ifdef SKEIN_DOUBLE
static const uint64_t golden_settled = 0x632f999e5c4d4c17;
static const uint64_t golden_soon[BITS_CASES] = {
    0x627e4a6222717200, 0x79135a587e3bc93e, 0xe12fd75fe1ae5e62, 0x4c3fc2f698c5ed87, 0x97f47ae6e344818f,
    0x486f9ec46920c93f, 0xfa3b8db0442550c1, 0x00e68d7d21ebd440, 0x9675530033092f59, 0x79135a587e3bc93e};
static const uint64_t golden[BITS_CASES] = {
    0xd669ca863258fa8d, 0x0e932173063dbebc, 0xe957ba44f09eeb9a, 0xbfa455587297eea6, 0x644a89e8fcb51a72,
    0x317a1e4bfbe1901f, 0xaf9456b5b5bc08a6, 0x68aadf2fa596f1bc, 0xbb79a8a860a8fac7, 0x4cb7a0f0d91237a5};
#else
static const uint64_t golden_settled = 0x18849e0371d38f51;
static const uint64_t golden_soon[BITS_CASES] = {
    0x3a129c4b5483f1b1, 0xde86e89f0c5d6122, 0x1e1652d3f8534dd4, 0xf6ca0cfcae11958c, 0x782731a51832e05f,
    0xb4d5bed55360d1d7, 0xba6093bbfd3ccc8a, 0x9bddcc2322586cda, 0x77d0b60f9f56c4a6, 0xde86e89f0c5d6122};
static const uint64_t golden[BITS_CASES] = {
    0x34918a6d0a786181, 0x731925b4ddc4a345, 0x01499e1a73b30952, 0x1a45190a2529c379, 0xafa3efefc6e2d2b7,
    0x66d5a2a8c0fc5a23, 0xe743f4387164090d, 0x32e987a795e3b2a3, 0xc026842f5b5870ff, 0x9c768ac2a4c5cb3a};
#endif

#endif
