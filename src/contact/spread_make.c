/* Lists of panels: which leaves they have, which lie beside and around them, and whether a border lies between. Made with
 * the skin, once; nothing where no sheet was built flat. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact/touch.h"

#define NOBODY UINT32_MAX

/* A place on a sheet's plane, and a rectangle on it. */
typedef struct spot {
    real u, v;
} spot;
typedef struct rectangle {
    spot low, high;
} rectangle;

typedef struct numbers {
    uint32_t *data;
    size_t count, capacity;
} numbers;

/* A panel by where it begins along the first axis. */
typedef struct beginning {
    real low;
    uint32_t panel;
} beginning;

/* Where a rectangle is, among those of a sheet. */
typedef struct bin {
    uint32_t u, v;
} bin;

/* What is needed while panels are made. */
typedef struct making {
    const sk_skin *skin;
    sk_spread *spread;
    sk_allocator *allocator;
    double (*normal)[3]; /* of pieces, by their numbers: their normals, */
    sk_vec4 *along;      /* and a direction on their planes */
    uint8_t *flat;           /* whether they are */
    uint8_t *border;         /* edges that have one triangle */
    spot *spot;              /* of vertices */
    sk_vec4 *centre;         /* of leaves */
    rectangle *of_leaf, *of_panel;
    real *longest;           /* edge of a panel */
    real *steep;             /* 1/m: how much J of its triangles changes with its corners, at most; */
    real *apart;             /* and the least between its features and those beside it */
    bin *bin;                /* of panels: which, on their sheet */
    beginning *order;        /* of a piece's panels */
    uint32_t *in_bin;        /* and these by their bins */
    numbers beside, members, around, starts[2]; /* of members, and around */
    struct {
        sk_panel_block *data;
        size_t count, capacity;
    } block;
    spot *point, *hull; /* of all members of one */
    size_t point_capacity;
} making;

/* ---- flat pieces ---- */

static uint32_t corner_of(const sk_skin *skin, const sk_leaf *leaf) {
    return leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
}

static sk_vec3 side(const sk_skin *skin, uint32_t a, uint32_t b) {
    return sk_sub(sk_xyz(skin->built[b]), sk_xyz(skin->built[a]));
}

static sk_vec3 cross_of(const sk_skin *skin, const uint32_t t[3]) {
    return sk_cross(side(skin, t[0], t[1]), side(skin, t[0], t[2]));
}

/* How many triangles an edge has. */
static int faces_of(const sk_skin *skin, const uint32_t edge[2]) {
    uint32_t a = edge[0], b = edge[1];
    if (skin->leaf_start[a + 1] - skin->leaf_start[a] > skin->leaf_start[b + 1] - skin->leaf_start[b]) a = edge[1], b = edge[0];
    int count = 0;
    for (uint32_t i = skin->leaf_start[a]; i < skin->leaf_start[a + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++) {
            const uint32_t *v = skin->triangle[t];
            count += (v[0] == a || v[1] == a || v[2] == a) && (v[0] == b || v[1] == b || v[2] == b);
        }
    }
    return count;
}

static sk_vec3 unit(double x, double y, double z) {
    double length = sqrt(x * x + y * y + z * z), share = length > 0 ? 1 / length : 0;
    return (sk_vec3){(real)(share * x), (real)(share * y), (real)(share * z)};
}

static sk_vec3 normal_of(const making *m, uint32_t piece) {
    const double *sum = m->normal[piece];
    return unit(sum[0], sum[1], sum[2]);
}

