/* Distances along a sheet, from pinned particles to all others: the lengths of tethers. */
#ifndef SK_BODIES_GEODESIC_H
#define SK_BODIES_GEODESIC_H

#include "bodies/sheet.h"

typedef struct sk_geodesic sk_geodesic; /* the sheet's triangles by particle, ready for searches */

sk_geodesic *sk_geodesic_create(const sk_sheet *sheet);
void sk_geodesic_release(sk_geodesic *geodesic);
/* From the particles with source[i]: distance[i] along the sheet (infinite where it does not reach) and
 * the source it comes from. False when there is no memory. */
bool sk_geodesic_from(sk_geodesic *geodesic, const bool *source, double *distance, uint32_t *nearest);
/* Calls `visit` for each particle that is nearer along the sheet than `most`, from the nearest on, the source first. Not for
 * grids. False when there is no memory. */
bool sk_geodesic_near(sk_geodesic *geodesic, uint32_t source, double most,
                      void (*visit)(void *user, uint32_t particle, double distance), void *user);

#endif
