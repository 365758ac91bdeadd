/* Backward Euler: the velocity at the end of the substep is the one whose own forces lead there,
 *
 *   m (v - v0) = h F(x0 + h v, v),     x = x0 + h v.
 *
 * First order, and stable at any stiffness and substep; what a substep is too long for is damped out. Solved by
 * Newton's method; each turn solves (m + h c + h^2 k) dv = R by conjugate gradients (Baraff, Witkin 1998, with
 * the spring's blocks kept positive definite as in Choi, Ko 2002), preconditioned by the matrix's 3 x 3 blocks or by a
 * sparse factor of it. Contact is a filter inside that solve.
 *
 * The plan has the solve as one row, and behind it in parts what the solve has run: the residual, the product with the
 * matrix and so on (plan/solve.h has the vectors). What is done when stands here, as a loop in C; a part's rows are cut
 * over threads as all rows are, and its sums have one order, so that the bits do not depend on how many there are. */
#include "methods/writer_solve.h"

#include <math.h>

#include "base/status.h"
#include "methods/method.h"

typedef struct backward_euler_params {
    int32_t substeps, turns, cg_iterations;
    int32_t preconditioner;
    double tolerance;
} backward_euler_params;

static const skein_field fields[] = {
    SK_INT(backward_euler_params, substeps, "substeps", "", 2, 1, 100000, "equal parts that a step is cut into"),
    SK_REAL(backward_euler_params, tolerance, "tolerance", "", 1e-5, 1e-12, 0.1,
            "a substep is solved when its residual is so small a share of its start, or all rounding"),
    SK_INT(backward_euler_params, turns, "turns", "", 20, 1, 1000, "of Newton's method in a substep, at most"),
    SK_INT(backward_euler_params, cg_iterations, "cg_iterations", "", 400, 1, 100000,
           "of conjugate gradients in a turn, at most"),
    SK_CHOICE(backward_euler_params, preconditioner, "preconditioner", 0, "blocks|cholesky",
              "what shortens conjugate gradients: each particle's own block, or a sparse factor of the whole matrix"),
};
enum { BLOCKS, CHOLESKY };

/* Conjugate gradients go somewhat further than the whole substep has to. */
static const double cg_share = 0.3;
enum { LINE_TURNS = 8 };

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    const backward_euler_params *given = params;
    if (given->preconditioner == CHOLESKY && !rules->sparse_solver)
        return sk_fail(error, SKEIN_ERROR_VALUE, "method.preconditioner",
                       "cholesky needs a sparse solver, and this world has none: 'tools/setup build' installs CHOLMOD, "
                       "then build again (programs: skein_cholmod_attach()); or take blocks");
    return sk_refuse_rigid(rules, "backward_euler", error);
}

/* ---- the solve ---- */

enum { GUESS, ALONG, HOLD, RESIDUAL, LINEARISE, PRECONDITION, MULTIPLY, STEP, PARTS };

typedef struct solver {
    sk_run *run;
    sk_solve *state;
    const backward_euler_params *params;
    const sk_row *part[PARTS];
    int turn;             /* of Newton's method, from 1 */
    double start, square; /* R w R when the substep began, and now; */
    double rounding;      /* what the rounding of positions makes of it */
    double slope;         /* R times the change, before the line search and on the way */
    double first_rz;      /* R in the preconditioner's norm, in the first turn, */
    bool first_factored;  /* and whether that was the factor's */
} solver;

static solver open_solver(sk_run *run, const sk_row *solve) {
    solver s = {.run = run, .state = run->solve, .params = solve->rule};
    for (const sk_row *row = solve + 1; row <= solve + solve->length; row++)
        if (row->kind == SK_ROW_PART) s.part[row->part] = row;
    s.state->factored = false;
    return s;
}