/* Finds the pieces that are flat, with all triangles on the same side, and where their vertices are on their planes. */
static bool find_flat(making *m) {
    const sk_skin *skin = m->skin;
    const real off = (real)1e-2 * skin->longest, thin = (real)1e-3;
    bool any = false;
    memset(m->flat, 1, skin->vertex_count);
    for (size_t t = 0; t < skin->triangle_count; t++) {
        const uint32_t *v = skin->triangle[t];
        sk_vec3 cross = cross_of(skin, v);
        double *sum = m->normal[skin->piece[v[0]]];
        sum[0] += (double)cross.x, sum[1] += (double)cross.y, sum[2] += (double)cross.z;
    }
    for (size_t e = 0; e < skin->edge_count; e++) { // along a border, as a rectangle's rows and columns are
        const uint32_t *edge = skin->edge[e], piece = skin->piece[edge[0]];
        int faces = faces_of(skin, edge);
        m->border[e] = faces < 2;
        if (faces > 2) m->flat[piece] = 0;
        sk_vec3 along = side(skin, edge[0], edge[1]);
        if (faces == 1) m->along[piece] = (sk_vec4){along.x, along.y, along.z, 0};
    }
    for (size_t i = 0; i < skin->leaf_count; i++)
        if (!skin->leaf[i].triangles) m->flat[skin->piece[corner_of(skin, &skin->leaf[i])]] = 0;
    for (size_t v = 0; v < skin->vertex_count; v++) {
        const uint32_t piece = skin->piece[v];
        const sk_vec4 *a = &m->along[piece];
        sk_vec3 n = normal_of(m, piece), r = side(skin, piece, (uint32_t)v), along = unit((double)a->x, (double)a->y, (double)a->z);
        if (!(sk_abs(sk_dot(n, r)) <= off)) m->flat[piece] = 0;
        m->spot[v] = (spot){sk_dot(along, r), sk_dot(sk_cross(n, along), r)};
    }
    for (size_t t = 0; t < skin->triangle_count; t++) {
        const uint32_t *v = skin->triangle[t];
        sk_vec3 cross = cross_of(skin, v), a = side(skin, v[0], v[1]), b = side(skin, v[0], v[2]);
        real least = thin * sk_max(sk_dot(a, a), sk_dot(b, b));
        if (!(sk_dot(cross, normal_of(m, skin->piece[v[0]])) > least)) m->flat[skin->piece[v[0]]] = 0;
    }
    for (size_t i = 0; i < skin->leaf_count; i++) any |= m->flat[skin->piece[corner_of(skin, &skin->leaf[i])]];
    return any;
}

/* ---- leaves of panels ---- */

static int corners_of_leaf(const sk_skin *skin, const sk_leaf *leaf, uint32_t corner[6]) {
    int count = 0;
    for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++)
        for (int c = 0; c < 3; c++) corner[count++] = skin->triangle[t][c];
    for (int c = 0; c < 2 && !leaf->triangles; c++) corner[count++] = skin->edge[leaf->first_edge][c];
    return count;
}

static rectangle with_spot(rectangle r, spot s) {
    return (rectangle){{sk_min(r.low.u, s.u), sk_min(r.low.v, s.v)}, {sk_max(r.high.u, s.u), sk_max(r.high.v, s.v)}};
}

static rectangle with_rectangle(rectangle r, const rectangle *other) {
    return with_spot(with_spot(r, other->low), other->high);
}

static const rectangle nowhere = {{SK_REAL_MAX, SK_REAL_MAX}, {-SK_REAL_MAX, -SK_REAL_MAX}};

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
    return (at.v / BINS_SQUARE * squares + at.u / BINS_SQUARE) * square + at.v % BINS_SQUARE * BINS_SQUARE + at.u % BINS_SQUARE;
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
    if (b.across > 4 * count || b.along > 4 * count || b.across * b.along > 4 * count + 64) { // a sheet with next to no area in its rectangle
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

/* Deals leaves to panels, one piece after the other. */
static bool deal_leaves(making *m) {
    const sk_skin *skin = m->skin;
    sk_spread *spread = m->spread;
    size_t leaves = skin->leaf_count;
    bool good = true;
    uint32_t *start = sk_allocate(m->allocator, (skin->vertex_count + 2) * sizeof *start);
    if (!start) return false;
    for (size_t i = 0; i < leaves; i++) start[skin->piece[corner_of(skin, &skin->leaf[i])] + 1]++;
    for (size_t v = 0; v < skin->vertex_count; v++) start[v + 1] += start[v];
    for (size_t i = 0; i < leaves; i++) spread->leaves.number[start[skin->piece[corner_of(skin, &skin->leaf[i])]]++] = (uint32_t)i;
    for (size_t v = 0, first = 0; v < skin->vertex_count && good; first = start[v++]) {
        if (start[v] == first) continue;
        if (m->flat[v]) good = deal_sheet(m, spread->leaves.number + first, start[v] - first);
        else split(m, spread->leaves.number + first, start[v] - first);
    }
    sk_release(m->allocator, start);
    return good;
}

/* ---- what lies around a panel ---- */

static uint32_t piece_of_panel(const making *m, size_t p) {
    const sk_skin *skin = m->skin;
    return skin->piece[corner_of(skin, &skin->leaf[m->spread->leaves.number[m->spread->leaves.start[p]]])];
}

/* J = [d1 d2] / [u1 u2]: both d change by up to two ways. */
static real steep_of(const making *m, const uint32_t t[3]) {
    spot o = m->spot[t[0]], a = m->spot[t[1]], b = m->spot[t[2]];
    real x1 = a.u - o.u, y1 = a.v - o.v, x2 = b.u - o.u, y2 = b.v - o.v, det = sk_abs(x1 * y2 - x2 * y1);
    return det > 0 ? (real)2.83 * sk_sqrt(x1 * x1 + y1 * y1 + x2 * x2 + y2 * y2) / det : SK_REAL_MAX;
}

static void measure_panels(making *m) {
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
                    if (a / 3 == b / 3) m->longest[p] = sk_max(m->longest[p], sk_length(side(skin, corner[a], corner[b])));
            for (int t = 0; t + 2 < count; t += 3) m->steep[p] = sk_max(m->steep[p], steep_of(m, corner + t));
        }
    }
}

