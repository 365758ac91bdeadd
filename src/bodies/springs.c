/* Finding springs: from faces, edges and the neighbours of edges, as pairs in a hash table. */
#include "bodies/springs.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/status.h"

/* One spring while they are being collected. */
typedef struct spring {
    uint32_t a, b; /* a < b */
    uint32_t sort;
    uint32_t next; /* in its bucket, its place + 1 */
    double area;   /* of the material it stands for; scale = area / length^2 */
} spring;

/* A hash table from pairs to springs, with chains. The springs of one direction of a grid are in buckets that follow
 * each other, so that looking through a large sheet walks through memory: spread at random it took five times as long. */
typedef struct pair_table {
    sk_allocator *allocator;
    struct {
        spring *data;
        size_t count, capacity;
    } springs;
    uint32_t *bucket; /* place in springs + 1; 0 is free */
    size_t bucket_count;
} pair_table;

static size_t bucket_of(const pair_table *table, uint32_t a, uint32_t b) {
    return (sk_hash_mix(b - a) + a) & (table->bucket_count - 1);
}

/* Room for `count` springs; those that are there find new buckets. */
static bool make_room(pair_table *table, size_t count) {
    size_t buckets = 1024;
    while (buckets < count) buckets *= 2;
    uint32_t *bucket = sk_allocate(table->allocator, buckets * sizeof *bucket);
    if (!bucket || !SK_RESERVE(table->allocator, &table->springs, count)) {
        sk_release(table->allocator, bucket);
        return false;
    }
    sk_release(table->allocator, table->bucket);
    table->bucket = bucket;
    table->bucket_count = buckets;
    for (size_t i = 0; i < table->springs.count; i++) {
        spring *s = &table->springs.data[i];
        uint32_t *first = &bucket[bucket_of(table, s->a, s->b)];
        s->next = *first;
        *first = (uint32_t)i + 1;
    }
    return true;
}

/* The spring of a pair, made if there is none yet; NULL when there is no memory. */
static spring *spring_of(pair_table *table, uint32_t p, uint32_t q, sk_spring_sort sort) {
    uint32_t a = p < q ? p : q, b = p < q ? q : p;
    size_t at = bucket_of(table, a, b);
    for (uint32_t i = table->bucket[at]; i; i = table->springs.data[i - 1].next) {
        spring *s = &table->springs.data[i - 1];
        if (s->a == a && s->b == b) return s;
    }
    if (table->springs.count == table->springs.capacity) {
        if (!make_room(table, 2 * table->springs.count)) return NULL;
        at = bucket_of(table, a, b);
    }
    spring *s = &table->springs.data[table->springs.count];
    *s = (spring){a, b, (uint32_t)sort, table->bucket[at], 0};
    table->bucket[at] = (uint32_t)++table->springs.count;
    return s;
}

/* Adds area to a pair's spring if it is of this sort (a pair that has a stronger sort keeps it). */
static bool add(pair_table *table, uint32_t p, uint32_t q, sk_spring_sort sort, double area) {
    if (p == q) return true;
    spring *s = spring_of(table, p, q, sort);
    if (!s) return false;
    if (s->sort == (uint32_t)sort) s->area += area;
    return true;
}

/* Every edge once, with the faces on it. Edges are the first springs of the table, in the same order. */
static bool collect_edges(sk_springs *springs, pair_table *table, const sk_sheet *sheet) {
    for (size_t f = 0; f < sheet->face_count; f++) {
        size_t start = sheet->face_start[f], size = sheet->face_start[f + 1] - start;
        // a triangle stands whole behind each of its edges (van Gelder 1998), a quad by half
        double share = size == 3 ? sheet->face_area[f] : 2 * sheet->face_area[f] / (double)(size ? size : 1);
        for (size_t k = 0; k < size; k++) {
            uint32_t p = sheet->corners[start + k], q = sheet->corners[start + (k + 1) % size];
            if (p == q) continue;
            spring *s = spring_of(table, p, q, SK_STRETCH);
            if (!s) return false;
            s->area += share;
            size_t e = (size_t)(s - table->springs.data);
            if (e == springs->edge_count) {
                if (!sk_reserve(springs->allocator, (void **)&springs->edges, &springs->edge_capacity, e + 1,
                                sizeof(sk_edge)))
                    return false;
                springs->edges[springs->edge_count++] = (sk_edge){s->a, s->b, {UINT32_MAX, UINT32_MAX}, {0, 0}, 0};
            }
            sk_edge *edge = &springs->edges[e];
            if (edge->face_count < 2) {
                edge->face[edge->face_count] = (uint32_t)f;
                edge->corner[edge->face_count] = (uint32_t)(start + k);
            }
            edge->face_count++;
        }
    }
    return true;
}

