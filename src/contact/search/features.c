/* Features of two leaves whose boxes may meet: vertices and triangles, edges and edges. All features of a leaf are
 * compared with one, or with several, at once, in cells (cells.c); how many of them meet is nowhere branched on one by
 * one. */
#include "base/kernels.h"
#include "contact/search/search.h"
#define SK_UNIT features
SK_KERNELS(sk_features_kernel, corners);
SK_KERNELS(sk_features_kernel, edges);

#ifdef SK_ISA
#include "contact/search/bits.h"

enum {
    AHEAD = 6,                   /* leaves: the boxes of so many more are on their way from memory */
    SOME = 32,                   /* partners that are compared before their pairs are put down */
    LANES = 8,                   /* a row of one leaf's features, which needs no more */
    ROWS = SK_VECTOR_BYTES / 16, /* of them in a vector */
    GROUPS = (SK_LEAF_EDGES + ROWS - 1) / ROWS,
    HALF = SK_CELL_ROWS / 2 /* rows of an end */
};
typedef uint16_t cells __attribute__((vector_size(16)));
typedef uint16_t wide_cells __attribute__((vector_size(SK_VECTOR_BYTES)));

/* ---- rows of cells ---- */

SK_INLINE cells load(const int16_t *number) {
    cells c;
    memcpy(&c, number, sizeof c);
    return c;
}

/* A row, as often as a vector has it. */
SK_INLINE wide_cells load_wide(const int16_t *number) {
#if SK_WIDTH == 64
    return (wide_cells)_mm512_broadcast_i32x4((__m128i)load(number));
#elif SK_WIDTH == 32
    return (wide_cells)_mm256_broadcastsi128_si256((__m128i)load(number));
#else
    return load(number);
#endif
}

/* Bits of the lanes that are negative, as differences of cells. */
SK_INLINE uint32_t negative(cells a) {
#if defined(__x86_64__)
    return (uint32_t)_mm_movemask_epi8(_mm_packs_epi16((__m128i)a, _mm_setzero_si128()));
#elif defined(__wasm_simd128__)
    return (uint32_t)wasm_i16x8_bitmask((v128_t)a);
#else
    uint32_t bits = 0;
    for (int l = 0; l < LANES; l++) bits |= (uint32_t)(a[l] >> 15) << l;
    return bits;
#endif
}

SK_INLINE uint32_t negative_wide(wide_cells a) {
#if SK_WIDTH == 64
    return _mm512_movepi16_mask((__m512i)a);
#elif SK_WIDTH == 32
    uint32_t halves = (uint32_t)_mm256_movemask_epi8(_mm256_packs_epi16((__m256i)a, _mm256_setzero_si256()));
    return (halves & 0xff) | halves >> LANES;
#else
    return negative(a);
#endif
}

SK_INLINE void fetch(const int16_t *number, int last) {
    __builtin_prefetch(number);
    if (last >= 32) __builtin_prefetch(number + 32);
    if (last >= 64) __builtin_prefetch(number + 64);
}

/* ---- what was met ---- */

/* Bits of the masks of some partners. */
typedef struct met_list {
    uint32_t place[SOME * SK_LEAVES_PAIRS + SK_BITS_AFTER];
    size_t count;
} met_list;

/* Where pairs are put down, one after the other. */
typedef struct places {
    uint32_t *restrict corner[4];
    uint64_t *restrict key;
    size_t count;
} places;

SK_INLINE places places_of(const sk_pairs *pairs) {
    return (places){{pairs->corner[0], pairs->corner[1], pairs->corner[2], pairs->corner[3]}, pairs->key, pairs->count};
}

/* Puts a pair down, which counts if it is one. */
SK_INLINE void put(places *to, bool counts, uint64_t key, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    size_t k = to->count;
    to->corner[0][k] = a, to->corner[1][k] = b, to->corner[2][k] = c, to->corner[3][k] = d;
    to->key[k] = key;
    to->count = k + counts;
}

/* ---- edges ---- */

/* Each edge of a leaf in rows of its own, eight times; which of them there are, and which are looked for. */
typedef struct edge_rows {
    SK_VECTOR_ALIGNED uint16_t number[SK_CELL_ROWS][GROUPS * ROWS][LANES];
    uint64_t all, hot;
    int groups;
} edge_rows;

