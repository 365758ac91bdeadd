/* Dual numbers: values that carry their derivatives along, exact to rounding, with nothing derived by hand.
 *
 * A header alone: it needs the C library's math.h and float.h, and nothing else of Skein. C11 or later, or C++.
 * Say how many derivatives there shall be, then include it; again, with other numbers, as often as you like:
 *
 *     #define SKEIN_DUAL_N 6            // 6 derivatives: for instance, by the coordinates of two points
 *     #define SKEIN_DUAL_REAL double    // float if not given
 *     #define SKEIN_DUAL_NAME dual      // what all names begin with; if not given, skein_dual6 or skein_dual6d:
 *     #include <skein/dual.h>           // N is in it, and a d for double
 *
 * The header undefines the three again. Each name is made once in a file: where several headers of yours want the
 * same numbers, put these lines into a header of their own, with an include guard. Below, the name is `dual`.
 *
 *     dual a;  a.d[0]  a.d[1] ... a.d[N]               the value, and its N derivatives: read and write them
 *     dual_of(x)  dual_set(&a, x)                      a plain number: its derivatives are 0
 *     dual_seed(x, i)                                  control i, from 1 to N: derivative i is 1, all others are 0
 *
 *     dual_add sub mul div (a, b)                      + - * /
 *     dual_add_real sub_real mul_real div_real (a, x)  the second is a plain number
 *     dual_real_add real_sub real_mul real_div (x, b)  the first is
 *     dual_add_to sub_from mul_by div_by (&a, b)       a += b, a -= b, a *= b, a /= b; b may be a itself
 *     dual_add_real_to sub_real_from mul_by_real div_by_real (&a, x)
 *     dual_neg abs sqrt exp log (a)
 *     dual_sin cos tan asin acos (a)                   angles in radians
 *     dual_atan2 (y, x)  dual_atan2_real (y, x)  dual_real_atan2 (y, x)
 *     dual_pow (a, b)    dual_pow_real (a, x)    dual_real_pow (x, b)
 *     dual_min max (a, b)  dual_min_real max_real (a, x)     of equals, the first
 *     dual_chain(value, slope, a)                      a function of your own: its value at a, and its slope there
 *     dual_chain2(value, slope_a, a, slope_b, b)       and of two
 *
 *     dual_vec v;  v.x  v.y  v.z                       three duals
 *     dual_vec_of(x, y, z)                             plain numbers
 *     dual_vec_seed(x, y, z, i)                        controls i, i + 1 and i + 2
 *     dual_vec_add sub cross (v, w)  dual_vec_scale(v, a)  dual_vec_scale_real(v, x)  dual_vec_normalize(v)
 *     dual_vec_dot distance (v, w)  dual_vec_length(v)       these are duals
 *
 * Guards. Where a function has no finite value or slope, it gets a sensible one, so that finite numbers make no NaN and
 * no infinity unless a sum, a product or a quotient grows beyond the real's range. Skein's formulas are to have the
 * same. With `least` the least normal number of the real (FLT_MIN, DBL_MIN):
 *
 *     sqrt(x)           the derivative is x > least ? 1 / (2 sqrt(x)) : 0; below 0 the value is 0. So a length of 0
 *                       has the derivative 0, and the vector 0 is normalized to 0 with the derivative 0
 *     asin(x), acos(x)  x counts as -1 to 1, and there the derivative is 0: (1 - x)(1 + x) > least ? ... : 0
 *     a / b             0 with the derivative 0 where |b| < least
 *     log(x)            x counts as at least `least`; below that the derivative is 0
 *     exp(x)            the largest number, with the derivative 0, beyond the range
 *     pow(x, y)         0 at a pole (x = 0, y < 0) and where it is not real (x < 0, y not whole); else at most the
 *                       largest number; 0 for a slope beyond the range; the derivative by y is 0 for x <= least
 *     atan2(y, x)       the derivative is 0 where y^2 + x^2 = 0 (where the distance is at most `least`)
 *     abs(x)            the derivative is 0 at 0
 *
 * A NaN that goes in comes out again (min and max may drop it). Guards ask for a build without -ffast-math. Sums,
 * products, quotients and roots have the same bits everywhere (if built with -ffp-contract=off); sin, exp and their kin
 * are the C library's.
 *
 * The cost is N + 1 numbers an operation. Compile with -O3 -march=native to have them done side by side. */