static int compare_beginnings(const void *a, const void *b) {
    const beginning *one = a, *two = b;
    if (one->low < two->low || two->low < one->low) return one->low < two->low ? -1 : 1;
    return (one->panel > two->panel) - (one->panel < two->panel);
}

/* Adds the panels, of `count` in order of which none is wider than that, that have a part in a rectangle. */
static bool list_in(const making *m, const rectangle *r, size_t count, real widest, real margin, numbers *list) {
    size_t first = 0, end = count;
    while (first < end) {
        size_t middle = (first + end) / 2;
        if (m->order[middle].low < r->low.u - widest - margin) first = middle + 1;
        else end = middle;
    }
    for (; first < count && m->order[first].low <= r->high.u + margin; first++) {
        const rectangle *other = &m->of_panel[m->order[first].panel];
        if (other->high.u < r->low.u - margin || other->high.v < r->low.v - margin || other->low.v > r->high.v + margin) continue;
        if (!SK_RESERVE(m->allocator, list, list->count + 1)) return false;
        list->data[list->count++] = m->order[first].panel;
    }
    return true;
}

static real turn_of(spot a, spot b, spot c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

static int compare_spots(const void *a, const void *b) {
    const spot *one = a, *two = b;
    if (one->u < two->u || two->u < one->u) return one->u < two->u ? -1 : 1;
    return (one->v > two->v) - (one->v < two->v);
}

/* The convex hull of points (Andrew's chains), anticlockwise; how many corners it has. */
static size_t find_hull(spot *point, size_t count, spot *hull) {
    size_t n = 0;
    qsort(point, count, sizeof *point, compare_spots);
    for (size_t i = 0; i < count; hull[n++] = point[i++])
        while (n > 1 && turn_of(hull[n - 2], hull[n - 1], point[i]) <= 0) n--;
    for (size_t i = count - 1, lower = n; i-- > 0; hull[n++] = point[i])
        while (n > lower && turn_of(hull[n - 2], hull[n - 1], point[i]) <= 0) n--;
    return n ? n - 1 : 0; // the first one comes again
}

/* Whether a line has a part inside a hull, farther in than a margin. */
static bool is_inside(const spot *hull, size_t count, spot a, spot b, real margin) {
    real from = 0, to = 1;
    for (size_t i = 0; i < count; i++) {
        spot c = hull[i], d = hull[(i + 1) % count];
        real length = sk_sqrt((d.u - c.u) * (d.u - c.u) + (d.v - c.v) * (d.v - c.v));
        if (!(length > 0)) continue;
        real first = turn_of(c, d, a) / length - margin, last = turn_of(c, d, b) / length - margin;
        if (first < 0 && last < 0) return false;
        if (first < 0) from = sk_max(from, first / (first - last));
        if (last < 0) to = sk_min(to, first / (first - last));
    }
    return from < to;
}

/* Whether ways between those beside a panel stay on the sheet: no border of it lies in the hull of all these, and it
 * does not lie upon itself. */
static bool is_whole(making *m, const uint32_t *member, size_t members, const uint32_t *around, size_t arounds,
                     bool *no_memory) {
    const sk_skin *skin = m->skin;
    const sk_spread *spread = m->spread;
    const real margin = (real)1e-3 * skin->longest, full = (real)1.0001;
    bool bordered = false;
    rectangle all = nowhere;
    double area = 0;
    for (size_t i = 0; i < arounds; i++)
        for (uint32_t k = spread->leaves.start[around[i]]; k < spread->leaves.start[around[i] + 1]; k++) {
            const sk_leaf *leaf = &skin->leaf[spread->leaves.number[k]];
            all = with_rectangle(all, &m->of_leaf[spread->leaves.number[k]]);
            for (uint32_t e = leaf->first_edge; e < leaf->first_edge + leaf->edges; e++) bordered |= m->border[e];
            for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++) {
                const uint32_t *v = skin->triangle[t];
                area += 0.5 * (double)turn_of(m->spot[v[0]], m->spot[v[1]], m->spot[v[2]]);
            }
        }
    if (area > (double)(full * (all.high.u - all.low.u) * (all.high.v - all.low.v))) return false;
    if (!bordered) return true;
    size_t points = 0;
    for (size_t i = 0; i < members; i++)
        for (uint32_t k = spread->leaves.start[member[i]]; k < spread->leaves.start[member[i] + 1]; k++) {
            uint32_t corner[6];
            int count = corners_of_leaf(skin, &skin->leaf[spread->leaves.number[k]], corner);
            if (points + 6 > m->point_capacity) {
                size_t need = 2 * m->point_capacity + 1024;
                spot *point = sk_allocate(m->allocator, need * sizeof *point);
                spot *hull = sk_allocate(m->allocator, (need + 2) * sizeof *hull);
                if (point && points) memcpy(point, m->point, points * sizeof *point);
                sk_release(m->allocator, m->point);
                sk_release(m->allocator, m->hull);
                m->point = point, m->hull = hull;
                m->point_capacity = need;
                *no_memory = !point || !hull;
                if (*no_memory) return false;
            }
            for (int c = 0; c < count; c++) m->point[points++] = m->spot[corner[c]];
        }
    size_t hull = find_hull(m->point, points, m->hull);
    for (size_t i = 0; i < arounds; i++)
        for (uint32_t k = spread->leaves.start[around[i]]; k < spread->leaves.start[around[i] + 1]; k++) {
            const sk_leaf *leaf = &skin->leaf[spread->leaves.number[k]];
            for (uint32_t e = leaf->first_edge; e < leaf->first_edge + leaf->edges; e++)
                if (m->border[e] && is_inside(m->hull, hull, m->spot[skin->edge[e][0]], m->spot[skin->edge[e][1]], margin)) return false;
        }
    return true;
}

