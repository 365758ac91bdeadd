/* All pairs of features that are near, found one after the other: what contact takes for near is held against it. */
#ifndef SKEIN_TESTS_NEAR_PAIRS_H
#define SKEIN_TESTS_NEAR_PAIRS_H

#include "contact/touch.h"
#include "helpers.h"
#include "world/world.h"

enum { MOST_PAIRS = 512 };

static inline sk_touch *touch_of(skein_world *world) {
    for (size_t i = 0; i < world->rules.forces.count; i++)
        if (world->rules.forces.data[i]->type->phase == SK_MEETS) return world->rules.forces.data[i]->state;
    return NULL;
}

/* Some pairs, and which of them kernels find near. */
typedef struct some_pairs {
    sk_touch *touch;
    sk_allocator allocator;
    sk_pairs pairs;
    size_t near;
    int sort;
} some_pairs;

static inline void look_at_some(some_pairs *some) {
    sk_touch *touch = some->touch;
    sk_pairs_pad(&some->pairs);
    sk_touch_set_thickness(touch, &some->pairs, 0, some->sort);
    sk_closest[some->sort][touch->isa](touch->p, &some->pairs);
    for (size_t k = 0; k < some->pairs.count; k++) some->near += (some->pairs.closes[k] & SK_IS_NEAR) != 0;
    some->pairs.count = 0;
}

static inline void add_pair(some_pairs *some, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    const uint32_t v[4] = {a, b, c, d};
    for (int k = 0; k < 4; k++) some->pairs.corner[k][some->pairs.count] = v[k];
    some->pairs.key[some->pairs.count++] = 0;
    if (some->pairs.count == MOST_PAIRS) look_at_some(some);
}

/* Where vertices were when the last substep began. */
static inline size_t count_near(sk_touch *touch, int sort) {
    const sk_skin *skin = &touch->skin;
    some_pairs some = {.touch = touch, .allocator = sk_default_allocator(), .sort = sort};
    assert_true(sk_pairs_reserve(&some.pairs, &some.allocator, MOST_PAIRS + 16));
    for (uint32_t v = 0; v < skin->vertex_count && sort == SK_CORNERS; v++)
        for (uint32_t t = 0; t < skin->triangle_count; t++) {
            const uint32_t *c = skin->triangle[t];
            if (v != c[0] && v != c[1] && v != c[2]) add_pair(&some, v, c[0], c[1], c[2]);
        }
    for (uint32_t e = 0; e < skin->edge_count && sort == SK_EDGES; e++)
        for (uint32_t f = e + 1; f < skin->edge_count; f++) {
            const uint32_t *a = skin->edge[e], *b = skin->edge[f];
            if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1]) add_pair(&some, a[0], a[1], b[0], b[1]);
        }
    look_at_some(&some);
    sk_pairs_release(&some.pairs, &some.allocator);
    return some.near;
}

#endif
