/* Twist: how far four corners are from a parallelogram, |p0 - p1 + p2 - p3|, over the root of its area at rest: about
 * the angle between opposite edges when it is twisted. It is the length of a linear function of the positions. As
 * bending of a grid of rigidity B each of its cells has the stiffness 2 B (bodies/lines.c). */
#define SK_ARITY 4
#define SK_RESTS 1
#define SK_FORMULA "constraints/emitted/twist.h"
#define SK_WITH_STRIPS
#define SK_LINEAR
#define SK_UNIT twist
#include "constraints/element.h"

#ifdef SK_ISA
SK_INLINE void linear(sk_element *e) {
    const sk_wide3 *x = e->x;
    sk_wide a = e->rest[0];
    e->gradient[0] =
        (sk_wide3){a * ((x[0].x - x[1].x) + (x[2].x - x[3].x)), a * ((x[0].y - x[1].y) + (x[2].y - x[3].y)),
                   a * ((x[0].z - x[1].z) + (x[2].z - x[3].z))};
    e->scale[0] = e->scale[2] = a, e->scale[1] = e->scale[3] = -a;
}
#endif

#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "torque a radian of a small twist; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N m s", 0, 0, SK_FAR, "torque a radian a second"),
};

const sk_constraint_type sk_twist = {
    .kind = {"twist", "keeps the four corners around a parallelogram in one plane", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