/* The square of how far a point is from an edge. */
static real square_off(spot p, spot a, spot b) {
    real u = b.u - a.u, v = b.v - a.v, square = u * u + v * v;
    real t = square > 0 ? sk_max(0, sk_min(1, ((p.u - a.u) * u + (p.v - a.v) * v) / square)) : 0;
    real x = p.u - a.u - t * u, y = p.v - a.v - t * v;
    return x * x + y * y;
}

/* Corners of a leaf: of the edge that two triangles share, and the third of each; of one triangle this comes twice, and of an
 * edge its first end. */
static void corners_in_row(const sk_skin *skin, const sk_leaf *leaf, uint32_t corner[4]) {
    if (!leaf->triangles) {
        const uint32_t *edge = skin->edge[leaf->first_edge];
        corner[0] = edge[0], corner[1] = edge[1], corner[2] = corner[3] = edge[0];
        return;
    }
    const uint32_t *t = skin->triangle[leaf->first_triangle], *s = leaf->triangles > 1 ? skin->triangle[leaf->first_triangle + 1] : t;
    int third = 0;
    uint32_t other = t[0];
    for (int k = 0; k < 3 && s != t; k++) {
        if (t[k] != s[0] && t[k] != s[1] && t[k] != s[2]) third = k;
        if (s[k] != t[0] && s[k] != t[1] && s[k] != t[2]) other = s[k];
    }
    corner[0] = t[(third + 1) % 3], corner[1] = t[(third + 2) % 3], corner[2] = t[third], corner[3] = s == t ? t[third] : other;
}

/* The least square of how far a corner of one leaf is from an edge of another that does not have it. On a plane no features are
 * nearer to each other. */
static real square_between(const making *m, const uint32_t a[4], const uint32_t b[4], real least) {
    static const int ends[5][2] = {{0, 1}, {0, 2}, {1, 2}, {0, 3}, {1, 3}};
    const int edges = b[2] == b[3] ? 3 : 5, corners = a[2] == a[3] ? 3 : 4;
    for (int e = 0; e < edges; e++) {
        const uint32_t c = b[ends[e][0]], d = b[ends[e][1]];
        for (int i = 0; i < corners; i++)
            if (a[i] != c && a[i] != d) least = sk_min(least, square_off(m->spot[a[i]], m->spot[c], m->spot[d]));
    }
    return least;
}

