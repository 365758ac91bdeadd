/* How files of wide kernels are written. The build (CMakeLists.txt) compiles them once as they are, and once for each
 * instruction set, with that set's flags and its name as SK_ISA. The kernels stand under #ifdef SK_ISA, in plain C; the
 * rest is compiled once. Only names that the rest refers to contain the set's name.
 *
 *     #include "base/kernels.h"
 *     #define SK_UNIT gravity
 *     SK_KERNELS(sk_op_kernel, kernel);      // declares sk_gravity_kernel_sse, sk_gravity_kernel_avx2 ...
 *
 *     #ifdef SK_ISA
 *     static sk_wide helper(sk_wide a) { ... }
 *     void SK_KERNEL(kernel)(...) { ... }     // defines sk_gravity_kernel_avx2, where SK_ISA is avx2
 *     #else
 *     const sk_force_type sk_gravity = {..., .kernel = {SK_EACH_ISA(kernel)}};
 *     #endif
 */
#ifndef SK_BASE_KERNELS_H
#define SK_BASE_KERNELS_H

#include "base/isa.h"
#include "base/wide_types.h"

#define SK_KERNEL_JOIN(unit, name, isa) sk_##unit##_##name##_##isa
#define SK_KERNEL_NAME(unit, name, isa) SK_KERNEL_JOIN(unit, name, isa)
#define SK_KERNEL_OF(name, isa) SK_KERNEL_NAME(SK_UNIT, name, isa)

/* Declares the versions, one for each set, of a kernel (a function type) or a table; and SK_EACH_ISA lists them. */
#ifdef SK_X86_ISAS
#define SK_KERNELS(type, name) extern type SK_KERNEL_OF(name, sse), SK_KERNEL_OF(name, avx2), SK_KERNEL_OF(name, avx512)
#define SK_EACH_ISA(name) \
    { &SK_KERNEL_OF(name, sse), &SK_KERNEL_OF(name, avx2), &SK_KERNEL_OF(name, avx512) }
#else
#define SK_KERNELS(type, name) extern type SK_KERNEL_OF(name, plain)
#define SK_EACH_ISA(name) \
    { &SK_KERNEL_OF(name, plain) }
#endif

#ifdef SK_ISA
/* The name of a kernel in the version that is being compiled, and that version's place in tables. */
#define SK_KERNEL(name) SK_KERNEL_NAME(SK_UNIT, name, SK_ISA)
#define SK_THIS_JOIN(isa) SK_ISA_OF_##isa
#define SK_THIS_NAME(isa) SK_THIS_JOIN(isa)
#define SK_THIS_ISA SK_THIS_NAME(SK_ISA)
#include "base/wide.h"
#endif

#endif
