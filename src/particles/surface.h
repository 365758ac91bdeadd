/* Triangles by slots, for forces that act on areas: in patches along strips where they fill the cells of a grid, the
 * rest one by one (plan/op.h). Owned by the world, rebuilt when slots change. */
#ifndef SK_PARTICLES_SURFACE_H
#define SK_PARTICLES_SURFACE_H

#include "particles/particles.h"

/* Builds it from the triangles of all bodies, whose corners are user's indices, without those of particles that take no
 * part and without those that a cut took away, which are three times one corner. False when there is no memory: the surface is then empty. */
bool sk_surface_arrange(sk_surface *surface, sk_allocator *allocator, const sk_particles *particles,
                        const sk_triangles *triangles);
/* The first place in the rest whose triangle has at least this number among all that take part. */
size_t sk_surface_rest_from(const sk_surface *surface, size_t number);
void sk_surface_release(sk_surface *surface, sk_allocator *allocator);

#endif
