/* Asking the processor, and the environment, for the widest instruction set that may run. */
#include "base/isa.h"

#include <stdlib.h>
#include <string.h>

#ifdef SK_X86_ISAS
static const char *const names[SK_ISA_COUNT] = {"sse", "avx2", "avx512"};

static int processor_has(sk_isa isa) {
    __builtin_cpu_init();
    switch (isa) {
    case SK_ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
    case SK_ISA_AVX2: return __builtin_cpu_supports("avx2");
    default: return __builtin_cpu_supports("sse4.1") != 0;
    }
}
#else
static const char *const names[SK_ISA_COUNT] = {"plain"};

static int processor_has(sk_isa isa) {
    (void)isa;
    return 1;
}
#endif

sk_isa sk_isa_choose(void) {
    const char *wanted = getenv("SKEIN_SIMD");
    for (int isa = SK_ISA_COUNT - 1; isa > 0; isa--)
        if (processor_has((sk_isa)isa) && (!wanted || !*wanted || !strcmp(wanted, names[isa]))) return (sk_isa)isa;
    return (sk_isa)0;
}

bool sk_isa_is_there(void) {
    return processor_has((sk_isa)0);
}

const char *sk_isa_text(sk_isa isa) {
    return names[isa];
}
