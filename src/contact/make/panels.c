/* Panels: some leaves that lie together. Of a sheet they are rectangles on its plane, of anything else what halving leaves. */
#include <math.h>
#include <string.h>

#include "contact/make/spread.h"

static void measure_leaves(making *m) {
    const sk_skin *skin = m->skin;
    for (size_t i = 0; i < skin->leaf_count; i++) {
        uint32_t corner[6];
        int count = corners_of_leaf(skin, &skin->leaf[i], corner);
        sk_vec3 sum = {0, 0, 0};
        m->of_leaf[i] = nowhere;
        for (int c = 0; c < count; c++) {
            sum = sk_add(sum, sk_xyz(skin->built[corner[c]]));
            m->of_leaf[i] = with_spot(m->of_leaf[i], m->spot[corner[c]]);
        }
        sum = sk_scale(1 / (real)count, sum);
        m->centre[i] = (sk_vec4){sum.x, sum.y, sum.z, 0};
    }
}

static real along_axis(const making *m, uint32_t leaf, int axis) {
    const sk_vec4 *c = &m->centre[leaf];
    return axis == 0 ? c->x : axis == 1 ? c->y : c->z;
}

/* Puts those that lie lowest along an axis first, so many of them. */
static void part_leaves(const making *m, uint32_t *leaf, size_t count, size_t first, int axis) {
    for (size_t low = 0, high = count - 1; low < high;) {
        real middle = along_axis(m, leaf[(low + high) / 2], axis);
        size_t i = low, k = high;
        while (i <= k) {
            while (along_axis(m, leaf[i], axis) < middle) i++;
            while (along_axis(m, leaf[k], axis) > middle) k--;
            if (i > k) break;
            uint32_t other = leaf[i];
            leaf[i] = leaf[k], leaf[k] = other;
            i++;
            if (!k) break;
            k--;
        }
        if (first <= k) high = k;
        else if (first >= i) low = i;
        else return;
    }
}

/* Halves leaves, across the longest axis, until there are few enough. */
static void split(making *m, uint32_t *leaf, size_t count) {
    if (count <= 2 * SK_PANEL_LEAVES) {
        sk_spread *spread = m->spread;
        for (size_t i = 0; i < count; i++) spread->of_leaf[leaf[i]] = (uint32_t)spread->count;
        spread->leaves.start[++spread->count] = (uint32_t)(leaf + count - spread->leaves.number);
        return;
    }
    sk_vec3 low = sk_xyz(m->centre[leaf[0]]), high = low;
    for (size_t i = 1; i < count; i++) {
        sk_vec3 c = sk_xyz(m->centre[leaf[i]]);
        low = (sk_vec3){sk_min(low.x, c.x), sk_min(low.y, c.y), sk_min(low.z, c.z)};
        high = (sk_vec3){sk_max(high.x, c.x), sk_max(high.y, c.y), sk_max(high.z, c.z)};
    }
    sk_vec3 wide = sk_sub(high, low);
    int axis = wide.x >= wide.y && wide.x >= wide.z ? 0 : wide.y >= wide.z ? 1 : 2;
    const size_t first = count / 2;
    part_leaves(m, leaf, count, first, axis);
    split(m, leaf, first);
    split(m, leaf + first, count - first);
}

/* Rectangles of one size on a sheet's plane, some of which follow each other lie together: those of a square of them. */
typedef struct bins {
    rectangle all;
    size_t across, along;
    uint32_t *start;
} bins;
enum { BINS_SQUARE = 4 };

static bin bin_of(const bins *b, const rectangle *leaf) {
    real wide = b->all.high.u - b->all.low.u, high = b->all.high.v - b->all.low.v;
    real u = ((real)0.5 * (leaf->low.u + leaf->high.u) - b->all.low.u) / wide;
    real v = ((real)0.5 * (leaf->low.v + leaf->high.v) - b->all.low.v) / high;
    size_t i = (size_t)(u * (real)b->across), k = (size_t)(v * (real)b->along);
    return (bin){(uint32_t)(i < b->across ? i : b->across - 1), (uint32_t)(k < b->along ? k : b->along - 1)};
}

static size_t place_of(const bins *b, bin at) {
    const size_t square = BINS_SQUARE * BINS_SQUARE, squares = (b->across + BINS_SQUARE - 1) / BINS_SQUARE;
    return (at.v / BINS_SQUARE * squares + at.u / BINS_SQUARE) * square + at.v % BINS_SQUARE * BINS_SQUARE +
           at.u % BINS_SQUARE;
}

static size_t bins_along(real wide, real side) {
    real count = wide / side + (real)0.5;
    return count > 1 ? (size_t)count : 1;
}

