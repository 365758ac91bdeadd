/* The hinges of a sheet: pairs of triangles over an edge, for bending by angle.
 *
 *        p2              faces of more than three corners are cut into triangles from their first corner;
 *       /  \             the cuts are hinges, too
 *     p0 -- p1
 *       \  /
 *        p3
 */
#ifndef SK_BODIES_HINGES_H
#define SK_BODIES_HINGES_H

#include "bodies/springs.h"
#include "constraints/constraint.h"

typedef struct sk_hinges {
    sk_allocator *allocator;
    size_t count;
    uint32_t (*corner)[4];
    real *rest;  /* the type's rest values, first all first ones */
    real *scale; /* what a sheet's rigidity is to be multiplied with; NULL: nothing */
} sk_hinges;

/* Finds all hinges, and for bending of that type their rest values and scales; in the order of their particles' ranks
 * (NULL: scattered, see order.h). */
skein_status sk_hinges_find(sk_hinges *hinges, const sk_sheet *sheet, const sk_springs *springs,
                            const sk_constraint_type *type, const uint32_t *rank, skein_error *error);
void sk_hinges_release(sk_hinges *hinges);

#endif
