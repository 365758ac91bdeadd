/* The assembled matrix of an implicit solve, for a solver from outside the library (skein_sparse_solver). Conjugate
 * gradients alone only need its product with a vector.
 *
 *   A = m + h c + h^2 k    a block row of three rows for each particle, in the user's order
 *
 * Its pattern is made with the slots (sk_matrix_shape): a 3 x 3 block for each particle, and one for each pair that
 * shares an element. Each iteration of Newton's method fills it: the particles' own blocks, then those of every batch.
 * The values are double: an element's forces on its ends must cancel to more digits than float has, or rounding would
 * act on a stiff sheet like a weight. Then S A S + (1 - S), which is definite also where contact holds particles, goes
 * to the solver.
 *
 *   columns of one particle, as they lie in `value`; a to f are its diagonal block, dots the n blocks below it:
 *
 *     a b c . . .    first column: 3 + 3 n entries
 *       d e . . .    second: 2 + 3 n
 *         f . . .    third: 1 + 3 n
 *
 * A solver's failure is counted, and the solve goes on with the diagonal blocks. Owned by the world. */
#ifndef SK_PLAN_MATRIX_H
#define SK_PLAN_MATRIX_H

#include "plan/op.h"

typedef struct sk_matrix {
    skein_sparse_solver solver; /* `solve` is NULL where there is none */
    bool shaped;                /* the pattern is that of the present slots and this solver */
    size_t particles;
    size_t *first;   /* where each particle's blocks below the diagonal begin in `below`; particles + 1 */
    uint32_t *below; /* the particles of those blocks' rows, ascending */
    int64_t *start, *row;
    double *value;
    double *given, *found; /* 3 x particles: a right side and its solution */
} sk_matrix;

/* Elements of `arity` particles. `pair` (arity (arity - 1)/2 for each element) receives where the block of its
 * particles p > q lies, at p (p - 1)/2 + q. */
typedef struct sk_matrix_part {
    const uint32_t *particle;
    size_t count, arity;
    uint32_t *pair;
} sk_matrix_part;

/* Makes the pattern. False without memory, or if 32 bits cannot count the blocks: there is no pattern then. */
bool sk_matrix_shape(sk_matrix *matrix, sk_allocator *allocator, size_t particles, const sk_matrix_part *parts,
                     size_t part_count);
/* Releases the pattern and keeps the solver. */
void sk_matrix_release(sk_matrix *matrix, sk_allocator *allocator);
skein_sparse_matrix sk_matrix_view(const sk_matrix *matrix, bool with_values);

/* Kernels of ops of kind SK_OP_CALL. `source` and dst are state vectors.
 *   clear   A = the particles' blocks alone: xx yy zz from source[0], xy xz yz from source[1]
 *   factor  gives S A S + (1 - S) to the solver; the solve's `factored` then says whether there is a factor
 *   solve   dst = (S A S + (1 - S))^-1 source[0], if there is a factor */
extern sk_op_kernel sk_matrix_clear, sk_matrix_factor, sk_matrix_solve;

/* ---- for the kernels of constraints ---- */

/* Where a particle's columns begin. */
static inline double *sk_matrix_column(const sk_matrix *matrix, size_t particle, size_t *blocks) {
    *blocks = matrix->first[particle + 1] - matrix->first[particle];
    return matrix->value + 6 * particle + 9 * matrix->first[particle];
}

/* Adds a symmetric block; only its lower triangle is read. */
static inline void sk_matrix_add_diagonal(sk_matrix *matrix, uint32_t particle, double block[3][3]) {
    size_t n;
    double *at = sk_matrix_column(matrix, particle, &n);
    at[0] += block[0][0], at[1] += block[1][0], at[2] += block[2][0];
    at += 3 + 3 * n;
    at[0] += block[1][1], at[1] += block[2][1];
    at[2 + 3 * n] += block[2][2];
}

/* Adds a block whose rows belong to particle a and whose columns to particle b. */
static inline void sk_matrix_add_pair(sk_matrix *matrix, uint32_t a, uint32_t b, uint32_t pair, double block[3][3]) {
    size_t n, column = a < b ? a : b;
    double *at = sk_matrix_column(matrix, column, &n) + 3 * (pair - matrix->first[column]);
    for (size_t c = 0; c < 3; c++, at += 3 * n)
        for (size_t r = 0; r < 3; r++) {
            if (r == 0) at += 3 - c; // skips this column's part of the diagonal block
            at[r] += a < b ? block[c][r] : block[r][c];
        }
}

/* Adds an element's push g g^T, and `across` to the diagonals of its blocks (for two particles, minus `across` to that
 * of the block between them). */
static inline void sk_matrix_add_square(sk_matrix *matrix, size_t arity, const uint32_t *particle, const uint32_t *pair,
                                        double (*g)[3], double push, double across) {
    for (size_t p = 0; p < arity; p++)
        for (size_t q = 0; q <= p; q++) {
            double block[3][3];
            for (size_t r = 0; r < 3; r++)
                for (size_t c = 0; c < 3; c++)
                    block[r][c] = push * g[p][r] * g[q][c] + (r != c ? 0 : p == q ? across : -across);
            if (p == q) sk_matrix_add_diagonal(matrix, particle[p], block);
            else sk_matrix_add_pair(matrix, particle[p], particle[q], pair[p * (p - 1) / 2 + q], block);
        }
}

#endif
