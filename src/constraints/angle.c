/* Angle: C = the angle at p1 between the directions to p0 and p2, minus that at rest. */
#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_ARITY 3
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/angle.h"
#define SK_UNIT angle
#include "constraints/element.h"
#ifdef SK_ISA
#include "base/wide_elementary.h"
#endif
#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "torque a radian; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N m s", 0, 0, SK_FAR, "torque a radian a second"),
};

const sk_constraint_type sk_angle = {
    .kind = {"angle", "keeps the angle at the second of three particles", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
