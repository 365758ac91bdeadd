/* Newton's method for an implicit substep, with a line search, and conjugate gradients in each iteration: what is done
 * when, over parts of the plan (op.h) that an implicit method has written. plan/solve.h has the vectors. */
#ifndef SK_PLAN_NEWTON_H
#define SK_PLAN_NEWTON_H

#include "plan/solve.h"

/* Where to stop. */
typedef struct sk_newton {
    double tolerance; /* a share of the residual that there is to begin with */
    int32_t iterations, cg_iterations;
} sk_newton;

/* The parts, and what is so when they have run. */
enum {
    SK_NEWTON_GUESS,        /* V = GUESS: V0 without what can change; CHANGE is that */
    SK_NEWTON_ALONG,        /* V = GUESS + scale CHANGE */
    SK_NEWTON_HOLD,         /* S and V are as contact holds them where V leads */
    SK_NEWTON_RESIDUAL,     /* X, F and RESIDUAL are V's; first sum: RESIDUAL CHANGE, second: that of its square */
    SK_NEWTON_LINEARISE,    /* the matrix A is ready at X and V, GUESS = V, CHANGE = 0; sum: what rounding makes of R w R */
    SK_NEWTON_PRECONDITION, /* PRODUCT = about A^-1 RESIDUAL; sum: RESIDUAL PRODUCT */
    SK_NEWTON_MULTIPLY,     /* DIRECTION = PRODUCT + scale DIRECTION, PRODUCT = A DIRECTION; sum: both */
    SK_NEWTON_STEP,         /* CHANGE += scale DIRECTION, RESIDUAL -= scale PRODUCT, then as PRECONDITION */
    SK_NEWTON_PARTS
};

/* The kernel of a solve op, whose rule is an sk_newton: takes V from V0 to the end of the substep. */
extern sk_op_kernel sk_newton_solve;

/* ---- for who goes through a solve in reverse (world/adjoint_solve.c); S is the solve's, and ops have run before ---- */

/* The matrix A at the run's X and V, */
void sk_newton_linearise(sk_run *run, const sk_op *solve);
/* and CHANGE = A^-1 RESIDUAL, up to that share of it; RESIDUAL is used up. */
void sk_newton_invert(sk_run *run, const sk_op *solve, double share);

#endif
