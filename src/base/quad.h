/* Four reals at once, whatever the instruction set: a place, or a corner of a box. */
#ifndef SK_BASE_QUAD_H
#define SK_BASE_QUAD_H

#include <string.h>

#include "base/vector.h"

typedef real sk_quad __attribute__((vector_size(4 * sizeof(real))));

static inline sk_quad sk_quad_at(const sk_vec4 *x) {
    sk_quad q;
    memcpy(&q, x, sizeof q);
    return q;
}

static inline sk_quad sk_quad_times(real a, sk_quad x) {
    return (sk_quad){a, a, a, a} * x;
}

/* The weighted sum of four: with a pair's weights, where its first feature is seen from its second. */
static inline sk_quad sk_quad_sum(const sk_vec4 *x, const uint32_t v[4], const real weight[4]) {
    return sk_quad_times(weight[0], sk_quad_at(&x[v[0]])) + sk_quad_times(weight[1], sk_quad_at(&x[v[1]])) +
           sk_quad_times(weight[2], sk_quad_at(&x[v[2]])) + sk_quad_times(weight[3], sk_quad_at(&x[v[3]]));
}

#endif
