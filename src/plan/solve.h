/* The vectors of an implicit solve (methods/backward_euler.c), the kernels that work on whole ones, and the figures
 * that a step reports of it.
 *
 *   A  the system's matrix, acting on changes of velocity: m + h drag + h (h k + c) along each spring ...
 *   R  the residual of the momentum balance, kg m/s: h F - m (V - V0), without the components that contact holds
 *   S  the filter: for each particle a symmetric projector onto the motions that pins and contact leave free
 *
 * Sums have the same bits for any number of threads: a kernel stores a partial sum for every block of sixteen slots,
 * and sk_solve_sum() adds these up in order. */
#ifndef SK_PLAN_SOLVE_H
#define SK_PLAN_SOLVE_H

#include "plan/op.h"

/* The temporaries of an implicit method. A symmetric 3 x 3 block takes two vectors, xx yy zz and xy xz yz. */
enum {
    SK_INERTIA = SK_T0, /* each particle's own diagonal terms of the matrix: mass and drag */
    SK_BLOCK0 = SK_T1,  /* the matrix's diagonal blocks; then their factors */
    SK_BLOCK1 = SK_T2,
    SK_FILTER0 = SK_T3,
    SK_FILTER1 = SK_T4,
    SK_FRICTION = SK_T5,  /* force, N, constant through a substep */
    SK_RESIDUAL = SK_T6,  /* R; also the residual of conjugate gradients */
    SK_DIRECTION = SK_T7, /* of conjugate gradients */
    SK_PRODUCT = SK_T8,   /* the matrix times the direction, or the preconditioned residual */
    SK_CHANGE = SK_T9,    /* the change of velocity that conjugate gradients solve for */
    SK_GUESS = SK_T10,    /* the velocity that the change starts from */
    SK_SUMS = SK_T11
};

typedef struct sk_solve {
    double scale;  /* a number that the ops of a part read, set before they run */
    bool factored; /* there is a factor of the whole matrix (plan/matrix.h) */
    size_t held;   /* particles that surfaces have held back, as they were last looked at */
    /* figures of a step */
    double residual;                      /* the largest final residual, as a share of the first one of its substep */
    size_t unsolved;                      /* substeps that reached neither the tolerance nor the level of rounding */
    size_t newton_iterations, iterations; /* of Newton's method, of conjugate gradients */
    size_t factors, failures;             /* factorisations, and those that failed, or whose solves did */
} sk_solve;

/* Kernels of ops over slots; `s` is the solve's scale, and those marked * store partial sums of what stands last.
 *   open          S = 1, or 0 for what is pinned
 *   guess         CHANGE = S V0, V = GUESS = V0 - CHANGE
 *   along         V = GUESS + s CHANGE
 *   imbalance  *  R = S (h F + h friction - m (V - V0));                               R CHANGE
 *   norm       *  for the first source p:                                              p w p, as the second sum
 *   mass          dst = m in x, y and z
 *   factor     *  factors BLOCK; pivots are at least the inertia, as exact ones are;   R w R that rounding may cause
 *   direction     DIRECTION = PRODUCT + s DIRECTION (0: PRODUCT), then PRODUCT = inertia DIRECTION
 *   curvature  *  PRODUCT = S PRODUCT;                                                 DIRECTION PRODUCT
 *   step          CHANGE += s DIRECTION, R -= s PRODUCT
 *   precondition  * PRODUCT = S BLOCK^-1 R, or S PRODUCT if there is a factor;         R PRODUCT */
extern const sk_kernels sk_solve_open, sk_solve_guess, sk_solve_along, sk_solve_imbalance, sk_solve_norm, sk_solve_mass,
    sk_solve_factor, sk_solve_direction, sk_solve_curvature, sk_solve_step, sk_solve_precondition;

/* Adds up the partial sums of the last such op: the first sum (0), or that of norm (1). */
double sk_solve_sum(const sk_run *run, int which);

#endif