/* Of a sheet, panels are rectangles, so that those beside each other are few: ways between them lead through no others. */
static bool deal_sheet(making *m, uint32_t *leaf, size_t count) {
    bins b = {.all = nowhere};
    double area = 0;
    for (size_t i = 0; i < count; i++) {
        const sk_leaf *of = &m->skin->leaf[leaf[i]];
        b.all = with_rectangle(b.all, &m->of_leaf[leaf[i]]);
        for (uint32_t t = of->first_triangle; t < of->first_triangle + of->triangles; t++)
            area += 0.5 * (double)sk_length(cross_of(m->skin, m->skin->triangle[t]));
    }
    const real side = (real)sqrt(SK_PANEL_LEAVES * area / (double)count);
    b.across = bins_along(b.all.high.u - b.all.low.u, side), b.along = bins_along(b.all.high.v - b.all.low.v, side);
    if (b.across > 4 * count || b.along > 4 * count ||
        b.across * b.along > 4 * count + 64) { // a sheet with next to no area in its rectangle
        m->flat[m->skin->piece[corner_of(m->skin, &m->skin->leaf[leaf[0]])]] = 0;
        split(m, leaf, count);
        return true;
    }
    const size_t squares = (b.across + BINS_SQUARE - 1) / BINS_SQUARE * ((b.along + BINS_SQUARE - 1) / BINS_SQUARE);
    const size_t all = squares * BINS_SQUARE * BINS_SQUARE;
    b.start = sk_allocate(m->allocator, (all + 1) * sizeof *b.start);
    uint32_t *dealt = sk_allocate(m->allocator, (count + 1) * sizeof *dealt);
    if (b.start && dealt) {
        for (size_t i = 0; i < count; i++) b.start[place_of(&b, bin_of(&b, &m->of_leaf[leaf[i]])) + 1]++;
        for (size_t i = 0; i < all; i++) b.start[i + 1] += b.start[i];
        for (size_t i = 0; i < count; i++) dealt[b.start[place_of(&b, bin_of(&b, &m->of_leaf[leaf[i]]))]++] = leaf[i];
        memcpy(leaf, dealt, count * sizeof *leaf);
        for (size_t i = 0, first = 0; i < all; first = b.start[i++]) {
            size_t panel = m->spread->count;
            if (b.start[i] > first) split(m, leaf + first, b.start[i] - first);
            for (; panel < m->spread->count; panel++) m->bin[panel] = bin_of(&b, &m->of_leaf[leaf[first]]);
        }
    }
    bool good = b.start && dealt;
    sk_release(m->allocator, b.start);
    sk_release(m->allocator, dealt);
    return good;
}

bool sk_panels_deal(making *m) {
    measure_leaves(m);
    const sk_skin *skin = m->skin;
    sk_spread *spread = m->spread;
    size_t leaves = skin->leaf_count;
    bool good = true;
    uint32_t *start = sk_allocate(m->allocator, (skin->vertex_count + 2) * sizeof *start);
    if (!start) return false;
    for (size_t i = 0; i < leaves; i++) start[skin->piece[corner_of(skin, &skin->leaf[i])] + 1]++;
    for (size_t v = 0; v < skin->vertex_count; v++) start[v + 1] += start[v];
    for (size_t i = 0; i < leaves; i++)
        spread->leaves.number[start[skin->piece[corner_of(skin, &skin->leaf[i])]]++] = (uint32_t)i;
    for (size_t v = 0, first = 0; v < skin->vertex_count && good; first = start[v++]) {
        if (start[v] == first) continue;
        if (m->flat[v]) good = deal_sheet(m, spread->leaves.number + first, start[v] - first);
        else split(m, spread->leaves.number + first, start[v] - first);
    }
    sk_release(m->allocator, start);
    return good;
}

/* J = [d1 d2] / [u1 u2]: both d change by up to two ways. */
static real steep_of(const making *m, const uint32_t t[3]) {
    spot o = m->spot[t[0]], a = m->spot[t[1]], b = m->spot[t[2]];
    real x1 = a.u - o.u, y1 = a.v - o.v, x2 = b.u - o.u, y2 = b.v - o.v, det = sk_abs(x1 * y2 - x2 * y1);
    return det > 0 ? (real)2.83 * sk_sqrt(x1 * x1 + y1 * y1 + x2 * x2 + y2 * y2) / det : SK_REAL_MAX;
}

void sk_panels_measure(making *m) {
    const sk_skin *skin = m->skin;
    const sk_spread *spread = m->spread;
    for (size_t p = 0; p < spread->count; p++) {
        m->of_panel[p] = nowhere;
        for (uint32_t i = spread->leaves.start[p]; i < spread->leaves.start[p + 1]; i++) {
            const sk_leaf *leaf = &skin->leaf[spread->leaves.number[i]];
            m->of_panel[p] = with_rectangle(m->of_panel[p], &m->of_leaf[spread->leaves.number[i]]);
            uint32_t corner[6];
            int count = corners_of_leaf(skin, leaf, corner);
            for (int a = 0; a < count; a++)
                for (int b = 0; b < a; b++)
                    if (a / 3 == b / 3)
                        m->longest[p] = sk_max(m->longest[p], sk_length(side(skin, corner[a], corner[b])));
            for (int t = 0; t + 2 < count; t += 3) m->steep[p] = sk_max(m->steep[p], steep_of(m, corner + t));
        }
    }
}