static real gap_along(real low, real high, real other_low, real other_high) {
    return sk_max(0, sk_max(other_low - high, low - other_high));
}

/* Of leaf a and those of panel q that come later. */
static void measure_apart_of(making *m, size_t p, uint32_t a, size_t q) {
    const sk_skin *skin = m->skin;
    const sk_lists *leaves = &m->spread->leaves;
    const rectangle *one = &m->of_leaf[a];
    uint32_t corner[4], other[4];
    corners_in_row(skin, &skin->leaf[a], corner);
    for (uint32_t j = leaves->start[q]; j < leaves->start[q + 1]; j++) {
        const uint32_t b = leaves->number[j];
        const rectangle *two = &m->of_leaf[b];
        real u = gap_along(one->low.u, one->high.u, two->low.u, two->high.u);
        real v = gap_along(one->low.v, one->high.v, two->low.v, two->high.v), least = sk_max(m->apart[p], m->apart[q]);
        if (b < a || u * u + v * v >= least) continue;
        corners_in_row(skin, &skin->leaf[b], other);
        least = square_between(m, corner, other, least);
        if (a != b) least = square_between(m, other, corner, least);
        m->apart[p] = sk_min(m->apart[p], least), m->apart[q] = sk_min(m->apart[q], least);
    }
}

/* Squares, until all have been seen. */
static void measure_apart(making *m, size_t p, const uint32_t *beside, size_t besides) {
    const sk_lists *leaves = &m->spread->leaves;
    for (uint32_t i = leaves->start[p]; i < leaves->start[p + 1]; i++) measure_apart_of(m, p, leaves->number[i], p);
    for (size_t k = 0; k < besides; k++)
        for (uint32_t i = leaves->start[p]; i < leaves->start[p + 1] && beside[k] != p; i++)
            measure_apart_of(m, p, leaves->number[i], beside[k]);
}

static bool add(making *m, numbers *list, uint32_t number) {
    if (!SK_RESERVE(m->allocator, list, list->count + 1)) return false;
    list->data[list->count++] = number;
    return true;
}

/* The panels of a sheet by their bins: where each begins, in rows. */
typedef struct by_bin {
    size_t across, along;
    uint32_t *start, *panel;
} by_bin;

/* Adds those of some bins that follow each other both ways. */
static bool add_bins(making *m, const by_bin *sheet, size_t u, size_t v, size_t end_u, size_t end_v, numbers *list) {
    bool good = true;
    for (; v < end_v && v < sheet->along; v++)
        for (size_t i = u; i < end_u && i < sheet->across; i++) {
            const size_t at = v * sheet->across + i;
            for (uint32_t k = sheet->start[at]; k < sheet->start[at + 1] && good; k++) good = add(m, list, sheet->panel[k]);
        }
    return good;
}

/* Lists the members of a block, which its bin begins, and what is around these. */
static bool list_block(making *m, const by_bin *sheet, size_t u, size_t v, size_t panels, real widest) {
    const real margin = (real)1e-3 * m->skin->longest;
    const size_t first = m->members.count, first_around = m->around.count;
    if (!add_bins(m, sheet, u, v, u + 2, v + 2, &m->members)) return false;
    if (m->members.count == first) return true;
    const uint32_t *member = m->members.data + first;
    const size_t count = m->members.count - first;
    sk_panel_block block = {.apart = SK_REAL_MAX};
    rectangle all = nowhere;
    real longest = 0;
    for (size_t i = 0; i < count; i++) {
        all = with_rectangle(all, &m->of_panel[member[i]]);
        block.apart = sk_min(block.apart, m->apart[member[i]]);
        longest = sk_max(longest, m->longest[member[i]]);
    }
    if (!list_in(m, &all, panels, widest, -margin, &m->around)) return false;
    for (size_t i = first_around; i < m->around.count; i++) block.steep = sk_max(block.steep, m->steep[m->around.data[i]]);
    block.across = block.apart > 0 ? 1 + 2 * longest / block.apart : SK_REAL_MAX;
    bool no_memory = false;
    block.whole = block.apart > (real)1e-3 * longest &&
                  is_whole(m, member, count, m->around.data + first_around, m->around.count - first_around, &no_memory);
    if (no_memory || !SK_RESERVE(m->allocator, &m->block, m->block.count + 1)) return false;
    m->block.data[m->block.count++] = block;
    return add(m, &m->starts[0], (uint32_t)m->members.count) && add(m, &m->starts[1], (uint32_t)m->around.count);
}

