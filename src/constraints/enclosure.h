/* A closed surface: triangles around a volume, all of them one constraint.
 *
 * Owned by the batch whose elements the triangles are; pressure.c makes it and works on it. Every edge lies in two
 * triangles, which run along it in opposite directions, so the sum of the tetrahedra from any one point to the
 * triangles is the volume inside, and the point does not matter: the first particle is taken, so that a body far from
 * the origin loses nothing to rounding. Triangles are turned outwards, and filled up to whole sixteens with ones
 * that are a single point. */
#ifndef SK_CONSTRAINTS_ENCLOSURE_H
#define SK_CONSTRAINTS_ENCLOSURE_H

#include "constraints/sweep.h"

struct sk_enclosure {
    size_t vertex_count, lane_count; /* lanes: triangles and what fills them up */
    uint32_t *vertex;                /* the particles, each once, in the order of their numbers */
    uint32_t *slot;                  /* the same as slots */
    uint32_t *corner[3];             /* of each lane, a place in the lists above */
    real *place;                     /* scratch: 3 a vertex, from the first vertex on */
    real *gradient;                  /* scratch: 3 a vertex, of the volume */
    double rest_volume;              /* m3, as the surface was when it was added */
};

/* Finds the surface of a batch of triangles, and says where it is open. `x` are the positions by slots. */
skein_status sk_enclosure_create(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                                 skein_error *error);
void sk_enclosure_turn(sk_enclosure *enclosure); /* inside out */
void sk_enclosure_release(sk_enclosure *enclosure, sk_allocator *allocator);
/* The whole batch as one sweep of one group. False when there is no memory. */
bool sk_enclosure_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles);

#endif
