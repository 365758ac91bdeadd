/* What lies between particles against colliders (faces.c): edges and triangles. */
#ifndef SK_CONTACT_FACES_H
#define SK_CONTACT_FACES_H

#include "base/vector.h"
#include "colliders/collider.h"

/* An edge or a triangle near a collider: where it is nearest, and the surface there. */
typedef struct sk_face {
    uint32_t corner[3];
    real weight[3];                   /* of an edge, the last is 0 */
    sk_vec3 normal, at, way;          /* of the surface: unit, m, and m in a substep */
    real thickness, wanted, friction; /* m: how far off it is to be, in the end and now */
} sk_face;

typedef struct sk_faces {
    const sk_collider **collider; /* that have an inside */
    size_t count;
    struct {
        sk_face *data;
        size_t count, capacity;
    } near;         /* as they were found last: */
    uint64_t clock; /* in which substep */
    /* by slot: 1 where a vertex of the skin is, else 0; of sixteen, where the first of these is, and in w how far the others are from there, or -1;
     * and after all of these the same of all */
    real *here;
    sk_vec4 *block;
    sk_vec4 *plane; /* of vertices: the normal at the collider that is looked at, and in w the distance; SK_REAL_MAX: it is far */
} sk_faces;

#endif