SK_INLINE void set_edge_rows(edge_rows *rows, const sk_touch *touch, uint32_t leaf, int ends) {
    const int16_t *number = touch->edge_cells[leaf].number;
    const uint32_t edges = touch->skin.leaf[leaf].edges;
    rows->all = rows->hot = 0;
    rows->groups = ((int)edges + ROWS - 1) / ROWS;
    for (uint32_t i = 0; i < edges; i++) {
        const uint64_t row = (uint64_t)0xff << i * LANES;
        rows->all |= row;
        rows->hot |= touch->hot[leaf].edges >> i & 1 ? row : 0;
        for (int r = 0; r < ends * HALF; r++) {
            cells c = (uint16_t)number[SK_CELL_ROW(r, SK_LEAF_EDGES) + (int)i] + (cells){0};
            memcpy(rows->number[r][i], &c, sizeof c);
        }
    }
}

SK_INLINE wide_cells group_of(const edge_rows *rows, int row, int group) {
    return *(const wide_cells *)(const void *)rows->number[row][group * ROWS];
}

/* Bit 8 i + k: edge i of the one and k of the other may meet: along no axis does one lie above the other on one side,
 * when it begins and when it ends. Where the ends are the same, one is asked. */
SK_INLINE uint64_t edges_met(const edge_rows *a, const int16_t *b, int ends) {
    uint64_t met = 0;
    for (int g = 0; g < a->groups; g++) {
        wide_cells apart = {0};
        for (int k = 0; k < 3; k++) {
            wide_cells above = ~(wide_cells){0}, below = above;
            for (int low = k; low < ends * HALF; low += HALF) {
                const int high = low + HALF / 2;
                above &= load_wide(b + SK_CELL_ROW(high, SK_LEAF_EDGES)) - group_of(a, low, g);
                below &= group_of(a, high, g) - load_wide(b + SK_CELL_ROW(low, SK_LEAF_EDGES));
            }
            apart |= above | below;
        }
        met |= (negative_wide(apart) ^ (((uint64_t)1 << ROWS * LANES) - 1)) << g * ROWS * LANES;
    }
    return met;
}

/* The same of leaves that are too wide for cells. */
static __attribute__((noinline)) uint64_t wide_edges_met(const sk_touch *touch, uint32_t a, uint32_t b) {
    const sk_leaf *one = &touch->skin.leaf[a], *two = &touch->skin.leaf[b];
    uint64_t met = 0;
    for (uint32_t i = 0; i < one->edges; i++)
        for (uint32_t k = 0; k < two->edges; k++)
            if (sk_boxes_meet(&touch->edge_box[one->first_edge + i], &touch->edge_box[two->first_edge + k]))
                met |= (uint64_t)1 << (i * LANES + k);
    return met;
}

SK_INLINE void list_edges(const sk_touch *touch, met_list *list, const edge_rows *rows, uint32_t a,
                          const uint32_t *partner, size_t count, int ends) {
    const uint64_t each_row = 0x0101010101010101, later = 0x10181c1e; // of a leaf and itself: k > i
    const bool wide = touch->edge_cells[a].number[SK_EDGES_WIDE];
    for (size_t i = 0; i < count; i++) {
        const uint32_t b = partner[i];
        fetch(touch->edge_cells[partner[i + AHEAD < count ? i + AHEAD : i]].number, ends > 1 ? 63 : 31);
        const int16_t *cells_of_b = touch->edge_cells[b].number;
        uint64_t asked = rows->all & each_row * ((1u << touch->skin.leaf[b].edges) - 1);
        asked &= rows->hot | each_row * touch->hot[b].edges;
        if (b == a) asked &= later;
        uint64_t met = edges_met(rows, cells_of_b, ends);
        if (wide | cells_of_b[SK_EDGES_WIDE]) met = wide_edges_met(touch, a, b);
        list->count = sk_list_bits(list->place, list->count, met & asked, rows->groups * ROWS * LANES,
                                   (uint32_t)i * SK_LEAVES_PAIRS);
    }
}

