/* More of the plan builder: ops for an implicit solve (plan/solve.h says what the letters mean). */
#ifndef SK_METHODS_PLAN_BUILDER_SOLVE_H
#define SK_METHODS_PLAN_BUILDER_SOLVE_H

#include "methods/plan_builder.h"
#include "plan/matrix.h"
#include "plan/solve.h"

/* Opens a solve: `kernel` is the algorithm, which runs the parts that are opened next, each by its number. sk_write_end
 * closes both. */
size_t sk_write_solve(sk_plan_builder *builder, sk_op_kernel *kernel, const void *params, const char *label);
size_t sk_write_part(sk_plan_builder *builder, int part, const char *label);

/* Adds an op with a kernel of plan/solve.h; `label` describes it, and dst, p and q tell what it writes and reads. */
void sk_write_pass(sk_plan_builder *builder, const sk_kernels *kernels, sk_vector dst, sk_vector p, sk_vector q,
                   const char *label);

/* Finds pairs of surfaces that are near where the substep begins, which press each other apart in this solve; and F += the
 * forces by which they do. The matrix's functions below have their part of it. */
void sk_write_near(sk_plan_builder *builder);
void sk_write_pressing(sk_plan_builder *builder);

/* dst += (a k + b c) p over every batch, where k is the stiffness and c the damping of its elements at X. */
void sk_write_apply(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, double b);
/* The product of conjugate gradients: DIRECTION = PRODUCT + scale DIRECTION, PRODUCT = S A DIRECTION, and their dot
 * product; A is the inertia plus the matrix of sk_write_apply. */
void sk_write_multiply(sk_plan_builder *builder, double a, double b);
/* Add that matrix's diagonal blocks to two vectors: those of batches, and those of forces. */
void sk_write_diagonal(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
void sk_write_diagonal_of_forces(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
/* Assembles and factors the whole matrix; the two vectors hold the particles' own blocks. */
void sk_write_factor(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
/* dst = the inverse of that matrix times p, if there is a factor. */
void sk_write_factor_solve(sk_plan_builder *builder, sk_vector dst, sk_vector p);
/* dst += a times the drag of forces on particles, per unit of velocity. */
void sk_write_resistance(sk_plan_builder *builder, sk_vector dst, double a);
/* S, the friction force, and V as contact holds it, once F is known at the start of a substep. */
void sk_write_filters(sk_plan_builder *builder);
/* The same S and V for particles that the present guess moves into a collider. */
void sk_write_more_filters(sk_plan_builder *builder);

#endif
