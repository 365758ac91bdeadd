/* Instruction sets: which version of a wide kernel runs.
 *
 * Wide kernels are compiled once for each set (base/for_each_isa.h) and chosen when a world is made: the
 * widest that the processor has, or the one that SKEIN_SIMD names (sse, avx2, avx512). All of them give
 * the same bits: sixteen logical lanes, plain + - * / sqrt, no fused operations. */
#ifndef SK_BASE_ISA_H
#define SK_BASE_ISA_H

/* SK_ONE_ISA (SKEIN_ONE_ISA in CMake) builds the plain version alone: the others take minutes to build, with sanitizers
 * above all. */
#if defined(__x86_64__) && !defined(SK_ONE_ISA)
#define SK_X86_ISAS
typedef enum sk_isa { SK_ISA_SSE, SK_ISA_AVX2, SK_ISA_AVX512, SK_ISA_COUNT } sk_isa;
/* A table of a kernel's versions, and one of a kernel that has only one. */
#define SK_EACH_ISA(kernel) \
    { kernel##_sse, kernel##_avx2, kernel##_avx512 }
#define SK_ANY_ISA(kernel) \
    { kernel, kernel, kernel }
#else
typedef enum sk_isa { SK_ISA_PLAIN, SK_ISA_COUNT } sk_isa;
#define SK_EACH_ISA(kernel) \
    { kernel##_plain }
#define SK_ANY_ISA(kernel) \
    { kernel }
#endif

/* The set to use: SKEIN_SIMD's if the processor has it, else the widest that it has. */
sk_isa sk_isa_choose(void);
const char *sk_isa_text(sk_isa isa);

#endif
