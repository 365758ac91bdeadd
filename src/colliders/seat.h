/* Seats: where something sits on a mesh's triangle, and where that is as the mesh moves and changes its shape.
 *
 *          p            the nearest point q of the nearest triangle is kept by its weights of b and c, and the way from
 *          |  off       there to p in the triangle's own frame: along its side a b, across that, and along its normal
 *     a----q------b     */
#ifndef SK_COLLIDERS_SEAT_H
#define SK_COLLIDERS_SEAT_H

#include "colliders/collider.h"

typedef struct sk_seat {
    uint32_t triangle;
    double weight[2], off[3];
} sk_seat;

/* The seat of p, a place when the collider stood as its fields said of `time` and its mesh was as it was made. With a finite
 * `offset` (m) it is put so far off the nearest point, along the triangle's normal. The collider has triangles. */
void sk_collider_find_seat(const sk_collider *collider, double time, const double p[3], double offset, sk_seat *seat);
/* The nearest triangle to p in the mesh's own frame, as it was made, and the nearest point's weights. */
void sk_trimesh_find_seat(const struct sk_trimesh *m, const double p[3], sk_seat *seat);
/* Where it is at a time within the present step, which has begun. */
void sk_collider_seat_place(const sk_collider *collider, const sk_seat *seat, double time, double p[3]);

#endif
