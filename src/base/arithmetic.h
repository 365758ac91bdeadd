/* The vocabulary in which a kind writes its arithmetic once, for kernels of every width, plain C, and graphics cards.
 *
 * What a kind computes for one particle stands in its file between two comments,
 *
 *     // ---- arithmetic ----
 *     SK_INLINE vec3 wind_force(wind_params p, vec3 v, num mass) {
 *         return PARAM3(p.force);
 *     }
 *     // ---- end of arithmetic ----
 *
 * and is both C and GLSL. In C this header makes it arithmetic on a part of a block (with SK_ISA) or on one particle.
 * For cards the build copies it out of the file, and gpu/ops.c puts base/arithmetic.glsl and a struct of parameters,
 * made from the kind's field table, before it. So it may use the words below, + - * / and comparisons of numbers, `if`
 * with a condition on parameters or none(...), and its own functions, but no pointers.
 *
 *     num, vec3, vec4, flag      of one particle: a number, vectors, a truth value
 *     scalar                     a number that is the same for all particles
 *     exact                      the same in double: parameters, and steps of time
 *     PARAM(e), PARAM3(v)        a scalar, and a vec3, from an expression of parameters, rounded once
 *     pick(flag, yes, no)        one of two numbers; pick3: of two vectors
 *     both, either, none         of flags; none(f): it is set for no particle
 *     vec3_of, vec4_of, xyz; plus, minus, times (a number and a vector), dot, cross; root, absolute
 */
#ifndef SK_BASE_ARITHMETIC_H
#define SK_BASE_ARITHMETIC_H

#include "base/elementary.h"
#include "base/kernels.h"

/* Functions have the same arguments for all kinds, also those that a kind does not use. */
#pragma GCC diagnostic ignored "-Wunused-parameter"

typedef double exact;
#define PARAM(e) ((scalar)(e))
#define PARAM3(v) vec3_of(PARAM((v)[0]), PARAM((v)[1]), PARAM((v)[2]))
#define STRUCT(name)          \
    typedef struct name name; \
    struct name
#define cosine(angle) sk_cos(angle)
#define sine(angle) sk_sin(angle)

#ifdef SK_ISA

typedef sk_wide num;
typedef sk_wide3 vec3;
typedef sk_wide4 vec4;
typedef sk_mask flag;
typedef real scalar;
#define NUM(a) ((a) - (sk_wide){0}) /* numbers and scalars alike */
#define pick(flag_, yes, no) sk_select((flag_), NUM(yes), NUM(no))
#define both(a, b) ((a) & (b))
#define either(a, b) ((a) | (b))
#define none(flag_) (!sk_any(flag_))
#define root(a) sk_wide_sqrt(a)
#define absolute(a) sk_wide_abs(a)

#else

/* One particle at a time: in `real`, or in the type that a file defines as SK_ARITHMETIC_OF. */
#ifndef SK_ARITHMETIC_OF
#define SK_ARITHMETIC_OF real
#endif
typedef SK_ARITHMETIC_OF num;
typedef num scalar;
typedef bool flag;
typedef struct vec3 {
    num x, y, z;
} vec3;
typedef struct vec4 {
    num x, y, z, w;
} vec4;
#define SK_INLINE static inline __attribute__((unused))
#define NUM(a) ((num)(a))
#define pick(flag_, yes, no) ((flag_) ? NUM(yes) : NUM(no))
#define both(a, b) ((a) && (b))
#define either(a, b) ((a) || (b))
#define none(flag_) (!(flag_))
#define root(a) _Generic((a), float : __builtin_sqrtf, default : __builtin_sqrt)(a)
#define absolute(a) _Generic((a), float : __builtin_fabsf, default : __builtin_fabs)(a)

#endif

#define vec3_of(x_, y_, z_) ((vec3){NUM(x_), NUM(y_), NUM(z_)})
#define vec4_of(v, w_) vec4_from((v), NUM(w_))
#define times(s, a) scaled(NUM(s), (a))
#define pick3(flag_, yes, no) picked((flag_), (yes), (no))

// clang-format off
SK_INLINE vec4 vec4_from(vec3 v, num w) { return (vec4){v.x, v.y, v.z, w}; }
SK_INLINE vec3 xyz(vec4 a) { return (vec3){a.x, a.y, a.z}; }
SK_INLINE vec3 scaled(num s, vec3 a) { return (vec3){s * a.x, s * a.y, s * a.z}; }
SK_INLINE vec3 plus(vec3 a, vec3 b) { return (vec3){a.x + b.x, a.y + b.y, a.z + b.z}; }
SK_INLINE vec3 minus(vec3 a, vec3 b) { return (vec3){a.x - b.x, a.y - b.y, a.z - b.z}; }
SK_INLINE num dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SK_INLINE vec3 cross(vec3 a, vec3 b) {
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
SK_INLINE vec3 picked(flag f, vec3 yes, vec3 no) {
    return (vec3){pick(f, yes.x, no.x), pick(f, yes.y, no.y), pick(f, yes.z, no.z)};
}
// clang-format on

#endif
