/* The tree of leaves' boxes: its order is that of a curve through the bodies as they were built (Morton's), and never changes;
 * only boxes do. */
#include "contact/make/curve.h"
#include "contact/search/boxes.h"

static sk_curve curve_of(const sk_skin *skin) {
    sk_vec3 low = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX}, high = {-SK_REAL_MAX, -SK_REAL_MAX, -SK_REAL_MAX};
    for (size_t v = 0; v < skin->vertex_count; v++) {
        sk_vec4 b = skin->built[v];
        low = (sk_vec3){sk_min(low.x, b.x), sk_min(low.y, b.y), sk_min(low.z, b.z)};
        high = (sk_vec3){sk_max(high.x, b.x), sk_max(high.y, b.y), sk_max(high.z, b.z)};
    }
    return sk_curve_through(low, high);
}

/* A body's own number leads, so that bodies built in one place are apart. */
static uint64_t place_on(const sk_curve *c, const sk_skin *skin, const sk_leaf *leaf) {
    uint32_t v = leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
    return (uint64_t)skin->piece[v] << 30 | sk_curve_place(c, sk_xyz(skin->built[v]));
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
        const sk_curve c = curve_of(skin);
        for (size_t i = 0; i < count; i++) place[i] = place_on(&c, skin, &skin->leaf[i]);
        sk_sort_by_place(place, tree->leaf_at, place + count, other, count);
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
