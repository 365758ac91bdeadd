/* Backward Euler: forces are evaluated at the end of the substep,
 *
 *   m (v - v0) = h F(x0 + h v, v),     x = x0 + h v.
 *
 * First order, and stable at any stiffness and substep; motion too fast for the substep is damped out. Solved by
 * Newton's method; each iteration solves (m + h c + h^2 k) dv = R by conjugate gradients (Baraff, Witkin 1998, with
 * the spring's blocks kept positive definite as in Choi, Ko 2002), preconditioned by the matrix's 3 x 3 blocks or by a
 * sparse factor of it. Contact is a filter inside that solve.
 *
 * This file writes the parts of the solve: the residual, the product with the matrix and so on (plan/solve.h has the
 * vectors). The algorithm that runs them, Newton's method with conjugate gradients, stands in plan/newton.c. */
#include "base/status.h"
#include "methods/method.h"
#include "methods/plan_builder_solve.h"
#include "plan/newton.h"

typedef struct backward_euler_params {
    int32_t substeps, preconditioner;
    sk_newton newton;
} backward_euler_params;

static const skein_field fields[] = {
    SK_INT(backward_euler_params, substeps, "substeps", "", 2, 1, 100000, "equal parts that a step is cut into"),
    SK_REAL(backward_euler_params, newton.tolerance, "tolerance", "", 1e-5, 1e-12, 0.1,
            "a substep is solved when its residual is so small a share of its start, or all rounding"),
    SK_INT(backward_euler_params, newton.iterations, "newton_iterations", "", 20, 1, 1000,
           "of Newton's method in a substep, at most"),
    SK_INT(backward_euler_params, newton.cg_iterations, "cg_iterations", "", 400, 1, 100000,
           "of conjugate gradients in one of those, at most"),
    SK_CHOICE(backward_euler_params, preconditioner, "preconditioner", 0, "blocks|cholesky",
              "what shortens conjugate gradients: each particle's own block, or a sparse factor of the whole matrix"),
};
enum { BLOCKS, CHOLESKY };

static skein_status check(const void *params, const sk_rules *rules, skein_error *error) {
    const backward_euler_params *given = params;
    if (given->preconditioner == CHOLESKY && !rules->sparse_solver)
        return sk_fail(error, SKEIN_ERROR_VALUE, "method.preconditioner",
                       "cholesky needs a sparse solver, and this world has none: 'tools/setup build' installs CHOLMOD, "
                       "then build again (programs: skein_cholmod_attach()); or take blocks");
    return SKEIN_OK;
}

/* R = S (h F + h friction - m (V - V0)), at X = X0 + h V. */
static void write_residual(sk_plan_builder *builder, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL;
    sk_write_sum(builder, SK_X, 1, SK_X0, h, SK_V);
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_pressing(builder);
    sk_write_pass(builder, &sk_solve_imbalance, residual, SK_F, (sk_vector)SK_FRICTION,
                  "S (h F + h T5 + m (V0 - V)); sum R T9");
    sk_write_pass(builder, &sk_solve_norm, (sk_vector)SK_SUMS, residual, SK_X, "R w R");
}

/* Factors the matrix at X and V. (The factor of an earlier iteration is no substitute: with springs that have gone
 * slack or taut since, conjugate gradients took as many iterations as with the blocks.) */
static void write_factor(sk_plan_builder *builder, double h) {
    sk_vector block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_sum(builder, block, 1, (sk_vector)SK_INERTIA, 0, SK_NONE);
    sk_write_clear(builder, off);
    sk_write_diagonal_of_forces(builder, block, off, h * h, h);
    sk_write_factor(builder, block, off, h * h, h);
}

