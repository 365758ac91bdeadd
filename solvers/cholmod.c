/* Between skein_sparse_solver and CHOLMOD.
 *
 * A pattern is ordered and analysed once; then each factorisation overwrites the last, and each solve goes through the
 * same scratch vectors, so that steps ask for no memory but where a simplicial factor moves its columns. CHOLMOD
 * chooses by the fill whether it works on single columns or, through the BLAS, on supernodes. */
#include "solvers/cholmod.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

typedef struct solver {
    cholmod_common common;
    cholmod_factor *factor;   /* of the pattern that was analysed; NULL before */
    cholmod_dense *x, *y, *e; /* a solution, and scratch */
} solver;

bool skein_cholmod_is_here(void) {
    return true;
}

static skein_status fail(skein_error *error, skein_status status, const char *message) {
    if (error) {
        *error = (skein_error){status, "", ""};
        snprintf(error->message, sizeof error->message, "CHOLMOD: %s", message);
    }
    return status;
}

/* The matrix as CHOLMOD sees it; nothing is copied, and CHOLMOD only reads it. */
static cholmod_sparse sparse_of(const skein_sparse_matrix *matrix) {
    return (cholmod_sparse){
        .nrow = matrix->size,
        .ncol = matrix->size,
        .nzmax = (size_t)matrix->start[matrix->size],
        .p = (void *)(uintptr_t)matrix->start,
        .i = (void *)(uintptr_t)matrix->row,
        .x = (void *)(uintptr_t)matrix->value,
        .stype = -1, // the lower triangle
        .itype = CHOLMOD_LONG,
        .xtype = matrix->value ? CHOLMOD_REAL : CHOLMOD_PATTERN,
        .dtype = CHOLMOD_DOUBLE,
        .sorted = true,
        .packed = true,
    };
}

static void forget(solver *s) {
    cholmod_l_free_factor(&s->factor, &s->common);
    cholmod_l_free_dense(&s->x, &s->common);
    cholmod_l_free_dense(&s->y, &s->common);
    cholmod_l_free_dense(&s->e, &s->common);
}

static skein_status analyse(void *user, const skein_sparse_matrix *pattern, skein_error *error) {
    solver *s = user;
    cholmod_sparse a = sparse_of(pattern);
    forget(s);
    s->factor = cholmod_l_analyze(&a, &s->common);
    if (s->factor) return SKEIN_OK;
    if (s->common.status == CHOLMOD_OUT_OF_MEMORY) return fail(error, SKEIN_ERROR_MEMORY, "no memory for a factor");
    return fail(error, SKEIN_ERROR_LIMIT, "the matrix is too large for it");
}

static bool factor(void *user, const skein_sparse_matrix *matrix) {
    solver *s = user;
    cholmod_sparse a = sparse_of(matrix);
    return cholmod_l_factorize(&a, s->factor, &s->common) && s->common.status == CHOLMOD_OK;
}

static bool solve(void *user, const double *b, double *x) {
    solver *s = user;
    cholmod_dense given = {.nrow = s->factor->n,
                           .ncol = 1,
                           .nzmax = s->factor->n,
                           .d = s->factor->n,
                           .x = (void *)(uintptr_t)b,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
    if (!cholmod_l_solve2(CHOLMOD_A, s->factor, &given, NULL, &s->x, NULL, &s->y, &s->e, &s->common)) return false;
    memcpy(x, s->x->x, s->factor->n * sizeof *x);
    return true;
}

static void release(void *user) {
    solver *s = user;
    forget(s);
    cholmod_l_finish(&s->common);
    free(s);
}

skein_status skein_cholmod_attach(skein_world *world, skein_error *error) {
    if (!world) return fail(error, SKEIN_ERROR_VALUE, "world is NULL");
    solver *s = calloc(1, sizeof *s);
    if (!s) return fail(error, SKEIN_ERROR_MEMORY, "no memory");
    cholmod_l_start(&s->common);
    s->common.print = 0;       // what fails is said through the world
    s->common.final_ll = true; // L L^T: a pivot that is not positive fails, where L D L^T would go on
    s->common.quick_return_if_not_posdef = true;
    skein_sparse_solver own = {"CHOLMOD", s, analyse, factor, solve, release};
    skein_status status = skein_sparse_solver_set(world, &own);
    if (!status) return SKEIN_OK;
    release(s);
    if (error) *error = *skein_world_error(world);
    return status;
}
