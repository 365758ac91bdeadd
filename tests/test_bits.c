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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
        cmocka_unit_test(what_settles_has_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