/* The matrix's diagonal blocks at X and V, and their factors; CHANGE = 0 and GUESS = V. */
static void write_linearise(sk_plan_builder *builder, const backward_euler_params *params, double h) {
    sk_vector inertia = (sk_vector)SK_INERTIA, block = (sk_vector)SK_BLOCK0, off = (sk_vector)SK_BLOCK1;
    sk_write_pass(builder, &sk_solve_mass, inertia, SK_V, SK_NONE, "m");
    sk_write_resistance(builder, inertia, h);
    if (params->preconditioner == CHOLESKY) write_factor(builder, h);
    sk_write_sum(builder, block, 1, inertia, 0, SK_NONE);
    sk_write_clear(builder, off);
    sk_write_diagonal(builder, block, off, h * h, h);
    sk_write_diagonal_of_forces(builder, block, off, h * h, h);
    sk_write_pass(builder, &sk_solve_factor, block, off, inertia, "L D L^T of the blocks; sum of rounding");
    sk_write_clear(builder, (sk_vector)SK_CHANGE);
    sk_write_sum(builder, (sk_vector)SK_GUESS, 1, SK_V, 0, SK_NONE);
}

/* T8 = the preconditioner times R, about A^-1 R. */
static void write_precondition(sk_plan_builder *builder, const backward_euler_params *params) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, product = (sk_vector)SK_PRODUCT;
    if (params->preconditioner == CHOLESKY) sk_write_factor_solve(builder, product, residual);
    sk_write_pass(builder, &sk_solve_precondition, product, residual, SK_NONE, "S A~^-1 R; sum R T8");
}

static void write_solve(sk_plan_builder *builder, const backward_euler_params *params, double h) {
    sk_vector residual = (sk_vector)SK_RESIDUAL, change = (sk_vector)SK_CHANGE, guess = (sk_vector)SK_GUESS;
    size_t solve = sk_write_solve(builder, sk_newton_solve, &params->newton, "V, X by Newton's method");
    size_t part = sk_write_part(builder, SK_NEWTON_GUESS, "first guess");
    sk_write_pass(builder, &sk_solve_guess, SK_V, change, guess, "T10 = V0 - T9; T9 = S V0");
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_ALONG, "along the change");
    sk_write_pass(builder, &sk_solve_along, SK_V, guess, change, "T10 + share T9");
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_HOLD, "contact at the guess");
    sk_write_sum(builder, SK_X, 1, SK_X0, h, SK_V);
    sk_write_more_filters(builder);
    sk_write_end(builder, part);
    if (sk_writes_meetings(builder)) {
        part = sk_write_part(builder, SK_NEWTON_MEET, "surfaces at the guess");
        sk_write_meetings(builder, SK_MEETING_HOLD, SK_V);
        sk_write_end(builder, part);
    }
    part = sk_write_part(builder, SK_NEWTON_RESIDUAL, "residual R");
    write_residual(builder, h);
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_LINEARISE, "matrix A");
    write_linearise(builder, params, h);
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_PRECONDITION, "first direction");
    write_precondition(builder, params);
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_MULTIPLY, "conjugate gradients: product");
    sk_write_multiply(builder, h * h, h);
    sk_write_end(builder, part);
    part = sk_write_part(builder, SK_NEWTON_STEP, "conjugate gradients: step");
    sk_write_pass(builder, &sk_solve_step, change, residual, SK_NONE, "T9 + alpha T7; R - alpha T8");
    write_precondition(builder, params);
    sk_write_end(builder, part);
    sk_write_end(builder, solve);
}

static void write(sk_plan_builder *builder, const void *data, double dt) {
    const backward_euler_params *params = data;
    double h = dt / params->substeps;
    size_t repeat = sk_write_repeat(builder, (size_t)params->substeps, h);
    sk_write_steering(builder);
    sk_write_near(builder);
    sk_write_fields(builder);
    sk_write_forces(builder);
    sk_write_pressing(builder);
    sk_write_filters(builder);
    sk_write_save(builder);
    sk_write_stage_time(builder, 1);
    write_solve(builder, params, h);
    sk_write_bounds(builder);
    sk_write_impulses(builder);
    sk_write_end(builder, repeat);
}

const sk_method_type sk_backward_euler = {
    .kind = {"backward_euler", "implicit: solves for the velocity whose forces lead to it; stable at any stiffness",
             SKEIN_METHOD, fields, sizeof fields / sizeof *fields, sizeof(backward_euler_params)},
    .check = check,
    .write = write,
    .substeps = sk_substeps_of,
};
