/* Sixteen reals at once, as compilers' vector types: the same sixteen logical lanes on every machine.
 * Narrower processors work a wide value in parts, in the same order, so the bits agree. */
#ifndef SK_BASE_WIDE_TYPES_H
#define SK_BASE_WIDE_TYPES_H

#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/vector.h"

enum { SK_LANES = 16 };

/* Passing these by value between functions would depend on the instruction set; everything that takes
 * or returns one is inlined, so the compilers' notes about that do not apply. */
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

#ifdef SKEIN_DOUBLE
typedef int64_t sk_lane_int;
#else
typedef int32_t sk_lane_int;
#endif
typedef real sk_wide __attribute__((vector_size(16 * sizeof(real)), aligned(64)));
typedef sk_lane_int sk_mask __attribute__((vector_size(16 * sizeof(real)), aligned(64))); /* -1 or 0 a lane */

/* Sixteen particles of a state vector. */
typedef struct sk_wide4 {
    sk_wide x, y, z, w;
} sk_wide4;

typedef struct sk_wide3 {
    sk_wide x, y, z;
} sk_wide3;

#endif