/* Has a part's rows run, with `scale` as their number; returns the sum that they leave. */
static double run_part(solver *s, int part, double scale) {
    s->state->scale = scale;
    if (s->part[part]) s->run->rows(s->run, s->part[part] + 1, s->part[part]->length);
    return sk_solve_sum(s->run, 0);
}

/* R at V, and R w R; returns R times the change. */
static double find_residual(solver *s) {
    double slope = run_part(s, RESIDUAL, 0);
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
    double beta = 0, rz = run_part(s, PRECONDITION, 0);
    if (s->turn == 1 || s->first_factored != s->state->factored) {
        s->first_rz = rz; // what later turns have to show is comparable in its own norm alone
        s->first_factored = s->state->factored;
    }
    s->slope = 0;
    for (int i = 0; i < s->params->cg_iterations && rz > 0; i++) {
        double curvature = run_part(s, MULTIPLY, beta);
        s->state->iterations++;
        if (!(curvature > 0) || is_lost(curvature)) return;
        double alpha = rz / curvature, now = run_part(s, STEP, alpha);
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
        run_part(s, ALONG, share);
        double slope = find_residual(s);
        if (slope >= -0.5 * fabs(s->slope)) return;
        double secant = s->slope > 0 && !is_lost(-slope) ? s->slope / (s->slope - slope) : 0;
        share *= secant > 0.1 ? secant : 0.1;
    }
}

/* The first guess lies between standing still and going on as before: as far along as the residual allows. Where
 * things meet, going on would press springs through themselves, and the solve would end in such a state. */
static void find_first_guess(solver *s) {
    run_part(s, GUESS, 0);
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
static void solve_substep(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)begin, (void)end;
    solver s = open_solver(run, row);
    find_first_guess(&s);
    for (s.turn = 1; s.turn <= s.params->turns; s.turn++) {
        run_part(&s, HOLD, 0);
        find_residual(&s);
        // one turn is always made, however small the residual: among it may be a weight that moves everything
        bool solved = is_solved(&s) && (s.turn > 1 || s.square <= 0);
        if (solved || is_lost(s.square)) break;
        s.state->turns++;
        s.rounding = run_part(&s, LINEARISE, 0);
        conjugate_gradients(&s);
        search_line(&s);
    }
    account(&s);
}

/* ---- what the solve has run ---- */

/* R = S (h F + h friction - m (V - V0)), at X = X0 + h V. */
static void write_residual(sk_writer *writer, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL;
    sk_write_sum(writer, SK_X, 1, SK_X0, h, SK_V);
    sk_write_fields(writer);
    sk_write_forces(writer);
    sk_write_pass(writer, &sk_solve_imbalance, residual, SK_F, (sk_vector)SK_FRICTION,
                  "S (h F + h T5 + m (V0 - V)); sum R T9");
    sk_write_pass(writer, &sk_solve_norm, (sk_vector)SK_SUMS, residual, SK_X, "R w R");
}

/* The matrix's factor at X and V. (That of an earlier turn is no substitute: springs that have gone slack or taut since
 * made conjugate gradients as long as the blocks do.) */
static void write_factor(sk_writer *writer, double h) {
    sk_vector block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_sum(writer, block, 1, (sk_vector)SK_INERTIA, 0, SK_NONE);
    sk_write_clear(writer, off);
    sk_write_diagonal_of_forces(writer, block, off, h * h, h);
    sk_write_factor(writer, block, off, h * h, h);
}

/* The matrix's diagonal blocks at X and V, and their factors; no change yet, from where V is. */
static void write_linearise(sk_writer *writer, const backward_euler_params *params, double h) {
    sk_vector inertia = (sk_vector)SK_INERTIA, block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_pass(writer, &sk_solve_mass, inertia, SK_V, SK_NONE, "m");
    sk_write_resistance(writer, inertia, h);
    if (params->preconditioner == CHOLESKY) write_factor(writer, h);
    sk_write_sum(writer, block, 1, inertia, 0, SK_NONE);
    sk_write_clear(writer, off);
    sk_write_diagonal(writer, block, off, h * h, h);
    sk_write_diagonal_of_forces(writer, block, off, h * h, h);
    sk_write_pass(writer, &sk_solve_factor, block, off, inertia, "L D L^T of the blocks; sum of rounding");
    sk_write_clear(writer, (sk_vector)SK_CHANGE);
    sk_write_sum(writer, (sk_vector)SK_GUESS, 1, SK_V, 0, SK_NONE);
}