#ifndef SKEIN_DUAL_N
#error "skein/dual.h: say how many derivatives before including it: #define SKEIN_DUAL_N 6"
#elif SKEIN_DUAL_N < 1
#error "skein/dual.h: SKEIN_DUAL_N must be at least 1"
#endif
#ifndef SKEIN_DUAL_REAL
#define SKEIN_DUAL_REAL float
#endif

#ifndef SKEIN_DUAL_H
#define SKEIN_DUAL_H
#include <float.h>
#include <math.h>
#define SKEIN_DUAL_JOIN_(a_, b_) a_##b_
#define SKEIN_DUAL_JOIN(a_, b_) SKEIN_DUAL_JOIN_(a_, b_)
#define SKEIN_DUAL_IS_float 1 /* so that #if can tell which real it is */
#define SKEIN_DUAL_IS_double 2
#endif

/* ---- What this inclusion makes: names, and the real's own functions and limits ------------------------- */

#define SKD_R SKEIN_DUAL_REAL
#define SKD_N SKEIN_DUAL_N
#if SKEIN_DUAL_JOIN(SKEIN_DUAL_IS_, SKEIN_DUAL_REAL) == 1
#define SKD_PLAIN_NAME SKEIN_DUAL_JOIN(skein_dual, SKEIN_DUAL_N)
#define SKD_MATH(name_) name_##f
#define SKD_LEAST FLT_MIN
#define SKD_MOST FLT_MAX
#elif SKEIN_DUAL_JOIN(SKEIN_DUAL_IS_, SKEIN_DUAL_REAL) == 2
#define SKD_PLAIN_NAME SKEIN_DUAL_JOIN(SKEIN_DUAL_JOIN(skein_dual, SKEIN_DUAL_N), d)
#define SKD_MATH(name_) name_
#define SKD_LEAST DBL_MIN
#define SKD_MOST DBL_MAX
#else
#error "skein/dual.h: SKEIN_DUAL_REAL must be float or double"
#endif
#ifdef SKEIN_DUAL_NAME
#define SKD SKEIN_DUAL_NAME
#else
#define SKD SKD_PLAIN_NAME
#endif
#define SKD_F(name_) SKEIN_DUAL_JOIN(SKD, _##name_)
#define SKD_V SKD_F(vec)

typedef struct SKD {
    SKD_R d[SKD_N + 1]; /* the value, and its derivatives from 1 to N */
} SKD;

typedef struct SKD_V {
    SKD x, y, z;
} SKD_V;

/* ---- Making ------------------------------------------------------------------------------------------- */

static inline SKD SKD_F(of)(SKD_R x) {
    SKD r;
    r.d[0] = x;
    for (int i = 1; i <= SKD_N; i++) r.d[i] = 0;
    return r;
}

static inline void SKD_F(set)(SKD *a, SKD_R x) {
    *a = SKD_F(of)(x);
}

/* A control outside 1 to N is a plain number. */
static inline SKD SKD_F(seed)(SKD_R x, int control) {
    SKD r = SKD_F(of)(x);
    if (control >= 1 && control <= SKD_N) r.d[control] = 1;
    return r;
}

/* The chain rule, which all functions below are made of. */
static inline SKD SKD_F(chain)(SKD_R value, SKD_R slope, SKD a) {
    SKD r;
    r.d[0] = value;
    for (int i = 1; i <= SKD_N; i++) r.d[i] = slope * a.d[i];
    return r;
}

static inline SKD SKD_F(chain2)(SKD_R value, SKD_R slope_a, SKD a, SKD_R slope_b, SKD b) {
    SKD r;
    r.d[0] = value;
    for (int i = 1; i <= SKD_N; i++) r.d[i] = slope_a * a.d[i] + slope_b * b.d[i];
    return r;
}

/* ---- Arithmetic --------------------------------------------------------------------------------------- */

static inline SKD SKD_F(neg)(SKD a) {
    for (int i = 0; i <= SKD_N; i++) a.d[i] = -a.d[i];
    return a;
}

