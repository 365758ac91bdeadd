/* The rows of an implicit solve: Newton's method with conjugate gradients and a line search, as data.
 *
 * Numbers that rows hand to each other are in *cells*. A dot row leaves a partial sum for every block of
 * sixteen slots in the vector SK_SUMS; the scalar row after it adds these up, in blocks of 1,024 slots in
 * their order, so that the sum has the same bits for any number of threads, and decides what comes next.
 * A repeat that names a cell ends when that is not 0.
 *
 *   A  the system's matrix, 1/h times that of the momenta: m + h drag + h (h k + c) along each spring ...
 *   R  what is missing of the momentum's balance, kg m/s: h F - m (V - V0), without what contact holds
 *   S  the filter: what a held or touching particle can still do, a symmetric projector for each */
#ifndef SK_PLAN_SOLVE_H
#define SK_PLAN_SOLVE_H

#include "plan/row.h"

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

typedef enum sk_cell {
    SK_CELL_NONE, /* a repeat that names it ends with its count */
    SK_CELL_SOLVED,
    SK_CELL_CG_DONE,
    SK_CELL_LINE_DONE,
    SK_CELL_START,     /* R w R when the substep began */
    SK_CELL_PRESENT,   /* the same now */
    SK_CELL_ROUNDING,  /* and what the rounding of positions makes of it */
    SK_CELL_TURN,      /* of Newton's method, from 1 */
    SK_CELL_RZ,        /* of conjugate gradients: the residual in the preconditioner's norm, */
    SK_CELL_RZ_START,  /* the same in the first turn */
    SK_CELL_ALPHA,     /* the step along the direction, */
    SK_CELL_BETA,      /* and what is kept of the direction */
    SK_CELL_SHARE,     /* of the change that the line search tries */
    SK_CELL_SLOPE,     /* R times the change, before it */
    SK_CELL_FACTORED,  /* there is a factor of the whole matrix */
    SK_CELL_IN_FACTOR, /* the first turn's residual was measured in the factor's norm */
    /* a step's account */
    SK_CELL_NEWTON_TURNS,
    SK_CELL_CG_TURNS,
    SK_CELL_WORST,    /* the largest residual that was left, as a share of its start */
    SK_CELL_UNSOLVED, /* substeps that came neither to the tolerance nor to rounding */
    SK_CELL_FACTORS,  /* factorisations, */
    SK_CELL_FAILURES, /* and those that failed, or whose solves did */
    SK_CELL_COUNT
} sk_cell;

/* Vectors.   product    dst = p q, component by component       mass      dst = m in x, y and z
 *            momentum   dst += m (p - q)                        cell_sum  dst = p + a cell q
 *            filter     dst = S dst                             open      S = 1, or 0 for what is held
 *            factor     blocks into factors, pivots at least the inertia (the exact ones are)
 *            backsolve  dst = blocks^-1 p */
extern const sk_kernels sk_solve_product, sk_solve_mass, sk_solve_momentum, sk_solve_cell_sum, sk_solve_filter,
    sk_solve_open, sk_solve_factor, sk_solve_backsolve;
/* Partial sums.   dot  p q      norm  p w p      rounding  what rounding alone may make of R w R */
extern const sk_kernels sk_solve_dot, sk_solve_norm, sk_solve_rounding;
/* Adds up what a row of partial sums has left. */
double sk_solve_sum(const sk_run *run);
/* Scalars; each begins with the sum of what the row before it left. */
extern sk_row_kernel sk_solve_start, sk_solve_line_start, sk_solve_judge, sk_solve_note_rounding, sk_solve_cg_start,
    sk_solve_cg_alpha, sk_solve_cg_beta, sk_solve_line_judge, sk_solve_end;

#endif
