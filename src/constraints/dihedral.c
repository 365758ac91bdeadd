/* Dihedral: the angle between the triangles p0 p1 p2 and p1 p0 p3 over their edge p0 p1, minus that at rest, wrapped to
 * -pi to pi. Computed by atan2, so it is accurate near flat. As bending of a sheet of rigidity B (N m) an edge of
 * length l between triangles of areas A and A' has the stiffness B l^2/(A + A') (bodies/hinges.c).
 * A projection turns by half a radian at most. Where a fine mesh crumples its angles are large and as good as rigid, and a
 * scanned man of 17,495 vertices, 2 mm apart and pinned by his head, flew apart (99th percentile of stretch 1,084 %; 24 without
 * bending; at most 2 radians 824, 1 32, 0.5 27, 0.1 27). What is soft, or near its rest, turns by less than that. */
#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_ARITY 4
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/dihedral.h"
#define SK_WITH_STRIPS
#define SK_MOST_CHANGE 0.5
#define SK_UNIT dihedral
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

const sk_constraint_type sk_dihedral = {
    .kind = {"dihedral",
             "keeps the angle between two triangles over an edge: the edge's two ends, then the two corners beside it",
             SKEIN_CONSTRAINT, fields, sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