static inline SKD SKD_F(add)(SKD a, SKD b) {
    for (int i = 0; i <= SKD_N; i++) a.d[i] += b.d[i];
    return a;
}

static inline SKD SKD_F(sub)(SKD a, SKD b) {
    for (int i = 0; i <= SKD_N; i++) a.d[i] -= b.d[i];
    return a;
}

static inline SKD SKD_F(mul)(SKD a, SKD b) {
    return SKD_F(chain2)(a.d[0] * b.d[0], b.d[0], a, a.d[0], b);
}

/* Too small to divide by; a NaN is not. */
static inline int SKD_F(vanishes)(SKD_R x) {
    return x < SKD_LEAST && x > -SKD_LEAST;
}

static inline SKD SKD_F(div)(SKD a, SKD b) {
    SKD r;
    if (SKD_F(vanishes)(b.d[0])) return SKD_F(of)(0);
    r.d[0] = a.d[0] / b.d[0];
    for (int i = 1; i <= SKD_N; i++) r.d[i] = (a.d[i] - r.d[0] * b.d[i]) / b.d[0];
    return r;
}

static inline SKD SKD_F(add_real)(SKD a, SKD_R x) {
    a.d[0] += x;
    return a;
}

static inline SKD SKD_F(sub_real)(SKD a, SKD_R x) {
    a.d[0] -= x;
    return a;
}

static inline SKD SKD_F(mul_real)(SKD a, SKD_R x) {
    for (int i = 0; i <= SKD_N; i++) a.d[i] *= x;
    return a;
}

static inline SKD SKD_F(div_real)(SKD a, SKD_R x) {
    if (SKD_F(vanishes)(x)) return SKD_F(of)(0);
    for (int i = 0; i <= SKD_N; i++) a.d[i] /= x;
    return a;
}

static inline SKD SKD_F(real_add)(SKD_R x, SKD b) {
    return SKD_F(add_real)(b, x);
}

static inline SKD SKD_F(real_sub)(SKD_R x, SKD b) {
    SKD r = SKD_F(neg)(b);
    r.d[0] = x - b.d[0];
    return r;
}

static inline SKD SKD_F(real_mul)(SKD_R x, SKD b) {
    return SKD_F(mul_real)(b, x);
}

static inline SKD SKD_F(real_div)(SKD_R x, SKD b) {
    return SKD_F(div)(SKD_F(of)(x), b);
}

/* Compound forms. The second operand comes by value, so that a *= a and a /= a see the old a throughout. */
static inline void SKD_F(add_to)(SKD *a, SKD b) {
    *a = SKD_F(add)(*a, b);
}

static inline void SKD_F(sub_from)(SKD *a, SKD b) {
    *a = SKD_F(sub)(*a, b);
}

static inline void SKD_F(mul_by)(SKD *a, SKD b) {
    *a = SKD_F(mul)(*a, b);
}

static inline void SKD_F(div_by)(SKD *a, SKD b) {
    *a = SKD_F(div)(*a, b);
}

static inline void SKD_F(add_real_to)(SKD *a, SKD_R x) {
    a->d[0] += x;
}

static inline void SKD_F(sub_real_from)(SKD *a, SKD_R x) {
    a->d[0] -= x;
}

static inline void SKD_F(mul_by_real)(SKD *a, SKD_R x) {
    *a = SKD_F(mul_real)(*a, x);
}

static inline void SKD_F(div_by_real)(SKD *a, SKD_R x) {
    *a = SKD_F(div_real)(*a, x);
}

/* ---- Functions ---------------------------------------------------------------------------------------- */

static inline SKD SKD_F(abs)(SKD a) {
    SKD_R slope = a.d[0] > 0 ? 1 : a.d[0] < 0 ? -1 : 0;
    return SKD_F(chain)(SKD_MATH(fabs)(a.d[0]), slope, a);
}

static inline SKD SKD_F(min)(SKD a, SKD b) {
    return b.d[0] < a.d[0] ? b : a;
}

static inline SKD SKD_F(max)(SKD a, SKD b) {
    return b.d[0] > a.d[0] ? b : a;
}

static inline SKD SKD_F(min_real)(SKD a, SKD_R x) {
    return x < a.d[0] ? SKD_F(of)(x) : a;
}

