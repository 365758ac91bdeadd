/* Newton's method. Each run_part() runs ops of the plan, on threads like all ops. Their sums are added in a fixed order
 * (solve.h), so that neither results nor decisions depend on the number of threads. */
#include "plan/newton.h"

#include <math.h>
#include <string.h>

/* The tolerance of conjugate gradients, as a share of the substep's. */
static const double cg_share = 0.3;
enum { LINE_STEPS = 8 };

typedef struct solver {
    sk_run *run;
    sk_solve *state;
    const sk_newton *params;
    const sk_op *part[SK_NEWTON_PARTS];
    int iteration;        /* of Newton's method, from 1 */
    double start, square; /* R w R when the substep began, and now; */
    double rounding;      /* the R w R that rounding alone may cause */
    double slope;         /* R times the change, where the line search begins */
    double first_rz;      /* the square of R in the preconditioner's norm, in the first iteration, */
    bool first_factored;  /* and whether that preconditioner was the factor */
} solver;

static solver open_solver(sk_run *run, const sk_op *solve) {
    solver s = {.run = run, .state = run->solve, .params = solve->rule};
    for (const sk_op *op = solve + 1; op <= solve + solve->length; op++)
        if (op->kind == SK_OP_PART) s.part[op->part] = op;
    s.state->factored = false;
    return s;
}

/* Runs the ops of a part, with `scale` as the solve's scale; returns the first sum that they leave. */
static double run_part(solver *s, int part, double scale) {
    s->state->scale = scale;
    if (s->part[part]) s->run->ops(s->run, s->part[part] + 1, s->part[part]->length);
    return sk_solve_sum(s->run, 0);
}

/* Finds R at V, and R w R; returns R times the change. */
static double find_residual(solver *s) {
    double slope = run_part(s, SK_NEWTON_RESIDUAL, 0);
    s->square = sk_solve_sum(s->run, 1);
    return slope;
}

/* A residual that is infinite or NaN cannot get better. */
static bool is_lost(double residual) {
    return !(residual <= SK_REAL_MAX);
}

static bool is_solved(const solver *s) {
    return s->square <= s->params->tolerance * s->params->tolerance * s->start || s->square <= s->rounding;
}

/* CHANGE = A^-1 R. Overwrites R. */
static void conjugate_gradients(solver *s) {
    const double tolerance = cg_share * s->params->tolerance;
    double beta = 0, rz = run_part(s, SK_NEWTON_PRECONDITION, 0);
    if (s->iteration == 1 || s->first_factored != s->state->factored) {
        s->first_rz = rz; // residuals can be compared only in the norm of one preconditioner
        s->first_factored = s->state->factored;
    }
    s->slope = 0;
    for (int i = 0; i < s->params->cg_iterations && rz > 0; i++) {
        double curvature = run_part(s, SK_NEWTON_MULTIPLY, beta);
        s->state->iterations++;
        if (!(curvature > 0) || is_lost(curvature)) return;
        double alpha = rz / curvature, now = run_part(s, SK_NEWTON_STEP, alpha);
        s->slope += alpha * rz; // a direction's product with the first residual equals that with the present one
        beta = now / rz;
        rz = now;
        if (!(rz > tolerance * tolerance * s->first_rz)) return;
    }
}

/* V = guess + share change, with a share at which R times the change is not far below 0: while it is positive, the
 * potential that is minimised falls along the change. Too far past the minimum, the secant method estimates where that
 * was. (Differences of the potential itself would be lost in rounding.) */
static void search_line(solver *s) {
    double share = 1;
    for (int i = 0; i < LINE_STEPS; i++) {
        run_part(s, SK_NEWTON_ALONG, share);
        double slope = find_residual(s);
        if (slope >= -0.5 * fabs(s->slope)) return;
        double secant = s->slope > 0 && !is_lost(-slope) ? s->slope / (s->slope - slope) : 0;
        share *= secant > 0.1 ? secant : 0.1;
    }
}

/* The first guess lies between rest and the velocity V0, as near to V0 as the line search allows. In a collision, V0
 * could turn springs inside out, and the solve would end in such a state. */
static void find_first_guess(solver *s) {
    run_part(s, SK_NEWTON_GUESS, 0);
    s->slope = find_residual(s);
    s->start = s->square;
    search_line(s);
}

static void account(solver *s) {
    double left = s->start > 0 ? sqrt(s->square / s->start) : 0;
    if (!(left <= s->state->residual)) s->state->residual = left;
    s->state->unsolved += s->start != 0 && !is_solved(s);
}

/* Newton's method, from V and X on. */
static void iterate(solver *s) {
    for (s->iteration = 1; s->iteration <= s->params->iterations; s->iteration++) {
        run_part(s, SK_NEWTON_HOLD, 0);
        find_residual(s);
        // always at least one iteration: even a small residual may be a uniform force such as weight, which moves all
        bool solved = is_solved(s) && (s->iteration > 1 || s->square <= 0);
        if (solved || is_lost(s->square)) break;
        s->state->newton_iterations++;
        s->rounding = run_part(s, SK_NEWTON_LINEARISE, 0);
        conjugate_gradients(s);
        search_line(s);
    }
}

/* Whether surfaces hold particles back from where the solve has led them. */
static bool meets(solver *s) {
    if (!s->part[SK_NEWTON_MEET]) return false;
    s->state->held = 0;
    run_part(s, SK_NEWTON_MEET, 0);
    return s->state->held > 0;
}

/* One substep: finds X and V from X0 and V0. What surfaces hold back stays where that is, and the others are solved for
 * again: if a bound after the solve did all of it, what is fastened to those would be stretched, which the next solve
 * turns into motion. */
void sk_newton_solve(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    enum { TIMES_AGAIN = 2 };
    solver s = open_solver(run, op);
    find_first_guess(&s);
    iterate(&s);
    for (int i = 0; i < TIMES_AGAIN && meets(&s); i++) iterate(&s);
    account(&s);
}

void sk_newton_linearise(sk_run *run, const sk_op *op) {
    solver s = open_solver(run, op);
    run_part(&s, SK_NEWTON_LINEARISE, 0);
}

void sk_newton_invert(sk_run *run, const sk_op *op, double share) {
    bool factored = run->solve->factored; // open_solver() resets it
    const sk_newton *own = op->rule;
    const sk_newton params = {share / cg_share, 1, own->cg_iterations};
    solver s = open_solver(run, op);
    run->solve->factored = factored;
    s.params = &params;
    s.iteration = 1;
    memset(run->vector[SK_CHANGE], 0, run->slot_count * sizeof(sk_vec4));
    conjugate_gradients(&s);
}
