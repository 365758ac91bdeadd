/* Enclosures: closed surfaces of triangles, all of which are one constraint on the volume inside.
 *
 * Owned by the batch whose elements the triangles are; pressure.c makes and uses it. Every edge lies in two triangles,
 * which run along it in opposite directions, so the volume inside is the sum of the tetrahedra from any point to the
 * triangles. That point is the first particle, so that a body far from the origin loses nothing to rounding. Triangles
 * face outwards, and are padded to whole sixteens with ones of a single point. */
#ifndef SK_CONSTRAINTS_ENCLOSURE_H
#define SK_CONSTRAINTS_ENCLOSURE_H

#include "constraints/sweep.h"

struct sk_enclosure {
    size_t vertex_count, lane_count; /* lanes: triangles and padding */
    uint32_t *vertex;                /* the particles, each once, in the order of their numbers */
    uint32_t *slot;                  /* the same as slots */
    uint32_t *corner[3];             /* for each lane, places in the lists above */
    real *place;                     /* scratch: 3 for each vertex, relative to the first vertex */
    real *gradient;                  /* scratch: 3 for each vertex, of the volume */
    double rest_volume;              /* m3, as the surface was when it was added */
};

/* Makes the enclosure of a batch of triangles, or says where the surface is open. */
skein_status sk_enclosure_create(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                                 skein_error *error);
void sk_enclosure_turn(sk_enclosure *enclosure); /* inside out */
void sk_enclosure_release(sk_enclosure *enclosure, sk_allocator *allocator);
/* The whole batch as one sweep of one group. False when there is no memory. */
bool sk_enclosure_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles);

#endif
