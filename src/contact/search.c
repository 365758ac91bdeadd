/* The search for pairs: leaves are sorted into cells by their boxes' centres (a counting sort); of each two whose boxes
 * overlap, features whose boxes overlap; of these, those that are near enough. Boxes are widened by the reach of their
 * vertices and half the limit, so that boxes apart are features apart. Pairs come out in the order of leaves, which is
 * always the same. */
#include <math.h>
#include <string.h>

#include "contact/touch.h"

/* ---- boxes ---- */

static inline bool overlap(const sk_box *a, const sk_box *b) {
    return (a->low[0] <= b->high[0]) & (b->low[0] <= a->high[0]) & (a->low[1] <= b->high[1]) &
           (b->low[1] <= a->high[1]) & (a->low[2] <= b->high[2]) & (b->low[2] <= a->high[2]);
}

static inline void widen(sk_box *box, const sk_box *by) {
    for (int k = 0; k < 3; k++) {
        box->low[k] = sk_min(box->low[k], by->low[k]);
        box->high[k] = sk_max(box->high[k], by->high[k]);
    }
}

static sk_box box_of(const sk_box *vertex_box, const uint32_t *vertex, int count) {
    sk_box box = vertex_box[vertex[0]];
    for (int k = 1; k < count; k++) widen(&box, &vertex_box[vertex[k]]);
    return box;
}

static real square_between(const sk_vec4 *p, uint32_t a, uint32_t b) {
    real x = p[a].x - p[b].x, y = p[a].y - p[b].y, z = p[a].z - p[b].z;
    return x * x + y * y + z * z;
}

/* Whether the longest side is four times as long as it was built. */
static bool is_torn(const sk_touch *touch, const uint32_t *vertex, int count) {
    const real most = 4 * 4;
    real now = 0, built = 0;
    for (int k = 0; k < count; k++) {
        uint32_t a = vertex[k], b = vertex[(k + 1) % count];
        now = sk_max(now, square_between(touch->p, a, b));
        built = sk_max(built, square_between(touch->skin.built, a, b));
    }
    return built > 0 && now > most * built;
}

/* What has blown up meets nobody: its boxes overlap with all others, and a step would take minutes. */
static bool has_blown_up(const sk_touch *touch, const sk_leaf *leaf) {
    bool torn = !leaf->triangles && is_torn(touch, touch->skin.edge[leaf->first_edge], 2);
    for (size_t k = 0; k < leaf->triangles; k++)
        torn |= is_torn(touch, touch->skin.triangle[leaf->first_triangle + k], 3);
    return torn;
}

void sk_touch_boxes(sk_touch *touch, const real *reach, real limit) {
    const sk_skin *skin = &touch->skin;
    for (size_t v = 0; v < skin->vertex_count; v++) {
        sk_vec4 p = touch->p[v];
        real r = (reach ? reach[v] : 0) + (real)0.5 * limit;
        touch->vertex_box[v] = (sk_box){{p.x - r, p.y - r, p.z - r}, {p.x + r, p.y + r, p.z + r}};
    }
    for (size_t e = 0; e < skin->edge_count; e++) touch->edge_box[e] = box_of(touch->vertex_box, skin->edge[e], 2);
    for (size_t t = 0; t < skin->triangle_count; t++)
        touch->triangle_box[t] = box_of(touch->vertex_box, skin->triangle[t], 3);
    for (size_t i = 0; i < skin->leaf_count; i++) {
        const sk_leaf *leaf = &skin->leaf[i];
        sk_box *box = &touch->leaf_box[i];
        *box = leaf->triangles ? touch->triangle_box[leaf->first_triangle] : touch->edge_box[leaf->first_edge];
        for (size_t k = 1; k < leaf->triangles; k++) widen(box, &touch->triangle_box[leaf->first_triangle + k]);
        if (has_blown_up(touch, leaf)) box->high[0] = INFINITY;
    }
}

/* ---- cells ---- */

typedef struct frame {
    double low[3], half, per; /* half the size of the largest box; cells a metre */
    long count[3];
} frame;

static long cell_along(const frame *cells, int k, double x) {
    double at = (x - cells->low[k]) * cells->per;
    return at < 0 ? 0 : at >= (double)cells->count[k] ? cells->count[k] - 1 : (long)at;
}

/* Whether a box is one. */
static bool is_sound(const sk_box *box) {
    bool sound = true;
    for (int k = 0; k < 3; k++) sound &= box->low[k] >= (real)-1e15 && box->high[k] <= (real)1e15;
    return sound;
}

static double middle(const sk_box *box, int k) {
    return 0.5 * ((double)box->low[k] + (double)box->high[k]);
}

