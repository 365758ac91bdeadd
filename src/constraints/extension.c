/* Extension: length(p0 - p1) <= L, a distance that resists stretching and is slack when shorter. A cloth's diagonals
 * can be of this kind (bodies/cloth.c says when). Users have a formula for it, so it is not a kind for users. */
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
const struct sk_constraint_type sk_extension = {
    // (`struct` keeps it out of the build's list of kinds)
    .kind = {"extension", "", SKEIN_CONSTRAINT, NULL, 0, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .strain = strain,
};
#endif
