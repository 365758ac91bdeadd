/* The search for pairs that may come near, from file to file: boxes of vertices, leaves and features; a tree of these; leaves
 * that may meet, features of two that may, and of these those that no plane keeps apart. */
#ifndef SK_CONTACT_SEARCH_H
#define SK_CONTACT_SEARCH_H

#include "contact/touch.h"

/* ---- search.c ---- */

/* Finds and keeps pairs. False when there is no memory. */
bool sk_touch_search(sk_touch *touch, sk_allocator *allocator, sk_touch_search_sort search);
/* Thicknesses: nearest points of edges that are all but parallel are no better known. */
#define SK_SEARCH_ROUNDING ((real)0.002)

/* ---- boxes.c ---- */

/* Marks vertices that are lost, edges and triangles that have one, and the leaves of all these. */
void sk_touch_mark_hot(sk_touch *touch);
/* Boxes of all vertices and leaves, or of those that are new. */
void sk_touch_make_boxes(sk_touch *touch, sk_touch_search_sort sort);
/* Of features, boxes are made where their leaf meets another: few do, of a surface that touches nothing. */
void sk_touch_box_features(sk_touch *touch);
/* The box of a leaf, which meets nobody if it is torn, and those of its features, from those of vertices. */
void sk_touch_leaf_box(sk_touch *touch, size_t leaf, bool torn);
void sk_touch_feature_boxes(sk_touch *touch, size_t leaf);
static inline void sk_touch_need_features(sk_touch *touch, size_t leaf) {
    if (!touch->featured[leaf]) sk_touch_feature_boxes(touch, leaf);
}

/* ---- cells.c ---- */

real sk_cells_a_metre(const sk_touch *touch);
/* The cells of a leaf, from its boxes. */
void sk_touch_leaf_cells(sk_touch *touch, size_t leaf);

/* ---- features.c ---- */

/* Lists the pairs of features of leaf a and each of its partners whose boxes may meet and of which one is looked for, in
 * order; there is room for SK_LEAVES_PAIRS a partner. */
enum { SK_LEAVES_PAIRS = 64 }; /* of two leaves: 2 x 4 x 2 corners, 5 x 5 edges */
typedef void sk_features_kernel(const struct sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner,
                                size_t count);
extern sk_features_kernel *const sk_features[SK_PAIR_SORTS][SK_ISA_COUNT];

/* ---- partners.c ---- */

/* Lists leaves whose boxes may meet, each two once, of which one at least is looked for `anew`: `first`, and `partner`, the
 * same leaf or a later one; in order, but none where they are more than `most`. Those of calm patches if asked for. */
bool sk_touch_partners(sk_touch *touch, sk_allocator *allocator, size_t most, bool calm_too, bool *too_many);
/* Has each part's work done on a thread of its own: `work` looks at what is next in its part of [0, count) until there is
 * none or no room, for which `grow` is then asked. Parts follow each other in order; or each takes so many at a time, whoever
 * is done. False when there is no memory. */
typedef struct sk_parts_job {
    sk_touch *touch;
    int sort, search;
    size_t most;
    bool calm_too;
    size_t at_once; /* 0: in order */
    void (*work)(const struct sk_parts_job *job, sk_search_part *part);
    bool (*grow)(sk_search_part *part, sk_allocator *allocator);
} sk_parts_job;
bool sk_touch_work(const sk_parts_job *job, sk_allocator *allocator, size_t count, size_t least);
void sk_touch_release_parts(sk_touch *touch, sk_allocator *allocator);

#endif