SK_INLINE void put_edges(const sk_touch *touch, sk_pairs *fresh, const met_list *list, uint32_t a,
                         const uint32_t *partner) {
    const sk_skin *skin = &touch->skin;
    const uint32_t(*const edge)[2] = (const uint32_t(*)[2])skin->edge,
                          (*const own)[2] = edge + skin->leaf[a].first_edge;
    const sk_leaf *leaf = skin->leaf;
    places to = places_of(fresh);
    for (size_t m = 0, all = list->count; m < all; m++) {
        const uint32_t place = list->place[m], i = place / LANES % LANES, k = place % LANES;
        const uint32_t b = partner[place / SK_LEAVES_PAIRS];
        const uint32_t *one = own[i], *two = edge[leaf[b].first_edge + k];
        const bool joined = (one[0] == two[0]) | (one[0] == two[1]) | (one[1] == two[0]) | (one[1] == two[1]);
        put(&to, !joined, sk_leaves_key(a, b) + SK_LEAF_EDGES * i + k, one[0], one[1], two[0], two[1]);
    }
    fresh->count = to.count;
}

SK_INLINE void meet_edges(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count,
                          int ends) {
    edge_rows rows;
    met_list list;
    set_edge_rows(&rows, touch, a, ends);
    for (size_t first = 0; first < count; first += SOME) {
        const size_t some = count - first < SOME ? count - first : SOME;
        list.count = 0;
        list_edges(touch, &list, &rows, a, partner + first, some, ends);
        put_edges(touch, fresh, &list, a, partner + first);
    }
}

void SK_KERNEL(edges)(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count) {
    if (touch->still) meet_edges(touch, fresh, a, partner, count, 1);
    else meet_edges(touch, fresh, a, partner, count, 2);
}

/* ---- corners ---- */

/* Two vertices of a leaf and its triangles in rows, as they are compared: v v w w s t s t. */
typedef struct corner_rows {
    cells number[SK_LEAF_VERTICES / 2][SK_CELL_ROWS];
} corner_rows;

/* Of a row of a leaf, which has four vertices and two triangles. */
SK_INLINE cells vertices_first(cells row, int pair) {
    return pair ? __builtin_shufflevector(row, row, 2, 2, 3, 3, 4, 5, 4, 5)
                : __builtin_shufflevector(row, row, 0, 0, 1, 1, 4, 5, 4, 5);
}

SK_INLINE cells triangles_first(cells row, int pair) {
    return pair ? __builtin_shufflevector(row, row, 4, 5, 4, 5, 2, 2, 3, 3)
                : __builtin_shufflevector(row, row, 4, 5, 4, 5, 0, 0, 1, 1);
}

/* Bits 2 i + k: vertex i of the one and triangle k of the other may meet; from 4 on, those of the other and of the one.
 */
SK_INLINE uint32_t corners_met(const corner_rows *a, const int16_t *b, int pair, int ends) {
    cells apart = {0};
    for (int k = 0; k < 3; k++) {
        cells above = ~(cells){0}, below = above;
        for (int low = k; low < ends * HALF; low += HALF) {
            const int high = low + HALF / 2;
            above &= triangles_first(load(b + SK_CELL_ROW(high, SK_LEAF_CORNERS)), pair) - a->number[pair][low];
            below &= a->number[pair][high] - triangles_first(load(b + SK_CELL_ROW(low, SK_LEAF_CORNERS)), pair);
        }
        apart |= above | below;
    }
    return ~negative(apart) & 0xff;
}

/* Bits 2 i + k of two leaves: vertex i of the one and triangle k of the other; and from 8 on, of the other and the one.
 */
SK_INLINE uint32_t all_corners_met(const corner_rows *a, const int16_t *b, bool many, int ends) {
    uint32_t met = corners_met(a, b, 0, ends), last = many ? corners_met(a, b, 1, ends) : 0;
    return (met & 0xf) | (met & 0xf0) << 4 | (last & 0xf) << 4 | (last & 0xf0) << 8;
}

static __attribute__((noinline)) uint32_t wide_corners_met(const sk_touch *touch, uint32_t a, uint32_t b) {
    const sk_leaf *one = &touch->skin.leaf[a], *two = &touch->skin.leaf[b];
    uint32_t met = 0;
    for (uint32_t i = 0; i < one->vertices; i++)
        for (uint32_t k = 0; k < two->triangles; k++)
            if (sk_boxes_meet(&touch->vertex_box[one->first_vertex + i], &touch->triangle_box[two->first_triangle + k]))
                met |= 1u << (2 * i + k);
    return met;
}

/* Which of these pairs there are, and of which one is looked for: by the numbers and the bits of vertices and
 * triangles. */
