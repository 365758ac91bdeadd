/* Area: of the triangle p0 p1 p2, less that at rest. */
#define SK_ARITY 3
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/area.h"
#include "base/kernels.h"
#include "constraints/element.h"

#define SK_UNIT area
SK_ELEMENT_KERNELS

#ifdef SK_ISA

#include "constraints/element_arithmetic.h"
#include "constraints/element_stiffness.h"
#include "constraints/element_sweeps.h"

#else

typedef struct area_params {
    sk_material material;
} area_params;

static const skein_field fields[] = {
    SK_REAL(area_params, material.stiffness, "stiffness", "N/m3", 1e6, 0, SK_UNBOUNDED,
            "force over length and square metre of change; \"infinite\" is rigid (position methods only)"),
    SK_REAL(area_params, material.damping, "damping", "N s/m3", 0, 0, SK_FAR,
            "the same against the area's change in time"),
};

#include "constraints/element_scalar.h"

const sk_constraint_type sk_area = {
    .kind = {"area", "keeps the area of a triangle of particles", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(area_params)},
    SK_ELEMENT_RULES,
};
#endif
