/* Dijkstra's algorithm over the vertices, with updates across triangles too. If both other corners
 * know their distance, the source is unfolded into the triangle's plane and the straight line from it
 * is taken, if it crosses the far edge (after Kimmel and Sethian 1998; exact from one source on a flat
 * convex sheet, where a walk along edges would be up to 8 % too long).
 *
 *        v                 u = (0, 0), w = (e, 0), the source below the edge at (sx, -sy)
 *       / \                sx = (du^2 - dw^2 + e^2) / 2e,  sy = sqrt(du^2 - sx^2)
 *      u---w               distance of v = |v - source|
 *       \./  source
 *
 * A grid is a flat rectangle, where every way is a straight line: there the nearest source of each particle is found
 * column by column, then row by row (Felzenszwalb and Huttenlocher 2012), in no more time than it takes to build it. */
#include "bodies/geodesic.h"

#include <math.h>
#include <string.h>

typedef struct heap_entry {
    double distance;
    uint32_t particle;
} heap_entry;

/* A column's nearest source, as a row sees it: a parabola over the row. */
typedef struct parabola {
    double middle, height; /* where it is lowest along the row, and how high there: the squared distance across */
    double from;           /* where along the row it is lower than all before it */
    uint32_t source;
} parabola;

/* All data of a particle in a search, in one or two cache lines, since meshes are numbered in any order. */
typedef struct place {
    double at[3], distance;
    uint32_t nearest;
    bool settled;
} place;

struct sk_geodesic {
    sk_allocator *allocator;
    const sk_sheet *sheet;
    parabola *lowest;      /* of a grid, which has none of the following: a row's */
    size_t *start;         /* of a particle's triangles in `around`; particles + 1 */
    uint32_t (*around)[2]; /* the other two corners */
    place *places;
    struct {
        heap_entry *data;
        size_t count, capacity;
    } heap;
    struct {
        uint32_t *data;
        size_t count, capacity;
    } seen;     /* by searches that end near where they begin */
    bool clear; /* no particle has a distance */
};

void sk_geodesic_release(sk_geodesic *g) {
    if (!g) return;
    sk_release(g->allocator, g->lowest);
    sk_release(g->allocator, g->start);
    sk_release(g->allocator, g->around);
    sk_release(g->allocator, g->places);
    sk_release(g->allocator, g->heap.data);
    sk_release(g->allocator, g->seen.data);
    sk_release(g->allocator, g);
}

/* Cuts a face into triangles: a quad in both ways, so that neither diagonal is preferred; larger faces into a fan. */
static size_t cut_face(const uint32_t *c, size_t size, uint32_t (*out)[3]) {
    if (size < 3) return 0;
    size_t count = 0;
    for (size_t k = 1; k + 1 < size; k++, count++)
        if (out) memcpy(out[count], (const uint32_t[]){c[0], c[k], c[k + 1]}, sizeof *out);
    if (size == 4)
        for (size_t k = 0; k < 2; k++, count++)
            if (out) memcpy(out[count], (const uint32_t[]){c[1], c[k ? 3 : 2], c[k ? 0 : 3]}, sizeof *out);
    return count;
}

sk_geodesic *sk_geodesic_create(const sk_sheet *sheet) {
    sk_allocator *allocator = sheet->allocator;
    sk_geodesic *g = sk_allocate(allocator, sizeof *g);
    if (!g) return NULL;
    g->allocator = allocator;
    g->sheet = sheet;
    if (sheet->grid_rows && sheet->particle_count == sheet->vertex_count) {
        g->lowest = sk_allocate(allocator, sheet->grid_columns * sizeof *g->lowest);
        if (g->lowest) return g;
        sk_geodesic_release(g);
        return NULL;
    }
    size_t count = 0;
    for (size_t f = 0; f < sheet->face_count; f++)
        count += cut_face(NULL, sheet->face_start[f + 1] - sheet->face_start[f], NULL);
    uint32_t(*triangle)[3] = sk_allocate(allocator, count * sizeof *triangle);
    g->start = sk_allocate(allocator, (sheet->particle_count + 2) * sizeof *g->start);
    g->around = sk_allocate(allocator, 3 * count * sizeof *g->around);
    g->places = sk_allocate(allocator, sheet->particle_count * sizeof *g->places);
    if (!triangle || !g->start || !g->around || !g->places) {
        sk_release(allocator, triangle);
        sk_geodesic_release(g);
        return NULL;
    }
    size_t filled = 0;
    for (size_t f = 0; f < sheet->face_count; f++)
        filled += cut_face(sheet->corners + sheet->face_start[f], sheet->face_start[f + 1] - sheet->face_start[f],
                           triangle + filled);
    // the triangles around each particle: count, sum up, scatter
    for (size_t t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) g->start[triangle[t][k] + 2]++;
    for (size_t i = 2; i < sheet->particle_count + 2; i++) g->start[i] += g->start[i - 1];
    for (size_t t = 0; t < count; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t *others = g->around[g->start[triangle[t][k] + 1]++];
            others[0] = triangle[t][k == 0], others[1] = triangle[t][k == 2 ? 1 : 2];
        }
    sk_release(allocator, triangle);
    return g;
}

