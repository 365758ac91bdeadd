/* Instruction sets: which version of a wide kernel runs.
 *
 * Wide kernels are compiled once for each set (base/kernels.h) and chosen when a world is made: the widest
 * that the processor has, or the one that SKEIN_SIMD names (sse, avx2, avx512). All of them give the same
 * bits: sixteen logical lanes, plain + - * / sqrt, no fused operations. */
#ifndef SK_BASE_ISA_H
#define SK_BASE_ISA_H

#include <stdbool.h>

/* SK_ONE_ISA (SKEIN_ONE_ISA in CMake) builds the plain version alone: the others take minutes to build, with sanitizers
 * above all. */
#if defined(__x86_64__) && !defined(SK_ONE_ISA)
#define SK_X86_ISAS
typedef enum sk_isa { SK_ISA_SSE, SK_ISA_AVX2, SK_ISA_AVX512, SK_ISA_COUNT } sk_isa;
/* By the names that the build gives SK_ISA. */
enum { SK_ISA_OF_sse = SK_ISA_SSE, SK_ISA_OF_avx2 = SK_ISA_AVX2, SK_ISA_OF_avx512 = SK_ISA_AVX512 };
/* A table of a kernel that has one version; of those that have several, see base/kernels.h. */
#define SK_ANY_ISA(kernel) \
    { kernel, kernel, kernel }
#else
typedef enum sk_isa { SK_ISA_PLAIN, SK_ISA_COUNT } sk_isa;
enum { SK_ISA_OF_plain = SK_ISA_PLAIN };
#define SK_ANY_ISA(kernel) \
    { kernel }
#endif

/* The set to use: SKEIN_SIMD's if the processor has it, else the widest that it has. */
sk_isa sk_isa_choose(void);
const char *sk_isa_text(sk_isa isa);
/* Whether the processor has the least of them, SSE 4.1 on x86-64: without it no kernel runs. */
bool sk_isa_is_there(void);

#endif
