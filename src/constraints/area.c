/* Area: C = the area of the triangle p0 p1 p2, minus that at rest. */
#define SK_ARITY 3
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/area.h"
#define SK_UNIT area
#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N/m3", 1e6, 0, SK_UNBOUNDED,
            "force over length and square metre of change; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N s/m3", 0, 0, SK_FAR, "the same against the area's change in time"),
};

const sk_constraint_type sk_area = {
    .kind = {"area", "keeps the area of a triangle of particles", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
