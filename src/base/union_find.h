/* Groups of numbers that grow together: each has a parent in its group, and the root of a group is its own. */
#ifndef SK_BASE_UNION_FIND_H
#define SK_BASE_UNION_FIND_H

#include <stdbool.h>
#include <stdint.h>

/* The root of i's group; ways to it are halved. */
static inline uint32_t sk_union_root(uint32_t *parent, uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Makes one group of two, of which the smaller root is the root; false if they were one. */
static inline bool sk_union_join(uint32_t *parent, uint32_t a, uint32_t b) {
    a = sk_union_root(parent, a), b = sk_union_root(parent, b);
    if (a != b) parent[a > b ? a : b] = a > b ? b : a;
    return a != b;
}

#endif
