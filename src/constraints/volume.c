/* Volume: C = the volume of the tetrahedron p0 p1 p2 p3, minus that at rest. The volume is positive if p3 lies on the
 * side that cross(p1 - p0, p2 - p0) points to, so that an inverted tetrahedron turns back. */
#define SK_ARITY 4
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/volume.h"
#define SK_UNIT volume
#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "Pa/m3", 1e9, 0, SK_UNBOUNDED,
            "pressure a cubic metre of change; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "Pa s/m3", 0, 0, SK_FAR, "the same against the volume's change in time"),
};

const sk_constraint_type sk_volume = {
    .kind = {"volume", "keeps the volume of a tetrahedron of particles", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