/* Lists the blocks of panels [first, end), a flat piece, and who is beside whom. */
static bool list_sheet(making *m, size_t first, size_t end) {
    sk_spread *spread = m->spread;
    by_bin sheet = {.across = 1, .along = 1, .panel = m->in_bin};
    real widest = 0;
    for (size_t p = first; p < end; p++) {
        m->order[p - first] = (beginning){m->of_panel[p].low.u, (uint32_t)p};
        widest = sk_max(widest, m->of_panel[p].high.u - m->of_panel[p].low.u);
        if (m->bin[p].u >= sheet.across) sheet.across = m->bin[p].u + 1;
        if (m->bin[p].v >= sheet.along) sheet.along = m->bin[p].v + 1;
    }
    qsort(m->order, end - first, sizeof *m->order, compare_beginnings);
    const size_t all = sheet.across * sheet.along;
    uint32_t *start = sk_allocate(m->allocator, (all + 2) * sizeof *start);
    if (!start) return false;
    for (size_t p = first; p < end; p++) start[m->bin[p].v * sheet.across + m->bin[p].u + 2]++;
    for (size_t i = 0; i < all; i++) start[i + 2] += start[i + 1];
    for (size_t p = first; p < end; p++) m->in_bin[start[m->bin[p].v * sheet.across + m->bin[p].u + 1]++] = (uint32_t)p;
    sheet.start = start;
    bool good = true;
    for (size_t p = first; p < end; p++) m->apart[p] = SK_REAL_MAX;
    for (size_t p = first; p < end && good; p++) {
        const size_t before = m->beside.count, u = m->bin[p].u, v = m->bin[p].v;
        spread->beside.start[p] = (uint32_t)before;
        good = add_bins(m, &sheet, u ? u - 1 : 0, v ? v - 1 : 0, u + 2, v + 2, &m->beside);
        if (good) measure_apart(m, p, m->beside.data + before, m->beside.count - before);
    }
    for (size_t p = first; p < end; p++) m->apart[p] = sk_sqrt(m->apart[p]) - 2 * (real)1e-3 * m->skin->longest; // (borders)
    for (size_t v = 0; (v == 0 || v + 1 < sheet.along) && good; v++)
        for (size_t u = 0; (u == 0 || u + 1 < sheet.across) && good; u++) good = list_block(m, &sheet, u, v, end - first, widest);
    sk_release(m->allocator, start);
    return good;
}

/* Lists of who is listed where. */
static bool invert(const sk_lists *lists, size_t count, sk_lists *of, size_t most, sk_allocator *allocator) {
    const size_t all = lists->start[count];
    of->start = sk_allocate(allocator, (most + 3) * sizeof *of->start);
    of->number = sk_allocate(allocator, (all + 1) * sizeof *of->number);
    if (!of->start || !of->number) return false;
    for (size_t i = 0; i < all; i++) of->start[lists->number[i] + 2]++;
    for (size_t i = 0; i < most; i++) of->start[i + 2] += of->start[i + 1];
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = lists->start[i]; k < lists->start[i + 1]; k++) of->number[of->start[lists->number[k] + 1]++] = (uint32_t)i;
    return true;
}

/* Takes what has been listed over. */
static void take(sk_lists *lists, numbers *start, numbers *number) {
    lists->start = start->data, lists->number = number->data;
    start->data = number->data = NULL;
}

/* Lists blocks of all sheets; of others, nobody lies beside them. */
static bool list_all(making *m) {
    sk_spread *spread = m->spread;
    bool good = add(m, &m->starts[0], 0) && add(m, &m->starts[1], 0);
    for (size_t p = 0, end; p < spread->count && good; p = end) {
        const uint32_t piece = piece_of_panel(m, p);
        for (end = p; end < spread->count && piece_of_panel(m, end) == piece; end++) spread->beside.start[end] = (uint32_t)m->beside.count;
        good = !m->flat[piece] || list_sheet(m, p, end);
    }
    spread->beside.start[spread->count] = (uint32_t)m->beside.count;
    spread->beside.number = m->beside.data, m->beside.data = NULL;
    spread->block_count = m->block.count, spread->block = m->block.data, m->block.data = NULL;
    take(&spread->members, &m->starts[0], &m->members);
    take(&spread->around, &m->starts[1], &m->around);
    return good && invert(&spread->members, spread->block_count, &spread->blocks, spread->count, m->allocator) &&
           invert(&spread->around, spread->block_count, &spread->through, spread->count, m->allocator);
}

