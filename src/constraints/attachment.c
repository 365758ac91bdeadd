/* Attachment: how far p0 is from its place on the triangle p1 p2 p3, which is there where it was when the constraint was made: at the
 * same weights of the corners, and as far along the normal. An element that is soft gives by its load over the stiffness. */
#define SK_ARITY 4
#define SK_RESTS 3
#define SK_FORMULA "constraints/emitted/attachment.h"
#define SK_VECTOR
#define SK_UNIT attachment
#include "constraints/element.h"

#ifdef SK_ISA
/* J^T v, where J is the derivative of the way L = p0 - p1 - b u - c w - height n by the positions: u and w are the sides
 * from p1, and n is the direction of u x w, which turns with them. */
SK_INLINE void spread(const sk_element *e, sk_wide3 v, sk_wide3 *g) {
    const sk_wide3 *x = e->x;
    sk_wide3 u = {x[2].x - x[1].x, x[2].y - x[1].y, x[2].z - x[1].z};
    sk_wide3 w = {x[3].x - x[1].x, x[3].y - x[1].y, x[3].z - x[1].z};
    sk_wide3 n = {u.y * w.z - u.z * w.y, u.z * w.x - u.x * w.z, u.x * w.y - u.y * w.x};
    sk_wide square = sk_dot_wide(n, n), inverse = sk_keep(sk_positive(square), 1 / square);
    sk_wide along = sk_dot_wide(n, v) * inverse, far = e->rest[2] * sk_wide_sqrt(inverse), b = e->rest[0],
            c = e->rest[1];
    sk_wide3 t = {far * (v.x - along * n.x), far * (v.y - along * n.y), far * (v.z - along * n.z)};
    g[0] = v;
    g[2] =
        (sk_wide3){w.z * t.y - w.y * t.z - b * v.x, w.x * t.z - w.z * t.x - b * v.y, w.y * t.x - w.x * t.y - b * v.z};
    g[3] =
        (sk_wide3){u.y * t.z - u.z * t.y - c * v.x, u.z * t.x - u.x * t.z - c * v.y, u.x * t.y - u.y * t.x - c * v.z};
    g[1] = (sk_wide3){-g[0].x - g[2].x - g[3].x, -g[0].y - g[2].y - g[3].y, -g[0].z - g[2].z - g[3].z};
}
#endif

#include "constraints/element_kind.h"

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N/m", 1e4, 0, SK_UNBOUNDED,
            "force a metre from its place; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N s/m", 0, 0, SK_FAR, "the same against the way's change in time"),
};

const sk_constraint_type sk_attachment = {
    .kind = {"attachment", "ties a particle to its place on a triangle: the particle, then the three corners",
             SKEIN_CONSTRAINT, fields, sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
};
#endif
