/* Dihedral: the angle between the triangles p0 p1 p2 and p1 p0 p3 over their edge p0 p1, less that at rest, taken into
 * -pi to pi. Made of atan2, so it is exact near flat. As bending of a sheet of rigidity B (N m) an edge of length l
 * between triangles of areas A and A' has the stiffness B l^2/(A + A') (bodies/hinges.c). */
#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_ARITY 4
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/dihedral.h"
#define SK_WITH_STRIPS
#include "base/kernels.h"
#include "constraints/element.h"

#define SK_UNIT dihedral
SK_ELEMENT_KERNELS

#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "constraints/element_arithmetic.h"
#include "constraints/element_stiffness.h"
#include "constraints/element_sweeps.h"

#else

typedef struct dihedral_params {
    sk_material material;
} dihedral_params;

static const skein_field fields[] = {
    SK_REAL(dihedral_params, material.stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "torque a radian; \"infinite\" is rigid (position methods only)"),
    SK_REAL(dihedral_params, material.damping, "damping", "N m s", 0, 0, SK_FAR, "torque a radian a second"),
};

#include "constraints/element_scalar.h"

const sk_constraint_type sk_dihedral = {
    .kind = {"dihedral",
             "keeps the angle between two triangles over an edge: the edge's two ends, then the two corners beside it",
             SKEIN_CONSTRAINT, fields, sizeof fields / sizeof *fields, sizeof(dihedral_params)},
    SK_ELEMENT_RULES,
};
#endif