/* Cells of half the largest box, fewer than four a leaf. */
static frame frame_of(const sk_touch *touch) {
    frame c = {.half = 0};
    double high[3], size;
    for (int k = 0; k < 3; k++) c.low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = 0; i < touch->skin.leaf_count; i++) {
        const sk_box *box = &touch->leaf_box[i];
        if (!is_sound(box)) continue;
        for (int k = 0; k < 3; k++) {
            double at = middle(box, k), extent = (double)box->high[k] - (double)box->low[k];
            c.half = extent > 2 * c.half ? 0.5 * extent : c.half;
            c.low[k] = at < c.low[k] ? at : c.low[k];
            high[k] = at > high[k] ? at : high[k];
        }
    }
    if (!(c.half > 0)) return c;
    c.half *= 1.0001;
    for (size = c.half;; size *= 1.3) {
        double all = 1;
        c.per = 1 / size;
        for (int k = 0; k < 3; k++) all *= floor((high[k] - c.low[k]) * c.per) + 1;
        if (all <= 4.0 * (double)touch->skin.leaf_count + 64) break;
    }
    for (int k = 0; k < 3; k++) c.count[k] = (long)((high[k] - c.low[k]) * c.per) + 1;
    return c;
}

/* Sorts leaves by cell; within one they keep their order. */
static bool sort_leaves(sk_touch *touch, sk_allocator *allocator, const frame *c) {
    size_t count = touch->skin.leaf_count, all = (size_t)(c->count[0] * c->count[1] * c->count[2]);
    if (!sk_reserve(allocator, (void **)&touch->start, &touch->start_capacity, all + 2, sizeof *touch->start))
        return false;
    uint32_t *start = touch->start;
    memset(start, 0, (all + 2) * sizeof *start);
    for (size_t i = 0; i < count; i++) {
        const sk_box *box = &touch->leaf_box[i];
        touch->cell[i] = UINT32_MAX;
        if (!is_sound(box)) continue;
        long at[3];
        for (int k = 0; k < 3; k++) at[k] = cell_along(c, k, middle(box, k));
        touch->cell[i] = (uint32_t)((at[2] * c->count[1] + at[1]) * c->count[0] + at[0]);
        start[touch->cell[i] + 2]++;
    }
    for (size_t i = 2; i < all + 2; i++) start[i] += start[i - 1];
    for (size_t i = 0; i < count; i++) {
        if (touch->cell[i] == UINT32_MAX) continue;
        uint32_t place = start[touch->cell[i] + 1]++;
        touch->item[place] = (uint32_t)i;
        touch->sorted_box[place] = touch->leaf_box[i];
    }
    return true;
}

/* Lists the later leaves whose boxes overlap that of a, in order. */
static bool list_partners(sk_touch *touch, sk_allocator *allocator, const frame *c, size_t a) {
    const sk_box *box = &touch->leaf_box[a];
    long low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = cell_along(c, k, (double)box->low[k] - c->half);
        high[k] = cell_along(c, k, (double)box->high[k] + c->half);
    }
    touch->list.count = 0;
    for (long z = low[2]; z <= high[2]; z++)
        for (long y = low[1]; y <= high[1]; y++) {
            size_t line = (size_t)((z * c->count[1] + y) * c->count[0]);
            uint32_t end = touch->start[line + (size_t)high[0] + 1];
            for (uint32_t i = touch->start[line + (size_t)low[0]]; i < end; i++) {
                if (touch->item[i] <= a || !overlap(box, &touch->sorted_box[i])) continue;
                if (!SK_RESERVE(allocator, &touch->list, touch->list.count + 1)) return false;
                uint32_t *list = touch->list.data, b = touch->item[i];
                size_t j = touch->list.count++;
                for (; j && list[j - 1] > b; j--) list[j] = list[j - 1];
                list[j] = b;
            }
        }
    return true;
}

bool sk_touch_meet(sk_touch *touch, sk_allocator *allocator, bool (*meet)(void *data, size_t a, size_t b), void *data) {
    frame c = frame_of(touch);
    if (!(c.half > 0)) return true;
    if (!sort_leaves(touch, allocator, &c)) return false;
    for (size_t a = 0; a < touch->skin.leaf_count; a++) {
        if (touch->cell[a] == UINT32_MAX) continue;
        if (!list_partners(touch, allocator, &c, a) || !meet(data, a, a)) return false;
        for (size_t i = 0; i < touch->list.count; i++)
            if (!meet(data, a, touch->list.data[i])) return false;
    }
    return true;
}

/* ---- pairs ---- */

typedef struct search {
    sk_touch *touch;
    sk_allocator *allocator;
} search;

static inline void put(sk_pairs *pairs, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    size_t k = pairs->count++;
    pairs->corner[0][k] = a, pairs->corner[1][k] = b, pairs->corner[2][k] = c, pairs->corner[3][k] = d;
}

/* Vertices of leaf a with triangles of leaf b. */
static void put_corners(sk_touch *touch, const sk_leaf *a, size_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *b = &skin->leaf[b_number];
    for (uint32_t v = a->first_vertex; v < a->first_vertex + a->vertices; v++) {
        if (!overlap(&touch->vertex_box[v], &touch->leaf_box[b_number])) continue;
        for (uint32_t t = b->first_triangle; t < b->first_triangle + b->triangles; t++) {
            const uint32_t *corner = skin->triangle[t];
            if (v != corner[0] && v != corner[1] && v != corner[2] &&
                overlap(&touch->vertex_box[v], &touch->triangle_box[t]))
                put(&touch->kept[SK_CORNERS], v, corner[0], corner[1], corner[2]);
        }
    }
}

