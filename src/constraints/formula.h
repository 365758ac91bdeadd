/* What the two kinds whose formula is a text share: `formula` (C of up to eight particles) and `energy` (E). */
#ifndef SK_CONSTRAINTS_FORMULA_H
#define SK_CONSTRAINTS_FORMULA_H

#include "constraints/sweep.h"
#include "formula/formula.h"
#include "formula/tape.h"
#include "plan/matrix.h"

/* Groups that run through a tape together at the most. Eight would share its dispatch better, but few sweeps have eight
 * in a row that share no particle: of a sheet's 5.6 are found, and 3.5 of four. */
enum { SK_FORMULA_GROUPS = 4 };

/* A formula on its way through the walks; made when its object is, and again when the text changes. */
typedef struct sk_constraint_formula {
    skein_formula *formula;
    sk_tape tape;    /* the value, its gradient by particle and axis, and its derivative by t */
    sk_tape single;  /* the same in blocks of sixteen elements; its arrays are the other's */
    sk_tape hessian; /* of an energy: the lower triangle of its second derivatives, row by row, for sixteen elements */
    bool is_energy, one_sided;
    const skein_compiled *compiled;                      /* runs in place of the tapes; NULL: nothing does */
    uint8_t parameter_of[SKEIN_FORMULA_MOST_PARAMETERS]; /* what its parameters are here */
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
