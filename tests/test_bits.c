/* The same bits: for every instruction set that the processor has, every compiler, any number of threads. */
#include "bits.h"
#include "helpers.h"

static void every_instruction_set_gives_the_same_bits(void **state) {
    (void)state;
#ifdef SK_ONE_ISA
    static const char *const isas[] = {""};
#else
    static const char *const isas[] = {"sse", "avx2", "avx512", ""};
#endif
    for (size_t m = 0; m < BITS_CASES; m++)
        for (size_t i = 0; i < COUNT(isas); i++) {
            uint64_t hash = hash_of_run(&bits_cases[m], isas[i], 1 + (int)i % 3);
            if (hash != golden[m])
                print_message("%s, %s: %016llx\n", bits_cases[m].method, isas[i], (unsigned long long)hash);
            assert_true(hash == golden[m]);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_instruction_set_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
