/* Polynomials and the constants of reductions, for elementary.c and wide_elementary.h alone. */
#ifndef SK_BASE_POLYNOMIAL_H
#define SK_BASE_POLYNOMIAL_H

/* a + b x + c x^2 + d x^3, given x^2 too. */
#define P2(x_, a_, b_) ((a_) + (b_) * (x_))
#define P3(x_, x2_, a_, b_, c_) (P2(x_, a_, b_) + (c_) * (x2_))
#define P4(x_, x2_, a_, b_, c_, d_) (P2(x_, a_, b_) + P2(x_, c_, d_) * (x2_))

#define ROUND 0x1.8p52 // x + ROUND has x, rounded to a whole number, in its last bits
#define ROUND_BITS UINT64_C(0x4338000000000000)
#define TWO_BY_PI 0x1.45f306dc9c883p-1

#endif