static inline SKD SKD_F(max_real)(SKD a, SKD_R x) {
    return x > a.d[0] ? SKD_F(of)(x) : a;
}

/* Divides each derivative instead of multiplying by a reciprocal: the length of (-21, 0, 0) has the slope -1 exactly.
 */
static inline SKD SKD_F(sqrt)(SKD a) {
    SKD r = SKD_F(of)(a.d[0] < 0 ? 0 : SKD_MATH(sqrt)(a.d[0]));
    if (a.d[0] > SKD_LEAST)
        for (int i = 1; i <= SKD_N; i++) r.d[i] = a.d[i] / (2 * r.d[0]);
    return r;
}

static inline SKD SKD_F(exp)(SKD a) {
    SKD_R value = SKD_MATH(exp)(a.d[0]);
    return value > SKD_MOST ? SKD_F(of)(SKD_MOST) : SKD_F(chain)(value, value, a);
}

static inline SKD SKD_F(log)(SKD a) {
    if (a.d[0] < SKD_LEAST) return SKD_F(of)(SKD_MATH(log)(SKD_LEAST));
    return SKD_F(chain)(SKD_MATH(log)(a.d[0]), 1 / a.d[0], a);
}

static inline SKD SKD_F(sin)(SKD a) {
    return SKD_F(chain)(SKD_MATH(sin)(a.d[0]), SKD_MATH(cos)(a.d[0]), a);
}

static inline SKD SKD_F(cos)(SKD a) {
    return SKD_F(chain)(SKD_MATH(cos)(a.d[0]), -SKD_MATH(sin)(a.d[0]), a);
}

static inline SKD SKD_F(tan)(SKD a) {
    SKD_R value = SKD_MATH(tan)(a.d[0]);
    return SKD_F(chain)(value, 1 + value * value, a);
}

/* The slope of asin. */
static inline SKD_R SKD_F(asin_slope)(SKD_R x) {
    SKD_R rest = (1 - x) * (1 + x);
    return rest > SKD_LEAST ? 1 / SKD_MATH(sqrt)(rest) : 0;
}

static inline SKD_R SKD_F(to_one)(SKD_R x) {
    return x > 1 ? 1 : x < -1 ? -1 : x;
}

static inline SKD SKD_F(asin)(SKD a) {
    SKD_R x = SKD_F(to_one)(a.d[0]);
    return SKD_F(chain)(SKD_MATH(asin)(x), SKD_F(asin_slope)(x), a);
}

static inline SKD SKD_F(acos)(SKD a) {
    SKD_R x = SKD_F(to_one)(a.d[0]);
    return SKD_F(chain)(SKD_MATH(acos)(x), -SKD_F(asin_slope)(x), a);
}

static inline SKD SKD_F(atan2)(SKD y, SKD x) {
    SKD_R far = SKD_MATH(hypot)(y.d[0], x.d[0]), value = SKD_MATH(atan2)(y.d[0], x.d[0]);
    if (far <= SKD_LEAST) return SKD_F(of)(value);
    return SKD_F(chain2)(value, x.d[0] / far / far, y, -y.d[0] / far / far, x);
}

static inline SKD SKD_F(atan2_real)(SKD y, SKD_R x) {
    return SKD_F(atan2)(y, SKD_F(of)(x));
}

static inline SKD SKD_F(real_atan2)(SKD_R y, SKD x) {
    return SKD_F(atan2)(SKD_F(of)(y), x);
}

/* x to the y for plain numbers, with the guards of pow. */
static inline SKD_R SKD_F(power)(SKD_R x, SKD_R y) {
    if ((x < 0 && y > SKD_MATH(floor)(y)) || (y < 0 && SKD_F(vanishes)(x))) return 0;
    SKD_R value = SKD_MATH(pow)(x, y);
    return value > SKD_MOST ? SKD_MOST : value < -SKD_MOST ? -SKD_MOST : value;
}

/* A slope, or 0 if it is beyond the range. */
static inline SKD_R SKD_F(in_range)(SKD_R slope) {
    return slope > SKD_MOST || slope < -SKD_MOST ? 0 : slope;
}

