/* The aggregates of a cloth that is any mesh (constraints/aggregate.h says what they do): hubs two edges apart, hubs of these
 * four apart, and so on, with the distances along the mesh between hubs that are near each other. */
#ifndef SK_BODIES_AGGREGATE_H
#define SK_BODIES_AGGREGATE_H

#include "bodies/body.h"
#include "bodies/sheet.h"

/* Which hubs are to have tethers of their own, before the aggregates carry their movement on. */
typedef struct sk_held_hubs {
    bool *is;    /* of each particle; NULL: there are no aggregates. The caller releases it */
    double edge; /* m: the mean length of an edge */
} sk_held_hubs;

/* Bounds that the body's tether bound holds. `mass` of each particle; rank[i]: its place in memory. A sheet that is too small, or is
 * a grid, gets none. */
skein_status sk_aggregates_add(const sk_sheet *sheet, const double *mass, const bool *pinned, const uint32_t *rank,
                               skein_world *world, sk_body *body, sk_held_hubs *held, skein_error *error);

#endif
