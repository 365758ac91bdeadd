/* Prints the hashes of bits.h and says whether they are the right ones: built and run by run.sh for another
 * processor. */
#include "../bits.h"

int main(void) {
    int wrong = 0;
    static const int some[] = {0, 1, 2, 8}; // every sort of kernel has a part; an emulator would take minutes for all
    for (int i = 0; i < (int)(sizeof some / sizeof *some); i++) {
        int m = some[i];
        uint64_t hash = hash_of_run(&bits_cases[m], "", 1 + m % 3, bits_cases[m].soon);
        printf("%s: %016llx, expected %016llx\n", bits_cases[m].method, (unsigned long long)hash,
               (unsigned long long)golden_soon[m]);
        wrong |= hash != golden_soon[m];
    }
    return wrong;
}