static inline SKD SKD_F(pow)(SKD a, SKD b) {
    SKD_R x = a.d[0], y = b.d[0], value = SKD_F(power)(x, y);
    SKD_R by_a = SKD_F(in_range)(y * SKD_F(power)(x, y - 1));
    SKD_R by_b = x > SKD_LEAST ? SKD_F(in_range)(value * SKD_MATH(log)(x)) : 0;
    return SKD_F(chain2)(value, by_a, a, by_b, b);
}

static inline SKD SKD_F(pow_real)(SKD a, SKD_R x) {
    SKD_R slope = SKD_F(in_range)(x * SKD_F(power)(a.d[0], x - 1));
    return SKD_F(chain)(SKD_F(power)(a.d[0], x), slope, a);
}

static inline SKD SKD_F(real_pow)(SKD_R x, SKD b) {
    return SKD_F(pow)(SKD_F(of)(x), b);
}

/* ---- Vectors ------------------------------------------------------------------------------------------ */

static inline SKD_V SKD_F(vec_of)(SKD_R x, SKD_R y, SKD_R z) {
    SKD_V r = {SKD_F(of)(x), SKD_F(of)(y), SKD_F(of)(z)};
    return r;
}

static inline SKD_V SKD_F(vec_seed)(SKD_R x, SKD_R y, SKD_R z, int control) {
    SKD_V r = {SKD_F(seed)(x, control), SKD_F(seed)(y, control + 1), SKD_F(seed)(z, control + 2)};
    return r;
}

static inline SKD_V SKD_F(vec_add)(SKD_V v, SKD_V w) {
    SKD_V r = {SKD_F(add)(v.x, w.x), SKD_F(add)(v.y, w.y), SKD_F(add)(v.z, w.z)};
    return r;
}

static inline SKD_V SKD_F(vec_sub)(SKD_V v, SKD_V w) {
    SKD_V r = {SKD_F(sub)(v.x, w.x), SKD_F(sub)(v.y, w.y), SKD_F(sub)(v.z, w.z)};
    return r;
}

static inline SKD_V SKD_F(vec_scale)(SKD_V v, SKD a) {
    SKD_V r = {SKD_F(mul)(v.x, a), SKD_F(mul)(v.y, a), SKD_F(mul)(v.z, a)};
    return r;
}

static inline SKD_V SKD_F(vec_scale_real)(SKD_V v, SKD_R x) {
    SKD_V r = {SKD_F(mul_real)(v.x, x), SKD_F(mul_real)(v.y, x), SKD_F(mul_real)(v.z, x)};
    return r;
}

static inline SKD SKD_F(vec_dot)(SKD_V v, SKD_V w) {
    return SKD_F(add)(SKD_F(add)(SKD_F(mul)(v.x, w.x), SKD_F(mul)(v.y, w.y)), SKD_F(mul)(v.z, w.z));
}

static inline SKD_V SKD_F(vec_cross)(SKD_V v, SKD_V w) {
    SKD_V r = {SKD_F(sub)(SKD_F(mul)(v.y, w.z), SKD_F(mul)(v.z, w.y)),
               SKD_F(sub)(SKD_F(mul)(v.z, w.x), SKD_F(mul)(v.x, w.z)),
               SKD_F(sub)(SKD_F(mul)(v.x, w.y), SKD_F(mul)(v.y, w.x))};
    return r;
}

static inline SKD SKD_F(vec_length)(SKD_V v) {
    return SKD_F(sqrt)(SKD_F(vec_dot)(v, v));
}

static inline SKD SKD_F(vec_distance)(SKD_V v, SKD_V w) {
    return SKD_F(vec_length)(SKD_F(vec_sub)(v, w));
}

static inline SKD_V SKD_F(vec_normalize)(SKD_V v) {
    SKD far = SKD_F(vec_length)(v);
    SKD_V r = {SKD_F(div)(v.x, far), SKD_F(div)(v.y, far), SKD_F(div)(v.z, far)};
    return r;
}

#undef SKD
#undef SKD_F
#undef SKD_LEAST
#undef SKD_MATH
#undef SKD_MOST
#undef SKD_N
#undef SKD_PLAIN_NAME
#undef SKD_R
#undef SKD_V
#undef SKEIN_DUAL_N
#undef SKEIN_DUAL_NAME
#undef SKEIN_DUAL_REAL
