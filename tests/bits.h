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
                                              SKEIN_REAL("shear.stiffness", 10), SKEIN_TEXT("bend.by", "springs"),
                                              SKEIN_REAL("bend.stiffness", 1), SKEIN_REAL("stretch.damping", 0.001),
                                              SKEIN_REAL("stretch.limit", 0.05), SKEIN_REAL("stretch.tether", 0.01)),
                               NULL));
    must(world, skein_body_add(world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_PAIR("grid", 21, 33), SKEIN_VEC3("position", 0.2, 0.7, 0.1),
                                              SKEIN_TEXT("pins", "left edge"), SKEIN_TEXT("bend.by", "lines"),
                                              SKEIN_REAL("bend.rigidity", 1e-4), SKEIN_REAL("stretch.stiffness", 30),
                                              SKEIN_REAL("shear.stiffness", 10)),
                               NULL));
    must(world, skein_body_add(world, "cloth", &mesh,
                               SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_REAL("stretch.stiffness", 30),
                                              SKEIN_TEXT("pins", "0"), SKEIN_TEXT("bend.by", "springs"),
                                              SKEIN_REAL("bend.stiffness", 1)),
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
static const uint64_t golden_settled = 0x9b4bb85e7eafa9b5;
static const uint64_t golden_soon[BITS_CASES] = {
    0x3f26d93f62383e09, 0xb8622c318c7a8791, 0x28c814fadea5d628, 0xbe5f89f0db8588f6, 0xf540e9885ce4162d,
    0xb510002e070aef80, 0xf3b57436675d099e, 0x797ba829bd504996, 0x9afac1d31b9c9e9f, 0xb8622c318c7a8791};
static const uint64_t golden[BITS_CASES] = {
    0xa7e075e6871b97ee, 0xc606d207d55cd455, 0xa6331d3eb10cf38e, 0x597c24e7ce48f5c2, 0xcabda057c07b288b,
    0xf1e6d297ebdd5cc6, 0xb3b75da32063541e, 0x9539284bbcc82c5f, 0x9347cbf795d10ff8, 0x51d5f33c705bd5b0};
#else
static const uint64_t golden_settled = 0xfd8a7bf69c83d80b;
static const uint64_t golden_soon[BITS_CASES] = {
    0x8a8291dc070f8416, 0xb21fb4f40e71be95, 0x823a681e6a2752bf, 0x786c3d3585de136a, 0x93d519499c7bd5b4,
    0xd76173361bf0c607, 0x25eff8728e2296fe, 0x2ccba0450da4797f, 0xfc2cd9aecc8cb699, 0xb21fb4f40e71be95};
static const uint64_t golden[BITS_CASES] = {
    0xeadff3604a505a7f, 0xe0e65cf8a2c23eab, 0x703fcfdda273b19d, 0x224bbebfcaabfdd7, 0x235684fc73c22721,
    0xc1c8b62a2f75a3c9, 0xa4f719e44b2e9b08, 0xf6d46d4f4cc1e33b, 0x04496dc510a2ea6b, 0xf734e6e5885cf833};
#endif

#endif
