/* Pairs that are near as pushes take them (push.c), dealt to slabs of space (slabs.c). */
#ifndef SK_CONTACT_PUSH_H
#define SK_CONTACT_PUSH_H

#include "base/vector.h"

/* One pair: a line of the cache, where reals are floats. The second feature is seen from the first by the sum of its weights times its
 * corners' places; along the normal that is to come to `wanted`, m. */
typedef struct sk_push {
    uint32_t corner[4];
    real weight[4], normal[3], wanted, before[3] /* the same sum where the substep begins */, friction;
} sk_push;

/* Slabs across the longest extent of what is near. A pair is of one slab, of two that lie side by side, or of more: no two classes that
 * are taken at the same time have a vertex in common. Their order in all, by which bits are decided, knows nothing of threads. */
enum {
    SK_MOST_SLABS = 16,
    SK_SLAB_CLASSES =
        2 * SK_MOST_SLABS, /* slabs; boundaries between them, every second one and then the others; all else */
    SK_PUSH_CLASSES = 2 * SK_SLAB_CLASSES, /* corners, and then edges */
    SK_SLAB_ROUNDS = 4
};
extern const size_t
    sk_slab_round[SK_SLAB_ROUNDS +
                  1]; /* the first class of each round, of a sort: those of a round are taken at the same time */
typedef struct sk_push_list {
    struct {
        sk_push *data;
        size_t count, capacity;
    } pair; /* corners, and then edges */
    struct {
        uint8_t *data;
        size_t count, capacity;
    } class_of; /* of pairs */
    struct {
        uint32_t *data;
        size_t count, capacity;
    } dealt;                           /* pairs by class */
    size_t start[SK_PUSH_CLASSES + 1]; /* of classes among those dealt */
    bool known;                        /* they are of this substep */
} sk_push_list;

#endif
