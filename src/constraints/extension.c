/* Extension: length(p0 - p1) <= L, a distance that is kept from growing and is slack when shorter. A cloth's diagonals can
 * be such (bodies/cloth.c says when); a user has a formula for it, so it is no user's kind. */
#define SK_ARITY 2
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/extension.h"
#define SK_WITH_STRIPS
#define SK_WITH_STRAIN
#define SK_ACROSS
#define SK_ONE_SIDED
#define SK_UNIT extension
#include "constraints/element_kind.h"

#ifndef SK_ISA
const struct sk_constraint_type sk_extension = { // (so written that it is not listed among the kinds)
    .kind = {"extension", "", SKEIN_CONSTRAINT, NULL, 0, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .strain = strain,
};
#endif
