/* Extension: length(p0 - p1) <= L, a distance that is kept from growing and is slack when shorter. A cloth's diagonals are
 * such (bodies/cloth.c says why); a user has a formula for it, so it is no user's kind. */
#define SK_ARITY 2
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/extension.h"
#define SK_WITH_STRIPS
#define SK_WITH_STRAIN
#define SK_ACROSS
#define SK_ONE_SIDED
#include "base/kernels.h"
#include "constraints/element.h"

#define SK_UNIT extension
SK_ELEMENT_KERNELS

#ifdef SK_ISA

#include "constraints/element_arithmetic.h"
#include "constraints/element_stiffness.h"
#include "constraints/element_sweeps.h"

#else

#include "constraints/element_scalar.h"

const struct sk_constraint_type sk_extension = { // (so written that it is not listed among the kinds)
    .kind = {"extension", "", SKEIN_CONSTRAINT, NULL, 0, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .strain = strain,
};
#endif
