/* A curve through space (Morton's): what lies together along it lies together in space. */
#ifndef SK_CONTACT_CURVE_H
#define SK_CONTACT_CURVE_H

#include <stddef.h>

#include "base/vector.h"

typedef struct sk_curve {
    sk_vec3 low;
    real per; /* cells a metre, of 1024 along the longest side */
} sk_curve;

/* Through a box. */
sk_curve sk_curve_through(sk_vec3 low, sk_vec3 high);
/* Where a point is along it: a number of 30 bits. */
uint64_t sk_curve_place(const sk_curve *curve, sk_vec3 x);
/* Sorts numbers by their places, which each go with theirs, least first; what has one place stays in order. There is room for as
 * many others. */
void sk_sort_by_place(uint64_t *place, uint32_t *number, uint64_t *other_place, uint32_t *other, size_t count);

#endif
