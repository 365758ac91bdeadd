/* Angle: at p1, between the ways to p0 and to p2, less that at rest. */
#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_ARITY 3
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/angle.h"
#include "base/kernels.h"
#include "constraints/element.h"

#define SK_UNIT angle
SK_ELEMENT_KERNELS

#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "constraints/element_arithmetic.h"
#include "constraints/element_stiffness.h"
#include "constraints/element_sweeps.h"

#else

typedef struct angle_params {
    sk_material material;
} angle_params;

static const skein_field fields[] = {
    SK_REAL(angle_params, material.stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "torque a radian; \"infinite\" is rigid (position methods only)"),
    SK_REAL(angle_params, material.damping, "damping", "N m s", 0, 0, SK_FAR, "torque a radian a second"),
};

#include "constraints/element_scalar.h"

const sk_constraint_type sk_angle = {
    .kind = {"angle", "keeps the angle at the second of three particles", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(angle_params)},
    SK_ELEMENT_RULES,
};
#endif
