/* Whom a box may meet, in a tree of boxes: sixteen at a time. */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT tree
SK_KERNELS(sk_tree_blocks_kernel, blocks);
SK_KERNELS(sk_tree_hits_kernel, hits);

#ifdef SK_ISA
#include "contact/lanes.h"

/* Bits of a block's lanes whose boxes may meet this one: along no axis does one lie above the other on one side, when
 * it begins and when it ends. */
SK_INLINE uint32_t boxes_met_at(const sk_tree_block *block, const sk_box *box, int ends) {
    uint32_t apart = 0;
    for (int part = 0; part < SK_PARTS; part++) {
        size_t l = (size_t)part * SK_PART;
        uint32_t bits = 0;
        for (int k = 0; k < 3; k++) {
            uint32_t above = ~0u, below = ~0u;
            for (int end = 0; end < ends; end++) {
                above &= sk_more_bits(*sk_row(&block->low[end][k][l]), sk_splat(box->high[end][k]));
                below &= sk_more_bits(sk_splat(box->low[end][k]), *sk_row(&block->high[end][k][l]));
            }
            bits |= above | below;
        }
        apart |= bits << l;
    }
    return ~apart & 0xffff;
}

SK_INLINE uint32_t boxes_met(const sk_tree *tree, const sk_tree_block *block, const sk_box *box) {
    return tree->still ? boxes_met_at(block, box, 1) : boxes_met_at(block, box, 2);
}

/* The box of a block of the lowest level. */
SK_INLINE sk_box box_of_block(const sk_tree *tree, size_t number) {
    const sk_tree_block *block = &tree->block[1][number / SK_TREE_WIDTH];
    size_t l = number % SK_TREE_WIDTH;
    sk_box box = {{{0}}, {{0}}};
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) box.low[end][k] = block->low[end][k][l], box.high[end][k] = block->high[end][k][l];
    return box;
}

size_t SK_KERNEL(blocks)(const sk_tree *tree, const sk_box *box, size_t first, uint32_t *block) {
    uint32_t left[SK_TREE_LEVELS]; // of each level: lanes that have not been gone down yet
    size_t at[SK_TREE_LEVELS], count = 0;
    int level = tree->levels - 1, top = level;
    if (!top) block[count++] = 0;
    if (!top) return count;
    at[level] = 0;
    left[level] = boxes_met(tree, &tree->block[level][0], box);
    for (;;) {
        if (level == 1)
            for (; left[1]; left[1] &= left[1] - 1) {
                block[count] = (uint32_t)(at[1] * SK_TREE_WIDTH) + (uint32_t)__builtin_ctz(left[1]);
                count += block[count] >= first;
            }
        while (level <= top && !left[level]) level++;
        if (level > top) return count;
        size_t below = at[level] * SK_TREE_WIDTH + (size_t)__builtin_ctz(left[level]);
        left[level] &= left[level] - 1;
        level--;
        at[level] = below;
        left[level] = boxes_met(tree, &tree->block[level][below], box);
    }
    return count;
}

size_t SK_KERNEL(hits)(const sk_tree *tree, size_t a, size_t b, uint32_t lanes, const sk_box *box, bool forward,
                       uint32_t *hit) {
    size_t count = 0;
    if (tree->levels > 1 && a != b) {
        sk_box around = box_of_block(tree, b);
        lanes &= boxes_met(tree, &tree->block[0][a], &around);
    }
    for (; lanes; lanes &= lanes - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(lanes);
        uint32_t bits = boxes_met(tree, &tree->block[0][b], &box[tree->leaf_at[a * SK_TREE_WIDTH + lane]]);
        if (forward && a == b) bits &= ~0u << lane;
        for (; bits; bits &= bits - 1) hit[count++] = lane << SK_TREE_SHIFT | (uint32_t)__builtin_ctz(bits);
    }
    return count;
}
#else
sk_tree_blocks_kernel *const sk_tree_blocks[SK_ISA_COUNT] = SK_EACH_ISA(blocks);
sk_tree_hits_kernel *const sk_tree_hits[SK_ISA_COUNT] = SK_EACH_ISA(hits);
#endif
