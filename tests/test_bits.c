/* The same bits: for every instruction set that the processor has, every compiler, any number of threads. */
#include "helpers.h"

#include <stdlib.h>

/* A grid in strips, a mesh in groups, loose particles, tethers, contact: every wide kernel has a part. */
static uint64_t hash_of_run(const char *method, const char *isa, int threads) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    assert_non_null(world);
    static const double corners[] = {0, 0, 0, 0.4, 0, 0.1, 0.1, 0.1, 0.5, 0.6, 0.1, 0.6, 0.3, 0.2, 0.9};
    static const uint32_t sizes[] = {3, 3, 3}, faces[] = {0, 1, 2, 1, 3, 2, 2, 3, 4};
    skein_mesh mesh = {corners, 5, sizes, 3, faces, 9};
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 8))));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 53, 70), SKEIN_VEC3("position", 0.1, 0.6, 0), SKEIN_TEXT("pins", "top corners"),
                                            SKEIN_REAL("stretch.stiffness", 30), SKEIN_REAL("shear.stiffness", 10),
                                            SKEIN_REAL("bend.stiffness", 1), SKEIN_REAL("stretch.damping", 0.001)),
                             NULL));
    OK(world, skein_body_add(world, "cloth", &mesh,
                             SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0), SKEIN_REAL("stretch.stiffness", 30), SKEIN_TEXT("pins", "0"),
                                            SKEIN_REAL("bend.stiffness", 1)),
                             NULL));
    for (int i = 0; i < 37; i++) add_moving(world, 0.01 + 0.001 * i, 0.03 * i - 0.5, 0.55, 0.01 * i, 0.1, -0.5, 0.02 * i);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5), SKEIN_REAL("quadratic", 1e-5)), NULL));
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 1e-5, 0, 2e-5)), NULL));
    OK(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 0, 1)), NULL));
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.5), SKEIN_REAL("motion.spin", 3)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", 0.3), SKEIN_REAL("restitution", 0.5)), NULL));
    steps(world, 30, 1.0 / 90);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.nonfinite, 0);
    assert_true(s.contacts > 10);
    skein_world_destroy(world);
    return s.state_hash;
}

/* Any compiler and machine must come to these; they change only when the arithmetic or its order does. */
#ifdef SKEIN_DOUBLE
static const uint64_t golden[] = {0x5f2798cfc873b035, 0x1ce74f269b1f9eeb};
#else
static const uint64_t golden[] = {0x73c8917842164c7c, 0xbaf261c092f09567};
#endif

static void every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
    static const char *const isas[] = {"sse", "avx2", "avx512", ""};
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (size_t i = 0; i < COUNT(isas); i++) {
            uint64_t hash = hash_of_run(method_names[m], isas[i], 1 + (int)i % 3);
            if (hash != golden[m]) print_message("%s, %s: %016llx\n", method_names[m], isas[i], (unsigned long long)hash);
            assert_true(hash == golden[m]);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
