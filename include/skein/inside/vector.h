/* The headers in this folder are the library's own, and no part of its interface. They are here for what emitted formulas are
 * compiled with (compiled_formula.h): the same arithmetic and the same walk as the library's kinds have.
 *
 * Small vectors of reals: the element of every state array (sk_vec4) and 3-vectors for kernels.
 * Used everywhere; owns nothing. All arithmetic is plain + - * / sqrt, in a fixed order, so that it
 * gives the same bits on every machine (the build forbids contraction to fused operations). */
#ifndef SK_BASE_VECTOR_H
#define SK_BASE_VECTOR_H

#include <math.h>
#include <skein/compiled.h>

typedef skein_real real;

/* One slot of a state vector. In X, w is the inverse mass; in V, w is the mass; else it is 0. */
typedef struct sk_vec4 {
    real x, y, z, w;
} sk_vec4;

typedef struct sk_vec3 {
    real x, y, z;
} sk_vec3;

#ifdef SKEIN_DOUBLE
#define SK_REAL_MAX 1.7976931348623157e308
#define SK_LEAST_NORMAL 2.2250738585072014e-308
static inline real sk_sqrt(real a) {
    return __builtin_sqrt(a);
}
static inline real sk_abs(real a) {
    return __builtin_fabs(a);
}
#else
#define SK_REAL_MAX 3.402823466e38f
#define SK_LEAST_NORMAL 1.17549435e-38f
static inline real sk_sqrt(real a) {
    return __builtin_sqrtf(a);
}
static inline real sk_abs(real a) {
    return __builtin_fabsf(a);
}
#endif

/* By compare and select: fmin and fmax differ between machines for signed zeros. */
static inline real sk_min(real a, real b) {
    return a < b ? a : b;
}
static inline real sk_max(real a, real b) {
    return a > b ? a : b;
}

// clang-format off
static inline sk_vec3 sk_v3(real x, real y, real z) { return (sk_vec3){x, y, z}; }
static inline sk_vec3 sk_v3_of(const double v[3]) {
    return (sk_vec3){(real)v[0], (real)v[1], (real)v[2]};
}
static inline sk_vec3 sk_xyz(sk_vec4 a) { return (sk_vec3){a.x, a.y, a.z}; }
static inline sk_vec3 sk_add(sk_vec3 a, sk_vec3 b) { return (sk_vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline sk_vec3 sk_sub(sk_vec3 a, sk_vec3 b) { return (sk_vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline sk_vec3 sk_scale(real s, sk_vec3 a) { return (sk_vec3){s * a.x, s * a.y, s * a.z}; }
static inline real sk_dot(sk_vec3 a, sk_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline sk_vec3 sk_cross(sk_vec3 a, sk_vec3 b) {
    return (sk_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline real sk_length(sk_vec3 a) { return sk_sqrt(sk_dot(a, a)); }
// clang-format on

/* Adds v to the first three components only: the fourth is a mass. */
static inline void sk_accumulate(sk_vec4 *a, sk_vec3 v) {
    a->x += v.x;
    a->y += v.y;
    a->z += v.z;
}

#endif
