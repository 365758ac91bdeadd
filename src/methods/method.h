/* Methods: time integration. Each type is one file that writes its substep as ops of the plan; no method touches
 * particles itself. */
#ifndef SK_METHODS_METHOD_H
#define SK_METHODS_METHOD_H

#include "base/fields.h"
#include "methods/plan_builder.h"

typedef struct sk_method_type {
    skein_kind kind;
    bool takes_rigid; /* it runs constraints of infinite stiffness; without it, a world that has any is refused */
    /* What a substep leaves uncorrected grows with the square of its length, and one of a fifth puts it right at once and has the velocity of
     * that: a step that is shorter than the one before has fewer substeps (world/step.c). Its parameters begin with sk_substeps. */
    bool shortens_slowly;
    /* Refuses rules that the method cannot run for another reason; NULL: there is none. */
    skein_status (*check)(const void *params, const sk_rules *rules, skein_error *error);
    /* Writes the ops of one step of `dt` seconds. */
    void (*write)(sk_plan_builder *builder, const void *params, double dt);
    int (*substeps)(const void *params);
    /* One substep of the oscillator x'' = -x - 2 zeta x' as a matrix on (x, v), by rows; `z` is the substep (times the
     * angular frequency, for other oscillators). It tells which substeps are stable. NULL: all are. */
    void (*amplify)(double z, double zeta, double matrix[4]);
    /* Fills in those of its parameters that are not fields; NULL: there are none. */
    void (*begin)(void *params, const struct sk_method_type *type);
} sk_method_type;

/* The parameters of a method that has no choice but its substeps; those of others begin with the same. */
typedef struct sk_substeps {
    int32_t substeps;
} sk_substeps;

#define SK_SUBSTEPS_FIELD(initial) \
    SK_INT(sk_substeps, substeps, "substeps", "", initial, 1, 100000, "equal parts that a step is cut into")

int sk_substeps_of(const void *params);

/* Whether a method with these parameters can run the rules. */
skein_status sk_method_check(const sk_method_type *method, const void *params, const sk_rules *rules,
                             skein_error *error);

/* The matrix 1 + c1 zA + c2 (zA)^2 + c3 (zA)^3 + c4 (zA)^4 of a Runge-Kutta method, A being the oscillator's. */
void sk_amplify_polynomial(double z, double zeta, const double c[4], double matrix[4]);

/* The default method of a world. */
extern const sk_method_type sk_xpbd;

#endif
