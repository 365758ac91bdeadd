/* Boxes of what goes on, of features and of leaves, in quads, in cells and in a tree: what a search compares first. */
#ifndef SK_CONTACT_BOXES_H
#define SK_CONTACT_BOXES_H

#include "base/isa.h"
#include "base/quad.h"
#include "base/wide_types.h"
#include "contact/skin.h"
#if defined(__wasm_simd128__) && !defined(SKEIN_DOUBLE)
#include <wasm_simd128.h>
#define SK_QUADS_OF_WASM
#elif defined(__SSE__) && !defined(SKEIN_DOUBLE)
#include <immintrin.h>
#define SK_QUADS_OF_SSE
#endif
typedef sk_lane_int sk_quad_lanes __attribute__((vector_size(4 * sizeof(real))));

/* A box that goes on: where it is when it begins, and when it ends. In between its sides are no farther out than on a
 * straight way. */
typedef struct sk_box {
    sk_quad low[2], high[2];
} sk_box;

/* The less and the more of each lane; of what is no number, the second. (Lane by lane, compilers shuffle: a heap's boxes took twice as long for
 * gcc, and five times so for WebAssembly.) */
static inline sk_quad sk_least_quad(sk_quad a, sk_quad b) {
#if defined(SK_QUADS_OF_WASM)
    return (sk_quad)wasm_f32x4_pmin((v128_t)b, (v128_t)a); // a where it is less
#elif defined(SK_QUADS_OF_SSE)
    return (sk_quad)_mm_min_ps((__m128)a, (__m128)b);
#else
    const sk_quad_lanes less = a < b;
    return (sk_quad)((less & (sk_quad_lanes)a) | (~less & (sk_quad_lanes)b));
#endif
}

static inline sk_quad sk_most_quad(sk_quad a, sk_quad b) {
#if defined(SK_QUADS_OF_WASM)
    return (sk_quad)wasm_f32x4_pmax((v128_t)b, (v128_t)a);
#elif defined(SK_QUADS_OF_SSE)
    return (sk_quad)_mm_max_ps((__m128)a, (__m128)b);
#else
    const sk_quad_lanes more = a > b;
    return (sk_quad)((more & (sk_quad_lanes)a) | (~more & (sk_quad_lanes)b));
#endif
}

/* Makes a box so wide that it has another one inside. */
static inline void sk_box_widen(sk_box *box, const sk_box *by) {
    for (int end = 0; end < 2; end++) {
        box->low[end] = sk_least_quad(box->low[end], by->low[end]);
        box->high[end] = sk_most_quad(box->high[end], by->high[end]);
    }
}

/* Boxes of a leaf's features, for many to be compared at once: in cells, features side by side. Of a cell's number the last
 * sixteen bits are kept: leaves are a quarter of that wide at most, and what two of them that meet are apart is half of it, so
 * that a difference is right where numbers wrap around. At each end there are six rows: low ones along each axis, and
 * high ones. Leaves that are wider (`wide`) are compared by their boxes. */
enum {
    SK_CELL_ROWS = 12,
    SK_LEAF_EDGES = 5,
    SK_LEAF_VERTICES = 4,
    SK_LEAF_CORNERS = SK_LEAF_VERTICES + 2, /* vertices, and triangles */
    SK_WIDEST_LEAF = (1 << 14) - 1,         /* cells */
/* where a row begins that has so many numbers; after those of the first end, it stands whether the leaf is too wide */
#define SK_CELL_ROW(row, numbers) ((row) * (numbers) + ((row) >= SK_CELL_ROWS / 2))
    SK_EDGES_WIDE = SK_CELL_ROWS / 2 * SK_LEAF_EDGES,
    SK_CORNERS_WIDE = SK_CELL_ROWS / 2 * SK_LEAF_CORNERS
};
typedef struct sk_edge_cells {
    _Alignas(64) int16_t number[64]; /* (eight are read of each row) */
} sk_edge_cells;
typedef struct sk_corner_cells {
    _Alignas(32) int16_t number[80];
} sk_corner_cells;

/* Boxes of leaves, and of sixteen of those below, up to one: by slots, in which leaves that were built near each other
 * are near. Sixteen slots are a block. */
enum { SK_TREE_LEVELS = 9, SK_TREE_SHIFT = 4, SK_TREE_WIDTH = 1 << SK_TREE_SHIFT };
typedef struct sk_tree_block {
    _Alignas(64) real low[2][3][SK_TREE_WIDTH], high[2][3][SK_TREE_WIDTH];
} sk_tree_block;
/* The box around a block's boxes. */
static inline sk_box sk_box_around(const sk_tree_block *block) {
    sk_box box = {{{0}}, {{0}}};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            sk_quad low[4], high[4];
            memcpy(low, block->low[end][k], sizeof low);
            memcpy(high, block->high[end][k], sizeof high);
            const sk_quad least = sk_least_quad(sk_least_quad(low[0], low[1]), sk_least_quad(low[2], low[3]));
            const sk_quad most = sk_most_quad(sk_most_quad(high[0], high[1]), sk_most_quad(high[2], high[3]));
            box.low[end][k] = sk_min(sk_min(least[0], least[1]), sk_min(least[2], least[3]));
            box.high[end][k] = sk_max(sk_max(most[0], most[1]), sk_max(most[2], most[3]));
        }
    return box;
}

typedef struct sk_tree {
    sk_tree_block *block[SK_TREE_LEVELS];
    size_t blocks[SK_TREE_LEVELS]; /* of each level; the last one has one */
    int levels;
    uint32_t *leaf_at; /* of slots */
    bool still;        /* boxes end where they begin */
} sk_tree;
/* Lists the blocks of the lowest level, from the first one on, that a box may meet at some time. */
typedef size_t sk_tree_blocks_kernel(const sk_tree *tree, const sk_box *box, size_t first, uint32_t *block);
/* Lists who of some lanes of block a may meet whom of block b, or of later lanes than their own if asked for: the lane of a,
 * and behind it in four bits that of b. Boxes of the former are those of leaves. At most SK_TREE_WIDTH squared. */
typedef size_t sk_tree_hits_kernel(const sk_tree *tree, size_t a, size_t b, uint32_t lanes, const sk_box *box,
                                   bool forward, uint32_t *hit);

/* Whether two boxes may meet at some time. */
static inline bool sk_boxes_meet(const sk_box *a, const sk_box *b) {
    const sk_quad_lanes apart =
        ((a->low[0] > b->high[0]) & (a->low[1] > b->high[1])) | ((b->low[0] > a->high[0]) & (b->low[1] > a->high[1]));
    return !(apart[0] | apart[1] | apart[2]);
}

/* ---- tree.c ---- */

extern sk_tree_blocks_kernel *const sk_tree_blocks[SK_ISA_COUNT];
extern sk_tree_hits_kernel *const sk_tree_hits[SK_ISA_COUNT];

/* ---- make/tree.c ---- */

/* Room for a tree of so many, each in its own slot. False when there is no memory. */
bool sk_tree_reserve(sk_tree *tree, sk_allocator *allocator, size_t count);
/* That of a skin's leaves. */
bool sk_tree_make(sk_tree *tree, sk_allocator *allocator, const sk_skin *skin);
void sk_tree_release(sk_tree *tree, sk_allocator *allocator);

#endif
