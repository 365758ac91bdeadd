/* The words in which shapes say their arithmetic, besides those of base/arithmetic.h. A shape's function is
 *
 *     sk_contact KIND_probe(KIND_params p, sk_pose where, vec3 x)
 *
 * the distance from its surface at x, negative inside, and the unit normal; SK_PROBE makes its kernel of it. On a card
 * colliders/shape.glsl stands for this file. */
#ifndef SK_COLLIDERS_SHAPE_H
#define SK_COLLIDERS_SHAPE_H

#include "base/arithmetic.h"
#include "colliders/collider.h"

#ifdef SK_ISA

#define position_of(where) vec3_of((where).position.x, (where).position.y, (where).position.z)
#define axis_of(where) vec3_of((where).axis.x, (where).axis.y, (where).axis.z)

SK_INLINE sk_contact contact_of(vec3 normal, num distance) {
    return (sk_contact){.normal = normal, .distance = distance};
}

/* From the axes that it was built in to those of the world, and back. */
SK_INLINE vec3 turned(sk_pose where, vec3 v) {
    const real *r = where.rotation;
    return (vec3){r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
                  r[6] * v.x + r[7] * v.y + r[8] * v.z};
}
SK_INLINE vec3 turned_back(sk_pose where, vec3 v) {
    const real *r = where.rotation;
    return (vec3){r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
                  r[2] * v.x + r[5] * v.y + r[8] * v.z};
}

#define SK_PROBE(kind)                                                                                       \
    void SK_KERNEL(probe)(const void *params, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) { \
        *contact = kind##_probe(*(const kind##_params *)params, *pose, *p);                                  \
    }

#endif
#endif
