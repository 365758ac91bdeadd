/* The tree of leaves' boxes: its order is that of a curve through the bodies as they were built (Morton's), and never changes;
 * only boxes do. */
#include <string.h>

#include "contact/boxes.h"

/* Every third bit: those of a number of ten bits. */
static uint32_t spread(uint32_t a) {
    uint32_t all = 0;
    for (uint32_t bit = 0; bit < 10; bit++) all |= (a >> bit & 1) << (3 * bit);
    return all;
}

typedef struct curve {
    sk_vec3 low;
    real per; /* cells a metre */
} curve;

static curve curve_of(const sk_skin *skin) {
    curve c = {{SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX}, 0};
    sk_vec3 high = {-SK_REAL_MAX, -SK_REAL_MAX, -SK_REAL_MAX};
    for (size_t v = 0; v < skin->vertex_count; v++) {
        sk_vec4 b = skin->built[v];
        c.low = (sk_vec3){sk_min(c.low.x, b.x), sk_min(c.low.y, b.y), sk_min(c.low.z, b.z)};
        high = (sk_vec3){sk_max(high.x, b.x), sk_max(high.y, b.y), sk_max(high.z, b.z)};
    }
    real size = sk_max(high.x - c.low.x, sk_max(high.y - c.low.y, high.z - c.low.z));
    c.per = size > 0 ? (real)1023.0 / size : 0;
    return c;
}

/* A body's own number leads, so that bodies built in one place are apart. */
static uint64_t place_on(const curve *c, const sk_skin *skin, const sk_leaf *leaf) {
    uint32_t v = leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
    sk_vec4 b = skin->built[v];
    uint32_t x = (uint32_t)(sk_max(0, b.x - c->low.x) * c->per), y = (uint32_t)(sk_max(0, b.y - c->low.y) * c->per),
             z = (uint32_t)(sk_max(0, b.z - c->low.z) * c->per);
    return (uint64_t)skin->piece[v] << 30 | spread(x & 1023) | spread(y & 1023) << 1 | spread(z & 1023) << 2;
}

/* Sorts leaves by their places, which each go with the leaf: by bytes, least first. */
static void sort_by_place(uint64_t *place, uint32_t *leaf, uint64_t *other_place, uint32_t *other, size_t count) {
    for (int shift = 0; shift < 64; shift += 8) {
        size_t start[257] = {0};
        for (size_t i = 0; i < count; i++) start[(place[i] >> shift & 255) + 1]++;
        for (int i = 0; i < 256; i++) start[i + 1] += start[i];
        for (size_t i = 0; i < count; i++) {
            size_t to = start[place[i] >> shift & 255]++;
            other_place[to] = place[i], other[to] = leaf[i];
        }
        memcpy(place, other_place, count * sizeof *place);
        memcpy(leaf, other, count * sizeof *leaf);
    }
}

bool sk_tree_reserve(sk_tree *tree, sk_allocator *allocator, size_t count) {
    sk_tree_release(tree, allocator);
    bool good = true;
    for (size_t blocks = count; good;) {
        blocks = (blocks + SK_TREE_WIDTH - 1) / SK_TREE_WIDTH;
        if (!blocks) blocks = 1;
        tree->blocks[tree->levels] = blocks;
        good = (tree->block[tree->levels++] = sk_allocate(allocator, blocks * sizeof **tree->block)) != NULL;
        if (blocks == 1) break;
    }
    tree->leaf_at = sk_allocate(allocator, (count + 1) * sizeof *tree->leaf_at);
    for (size_t i = 0; i < count && tree->leaf_at; i++) tree->leaf_at[i] = (uint32_t)i;
    return good && tree->leaf_at;
}

bool sk_tree_make(sk_tree *tree, sk_allocator *allocator, const sk_skin *skin) {
    const size_t count = skin->leaf_count;
    bool good = sk_tree_reserve(tree, allocator, count);
    uint64_t *place = sk_allocate(allocator, 2 * (count + 1) * sizeof *place);
    uint32_t *other = sk_allocate(allocator, (count + 1) * sizeof *other);
    good = good && place && other;
    if (good) {
        curve c = curve_of(skin);
        for (size_t i = 0; i < count; i++) place[i] = place_on(&c, skin, &skin->leaf[i]);
        sort_by_place(place, tree->leaf_at, place + count, other, count);
    }
    sk_release(allocator, place);
    sk_release(allocator, other);
    return good;
}

void sk_tree_release(sk_tree *tree, sk_allocator *allocator) {
    for (int l = 0; l < tree->levels; l++) sk_release(allocator, tree->block[l]);
    sk_release(allocator, tree->leaf_at);
    *tree = (sk_tree){.levels = 0};
}
