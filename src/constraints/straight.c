/* Straight: the length of the sum of the vectors from p1 to p0 and p2, each over its length at rest. That is 2 sin(half
 * the angle by which the line through the three turns), 0 if it is straight. It is the length of a linear function of
 * the positions, so that it is the cheapest kind of bending, and always defined. As bending of a grid of rigidity B (N
 * m) the three have the stiffness B area/l^2 (bodies/lines.c). */
#define SK_ARITY 3
#define SK_RESTS 2
#define SK_FORMULA "constraints/emitted/straight.h"
#define SK_WITH_STRIPS
#define SK_LINEAR
#define SK_UNIT straight
#include "constraints/element.h"

#ifdef SK_ISA
SK_INLINE void linear(sk_element *e) {
    const sk_wide3 *x = e->x;
    sk_wide a = e->rest[0], b = e->rest[1];
    e->gradient[0] =
        (sk_wide3){a * (x[0].x - x[1].x) + b * (x[2].x - x[1].x), a * (x[0].y - x[1].y) + b * (x[2].y - x[1].y),
                   a * (x[0].z - x[1].z) + b * (x[2].z - x[1].z)};
    e->scale[0] = a, e->scale[1] = -(a + b), e->scale[2] = b;
}
#endif

#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N m", 0.01, 0, SK_UNBOUNDED,
            "torque a radian of a small turn; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N m s", 0, 0, SK_FAR, "torque a radian a second"),
};

const sk_constraint_type sk_straight = {
    .kind = {"straight", "keeps three particles in a straight line, the second in the middle", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