/* ---- rows ---- */

/* What makes J of two differences of corners. */
static void put_inverse(const making *m, const uint32_t corner[3], real (*inverse)[SK_PANEL_LANES], size_t lane) {
    spot o = m->spot[corner[0]], a = m->spot[corner[1]], b = m->spot[corner[2]];
    real x1 = a.u - o.u, y1 = a.v - o.v, x2 = b.u - o.u, y2 = b.v - o.v, det = x1 * y2 - x2 * y1;
    bool good = det > 0 || det < 0;
    const real of[4] = {y2, -y1, -x2, x1};
    for (int k = 0; k < 4; k++) inverse[k][lane] = good ? of[k] / det : 0;
}

static void put_row(making *m, size_t row, size_t lane, uint32_t leaf, bool flat) {
    sk_spread *spread = m->spread;
    uint32_t corner[4];
    corners_in_row(m->skin, &m->skin->leaf[leaf], corner);
    for (int c = 0; c < 4; c++) spread->corner[row][c][lane] = corner[c];
    const uint32_t first[3] = {corner[0], corner[1], corner[2]}, second[3] = {corner[0], corner[1], corner[3]};
    if (flat) put_inverse(m, first, spread->inverse[row][0], lane), put_inverse(m, second, spread->inverse[row][1], lane);
}

static bool make_rows(making *m) {
    sk_spread *spread = m->spread;
    const size_t groups = (spread->count + SK_PANEL_LANES - 1) / SK_PANEL_LANES;
    spread->row_start = sk_allocate(m->allocator, (groups + 1) * sizeof *spread->row_start);
    if (!spread->row_start) return false;
    for (size_t p = 0; p < spread->count; p++) {
        uint32_t leaves = spread->leaves.start[p + 1] - spread->leaves.start[p], *rows = &spread->row_start[p / SK_PANEL_LANES + 1];
        if (leaves > *rows) *rows = leaves;
    }
    for (size_t g = 0; g < groups; g++) spread->row_start[g + 1] += spread->row_start[g];
    const size_t rows = spread->row_start[groups];
    spread->corner = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->corner);
    spread->inverse = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->inverse);
    spread->gradient = sk_allocate(m->allocator, (rows + 1) * sizeof *spread->gradient);
    if (!spread->corner || !spread->inverse || !spread->gradient) return false;
    for (size_t p = 0; p < groups * SK_PANEL_LANES; p++) { // lanes of no panel are the last one's
        const size_t panel = p < spread->count ? p : spread->count - 1, group = p / SK_PANEL_LANES;
        const uint32_t first = spread->leaves.start[panel], leaves = spread->leaves.start[panel + 1] - first;
        const bool flat = m->flat[piece_of_panel(m, panel)];
        for (uint32_t r = spread->row_start[group]; r < spread->row_start[group + 1]; r++) {
            uint32_t k = r - spread->row_start[group];
            put_row(m, r, p % SK_PANEL_LANES, spread->leaves.number[first + (k < leaves ? k : 0)], flat);
        }
    }
    return true;
}

/* ---- all ---- */

static bool reserve(making *m) {
    const size_t vertices = m->skin->vertex_count + 1, leaves = m->skin->leaf_count + 2;
    sk_spread *spread = m->spread;
    sk_allocator *a = m->allocator;
    spread->of_leaf = sk_allocate(a, leaves * sizeof *spread->of_leaf);
    spread->leaves.start = sk_allocate(a, leaves * sizeof *spread->leaves.start);
    spread->leaves.number = sk_allocate(a, leaves * sizeof *spread->leaves.number);
    spread->vertex_out = sk_allocate(a, vertices);
    spread->patch_out = sk_allocate(a, leaves);
    spread->mark = sk_allocate(a, vertices);
    m->centre = sk_allocate(a, leaves * sizeof *m->centre);
    m->bin = sk_allocate(a, leaves * sizeof *m->bin);
    m->of_leaf = sk_allocate(a, leaves * sizeof *m->of_leaf);
    return spread->of_leaf && spread->leaves.start && spread->leaves.number && spread->vertex_out && spread->patch_out && spread->mark && m->centre && m->of_leaf && m->bin;
}

