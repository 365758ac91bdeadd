/* Coarse distance: a distance between particles that carry others along (constraints/coarse.h). It divides its
 * correction by the masses that are carried: the second and third rest values are, for each end, its own mass over all
 * that it carries. It is only used as a bound, and is not a kind for users. */
#define SK_ARITY 2
#define SK_RESTS 3
#define SK_FORMULA "constraints/emitted/distance.h"
#define SK_WITH_STRIPS
#define SK_WITH_STRAIN
#define SK_WITH_LIMITS
#define SK_ONLY_BOUNDS
#define SK_SHARES
#define SK_UNIT coarse_distance
#include "constraints/element_kind.h"

#ifndef SK_ISA
const struct sk_constraint_type sk_coarse_distance = {
    // (`struct` keeps it out of the build's list of kinds)
    .kind = {"coarse distance", "", SKEIN_CONSTRAINT, NULL, 0, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .limit = SK_WALKS_OF(limit),
    .strain = strain,
};
#endif
