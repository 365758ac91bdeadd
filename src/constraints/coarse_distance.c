/* Coarse distance: a distance between particles that take others along (constraints/coarse.h). It shares its correction out by
 * the masses that go with them: the second and third rest values are the own mass over all that is carried, for each
 * end. It is a bound and nothing else, and no user's kind. */
#define SK_ARITY 2
#define SK_RESTS 3
#define SK_FORMULA "constraints/emitted/distance.h"
#define SK_WITH_STRIPS
#define SK_WITH_STRAIN
#define SK_WITH_LIMITS
#define SK_SHARES
#define SK_UNIT coarse_distance
#include "constraints/element_kind.h"

#ifndef SK_ISA
const struct sk_constraint_type sk_coarse_distance = { // (so written that it is not listed among the kinds)
    .kind = {"coarse distance", "", SKEIN_CONSTRAINT, NULL, 0, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .limit = SK_WALKS_OF(limit),
    .strain = strain,
};
#endif