static void put_edges(sk_touch *touch, size_t a_number, size_t b_number) {
    const sk_skin *skin = &touch->skin;
    const sk_leaf *a = &skin->leaf[a_number], *b = &skin->leaf[b_number];
    for (uint32_t e = a->first_edge; e < a->first_edge + a->edges; e++) {
        if (!overlap(&touch->edge_box[e], &touch->leaf_box[b_number])) continue;
        const uint32_t *one = skin->edge[e];
        for (uint32_t f = a_number == b_number ? e + 1 : b->first_edge; f < b->first_edge + b->edges; f++) {
            const uint32_t *two = skin->edge[f];
            if (overlap(&touch->edge_box[e], &touch->edge_box[f]) && one[0] != two[0] && one[0] != two[1] &&
                one[1] != two[0] && one[1] != two[1])
                put(&touch->kept[SK_EDGES], one[0], one[1], two[0], two[1]);
        }
    }
}

static bool add_pairs(void *data, size_t a, size_t b) {
    const search *s = data;
    sk_touch *touch = s->touch;
    const sk_skin *skin = &touch->skin;
    enum { MOST = 64, MOST_A_VERTEX = 1000 }; // of two leaves: 2 x 4 x 2 corners, 5 x 5 edges
    // what has blown up is everywhere at once: gigabytes of pairs, and minutes a step
    if (touch->kept[SK_CORNERS].count + touch->kept[SK_EDGES].count > MOST_A_VERTEX * (skin->vertex_count + MOST)) {
        touch->gave_up = true;
        return false;
    }
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++)
        if (!sk_pairs_reserve(&touch->kept[sort], s->allocator, touch->kept[sort].count + MOST)) return false;
    put_corners(touch, &skin->leaf[a], b);
    if (a != b) put_corners(touch, &skin->leaf[b], a);
    put_edges(touch, a, b);
    return true;
}

/* Leaves those that are near enough. */
static void keep_near(sk_touch *touch, int sort, real limit) {
    sk_pairs *pairs = &touch->kept[sort];
    const real *reach = touch->reach;
    sk_pairs_pad(pairs);
    sk_closest[sort][touch->isa](touch->p, pairs);
    size_t count = pairs->count;
    pairs->count = 0;
    for (size_t k = 0; k < count; k++) {
        real r[4];
        for (int c = 0; c < 4; c++) r[c] = reach[pairs->corner[c][k]];
        real one = sort == SK_EDGES ? sk_max(r[0], r[1]) : r[0];
        real two = sort == SK_EDGES ? sk_max(r[2], r[3]) : sk_max(r[1], sk_max(r[2], r[3]));
        if (pairs->distance[k] < limit + one + two) sk_pairs_copy(pairs, pairs, k);
    }
    sk_pairs_pad(pairs);
}

/* A surface as it was built is not pushed apart: features of one piece are as thick as their distance then allows. */
static void set_thickness(sk_touch *touch, int sort, real thickness) {
    const real share = (real)0.9;
    sk_pairs *pairs = &touch->kept[sort], rest = *pairs;
    rest.distance = touch->rest.distance;
    for (int c = 0; c < 3; c++) rest.normal[c] = touch->rest.normal[c];
    for (int c = 0; c < 2; c++) rest.share[c] = touch->rest.share[c];
    sk_closest[sort][touch->isa](touch->skin.built, &rest);
    const uint32_t *piece = touch->skin.piece;
    for (size_t k = 0; k < pairs->count; k++) {
        bool same = piece[pairs->corner[0][k]] == piece[pairs->corner[2][k]];
        pairs->thickness[k] = same ? sk_min(thickness, share * rest.distance[k]) : thickness;
    }
}

bool sk_touch_search(sk_touch *touch, sk_allocator *allocator, real thickness, real limit) {
    search s = {touch, allocator};
    sk_touch_boxes(touch, touch->reach, limit);
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->kept[sort].count = 0;
    touch->found = false;
    touch->searches++;
    touch->gave_up = false;
    if (!sk_touch_meet(touch, allocator, add_pairs, &s)) {
        for (int sort = 0; sort < SK_PAIR_SORTS; sort++) touch->kept[sort].count = 0;
        return touch->gave_up;
    }
    for (int sort = 0; sort < SK_PAIR_SORTS; sort++) {
        keep_near(touch, sort, limit);
        if (!sk_pairs_reserve(&touch->rest, allocator, touch->kept[sort].count)) return false;
        set_thickness(touch, sort, thickness);
    }
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        touch->s[v] = touch->p[v];
        touch->p[v].w = 0;
    }
    touch->most_moved = 0;
    touch->found = true;
    return true;
}
