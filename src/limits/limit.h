/* Limits: corrections of positions at the end of a substep, whatever the method.
 *
 * A strain limit shortens every edge that has become longer than rest times 1 + bound, one after the
 * other (ordered): what the springs let through, however soft they are.
 *
 * Tethers keep cloth from stretching like rubber (Kim, Chentanez, Mueller 2012): a particle may not be
 * farther from a held one, its anchor, than its distance along the cloth, times 1 + bound. One pass does
 * for a whole sheet what thousands of spring sweeps would. Each element moves its own particle (free). */
#ifndef SK_LIMITS_LIMIT_H
#define SK_LIMITS_LIMIT_H

#include "base/fields.h"
#include "plan/row.h"

/* The edges of a strain limit: indices and rest lengths of a batch, which outlives the limit. */
typedef struct sk_limited_edges {
    const uint32_t *slot; /* count x 2 */
    const real *rest;
} sk_limited_edges;

typedef struct sk_limit {
    sk_row_kernel *kernel;
    sk_order order;
    const char *label;
    const bool *enabled;
    const double *bound; /* of the stretch: 0.05 lets it grow by 5 % */
    size_t count;
    sk_limited_edges edges; /* of a strain limit; the rest is for tethers */
    size_t anchors;      /* of each element */
    uint32_t *particle;  /* the tethered one, then its anchors: count x (1 + anchors), user's indices */
    uint32_t *slot;      /* the same as slots */
    real *length;        /* count x anchors: along the cloth at rest, m; infinite where there is no way */
} sk_limit;

/* Copies; no particle is tethered twice. NULL when there is no memory. */
sk_limit *sk_tethers_create(sk_allocator *allocator, size_t count, size_t anchors, const uint32_t *particles, const real *lengths);
sk_limit *sk_strain_limit_create(sk_allocator *allocator, size_t count, sk_limited_edges edges);
void sk_limit_release(sk_limit *limit, sk_allocator *allocator);
void sk_limit_refresh(sk_limit *limit, const uint32_t *slot_of);

#endif
