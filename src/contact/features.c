/* Features of two leaves whose boxes may meet: vertices and triangles, edges and edges. All of the boxes' numbers are
 * compared at once, and what is listed branches on its result alone. */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT features
SK_KERNELS(sk_features_kernel, corners);
SK_KERNELS(sk_features_kernel, edges);

#ifdef SK_ISA
enum { AHEAD = 6 }; /* leaves: the boxes of so many more are on their way from memory */
enum { BOX = 16, HALF = BOX / 2 }; /* reals of a box: low ones when it begins and ends, and high ones */

/* A box to compare others with: its high ones where theirs are low. */
typedef struct turned_box {
    sk_wide part[SK_PARTS];
} turned_box;

SK_INLINE const sk_wide *parts_of(const sk_box *box) {
    return (const sk_wide *)(const void *)box;
}

SK_INLINE turned_box turned(const sk_box *box) {
    turned_box t;
#if defined(SK_WIDTH) && SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    const __m512 numbers = (__m512)*parts_of(box);
    t.part[0] = (sk_wide)_mm512_shuffle_f32x4(numbers, numbers, 0x4e); // its halves
#else
    for (int part = 0; part < SK_PARTS; part++) t.part[part] = parts_of(box)[(part + SK_PARTS / 2) % SK_PARTS];
#endif
    return t;
}

/* 1 where the boxes may meet: along no axis does one lie above the other on one side, when it begins and when it ends. */
SK_INLINE uint32_t meets(const turned_box *a, const sk_box *b) {
    const uint32_t axes = 7, sides = axes | axes << HALF, low = (1u << HALF) - 1;
    uint32_t apart = 0;
    for (int part = 0; part < SK_PARTS; part++) {
        int l = part * SK_PART;
        sk_wide others = parts_of(b)[part];
        uint32_t below = l < HALF ? sk_more_bits(others, a->part[part]) << l : 0;
        uint32_t above = l + SK_PART > HALF ? sk_more_bits(a->part[part], others) << l : 0;
        apart |= (below & low) | (above & ~low);
    }
    return !(apart & apart >> 4 & sides);
}

/* Bits of those of some boxes that may meet this one. */
SK_INLINE uint32_t met_by(const sk_box *box, const sk_box *others, uint32_t first, uint32_t count) {
    const turned_box a = turned(box);
    uint32_t met = 0;
    for (uint32_t k = first; k < count; k++) met |= meets(&a, &others[k]) << k;
    return met;
}

SK_INLINE void put(sk_pairs *pairs, uint64_t key, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    size_t k = pairs->count++;
    pairs->corner[0][k] = a, pairs->corner[1][k] = b, pairs->corner[2][k] = c, pairs->corner[3][k] = d;
    pairs->key[k] = key;
}

/* Vertices of leaf a with triangles of leaf b, of which one is looked for. */
SK_INLINE void put_corners(const sk_touch *touch, sk_pairs *fresh, uint64_t key, uint32_t a_number, uint32_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf a = skin->leaf[a_number], b = skin->leaf[b_number];
    const sk_hot hot_a = touch->hot[a_number], hot_b = touch->hot[b_number];
    for (uint32_t i = 0; i < a.vertices; i++) {
        const uint32_t v = a.first_vertex + i, hot = hot_a.vertices >> i & 1 ? ~0u : hot_b.triangles;
        uint32_t met = hot & met_by(&touch->vertex_box[v], &touch->triangle_box[b.first_triangle], 0, b.triangles);
        for (; met; met &= met - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(met);
            const uint32_t *t = skin->triangle[b.first_triangle + k];
            if (v != t[0] && v != t[1] && v != t[2]) put(fresh, key + 2 * i + k, v, t[0], t[1], t[2]);
        }
    }
}

SK_INLINE void put_edges(const sk_touch *touch, sk_pairs *fresh, uint64_t key, uint32_t a_number, uint32_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf a = skin->leaf[a_number], b = skin->leaf[b_number];
    const sk_hot hot_a = touch->hot[a_number], hot_b = touch->hot[b_number];
    for (uint32_t i = 0; i < a.edges; i++) {
        const uint32_t e = a.first_edge + i, hot = hot_a.edges >> i & 1 ? ~0u : hot_b.edges;
        uint32_t met = hot & met_by(&touch->edge_box[e], &touch->edge_box[b.first_edge],
                                    a_number == b_number ? i + 1 : 0, b.edges);
        const uint32_t *one = skin->edge[e];
        for (; met; met &= met - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(met);
            const uint32_t *two = skin->edge[b.first_edge + k];
            if (one[0] != two[0] && one[0] != two[1] && one[1] != two[0] && one[1] != two[1])
                put(fresh, key + 5 * i + k, one[0], one[1], two[0], two[1]);
        }
    }
}

SK_INLINE void fetch(const sk_box *box, uint32_t first, uint32_t count) {
    for (uint32_t k = 0; k < count; k++) __builtin_prefetch(&box[first + k]);
}

void SK_KERNEL(corners)(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const sk_leaf *next = &touch->skin.leaf[partner[i + AHEAD < count ? i + AHEAD : i]];
        fetch(touch->triangle_box, next->first_triangle, next->triangles);
        fetch(touch->vertex_box, next->first_vertex, next->vertices);
        uint32_t b = partner[i];
        uint64_t key = sk_leaves_key(a, b);
        put_corners(touch, fresh, key, a, b);
        if (b != a) put_corners(touch, fresh, key + SK_LEAVES_PAIRS / 2, b, a);
    }
}

void SK_KERNEL(edges)(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const sk_leaf *next = &touch->skin.leaf[partner[i + AHEAD < count ? i + AHEAD : i]];
        fetch(touch->edge_box, next->first_edge, next->edges);
        put_edges(touch, fresh, sk_leaves_key(a, partner[i]), a, partner[i]);
    }
}
#else
sk_features_kernel *const sk_features[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners), SK_EACH_ISA(edges)};
#endif
