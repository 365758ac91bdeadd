/* Backward Euler: the velocity at the end of the substep is the one whose own forces lead there,
 *
 *   m (v - v0) = h F(x0 + h v, v),     x = x0 + h v.
 *
 * First order, and stable at any stiffness and substep; what a substep is too long for is damped out. Solved by
 * Newton's method; each turn solves (m + h c + h^2 k) dv = R by conjugate gradients (Baraff, Witkin 1998, with
 * the spring's blocks kept positive definite as in Choi, Ko 2002), preconditioned by the matrix's 3 x 3 blocks.
 * Contact is a filter inside that solve. */
#include "methods/writer_solve.h"

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
static const size_t line_turns = 8;

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    const backward_euler_params *given = params;
    if (given->preconditioner == CHOLESKY && !rules->sparse_solver)
        return sk_fail(error, SKEIN_ERROR_VALUE, "method.preconditioner",
                       "cholesky needs a sparse solver, and this world has none: 'tools/setup build' installs CHOLMOD, "
                       "then build again (programs: skein_cholmod_attach()); or take blocks");
    return sk_refuse_rigid(rules, "backward_euler", error);
}

/* R = S (h F + h friction - m (V - V0)), at X = X0 + h V. */
static void write_residual(sk_writer *writer, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL;
    sk_write_sum(writer, SK_X, 1, SK_X0, h, SK_V);
    sk_write_fields(writer);
    sk_write_forces(writer);
    sk_write_sum(writer, residual, h, SK_F, h, (sk_vector)SK_FRICTION);
    sk_write_solve(writer, &sk_solve_momentum, residual, SK_V0, SK_V, "R + m (V0 - V)");
    sk_write_solve(writer, &sk_solve_filter, residual, SK_NONE, SK_NONE, "S R");
}

/* The matrix's factor at X and V. (That of an earlier turn is no substitute: springs that have gone slack or taut since
 * made conjugate gradients as long as the blocks do.) */
static void write_factor(sk_writer *writer, sk_vector inertia, double h) {
    sk_vector block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_sum(writer, block, 1, inertia, 0, SK_NONE);
    sk_write_clear(writer, off);
    sk_write_diagonal_of_forces(writer, block, off, h * h, h);
    sk_write_factor(writer, block, off, h * h, h);
}

/* The matrix's diagonal blocks at X and V, and their factors. */
static void write_linearise(sk_writer *writer, const backward_euler_params *params, double h) {
    const double epsilon = sizeof(real) == sizeof(double) ? 1e-16 : 5e-8;
    sk_vector inertia = (sk_vector)SK_INERTIA, block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_solve(writer, &sk_solve_mass, inertia, SK_V, SK_NONE, "m");
    sk_write_resistance(writer, inertia, h);
    if (params->preconditioner == CHOLESKY) write_factor(writer, inertia, h);
    sk_write_sum(writer, block, 1, inertia, 0, SK_NONE);
    sk_write_clear(writer, off);
    sk_write_diagonal(writer, block, off, h * h, h);
    sk_write_diagonal_of_forces(writer, block, off, h * h, h);
    sk_write_dot(writer, &sk_solve_rounding, SK_X, SK_V, epsilon, "rounding");
    sk_write_scalar(writer, sk_solve_note_rounding, 0, "rounding = sum");
    sk_write_solve(writer, &sk_solve_factor, block, off, inertia, "L D L^T of the blocks");
}

/* T8 = about the matrix^-1 R. */
static void write_precondition(sk_writer *writer, const backward_euler_params *params) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, product = (sk_vector)SK_PRODUCT;
    size_t once = 0;
    if (params->preconditioner == CHOLESKY) {
        sk_write_factor_solve(writer, product, residual);
        once = sk_write_until(writer, 1, SK_CELL_FACTORED, "unless there was a factor");
    }
    sk_write_solve(writer, &sk_solve_backsolve, product, residual, SK_NONE, "blocks^-1 R");
    if (once) sk_write_end(writer, once);
    sk_write_solve(writer, &sk_solve_filter, product, SK_NONE, SK_NONE, "S T8");
}

