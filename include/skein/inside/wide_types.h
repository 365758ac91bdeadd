/* Vectors of as many reals as the processor works on at once, in the compilers' vector types.
 *
 * State vectors and elements come in blocks of sixteen lanes, the same on every machine (SK_LANES). A kernel works a
 * block in parts, one vector each: one part with AVX-512, two with AVX2, four with SSE or NEON; twice as many in
 * double. Lanes are independent wherever it matters, so the parts give the same bits.
 *
 *     block    0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15
 *     AVX2     ------ part 0 -- ------- part 1 -----      SK_PART = 8 lanes, SK_PARTS = 2 */
#ifndef SK_BASE_WIDE_TYPES_H
#define SK_BASE_WIDE_TYPES_H

#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#elif defined(__wasm_simd128__)
#include <wasm_simd128.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

#include <skein/inside/vector.h>

/* Passing vectors by value between functions would depend on the instruction set; everything that takes
 * or returns one is inlined, so the compilers' notes about that do not apply. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#ifdef SKEIN_DOUBLE
typedef int64_t sk_lane_int;
#else
typedef int32_t sk_lane_int;
#endif

#ifdef SK_WIDTH
#define SK_VECTOR_BYTES SK_WIDTH /* what the build says of the instruction set (kernels.h) */
#else
#define SK_VECTOR_BYTES 16
#endif
typedef real sk_wide __attribute__((vector_size(SK_VECTOR_BYTES)));
typedef sk_lane_int sk_mask __attribute__((vector_size(SK_VECTOR_BYTES))); /* -1 or 0 a lane */

enum {
    SK_LANES = 16,                                 /* of a block, on every machine */
    SK_PART = SK_VECTOR_BYTES / (int)sizeof(real), /* of a vector */
    SK_PARTS = SK_LANES / SK_PART                  /* vectors a block */
};

/* What may be a vector of any instruction set must lie so. */
#define SK_VECTOR_ALIGNED _Alignas(64)

/* As many particles of a state vector. */
typedef struct sk_wide4 {
    sk_wide x, y, z, w;
} sk_wide4;

typedef struct sk_wide3 {
    sk_wide x, y, z;
} sk_wide3;

#endif