static bool reserve_panels(making *m) {
    const size_t panels = m->spread->count + 2;
    sk_spread *spread = m->spread;
    sk_allocator *a = m->allocator;
    spread->sixteen = sk_allocate(a, (panels + SK_PANEL_LANES) / SK_PANEL_LANES * sizeof *spread->sixteen);
    spread->least = sk_allocate(a, panels * sizeof *spread->least);
    spread->out = sk_allocate(a, panels);
    spread->was_out = sk_allocate(a, panels);
    spread->box = sk_allocate(a, panels * sizeof *spread->box);
    spread->wide = sk_allocate(a, panels * sizeof *spread->wide);
    spread->age = SK_PANEL_AHEAD;
    spread->met = sk_allocate(a, panels * sizeof *spread->met);
    spread->beside.start = sk_allocate(a, panels * sizeof *spread->beside.start);
    m->in_bin = sk_allocate(a, panels * sizeof *m->in_bin);
    m->apart = sk_allocate(a, panels * sizeof *m->apart);
    m->steep = sk_allocate(a, panels * sizeof *m->steep);
    m->of_panel = sk_allocate(a, panels * sizeof *m->of_panel);
    m->longest = sk_allocate(a, panels * sizeof *m->longest);
    m->order = sk_allocate(a, panels * sizeof *m->order);
    bool good = sk_tree_reserve(&spread->tree, a, spread->count);
    return good && spread->sixteen && spread->least && spread->out && spread->was_out && spread->box && spread->wide &&
           spread->met && spread->beside.start && m->in_bin && m->apart && m->steep && m->of_panel && m->longest &&
           m->order;
}

/* Lanes of no panel are never off their course. */
static void free_lanes(sk_spread *spread) {
    for (size_t p = spread->count; p % SK_PANEL_LANES; p++)
        for (int n = 0; n < 6; n++) {
            sk_tree_block *course = &spread->sixteen[p / SK_PANEL_LANES].course;
            course->low[n / 3][n % 3][p % SK_PANEL_LANES] = -SK_REAL_MAX, course->high[n / 3][n % 3][p % SK_PANEL_LANES] = SK_REAL_MAX;
        }
}

static bool make_panels(making *m) {
    if (!reserve(m)) return false;
    measure_leaves(m);
    if (!deal_leaves(m) || !reserve_panels(m)) return false;
    free_lanes(m->spread);
    measure_panels(m);
    return list_all(m) && make_rows(m);
}

bool sk_spread_make(sk_touch *touch, sk_allocator *allocator) {
    sk_spread_release(&touch->spread, allocator);
    const size_t vertices = touch->skin.vertex_count + 1;
    making m = {.skin = &touch->skin, .spread = &touch->spread, .allocator = allocator};
    m.normal = sk_allocate(allocator, vertices * sizeof *m.normal);
    m.along = sk_allocate(allocator, vertices * sizeof *m.along);
    m.flat = sk_allocate(allocator, vertices);
    m.border = sk_allocate(allocator, touch->skin.edge_count + 1);
    m.spot = sk_allocate(allocator, vertices * sizeof *m.spot);
    bool good = m.normal && m.along && m.flat && m.border && m.spot;
    if (good && find_flat(&m)) good = make_panels(&m);
    void *arrays[] = {m.normal, m.along, m.flat, m.border, m.spot, m.centre, m.of_leaf, m.of_panel, m.longest, m.apart, m.steep, m.bin, m.order,
                      m.in_bin, m.beside.data, m.members.data, m.around.data, m.starts[0].data, m.starts[1].data, m.block.data,
                      m.point, m.hull};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    if (!good) sk_spread_release(&touch->spread, allocator);
    return good;
}

void sk_spread_release(sk_spread *spread, sk_allocator *allocator) {
    sk_lists *lists[] = {&spread->leaves, &spread->blocks, &spread->beside, &spread->members, &spread->around, &spread->through};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        sk_release(allocator, lists[i]->start);
        sk_release(allocator, lists[i]->number);
    }
    void *arrays[] = {spread->sixteen, spread->least, spread->of_leaf, spread->block, spread->out, spread->was_out, spread->vertex_out, spread->patch_out,
                      spread->mark, spread->row_start, spread->corner, spread->inverse, spread->gradient, spread->box, spread->wide,
                      spread->met};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_tree_release(&spread->tree, allocator);
    *spread = (sk_spread){.count = 0};
}
