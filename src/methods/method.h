/* Methods: how rules become motion. Each type is one file that writes its substep as ops of the plan;
 * no method touches a particle itself. */
#ifndef SK_METHODS_METHOD_H
#define SK_METHODS_METHOD_H

#include "base/fields.h"
#include "methods/plan_builder.h"

typedef struct sk_method_type {
    skein_kind kind;
    bool takes_rigid; /* constraints without a finite stiffness; a world with such is refused elsewhere */
    /* Whether the method can run the rules for any other reason; NULL: always. */
    skein_status (*check)(const void *params, const sk_rules *rules, skein_error *error);
    /* Writes the ops of one step of `dt` seconds. */
    void (*write)(sk_plan_builder *builder, const void *params, double dt);
    int (*substeps)(const void *params);
    /* One substep of the oscillator x'' = -x - 2 zeta x' as a matrix on (x, v), by rows; `z` is the substep
     * (of any oscillator: times its angular frequency). It says which substeps are stable. NULL: all are. */
    void (*amplify)(double z, double zeta, double matrix[4]);
    /* Fills in what of its parameters is no field; NULL: nothing. */
    void (*begin)(void *params, const struct sk_method_type *type);
} sk_method_type;

/* The parameters of a method that has nothing to choose but its substeps; others begin with the same. */
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

/* The one that a world begins with. */
extern const sk_method_type sk_xpbd;

#endif