static bool collect_shear(pair_table *table, const sk_sheet *sheet) {
    for (size_t f = 0; f < sheet->face_count; f++) {
        size_t start = sheet->face_start[f], size = sheet->face_start[f + 1] - start;
        size_t diagonals = size == 4 ? 2 : size > 4 ? size : 0;
        for (size_t k = 0; k < diagonals; k++)
            if (!add(table, sheet->corners[start + k], sheet->corners[start + (k + 2) % size], SK_SHEAR,
                     8 * sheet->face_area[f] / (double)size))
                return false;
    }
    return true;
}

/* On the face of an edge's side, the corner beside `end` that is not on the edge. */
static uint32_t beside(const sk_sheet *sheet, const sk_edge *edge, int side, uint32_t end) {
    size_t start = sheet->face_start[edge->face[side]], size = sheet->face_start[edge->face[side] + 1] - start;
    size_t k = edge->corner[side] - start;
    bool at_first = sheet->corners[start + k] == end;
    return sheet->corners[start + (at_first ? (k + size - 1) % size : (k + 2) % size)];
}

static bool collect_bend(const sk_springs *springs, pair_table *table, const sk_sheet *sheet) {
    for (size_t e = 0; e < springs->edge_count; e++) {
        const sk_edge *edge = &springs->edges[e];
        if (edge->face_count != 2) continue;
        uint32_t a0 = beside(sheet, edge, 0, edge->a), a1 = beside(sheet, edge, 1, edge->a);
        uint32_t b0 = beside(sheet, edge, 0, edge->b), b1 = beside(sheet, edge, 1, edge->b);
        double area = sheet->face_area[edge->face[0]] + sheet->face_area[edge->face[1]];
        // between two triangles both pairs are the same one
        bool same = a0 == b0 && a1 == b1;
        if (!add(table, a0, a1, SK_BEND, same ? 2 * area : area)) return false;
        if (!same && !add(table, b0, b1, SK_BEND, area)) return false;
    }
    return true;
}

/* Lengths and scales of one sort, in the order in which the springs were found. */
static bool fill_list(sk_springs *springs, const pair_table *table, const sk_sheet *sheet, sk_spring_sort sort) {
    struct sk_spring_list *list = &springs->list[sort];
    size_t count = 0;
    for (size_t i = 0; i < table->springs.count; i++) count += table->springs.data[i].sort == (uint32_t)sort;
    list->pairs = sk_allocate(springs->allocator, 2 * count * sizeof *list->pairs);
    list->rest = sk_allocate(springs->allocator, count * sizeof *list->rest);
    list->scale = sk_allocate(springs->allocator, count * sizeof *list->scale);
    if (!list->pairs || !list->rest || !list->scale) return false;
    for (size_t i = 0; i < table->springs.count; i++) {
        const spring *s = &table->springs.data[i];
        if (s->sort != (uint32_t)sort) continue;
        const double *p = sheet->position[s->a], *q = sheet->position[s->b];
        double square = (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]);
        list->pairs[2 * list->count] = s->a;
        list->pairs[2 * list->count + 1] = s->b;
        list->rest[list->count] = (real)sqrt(square);
        // springs of needle-shaped faces would be too stiff for any step
        double scale = square > 0 ? s->area / square : 0;
        list->scale[list->count++] = (real)(scale > 100 ? 100 : scale);
    }
    return true;
}

skein_status sk_springs_find(sk_springs *springs, const sk_sheet *sheet, skein_error *error) {
    memset(springs, 0, sizeof *springs);
    springs->allocator = sheet->allocator;
    pair_table table = {.allocator = sheet->allocator};
    // a grid of quads has three springs for two corners, a mesh of triangles one for each
    bool good = make_room(&table, sheet->corner_count + sheet->corner_count / 2 + 16) &&
                sk_reserve(springs->allocator, (void **)&springs->edges, &springs->edge_capacity,
                           sheet->corner_count / 2 + sheet->corner_count / 16, sizeof(sk_edge)) &&
                collect_edges(springs, &table, sheet) && collect_shear(&table, sheet) &&
                collect_bend(springs, &table, sheet);
    for (int sort = 0; sort < SK_SPRING_SORTS && good; sort++)
        good = fill_list(springs, &table, sheet, (sk_spring_sort)sort);
    sk_release(sheet->allocator, table.springs.data);
    sk_release(sheet->allocator, table.bucket);
    return good ? SKEIN_OK : sk_fail_memory(error, "springs");
}

void sk_springs_release(sk_springs *springs) {
    if (!springs->allocator) return;
    sk_release(springs->allocator, springs->edges);
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++) {
        sk_release(springs->allocator, springs->list[sort].pairs);
        sk_release(springs->allocator, springs->list[sort].rest);
        sk_release(springs->allocator, springs->list[sort].scale);
    }
    memset(springs, 0, sizeof *springs);
}
