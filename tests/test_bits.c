/* The same bits: for every instruction set that the processor has, every compiler, any number of threads. */
#include "bits.h"
#include "helpers.h"

static void gives(const bits_case *c, const char *isa, int threads, int steps, uint64_t expected) {
    uint64_t hash = hash_of_run(c, isa, threads, steps);
    if (hash != expected) print_message("%s, %d steps, %s: %016llx\n", c->method, steps, isa, (unsigned long long)hash);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
