/* The weights of a pair rule as formulas: a neighbour's weight along the direction to it, and along its direction of
 * flight, as functions of `relative_distance`, its distance over the reach.
 *
 * Owned by the rule's parameters, made anew when their texts change. */
#ifndef SK_FORCES_PAIR_FORMULA_H
#define SK_FORCES_PAIR_FORMULA_H

#include <skein/formula.h>

#include "base/memory.h"
#include "formula/tape.h"

enum { SK_TOWARDS, SK_ALONG, SK_PAIR_WEIGHTS };

typedef struct sk_pair_formula {
    skein_formula *formula[SK_PAIR_WEIGHTS]; /* NULL: that weight is 0 */
    sk_tape tape[SK_PAIR_WEIGHTS];
    uint16_t relative_distance[SK_PAIR_WEIGHTS]; /* the register for relative_distance; UINT16_MAX: it is not used */
} sk_pair_formula;

/* Makes them from their texts; *made is NULL if both are empty. On failure the error names the field. */
skein_status sk_pair_formula_create(sk_pair_formula **made, const char *const texts[SK_PAIR_WEIGHTS],
                                    const char *const fields[SK_PAIR_WEIGHTS], sk_allocator *allocator,
                                    skein_error *error);
/* Writes float towards@(float relative_distance, float t) and along@(...) in GLSL; false when there is no memory. */
bool sk_pair_formula_put_glsl(const sk_pair_formula *pair, void (*put)(void *user, const char *text), void *user);
void sk_pair_formula_release(sk_pair_formula *pair, sk_allocator *allocator); /* NULL is allowed */

#endif
