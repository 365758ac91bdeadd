/* Newton's method for an implicit substep, with a line search, and conjugate gradients in each iteration. It decides in
 * which order the parts of the plan (op.h) that an implicit method has written run. plan/solve.h has the vectors. */
#ifndef SK_PLAN_NEWTON_H
#define SK_PLAN_NEWTON_H

#include "plan/solve.h"

/* Where to stop. */
typedef struct sk_newton {
    double tolerance; /* as a share of the first residual */
    int32_t iterations, cg_iterations;
} sk_newton;

/* The parts, and what holds after each has run. */
enum {
    SK_NEWTON_GUESS,        /* CHANGE = S V0, the part of V0 that is free to change; V = GUESS = V0 - CHANGE */
    SK_NEWTON_ALONG,        /* V = GUESS + scale CHANGE */
    SK_NEWTON_HOLD,         /* S and V include the contacts at the position that V leads to */
    SK_NEWTON_RESIDUAL,     /* X, F and RESIDUAL belong to V; first sum: RESIDUAL CHANGE, second: RESIDUAL w RESIDUAL */
    SK_NEWTON_LINEARISE,    /* A is ready at X and V, GUESS = V, CHANGE = 0; sum: the R w R that rounding may cause */
    SK_NEWTON_PRECONDITION, /* PRODUCT = about A^-1 RESIDUAL; sum: RESIDUAL PRODUCT */
    SK_NEWTON_MULTIPLY,     /* DIRECTION = PRODUCT + scale DIRECTION, PRODUCT = A DIRECTION; sum: their dot product */
    SK_NEWTON_STEP,         /* CHANGE += scale DIRECTION, RESIDUAL -= scale PRODUCT, then the same as PRECONDITION */
    SK_NEWTON_MEET,         /* V, X and S include what surfaces hold back at X, and `held` counts it; may be missing */
    SK_NEWTON_PARTS
};

/* The kernel of a solve op, whose rule is an sk_newton: takes V from V0 to the end of the substep. */
extern sk_op_kernel sk_newton_solve;

/* ---- for the adjoint of a solve (world/adjoint_solve.c), after the solve has run; it keeps the solve's S ---- */

/* Makes the matrix A at the run's X and V. */
void sk_newton_linearise(sk_run *run, const sk_op *solve);
/* CHANGE = A^-1 RESIDUAL, to the tolerance `share`. Overwrites RESIDUAL. */
void sk_newton_invert(sk_run *run, const sk_op *solve, double share);

#endif
