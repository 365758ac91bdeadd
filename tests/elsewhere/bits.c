/* Prints the hashes of bits.h and says whether they are the right ones: built and run by run.sh for another
 * processor or with another compiler. */
#include "../bits.h"

static bool gives(const char *what, const char *isa, uint64_t hash, uint64_t expected) {
    printf("%s %s: %016llx, expected %016llx\n", what, isa, (unsigned long long)hash, (unsigned long long)expected);
    return hash == expected;
}

static bool runs_to(const bits_case *c, const char *isa, uint64_t expected) {
    return gives(c->method, isa, hash_of_run(c, isa, 1 + (int)(expected % 3), c->soon), expected);
}

int main(void) {
    bool right = true;
    static const int some[] = {0, 1, 2, 8}; // every sort of kernel has a part; an emulator would take minutes for all
    for (int i = 0; i < (int)(sizeof some / sizeof *some); i++) {
        const bits_case *c = &bits_cases[some[i]];
        uint64_t expected = golden_soon[some[i]];
#if defined __x86_64__ && !defined SK_ONE_ISA
        for (int k = 0; k < (int)(sizeof bits_isas / sizeof *bits_isas); k++)
            right &= runs_to(c, bits_isas[k], expected);
#else
        right &= runs_to(c, "", expected);
#endif
    }
    right &= gives("settled", "", hash_when_settled(""), golden_settled);
    return !right;
}