/* T8 = about A^-1 R. */
static void write_precondition(sk_writer *writer, const backward_euler_params *params) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, product = (sk_vector)SK_PRODUCT;
    if (params->preconditioner == CHOLESKY) sk_write_factor_solve(writer, product, residual);
    sk_write_pass(writer, &sk_solve_precondition, product, residual, SK_NONE, "S A~^-1 R; sum R T8");
}

static void write_solve(sk_writer *writer, const backward_euler_params *params, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, change = (sk_vector)SK_CHANGE, guess = (sk_vector)SK_GUESS;
    size_t solve = sk_write_solve(writer, solve_substep, params, "V, X by Newton's method");
    size_t part = sk_write_part(writer, GUESS, "first guess");
    sk_write_pass(writer, &sk_solve_guess, SK_V, change, guess, "T10 = V0 - T9; T9 = S V0");
    sk_write_end(writer, part);
    part = sk_write_part(writer, ALONG, "along the change");
    sk_write_pass(writer, &sk_solve_along, SK_V, guess, change, "T10 + share T9");
    sk_write_end(writer, part);
    part = sk_write_part(writer, HOLD, "contact at the guess");
    sk_write_sum(writer, SK_X, 1, SK_X0, h, SK_V);
    sk_write_more_filters(writer);
    sk_write_end(writer, part);
    part = sk_write_part(writer, RESIDUAL, "residual R");
    write_residual(writer, h);
    sk_write_end(writer, part);
    part = sk_write_part(writer, LINEARISE, "matrix A");
    write_linearise(writer, params, h);
    sk_write_end(writer, part);
    part = sk_write_part(writer, PRECONDITION, "first direction");
    write_precondition(writer, params);
    sk_write_end(writer, part);
    part = sk_write_part(writer, MULTIPLY, "conjugate gradients: product");
    sk_write_multiply(writer, h * h, h);
    sk_write_end(writer, part);
    part = sk_write_part(writer, STEP, "conjugate gradients: step");
    sk_write_pass(writer, &sk_solve_step, change, residual, SK_NONE, "T9 + alpha T7; R - alpha T8");
    write_precondition(writer, params);
    sk_write_end(writer, part);
    sk_write_end(writer, solve);
}

static void write(sk_writer *writer, const void *data, double dt) {
    const backward_euler_params *params = data;
    double h = dt / params->substeps;
    size_t repeat = sk_write_repeat(writer, (size_t)params->substeps, h);
    sk_write_steering(writer);
    sk_write_fields(writer);
    sk_write_forces(writer);
    sk_write_filters(writer);
    sk_write_sum(writer, SK_X0, 1, SK_X, 0, SK_NONE);
    sk_write_sum(writer, SK_V0, 1, SK_V, 0, SK_NONE);
    sk_write_moment(writer, 1);
    write_solve(writer, params, h);
    sk_write_bounds(writer);
    sk_write_contacts(writer, SK_CONTACT_IMPULSE);
    sk_write_limits(writer, SK_V);
    sk_write_contacts(writer, SK_CONTACT_PUSH);
    sk_write_end(writer, repeat);
}

const sk_method_type sk_backward_euler = {
    .kind = {"backward_euler", "implicit: solves for the velocity whose forces lead to it; stable at any stiffness",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(backward_euler_params)},
    .check = check,
    .write = write,
    .substeps = sk_substeps_of,
};
