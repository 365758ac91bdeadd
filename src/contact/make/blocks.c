/* Blocks: panels that have a corner in common. Which panels ways between these may lead through, whether a border of the sheet lies
 * there, and how far apart features were built. */
#include <stdlib.h>
#include <string.h>

#include "contact/make/spread.h"

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
        if (other->high.u < r->low.u - margin || other->high.v < r->low.v - margin || other->low.v > r->high.v + margin)
            continue;
        if (!SK_RESERVE(m->allocator, list, list->count + 1)) return false;
        list->data[list->count++] = m->order[first].panel;
    }
    return true;
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
                if (m->border[e] &&
                    is_inside(m->hull, hull, m->spot[skin->edge[e][0]], m->spot[skin->edge[e][1]], margin))
                    return false;
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
            for (uint32_t k = sheet->start[at]; k < sheet->start[at + 1] && good; k++)
                good = add(m, list, sheet->panel[k]);
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
    for (size_t i = first_around; i < m->around.count; i++)
        block.steep = sk_max(block.steep, m->steep[m->around.data[i]]);
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
    for (size_t p = first; p < end; p++)
        m->apart[p] = sk_sqrt(m->apart[p]) - 2 * (real)1e-3 * m->skin->longest; // (borders)
    for (size_t v = 0; (v == 0 || v + 1 < sheet.along) && good; v++)
        for (size_t u = 0; (u == 0 || u + 1 < sheet.across) && good; u++)
            good = list_block(m, &sheet, u, v, end - first, widest);
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
        for (uint32_t k = lists->start[i]; k < lists->start[i + 1]; k++)
            of->number[of->start[lists->number[k] + 1]++] = (uint32_t)i;
    return true;
}

/* Takes what has been listed over. */
static void take(sk_lists *lists, numbers *start, numbers *number) {
    lists->start = start->data, lists->number = number->data;
    start->data = number->data = NULL;
}

bool sk_blocks_list(making *m) {
    sk_spread *spread = m->spread;
    bool good = add(m, &m->starts[0], 0) && add(m, &m->starts[1], 0);
    for (size_t p = 0, end; p < spread->count && good; p = end) {
        const uint32_t piece = piece_of_panel(m, p);
        for (end = p; end < spread->count && piece_of_panel(m, end) == piece; end++)
            spread->beside.start[end] = (uint32_t)m->beside.count;
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
