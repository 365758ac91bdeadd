/* The weights of a pair rule as formulas: what a neighbour counts along the direction to it, and along its direction of
 * flight, as functions of `percent`, how far it is in shares of the reach.
 *
 * Owned by the world, a state beside the rule's parameters; made anew when their texts change. */
#ifndef SK_FORCES_PAIR_FORMULA_H
#define SK_FORCES_PAIR_FORMULA_H

#include <skein/formula.h>

#include "base/memory.h"
#include "formula/tape.h"

enum { SK_TOWARDS, SK_ALONG, SK_PAIR_WEIGHTS };

typedef struct sk_pair_formula {
    char *text[SK_PAIR_WEIGHTS]; /* "": that weight is 0 */
    skein_formula *formula[SK_PAIR_WEIGHTS];
    sk_tape tape[SK_PAIR_WEIGHTS];
    uint16_t percent[SK_PAIR_WEIGHTS]; /* the register that percent goes to; UINT16_MAX: it is not asked for */
} sk_pair_formula;

/* Makes *state fit the texts: NULL where both are empty. On failure *state is NULL, and the error says which field. */
skein_status sk_pair_formula_prepare(sk_pair_formula **state, const char *const texts[SK_PAIR_WEIGHTS],
                                     const char *const fields[SK_PAIR_WEIGHTS], sk_allocator *allocator,
                                     skein_error *error);
void sk_pair_formula_release(sk_pair_formula *state, sk_allocator *allocator); /* NULL is allowed */

#endif
