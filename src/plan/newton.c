/* Newton's method in C. Each run_part() has ops of the plan run, cut over threads as all ops are; their sums have one
 * order (solve.h), so that neither the bits nor what is decided here depend on how many threads there are. */
#include "plan/newton.h"

#include <math.h>
#include <string.h>

/* Conjugate gradients go somewhat further than the whole substep has to. */
static const double cg_share = 0.3;
enum { LINE_TURNS = 8 };

typedef struct solver {
    sk_run *run;
    sk_solve *state;
    const sk_newton *params;
    const sk_op *part[SK_NEWTON_PARTS];
    int iteration;        /* of Newton's method, from 1 */
    double start, square; /* R w R when the substep began, and now; */
    double rounding;      /* what the rounding of positions makes of it */
    double slope;         /* R times the change, before the line search and on the way */
    double first_rz;      /* R in the preconditioner's norm, in the first iteration, */
    bool first_factored;  /* and whether that was the factor's */
} solver;

static solver open_solver(sk_run *run, const sk_op *solve) {
    solver s = {.run = run, .state = run->solve, .params = solve->rule};
    for (const sk_op *op = solve + 1; op <= solve + solve->length; op++)
        if (op->kind == SK_OP_PART) s.part[op->part] = op;
    s.state->factored = false;
    return s;
}

/* Has a part's ops run, with `scale` as their number; returns the sum that they leave. */
static double run_part(solver *s, int part, double scale) {
    s->state->scale = scale;
    if (s->part[part]) s->run->ops(s->run, s->part[part] + 1, s->part[part]->length);
    return sk_solve_sum(s->run, 0);
}

/* R at V, and R w R; returns R times the change. */
static double find_residual(solver *s) {
    double slope = run_part(s, SK_NEWTON_RESIDUAL, 0);
    s->square = sk_solve_sum(s->run, 1);
    return slope;
}

/* One that is not finite cannot get better. */
static bool is_lost(double residual) {
    return !(residual <= SK_REAL_MAX);
}

static bool is_solved(const solver *s) {
    return s->square <= s->params->tolerance * s->params->tolerance * s->start || s->square <= s->rounding;
}

/* CHANGE = A^-1 R; R is used up. */
static void conjugate_gradients(solver *s) {
    const double tolerance = cg_share * s->params->tolerance;
    double beta = 0, rz = run_part(s, SK_NEWTON_PRECONDITION, 0);
    if (s->iteration == 1 || s->first_factored != s->state->factored) {
        s->first_rz = rz; // what later iterations have to show is comparable in its own norm alone
        s->first_factored = s->state->factored;
    }
    s->slope = 0;
    for (int i = 0; i < s->params->cg_iterations && rz > 0; i++) {
        double curvature = run_part(s, SK_NEWTON_MULTIPLY, beta);
        s->state->iterations++;
        if (!(curvature > 0) || is_lost(curvature)) return;
        double alpha = rz / curvature, now = run_part(s, SK_NEWTON_STEP, alpha);
        s->slope += alpha * rz; // every direction is as far from the first residual as from the present one
        beta = now / rz;
        rz = now;
        if (!(rz > tolerance * tolerance * s->first_rz)) return;
    }
}

/* V = guess + share change, with the share at which the residual no longer points far back: the potential whose minimum
 * is sought falls along the change while R times the change is positive. Too far past the minimum, the secant says
 * where it was. (Comparing potentials would compare roundings.) */
static void search_line(solver *s) {
    double share = 1;
    for (int i = 0; i < LINE_TURNS; i++) {
        run_part(s, SK_NEWTON_ALONG, share);
        double slope = find_residual(s);
        if (slope >= -0.5 * fabs(s->slope)) return;
        double secant = s->slope > 0 && !is_lost(-slope) ? s->slope / (s->slope - slope) : 0;
        share *= secant > 0.1 ? secant : 0.1;
    }
}

/* The first guess lies between standing still and going on as before: as far along as the residual allows. Where
 * things meet, going on would press springs through themselves, and the solve would end in such a state. */
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

/* A substep: X and V from X0 and V0. */
void sk_newton_solve(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    solver s = open_solver(run, op);
    find_first_guess(&s);
    for (s.iteration = 1; s.iteration <= s.params->iterations; s.iteration++) {
        run_part(&s, SK_NEWTON_HOLD, 0);
        find_residual(&s);
        // one iteration is always made, however small the residual: among it may be a weight that moves everything
        bool solved = is_solved(&s) && (s.iteration > 1 || s.square <= 0);
        if (solved || is_lost(s.square)) break;
        s.state->newton_iterations++;
        s.rounding = run_part(&s, SK_NEWTON_LINEARISE, 0);
        conjugate_gradients(&s);
        search_line(&s);
    }
    account(&s);
}

void sk_newton_linearise(sk_run *run, const sk_op *op) {
    solver s = open_solver(run, op);
    run_part(&s, SK_NEWTON_LINEARISE, 0);
}

void sk_newton_invert(sk_run *run, const sk_op *op, double share) {
    bool factored = run->solve->factored; // which opening forgets
    const sk_newton *own = op->rule;
    const sk_newton params = {share / cg_share, 1, own->cg_iterations};
    solver s = open_solver(run, op);
    run->solve->factored = factored;
    s.params = &params;
    s.iteration = 1;
    memset(run->vector[SK_CHANGE], 0, run->slot_count * sizeof(sk_vec4));
    conjugate_gradients(&s);
}
