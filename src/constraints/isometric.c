/* Isometric bending (Bergou and others 2006): the length of the mean curvature vector at the edge p0 p1, which is
 * linear in the positions as long as the triangles p0 p1 p2 and p1 p0 p3 keep their shape. Its stiffness is the sheet's
 * bending rigidity. Its rest state is flat, whatever the sheet was at rest. Cheaper than an angle. */
#define SK_ARITY 4
#define SK_RESTS 3
#define SK_FORMULA "constraints/emitted/isometric.h"
#define SK_WITH_STRIPS
#define SK_LINEAR
#define SK_UNIT isometric
#include "constraints/element.h"

#ifdef SK_ISA
SK_INLINE void linear(sk_element *e) {
    const sk_wide3 *x = e->x;
    sk_wide a = e->rest[0], b = e->rest[1], c = e->rest[2];
    e->gradient[0] = (sk_wide3){a * (x[1].x - x[0].x) - b * (x[2].x - x[0].x) - c * (x[3].x - x[0].x),
                                a * (x[1].y - x[0].y) - b * (x[2].y - x[0].y) - c * (x[3].y - x[0].y),
                                a * (x[1].z - x[0].z) - b * (x[2].z - x[0].z) - c * (x[3].z - x[0].z)};
    e->scale[0] = b + c - a, e->scale[1] = a, e->scale[2] = -b, e->scale[3] = -c;
}
#endif

#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "the bending rigidity of a sheet; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N m s", 0, 0, SK_FAR, "the same against bending's change in time"),
};

const sk_constraint_type sk_isometric = {
    .kind = {"isometric", "keeps two triangles flat over an edge: the edge's two ends, then the two corners beside it",
             SKEIN_CONSTRAINT, fields, sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
