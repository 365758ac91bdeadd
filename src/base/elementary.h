/* Elementary functions (sine, exponential, ...) with the same bits on every machine.
 *
 * The C library picks its code by processor, so its last bits differ. These use only + - * /, square roots,
 * comparisons and bit patterns, so that compiler, instruction set and vector width do not matter.
 * They ask for round-to-nearest and, like everything here, a build without contraction (-ffp-contract=off).
 * Used by whatever computes state: colliders, builders, forces, formulas. Pure functions; nothing is owned.
 *
 * Each comes for double and (with f) for float, whatever `real` is. Errors are the largest against the exact value,
 * in units in the last place of the result (ulp; for results under the least normal number, of that number's):
 *
 *                 double   float
 *     sin, cos    0.87     0.83    all finite x, huge ones too: those are reduced by all the bits of pi that count
 *     tan         1.05     1.02    the same
 *     exp         0.79     0.80    beyond the range inf, subnormal numbers (the worst here), and then 0
 *     log         0.68     0.67    all x > 0
 *     pow         0.79     0.51    all x and y; the worst is subnormal
 *     asin        0.73     0.74    -1 to 1
 *     acos        0.70     0.72    -1 to 1
 *     atan2       0.74     0.75    all x and y
 *
 * Found by trial, not proved: float, over every argument (pow and atan2: 3 10^8 pairs); double, over 10^8 arguments
 * each, with up to 0.06 added.
 *
 * A NaN in gives a NaN out (but pow, below); outside the domain comes NaN: sin, cos and tan of an infinity, log of
 * x < 0, asin and acos of |x| > 1. A NaN's own sign and payload are not promised. An odd function keeps the sign of
 * zero. errno and the exception flags are not specified. Where denormals are flushed to zero, a subnormal
 * argument counts as 0 and a subnormal result is 0. */
#ifndef SK_BASE_ELEMENTARY_H
#define SK_BASE_ELEMENTARY_H

#include <stdint.h>

/* Angles in radians. One reduction up to |x| = 2^30 (float: 2^25), a slower one beyond. */
double sk_sin(double x) __attribute__((const)); /* so that loops ask once */
double sk_cos(double x) __attribute__((const));
double sk_tan(double x);
void sk_sincos(double x, double *sine, double *cosine); /* the bits of sk_sin and sk_cos */
float sk_sinf(float x);
float sk_cosf(float x);
float sk_tanf(float x);
void sk_sincosf(float x, float *sine, float *cosine);

/* The remainder of an angle of 2^25 or more after whole quarter turns, and their number modulo 4: for wide versions. */
void sk_reduce_far(double x, double *rest, uint32_t *quarters);

/* e to the x: exp(-inf) = 0, exp(inf) = inf. */
double sk_exp(double x);
float sk_expf(float x);

/* The natural logarithm: log(0) = -inf, log(inf) = inf, NaN below zero. */
double sk_log(double x);
float sk_logf(float x);

/* x to the y, with C's special cases: pow(x, 0) = pow(1, y) = 1 even for NaN, pow(-1, inf) = 1; a negative x takes
 * its sign from an odd y, and gives NaN for a y that is not whole; pow(0, y) is 0 or, for y < 0, infinite. */
double sk_pow(double x, double y);
float sk_powf(float x, float y);

/* -pi/2 to pi/2, and 0 to pi. */
double sk_asin(double x);
double sk_acos(double x);
float sk_asinf(float x);
float sk_acosf(float x);

/* The angle of the point (x, y), -pi to pi. As in C, zeros count by their signs and infinities as equally far:
 * atan2(+-0, -0) = +-pi, atan2(+-0, +0) = +-0, atan2(inf, inf) = pi/4. */
double sk_atan2(double y, double x);
float sk_atan2f(float y, float x);

#endif