/* ---- a binary heap; an entry that was overtaken stays and is skipped when it comes up ---- */

static bool heap_push(sk_geodesic *g, heap_entry entry) {
    if (!SK_RESERVE(g->allocator, &g->heap, g->heap.count + 1)) return false;
    size_t i = g->heap.count++;
    for (; i && g->heap.data[(i - 1) / 2].distance > entry.distance; i = (i - 1) / 2)
        g->heap.data[i] = g->heap.data[(i - 1) / 2];
    g->heap.data[i] = entry;
    return true;
}

static heap_entry heap_pop(sk_geodesic *g) {
    heap_entry top = g->heap.data[0], last = g->heap.data[--g->heap.count];
    size_t i = 0;
    for (size_t child; (child = 2 * i + 1) < g->heap.count; i = child) {
        if (child + 1 < g->heap.count && g->heap.data[child + 1].distance < g->heap.data[child].distance) child++;
        if (!(g->heap.data[child].distance < last.distance)) break;
        g->heap.data[i] = g->heap.data[child];
    }
    if (g->heap.count) g->heap.data[i] = last;
    return top;
}

static double length_between(const double *p, const double *q) {
    double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
    return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* The distance of v over the edge u w, or infinity where the straight line misses the edge. */
static double across(const double *u, const double *w, const double *v, double du, double dw) {
    double e = length_between(u, w), uv = length_between(u, v), wv = length_between(w, v);
    if (!(e > 0)) return INFINITY;
    double sx = (du * du - dw * dw + e * e) / (2 * e), vx = (uv * uv - wv * wv + e * e) / (2 * e);
    double sy2 = du * du - sx * sx, vy2 = uv * uv - vx * vx;
    if (!(sy2 > 0) || !(vy2 > 0)) return INFINITY;
    double sy = sqrt(sy2), vy = sqrt(vy2);
    double crossing = sx + (vx - sx) * sy / (sy + vy);
    if (!(crossing >= -1e-9 * e && crossing <= e * (1 + 1e-9))) return INFINITY;
    return sqrt((vx - sx) * (vx - sx) + (vy + sy) * (vy + sy));
}

/* ---- grids ---- */

/* Of each particle the nearest source in its own column: down the columns, then up. */
static void find_in_columns(const sk_sheet *sheet, const bool *source, uint32_t *nearest) {
    size_t columns = sheet->grid_columns, count = sheet->particle_count;
    for (size_t i = 0; i < count; i++)
        nearest[i] = source[i] ? (uint32_t)i : i < columns ? UINT32_MAX : nearest[i - columns];
    for (size_t i = count - columns; i-- > 0;) {
        uint32_t below = nearest[i + columns];
        if (below != UINT32_MAX && (nearest[i] == UINT32_MAX || below - i < i - nearest[i])) nearest[i] = below;
    }
}

/* The lowest parabolas of a row, from its first place to its last; returns how many. */
static size_t find_lowest(const sk_geodesic *g, size_t row, const double step[2], const uint32_t *nearest) {
    size_t columns = g->sheet->grid_columns, count = 0;
    for (size_t c = 0; c < columns; c++) {
        uint32_t source = nearest[row * columns + c];
        if (source == UINT32_MAX) continue;
        size_t source_row = source / columns;
        double across = step[0] * ((double)row - (double)source_row);
        parabola p = {step[1] * (double)c, across * across, -INFINITY, source};
        for (; count; count--) {
            const parabola *last = &g->lowest[count - 1];
            double sum = p.middle + last->middle, apart = p.middle - last->middle;
            p.from = 0.5 * (sum + (p.height - last->height) / apart);
            if (p.from > last->from) break;
        }
        if (!count) p.from = -INFINITY;
        g->lowest[count++] = p;
    }
    return count;
}

static void from_on_grid(const sk_geodesic *g, const bool *source, double *distance, uint32_t *nearest) {
    const sk_sheet *sheet = g->sheet;
    size_t columns = sheet->grid_columns;
    double step[2] = {length_between(sheet->position[0], sheet->position[columns]),
                      length_between(sheet->position[0], sheet->position[1])};
    find_in_columns(sheet, source, nearest);
    for (size_t row = 0; row < sheet->grid_rows; row++) {
        size_t count = find_lowest(g, row, step, nearest), k = 0;
        for (size_t c = 0, i = row * columns; c < columns; c++, i++) {
            while (k + 1 < count && g->lowest[k + 1].from < step[1] * (double)c) k++;
            nearest[i] = count ? g->lowest[k].source : UINT32_MAX;
            distance[i] = count ? length_between(sheet->position[i], sheet->position[nearest[i]]) : INFINITY;
        }
    }
}

/* ---- searches ---- */

/* Makes a particle's distance final, and updates its neighbours. False when there is no memory. */
static bool settle(sk_geodesic *g, uint32_t top) {
    place *u = &g->places[top];
    u->settled = true;
    for (size_t k = g->start[top]; k < g->start[top + 1]; k++)
        for (int c = 0; c < 2; c++) {
            uint32_t number = g->around[k][c];
            place *v = &g->places[number];
            const place *w = &g->places[g->around[k][1 - c]];
            if (v->settled) continue;
            double best = u->distance + length_between(u->at, v->at);
            if (w->settled && w->nearest == u->nearest) {
                double straight = across(u->at, w->at, v->at, u->distance, w->distance);
                if (straight < best) best = straight;
            }
            if (!(best < v->distance)) continue;
            v->distance = best;
            v->nearest = u->nearest;
            if (!heap_push(g, (heap_entry){best, number})) return false;
        }
    return true;
}

static void clear(sk_geodesic *g) {
    g->heap.count = 0;
    for (size_t i = 0; i < g->sheet->particle_count; i++) {
        place *p = &g->places[i];
        memcpy(p->at, g->sheet->position[i], sizeof p->at);
        p->distance = INFINITY;
        p->nearest = UINT32_MAX;
        p->settled = false;
    }
    g->clear = true;
}

bool sk_geodesic_from(sk_geodesic *g, const bool *source, double *distance, uint32_t *nearest) {
    size_t count = g->sheet->particle_count;
    if (g->lowest) {
        from_on_grid(g, source, distance, nearest);
        return true;
    }
    clear(g);
    g->clear = false;
    for (size_t i = 0; i < count; i++) {
        if (!source[i]) continue;
        g->places[i].distance = 0;
        g->places[i].nearest = (uint32_t)i;
        if (!heap_push(g, (heap_entry){0, (uint32_t)i})) return false;
    }
    while (g->heap.count) {
        uint32_t top = heap_pop(g).particle;
        if (!g->places[top].settled && !settle(g, top)) return false;
    }
    for (size_t i = 0; i < count; i++) distance[i] = g->places[i].distance, nearest[i] = g->places[i].nearest;
    return true;
}

bool sk_geodesic_near(sk_geodesic *g, uint32_t source, double most,
                      void (*visit)(void *user, uint32_t particle, double distance), void *user) {
    if (!g->clear) clear(g);
    g->seen.count = 0;
    g->places[source].distance = 0;
    g->places[source].nearest = source;
    bool good = heap_push(g, (heap_entry){0, source});
    while (g->heap.count && good) {
        const uint32_t top = heap_pop(g).particle;
        if (g->places[top].settled) continue;
        if (!(g->places[top].distance < most)) break;
        visit(user, top, g->places[top].distance);
        good = SK_RESERVE(g->allocator, &g->seen, g->seen.count + 1) && settle(g, top);
        if (good) g->seen.data[g->seen.count++] = top;
    }
    // who has a distance was settled, or is beside one who was
    for (size_t i = 0; i < g->seen.count; i++) {
        const uint32_t one = g->seen.data[i];
        for (size_t k = g->start[one]; k < g->start[one + 1]; k++)
            for (int c = 0; c < 2; c++)
                g->places[g->around[k][c]].distance = INFINITY, g->places[g->around[k][c]].settled = false;
        g->places[one].distance = INFINITY, g->places[one].settled = false;
    }
    g->heap.count = 0;
    g->clear = good;
    return good;
}
