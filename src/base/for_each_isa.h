/* Compiles SK_KERNELS, a file of wide kernels, once for each instruction set. A file usually names
 * itself: the part under #ifdef SK_ISA is the kernels, the rest is compiled once.
 *
 *     #ifdef SK_ISA
 *     static void SK_ISA(kernel)(...) { sk_wide a = ...; }     // kernel_sse, kernel_avx2, kernel_avx512
 *     #else
 *     #define SK_KERNELS "forces/gravity.c"
 *     #include "base/for_each_isa.h"
 *     const sk_force_type sk_gravity = {..., .kernel = SK_EACH_ISA(kernel)};
 *     #endif
 */
#include "base/isa.h"
#include "base/wide_types.h"

#define SK_ISA_JOIN2(name, set) name##_##set
#define SK_ISA_JOIN(name, set) SK_ISA_JOIN2(name, set)
#define SK_ISA(name) SK_ISA_JOIN(name, SK_ISA_SET)

#ifdef SK_X86_ISAS

#define SK_ISA_SET sse
#define SK_ISA_VERSION SK_ISA_SSE
#include "base/wide.h"
#include SK_KERNELS
#undef SK_ISA_SET
#undef SK_ISA_VERSION

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2")
#endif
#define SK_ISA_SET avx2
#define SK_ISA_VERSION SK_ISA_AVX2
#define SK_HAS_AVX2
#include "base/wide.h"
#include SK_KERNELS
#undef SK_ISA_SET
#undef SK_ISA_VERSION
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#ifdef __clang__
#pragma clang attribute push(__attribute__((target("avx2,avx512f,avx512dq,avx512bw,avx512vl"))), apply_to = function)
#else
#pragma GCC push_options
#pragma GCC target("avx2,avx512f,avx512dq,avx512bw,avx512vl")
#endif
#define SK_ISA_SET avx512
#define SK_ISA_VERSION SK_ISA_AVX512
#define SK_HAS_AVX512
#include "base/wide.h"
#include SK_KERNELS
#undef SK_ISA_SET
#undef SK_ISA_VERSION
#undef SK_HAS_AVX2
#undef SK_HAS_AVX512
#ifdef __clang__
#pragma clang attribute pop
#else
#pragma GCC pop_options
#endif

#else

#define SK_ISA_SET plain
#define SK_ISA_VERSION SK_ISA_PLAIN
#include "base/wide.h"
#include SK_KERNELS
#undef SK_ISA_SET
#undef SK_ISA_VERSION

#endif

#undef SK_ISA
#undef SK_KERNELS
