/* More of the plan builder: what rules bring to an implicit solve (plan/solve.h says what the letters mean). */
#ifndef SK_METHODS_PLAN_BUILDER_SOLVE_H
#define SK_METHODS_PLAN_BUILDER_SOLVE_H

#include "methods/plan_builder.h"
#include "plan/matrix.h"
#include "plan/solve.h"

/* Opens a solve: `kernel` is the algorithm, and has the parts run that are opened next, each by its number.
 * sk_write_end closes both. */
size_t sk_write_solve(sk_plan_builder *builder, sk_op_kernel *kernel, const void *params, const char *label);
size_t sk_write_part(sk_plan_builder *builder, int part, const char *label);

/* An op of plan/solve.h, as `label` says it; dst and p, q only name what it makes and reads. */
void sk_write_pass(sk_plan_builder *builder, const sk_kernels *kernels, sk_vector dst, sk_vector p, sk_vector q,
                   const char *label);

/* dst += (a k + b c) p, over every batch: k stiffness and c damping of its springs as they lie at X. */
void sk_write_apply(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, double b);
/* The product of conjugate gradients: DIRECTION = PRODUCT + scale DIRECTION, PRODUCT = S A DIRECTION, and the sum of
 * both with each other; A is the inertia and what sk_write_apply says. */
void sk_write_multiply(sk_plan_builder *builder, double a, double b);
/* The same matrix's diagonal blocks, added to two vectors: those of batches, and those of forces. */
void sk_write_diagonal(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
void sk_write_diagonal_of_forces(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
/* The whole of it, and its factor: what particles have by themselves lies in the two vectors. */
void sk_write_factor(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b);
/* dst = the matrix^-1 p, where there is a factor. */
void sk_write_factor_solve(sk_plan_builder *builder, sk_vector dst, sk_vector p);
/* dst += a times what the fields' forces lose with velocity. */
void sk_write_resistance(sk_plan_builder *builder, sk_vector dst, double a);
/* S, friction, and V as contact holds it: after F is known at the start of a substep. */
void sk_write_filters(sk_plan_builder *builder);
/* S and V for what the present guess has brought inside a collider. */
void sk_write_more_filters(sk_plan_builder *builder);

#endif