SK_INLINE uint32_t corners_asked(const sk_leaf *a, const sk_leaf *b, sk_hot hot_a, sk_hot hot_b) {
    static const uint8_t twice[16] = {0x00, 0x03, 0x0c, 0x0f, 0x30, 0x33, 0x3c, 0x3f,
                                      0xc0, 0xc3, 0xcc, 0xcf, 0xf0, 0xf3, 0xfc, 0xff};
    uint32_t all = twice[(1u << a->vertices) - 1] & 0x55 * ((1u << b->triangles) - 1);
    return all & (twice[hot_a.vertices] | 0x55 * (uint32_t)hot_b.triangles);
}

SK_INLINE void list_corners(const sk_touch *touch, met_list *list, const corner_rows *rows, uint32_t a,
                            const uint32_t *partner, size_t count, int ends) {
    const bool wide = touch->corner_cells[a].number[SK_CORNERS_WIDE];
    const sk_leaf one = touch->skin.leaf[a];
    const sk_hot hot = touch->hot[a];
    for (size_t i = 0; i < count; i++) {
        const uint32_t b = partner[i];
        fetch(touch->corner_cells[partner[i + AHEAD < count ? i + AHEAD : i]].number, ends > 1 ? 79 : 36);
        const sk_leaf *two = &touch->skin.leaf[b];
        const int16_t *cells_of_b = touch->corner_cells[b].number;
        const sk_hot hot_b = touch->hot[b];
        uint32_t asked = corners_asked(&one, two, hot, hot_b) | corners_asked(two, &one, hot_b, hot) << 8;
        if (b == a) asked &= 0xff;
        uint32_t met = all_corners_met(rows, cells_of_b, one.vertices > 2 || two->vertices > 2, ends);
        if (wide | cells_of_b[SK_CORNERS_WIDE])
            met = wide_corners_met(touch, a, b) | wide_corners_met(touch, b, a) << 8;
        list->count = sk_list_bits(list->place, list->count, met & asked, 2 * LANES, (uint32_t)i * SK_LEAVES_PAIRS);
    }
}

SK_INLINE void put_corners(const sk_touch *touch, sk_pairs *fresh, const met_list *list, uint32_t a,
                           const uint32_t *partner) {
    const sk_skin *skin = &touch->skin;
    const uint32_t(*const triangle)[3] = (const uint32_t(*)[3])skin->triangle;
    const sk_leaf *leaf = skin->leaf;
    places to = places_of(fresh);
    for (size_t m = 0, all = list->count; m < all; m++) {
        const uint32_t place = list->place[m], b = partner[place / SK_LEAVES_PAIRS], turned = place / 8 % 8;
        const uint32_t v = leaf[turned ? b : a].first_vertex + place / 2 % 4;
        const uint32_t *t = triangle[leaf[turned ? a : b].first_triangle + place % 2];
        const bool has = (v == t[0]) | (v == t[1]) | (v == t[2]);
        put(&to, !has, sk_leaves_key(a, b) + turned * (SK_LEAVES_PAIRS / 2) + place % 8, v, t[0], t[1], t[2]);
    }
    fresh->count = to.count;
}

SK_INLINE void meet_corners(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count,
                            int ends) {
    corner_rows rows;
    met_list list;
    for (int pair = 0; pair < SK_LEAF_VERTICES / 2; pair++)
        for (int r = 0; r < ends * HALF; r++)
            rows.number[pair][r] =
                vertices_first(load(touch->corner_cells[a].number + SK_CELL_ROW(r, SK_LEAF_CORNERS)), pair);
    for (size_t first = 0; first < count; first += SOME) {
        const size_t some = count - first < SOME ? count - first : SOME;
        list.count = 0;
        list_corners(touch, &list, &rows, a, partner + first, some, ends);
        put_corners(touch, fresh, &list, a, partner + first);
    }
}

void SK_KERNEL(corners)(const sk_touch *touch, sk_pairs *fresh, uint32_t a, const uint32_t *partner, size_t count) {
    if (touch->still) meet_corners(touch, fresh, a, partner, count, 1);
    else meet_corners(touch, fresh, a, partner, count, 2);
}
#else
sk_features_kernel *const sk_features[SK_PAIR_SORTS][SK_ISA_COUNT] = {SK_EACH_ISA(corners), SK_EACH_ISA(edges)};
#endif
