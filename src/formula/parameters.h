/* Parameters of formulas, for objects (colliders, forces, constraints) whose kind has texts that are formulas.
 *
 * Names in a formula other than particles and time are its object's parameters, which no table can list beforehand. A
 * kind that takes them has the row "parameters.*" (SK_PARAMETERS in base/fields.h), and each of its objects has a kind
 * of its own: the same table, with a row for every setting "parameters.NAME" that it was made with. So setting,
 * reading, paths, scenes, checks and messages treat parameters like all other fields. The world makes this kind with
 * the object; the types' files read it when they compile their texts. */
#ifndef SK_FORMULA_PARAMETERS_H
#define SK_FORMULA_PARAMETERS_H

#include <skein/formula.h>

#include "base/memory.h"

/* The functions of a type whose objects keep something made from their parameters, such as a formula's tape. */
typedef struct sk_making {
    /* Makes it, when the object is added and whenever a text has changed; `kind` is the object's own. On failure
     * what was there before stays. */
    skein_status (*make)(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error);
    void (*unmake)(void *params, sk_allocator *allocator); /* also where nothing was made */
    /* Of a type whose formula can be compiled, else NULL: the formula; and lets compiled code run for it, or (NULL) its
     * tape. */
    const skein_formula *(*formula_of)(const void *params);
    void (*run_compiled)(void *params, const skein_compiled *compiled);
    const double *(*parameters_of)(const void *params); /* the numbers that the formula names, where there is one */
    bool by_text; /* what it does is in its texts: whether it changes as time goes by can be read there */
} sk_making;

/* Whether objects of the kind name parameters. */
bool sk_takes_parameters(const skein_kind *kind);
/* An object's own kind, from the settings that it is made with; release it with sk_release(). */
skein_status sk_own_kind_create(sk_allocator *allocator, const skein_kind *kind, const skein_setting *settings,
                                skein_kind **own, skein_error *error);
/* The parameters' names in an object's own kind, ended by NULL; returns how many. Number i is stored at the place of
 * SK_PARAMETERS, as its i-th double. */
int sk_parameter_names(const skein_kind *own, const char *names[static SKEIN_FORMULA_MOST_PARAMETERS + 1]);

/* The formula of a text field. `desc` says what may stand in it; its text and its parameters are filled in here. The
 * error is at `field`, and says line, column and, in two more lines, the place in the text. A parameter that no field
 * of the object needs is for sk_formula_check_used() to find. NULL on failure. */
skein_formula *sk_formula_of_field(const char *field, const char *text, skein_formula_desc desc, const skein_kind *own,
                                   sk_allocator *allocator, skein_error *error);
/* Fails for a parameter that none of the formulas names. */
skein_status sk_formula_check_used(const skein_kind *own, const skein_formula *const *formulas, size_t count,
                                   skein_error *error);

#endif
