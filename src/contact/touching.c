/* Which features touch now: for programs, and for whoever draws. Found by the places alone, so that it is the same before a step
 * and after it, however long the world has been there. */
#include "contact/search/search.h"

enum { SOME = 64 };

/* Pairs that are looked at together, and what is told of them. */
typedef struct listing {
    sk_touch *touch;
    sk_allocator *allocator;
    sk_pairs some[SK_PAIR_SORTS];
    skein_surface_contact *out;
    size_t most, count;
} listing;

static void tell(listing *list, int sort, size_t k) {
    const sk_pairs *pairs = &list->some[sort];
    if (list->count++ >= list->most) return;
    skein_surface_contact *out = &list->out[list->count - 1];
    real weight[4];
    sk_weights_of(pairs, sort, k, weight);
    *out = (skein_surface_contact){
        .edges = sort == SK_EDGES,
        .gap = (double)pairs->distance[k],
        .thickness = (double)pairs->thickness[k],
        .normal = {(double)pairs->normal[0][k], (double)pairs->normal[1][k], (double)pairs->normal[2][k]}};
    for (int c = 0; c < 4; c++) {
        out->particle[c] = list->touch->skin.particle[pairs->corner[c][k]];
        out->weight[c] = (double)weight[c];
    }
}

/* Looks at the pairs of a sort: as contact does, those of one piece are no thicker than nine tenths of what they were apart. */
static void look(listing *list, int sort) {
    sk_touch *touch = list->touch;
    sk_pairs *pairs = &list->some[sort];
    const uint32_t *piece = touch->skin.piece;
    sk_pairs_pad(pairs);
    sk_closest[sort][touch->isa](touch->skin.built, pairs);
    for (size_t k = 0; k < pairs->count; k++) {
        uint32_t a = pairs->corner[0][k], b = pairs->corner[2][k];
        real thickness = sk_pair_thickness(touch, a, b);
        pairs->thickness[k] = piece[a] == piece[b] ? sk_min(thickness, (real)0.9 * pairs->distance[k]) : thickness;
    }
    sk_closest[sort][touch->isa](touch->p, pairs);
    for (size_t k = 0; k < pairs->count; k++)
        if (pairs->distance[k] <= (real)1.001 * pairs->thickness[k]) tell(list, sort, k);
    pairs->count = 0;
}

static void add(listing *list, int sort, const uint32_t corner[4]) {
    sk_pairs *pairs = &list->some[sort];
    for (int c = 0; c < 4; c++) pairs->corner[c][pairs->count] = corner[c];
    pairs->key[pairs->count++] = 0;
    if (pairs->count == SOME) look(list, sort);
}

static void add_corners(listing *list, const sk_leaf *a, const sk_leaf *b) {
    const sk_touch *touch = list->touch;
    for (uint32_t v = a->first_vertex; v < a->first_vertex + a->vertices; v++)
        for (uint32_t t = b->first_triangle; t < b->first_triangle + b->triangles; t++) {
            const uint32_t *of = touch->skin.triangle[t], corner[4] = {v, of[0], of[1], of[2]};
            if (v != of[0] && v != of[1] && v != of[2] && sk_boxes_meet(&touch->vertex_box[v], &touch->triangle_box[t]))
                add(list, SK_CORNERS, corner);
        }
}

static void add_edges(listing *list, const sk_leaf *a, const sk_leaf *b) {
    const sk_touch *touch = list->touch;
    for (uint32_t e = a->first_edge; e < a->first_edge + a->edges; e++)
        for (uint32_t f = a == b ? e + 1 : b->first_edge; f < b->first_edge + b->edges; f++) {
            const uint32_t *one = touch->skin.edge[e], *two = touch->skin.edge[f],
                           corner[4] = {one[0], one[1], two[0], two[1]};
            if (one[0] != two[0] && one[0] != two[1] && one[1] != two[0] && one[1] != two[1] &&
                sk_boxes_meet(&touch->edge_box[e], &touch->edge_box[f]))
                add(list, SK_EDGES, corner);
        }
}

static void list_all(listing *list) {
    sk_touch *touch = list->touch;
    for (size_t i = 0; i < touch->partner.count; i++) {
        size_t first = touch->first.data[i], second = touch->partner.data[i];
        const sk_leaf *a = &touch->skin.leaf[first], *b = &touch->skin.leaf[second];
        sk_touch_need_features(touch, first), sk_touch_need_features(touch, second);
        add_corners(list, a, b);
        if (a != b) add_corners(list, b, a);
        add_edges(list, a, b);
    }
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) look(list, sort);
}

bool sk_touch_touching(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                       skein_surface_contact *out, size_t most, size_t *count) {
    sk_touch *touch = force->state;
    *count = 0;
    if (!touch || !touch->skin.leaf_count) return true;
    listing list = {.touch = touch, .allocator = allocator, .out = out, .most = most};
    const sk_contact_params *params = force->params;
    real found_for = touch->thickness, usual = touch->usual; // pairs that are kept were
    touch->thickness = sk_touch_thickest(touch, params);
    touch->usual = (real)params->thickness;
    sk_touch_load_from(touch, x, slot_of);
    sk_touch_put_boxes(touch, (real)0.51 * touch->thickness);
    bool too_many, good = true;
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        good = good && sk_pairs_reserve(&list.some[sort], allocator, SOME + 16);
    good = good && sk_touch_partners(touch, allocator, SIZE_MAX / 2, true, &too_many);
    if (good) list_all(&list);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) sk_pairs_release(&list.some[sort], allocator);
    touch->thickness = found_for;
    touch->usual = usual;
    *count = list.count;
    return good;
}
