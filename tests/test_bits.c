/* The same bits: for every instruction set that the processor has, every compiler, any number of threads. */
#include "bits.h"
#include "helpers.h"

static void gives(const bits_case *c, const char *isa, int threads, int steps, uint64_t expected) {
    uint64_t hash = hash_of_run(c, isa, threads, steps);
    if (hash != expected)
        print_message("%s, %d steps, %s: %016llx, not %016llx\n", c->method, steps, isa, (unsigned long long)hash,
                      (unsigned long long)expected);
    assert_true(hash == expected);
}

static void every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
    for (size_t m = 0; m < BITS_CASES; m++) {
        const bits_case *c = &bits_cases[m];
        gives(c, "", 2, c->soon, golden_soon[m]);
#ifndef SK_ONE_ISA
        for (int i = 0; i < (int)COUNT(bits_isas); i++) gives(c, bits_isas[i], 1 + i, c->soon, golden_soon[m]);
        // a rounding apart shows soon; that it stays away for long is looked for once
        gives(c, "", 3, c->steps, golden[m]);
#endif
    }
}

static void what_settles_has_the_same_bits(void **state) {
    (void)state;
    for (int i = 0; i < (int)COUNT(bits_isas); i++) {
        uint64_t hash = hash_when_settled(bits_isas[i]);
        if (hash != golden_settled) print_message("settled, %s: %016llx\n", bits_isas[i], (unsigned long long)hash);
        assert_true(hash == golden_settled);
    }
#ifdef __x86_64__
    unsigned mode = __builtin_ia32_stmxcsr();
    __builtin_ia32_ldmxcsr(mode | 0x8040); // a program that was built by -ffast-math
    uint64_t hash = hash_when_settled("");
    assert_int_equal(__builtin_ia32_stmxcsr() & 0x8040, 0x8040);
    __builtin_ia32_ldmxcsr(mode);
    assert_true(hash == golden_settled);
#endif
}

/* A sheet between a rod that turns and a ball. Who was asked whether he had been inside depended on who lay beside him in a register: five of ten such
 * scenes had other bits with SSE. */
static uint64_t hash_of_squeezed(const char *isa, int number) {
    setenv("SKEIN_SIMD", isa, 1);
    skein_world *world = skein_world_create(NULL, NULL);
    unsetenv("SKEIN_SIMD");
    assert_non_null(world);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    add_gravity(world);
    OK(world, skein_collider_add(world, "capsule",
                                 SKEIN_SETTINGS(SKEIN_VEC3("from", -0.4, 0.4, 0), SKEIN_VEC3("to", 0.4, 0.42, 0.1),
                                                SKEIN_REAL("radius", 0.1), SKEIN_VEC3("motion.velocity", 0.1, 0.05, 0),
                                                SKEIN_REAL("motion.spin", 1.5 + 0.5 * (number % 7))),
                                 NULL));
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0.5, 0.5, 0.3), SKEIN_REAL("radius", 0.12),
                                                SKEIN_VEC3("motion.velocity", -0.4 - 0.05 * (number % 5), 0, -0.2),
                                                SKEIN_REAL("motion.spin", 3)),
                                 NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 31, 33), SKEIN_VEC3("position", 0.01 * number, 0.8, 0),
                                            SKEIN_VEC3("rotation", 10, 25 + number, 5)),
                             NULL));
    steps(world, 70, 1.0 / 60);
    const uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void nobody_minds_who_lies_beside_him(void **state) {
    (void)state;
    for (int number = 0; number < 10; number++) {
        const uint64_t hash = hash_of_squeezed(bits_isas[0], number);
        for (size_t i = 1; i < COUNT(bits_isas); i++) assert_true(hash_of_squeezed(bits_isas[i], number) == hash);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(what_settles_has_the_same_bits),
        cmocka_unit_test(nobody_minds_who_lies_beside_him),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
