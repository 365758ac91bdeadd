/* The vectors of an implicit solve (methods/backward_euler.c), the arithmetic on whole ones that it is made of, and
 * what it leaves to be told.
 *
 *   A  the system's matrix, 1/h times that of the momenta: m + h drag + h (h k + c) along each spring ...
 *   R  what is missing of the momentum's balance, kg m/s: h F - m (V - V0), without what contact holds
 *   S  the filter: what a pinned or touching particle can still do, a symmetric projector for each
 *
 * Sums have the same bits for any number of threads: a kernel leaves a partial sum for every block of sixteen slots,
 * and sk_solve_sum() adds these up in their order. */
#ifndef SK_PLAN_SOLVE_H
#define SK_PLAN_SOLVE_H

#include "plan/op.h"

/* Where an implicit method keeps what it needs; symmetric 3 x 3 blocks are two vectors, xx yy zz and xy xz yz. */
enum {
    SK_INERTIA = SK_T0, /* the matrix's own part of each particle: mass and drag */
    SK_BLOCK0 = SK_T1,  /* the matrix's diagonal blocks; then their factors */
    SK_BLOCK1 = SK_T2,
    SK_FILTER0 = SK_T3,
    SK_FILTER1 = SK_T4,
    SK_FRICTION = SK_T5,  /* force, N, the same through a substep */
    SK_RESIDUAL = SK_T6,  /* R; of conjugate gradients, too */
    SK_DIRECTION = SK_T7, /* of conjugate gradients */
    SK_PRODUCT = SK_T8,   /* the matrix times the direction, or the preconditioned residual */
    SK_CHANGE = SK_T9,    /* of the velocity: what conjugate gradients solve for */
    SK_GUESS = SK_T10,    /* the velocity that the change starts from */
    SK_SUMS = SK_T11
};

typedef struct sk_solve {
    double scale;  /* a number that the ops of a part take, set before they run */
    bool factored; /* there is a factor of the whole matrix (plan/matrix.h) */
    /* a step's account */
    double residual; /* the largest that was left, as a share of its start */
    size_t unsolved; /* substeps that came neither to the tolerance nor to rounding */
    size_t newton_iterations, iterations; /* of Newton's method, of conjugate gradients */
    size_t factors, failures; /* factorisations, and those that failed, or whose solves did */
} sk_solve;

/* Kernels of ops over slots; `s` is the solve's scale, and those marked leave partial sums.
 *   open          S = 1, or 0 for what is pinned
 *   guess         CHANGE = S V0, V = GUESS = V0 - CHANGE
 *   along         V = GUESS + s CHANGE
 *   imbalance  *  R = S (h F + h friction - m (V - V0));                               R CHANGE
 *   norm       *  of the first source p:                                               p w p, as the second sum
 *   mass          dst = m in x, y and z
 *   factor     *  BLOCK into factors, pivots at least the inertia (the exact ones are);  what rounding makes of R w R
 *   direction     DIRECTION = PRODUCT + s DIRECTION (0: PRODUCT), then PRODUCT = inertia DIRECTION
 *   curvature  *  PRODUCT = S PRODUCT;                                                 DIRECTION PRODUCT
 *   step          CHANGE += s DIRECTION, R -= s PRODUCT
 *   precondition  * PRODUCT = S BLOCK^-1 R, or where there is a factor S PRODUCT;      R PRODUCT */
extern const sk_kernels sk_solve_open, sk_solve_guess, sk_solve_along, sk_solve_imbalance, sk_solve_norm, sk_solve_mass,
    sk_solve_factor, sk_solve_direction, sk_solve_curvature, sk_solve_step, sk_solve_precondition;

/* Adds up what the last such op has left, as its first sum (0), or what norm has (1). */
double sk_solve_sum(const sk_run *run, int which);

#endif