/* The change of V, from the residual; R is used up. */
static void write_conjugate_gradients(sk_writer *writer, const backward_euler_params *params, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, direction = (sk_vector)SK_DIRECTION, change = (sk_vector)SK_CHANGE;
    sk_vector product = (sk_vector)SK_PRODUCT;
    sk_write_clear(writer, change);
    write_precondition(writer, params);
    sk_write_sum(writer, direction, 1, product, 0, SK_NONE);
    sk_write_dot(writer, &sk_solve_dot, residual, product, 0, "R T8");
    sk_write_scalar(writer, sk_solve_cg_start, 0, "rz");
    size_t repeat = sk_write_until(writer, (size_t)params->cg_iterations, SK_CELL_CG_DONE, "conjugate gradients");
    sk_write_solve(writer, &sk_solve_product, product, (sk_vector)SK_INERTIA, direction, "inertia T7");
    sk_write_apply(writer, product, direction, h * h, h);
    sk_write_solve(writer, &sk_solve_filter, product, SK_NONE, SK_NONE, "S T8");
    sk_write_dot(writer, &sk_solve_dot, direction, product, 0, "T7 T8");
    sk_write_scalar(writer, sk_solve_cg_alpha, 0, "alpha = rz / sum");
    sk_write_cell_sum(writer, change, change, 1, SK_CELL_ALPHA, direction, "T9 + alpha T7");
    sk_write_cell_sum(writer, residual, residual, -1, SK_CELL_ALPHA, product, "R - alpha T8");
    write_precondition(writer, params);
    sk_write_dot(writer, &sk_solve_dot, residual, product, 0, "R T8");
    sk_write_scalar(writer, sk_solve_cg_beta, cg_share * params->tolerance, "beta = sum / rz, rz = sum");
    sk_write_cell_sum(writer, direction, product, 1, SK_CELL_BETA, direction, "T8 + beta T7");
    sk_write_end(writer, repeat);
}

/* V = guess + share change, with the share at which the residual no longer points far back. */
static void write_line_search(sk_writer *writer, double h) {
    sk_vector change = (sk_vector)SK_CHANGE, guess = (sk_vector)SK_GUESS;
    size_t repeat = sk_write_until(writer, line_turns, SK_CELL_LINE_DONE, "line search");
    sk_write_cell_sum(writer, SK_V, guess, 1, SK_CELL_SHARE, change, "T10 + share T9");
    write_residual(writer, h);
    sk_write_dot(writer, &sk_solve_dot, (sk_vector)SK_RESIDUAL, change, 0, "R T9");
    sk_write_scalar(writer, sk_solve_line_judge, 0, "far enough? else a smaller share");
    sk_write_end(writer, repeat);
}

/* The first guess lies between standing still and going on as before: as far along as the residual allows. Where
 * things meet, going on would press springs through themselves, and the solve would end in such a state. */
static void write_first_guess(sk_writer *writer, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, change = (sk_vector)SK_CHANGE, guess = (sk_vector)SK_GUESS;
    sk_write_sum(writer, change, 1, SK_V0, 0, SK_NONE);
    sk_write_solve(writer, &sk_solve_filter, change, SK_NONE, SK_NONE, "S T9");
    sk_write_sum(writer, guess, 1, SK_V0, -1, change);
    sk_write_sum(writer, SK_V, 1, guess, 0, SK_NONE);
    write_residual(writer, h);
    sk_write_dot(writer, &sk_solve_norm, residual, SK_X, 0, "R w R");
    sk_write_scalar(writer, sk_solve_start, 0, "start = sum");
    sk_write_dot(writer, &sk_solve_dot, residual, change, 0, "R T9");
    sk_write_scalar(writer, sk_solve_line_start, 0, "slope = sum, share = 1");
    write_line_search(writer, h);
}

/* A turn: contact for the present guess, its residual, and if that is too much a better guess. */
static void write_newton(sk_writer *writer, const backward_euler_params *params, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL;
    size_t turns = sk_write_until(writer, (size_t)params->turns, SK_CELL_SOLVED, "Newton");
    sk_write_sum(writer, SK_X, 1, SK_X0, h, SK_V);
    sk_write_more_filters(writer);
    write_residual(writer, h);
    sk_write_dot(writer, &sk_solve_norm, residual, SK_X, 0, "R w R");
    sk_write_scalar(writer, sk_solve_judge, params->tolerance, "solved?");
    size_t once = sk_write_until(writer, 1, SK_CELL_SOLVED, "unless solved");
    write_linearise(writer, params, h);
    write_conjugate_gradients(writer, params, h);
    sk_write_sum(writer, (sk_vector)SK_GUESS, 1, SK_V, 0, SK_NONE);
    write_line_search(writer, h);
    sk_write_end(writer, once);
    sk_write_end(writer, turns);
    sk_write_dot(writer, &sk_solve_norm, residual, SK_X, 0, "R w R");
    sk_write_scalar(writer, sk_solve_end, params->tolerance, "account");
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
    write_first_guess(writer, h);
    write_newton(writer, params, h);
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
