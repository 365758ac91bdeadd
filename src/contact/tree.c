/* Whom a box may meet, in a tree of boxes: sixteen at a time. */
#include "base/kernels.h"
#include "contact/touch.h"
#define SK_UNIT tree
SK_KERNELS(sk_tree_kernel, hits);

#ifdef SK_ISA

/* Of the axis' side where `low` lies above `high` when it begins and when it ends: bits of lanes. */
SK_INLINE uint32_t apart_above(const real *low_first, const real *low_last, real high_first, real high_last) {
    uint32_t first = sk_more_bits(*(const sk_wide *)(const void *)low_first, sk_splat(high_first));
    return first & sk_more_bits(*(const sk_wide *)(const void *)low_last, sk_splat(high_last));
}

SK_INLINE uint32_t apart_below(const real *high_first, const real *high_last, real low_first, real low_last) {
    uint32_t first = sk_more_bits(sk_splat(low_first), *(const sk_wide *)(const void *)high_first);
    return first & sk_more_bits(sk_splat(low_last), *(const sk_wide *)(const void *)high_last);
}

/* Bits of a block's lanes whose boxes may meet this one. */
SK_INLINE uint32_t boxes_met(const sk_tree_block *block, const sk_box *box) {
    uint32_t apart = 0;
    for (int part = 0; part < SK_PARTS; part++) {
        size_t l = (size_t)part * SK_PART;
        uint32_t bits = 0;
        for (int k = 0; k < 3; k++)
            bits |= apart_above(&block->low[0][k][l], &block->low[1][k][l], box->high[0][k], box->high[1][k]) |
                    apart_below(&block->high[0][k][l], &block->high[1][k][l], box->low[0][k], box->low[1][k]);
        apart |= bits << l;
    }
    return ~apart & 0xffff;
}

/* Bits of a level's block, without what lies below the first slot. */
SK_INLINE uint32_t boxes_met_from(const sk_tree *tree, int level, size_t number, const sk_box *box, size_t first) {
    size_t low = first / ((size_t)1 << SK_TREE_SHIFT * level), begins = number * SK_TREE_WIDTH;
    uint32_t bits = boxes_met(&tree->block[level][number], box);
    return begins < low ? bits & ~0u << (low - begins) : bits;
}

size_t SK_KERNEL(hits)(const sk_tree *tree, const sk_box *box, size_t first, uint32_t *slot) {
    uint32_t left[SK_TREE_LEVELS]; // of each level: lanes that have not been gone down yet
    size_t at[SK_TREE_LEVELS], count = 0;
    int level = tree->levels - 1, top = level;
    at[level] = 0;
    left[level] = boxes_met_from(tree, level, 0, box, first);
    for (;;) {
        if (!level)
            for (; left[0]; left[0] &= left[0] - 1)
                slot[count++] = (uint32_t)(at[0] * SK_TREE_WIDTH) + (uint32_t)__builtin_ctz(left[0]);
        while (level <= top && !left[level]) level++;
        if (level > top) return count;
        size_t below = at[level] * SK_TREE_WIDTH + (size_t)__builtin_ctz(left[level]);
        left[level] &= left[level] - 1;
        level--;
        at[level] = below;
        left[level] = boxes_met_from(tree, level, below, box, first);
    }
}
#else
sk_tree_kernel *const sk_tree_hits[SK_ISA_COUNT] = SK_EACH_ISA(hits);
#endif
