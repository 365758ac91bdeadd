/* What the two kinds by formula share: `formula` (a constraint C of up to eight particles) and `energy` (E). */
#ifndef SK_CONSTRAINTS_FORMULA_H
#define SK_CONSTRAINTS_FORMULA_H

#include "constraints/sweep.h"
#include "formula/formula.h"
#include "formula/tape.h"
#include "plan/matrix.h"

/* The most groups that run through a tape together. Eight would amortise its dispatch better, but few sweeps have eight
 * in a row that share no particle: in a sheet's the mean is 5.6 of eight, and 3.5 of four. */
enum { SK_FORMULA_GROUPS = 4 };

/* A compiled formula; made with its object, and again when the text changes. */
typedef struct sk_constraint_formula {
    skein_formula *formula;
    sk_tape tape;    /* the value, its gradient by particle and axis, and its derivative by t */
    sk_tape single;  /* the same in blocks of sixteen elements; it shares the arrays of `tape` */
    sk_tape hessian; /* of an energy: the lower triangle of its second derivatives, row by row, for sixteen elements */
    bool is_energy, one_sided;
    const skein_compiled *compiled;                      /* runs in place of the tapes; NULL: the tapes run */
    uint8_t parameter_of[SKEIN_FORMULA_MOST_PARAMETERS]; /* the formula's parameter for each of the compiled code's */
} sk_constraint_formula;

typedef struct sk_formula_params {
    sk_material material;
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    char *text;
    sk_constraint_formula *made;
} sk_formula_params;

/* As in sk_constraint_type; for `formula` and for `energy`. */
extern const sk_making sk_formula_making, sk_energy_making;
int sk_formula_arity_of(const void *params);
int sk_formula_rest_count_of(const void *params);
bool sk_formula_rest(const void *params, const double (*x)[3], double *rest);
bool sk_formula_evaluate_one(const sk_batch *batch, double time, const sk_vec4 *x, size_t element, size_t most,
                             sk_constraint_answer *answer, double (*gradient)[3]);

#endif
