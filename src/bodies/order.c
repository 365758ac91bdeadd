#include "bodies/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bodies/geodesic.h"

enum { MOST_STEP = 2 }; /* rows and columns that a grid's spring may lead over */

/* The commonest difference of edges' numbers besides 1: the length of a row. False when there is no memory. */
static bool find_commonest_step(const sk_springs *springs, const sk_sheet *sheet, uint32_t *step) {
    uint32_t *count = sk_allocate(sheet->allocator, sheet->particle_count * sizeof *count), best = 0;
    if (!count) return false;
    for (size_t e = 0; e < springs->edge_count; e++) count[springs->edges[e].b - springs->edges[e].a]++;
    for (size_t d = 2; d < sheet->particle_count; d++)
        if (count[d] && (!best || count[d] > count[best])) best = (uint32_t)d;
    sk_release(sheet->allocator, count);
    *step = best;
    return true;
}

bool sk_order_find_grid(const sk_sheet *sheet, const sk_springs *springs, uint32_t *rows, uint32_t *columns) {
    uint32_t step = sheet->grid_columns;
    *rows = *columns = 0;
    bool known = sheet->grid_columns && sheet->particle_count == sheet->vertex_count;
    if (!known && !find_commonest_step(springs, sheet, &step)) return false;
    if (step < 3 || sheet->particle_count / step < 3) return true;
    // nearly all springs must lead to a near row and column
    size_t total = 0, fitting = 0;
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++) {
        const struct sk_spring_list *list = &springs->list[sort];
        total += list->count;
        for (size_t i = 0; i < list->count; i++) {
            uint32_t a = list->pairs[2 * i], b = list->pairs[2 * i + 1];
            uint32_t down = b / step - a / step, ca = a % step, cb = b % step, across = ca > cb ? ca - cb : cb - ca;
            fitting += down <= MOST_STEP && across <= MOST_STEP;
        }
    }
    if (fitting < total - total / 10) return true;
    *columns = step;
    *rows = (uint32_t)((sheet->particle_count + step - 1) / step);
    return true;
}

/* A spring with what it is sorted by. */
typedef struct sorted_spring {
    double key;
    uint32_t later; /* sorts before the key */
    uint32_t a, b;
    real rest, scale;
} sorted_spring;

static int compare_springs(const void *p, const void *q) {
    const sorted_spring *s = p, *t = q;
    if (s->later != t->later) return s->later < t->later ? -1 : 1;
    if (s->key != t->key) return s->key < t->key ? -1 : 1;
    if (s->a != t->a) return s->a < t->a ? -1 : 1;
    return s->b < t->b ? -1 : s->b > t->b;
}

/* Sorts one list; `distance` NULL sorts by direction, from lower places to higher ones. */
static bool sort_list(sk_allocator *allocator, struct sk_spring_list *list, const double *distance,
                      const uint32_t *place) {
    sorted_spring *sorted = sk_allocate(allocator, list->count * sizeof *sorted);
    if (!sorted) return false;
    for (size_t i = 0; i < list->count; i++) {
        uint32_t a = list->pairs[2 * i], b = list->pairs[2 * i + 1];
        if (place && place[a] > place[b]) a = list->pairs[2 * i + 1], b = list->pairs[2 * i];
        uint32_t step = place ? place[b] - place[a] : b - a;
        sorted[i] = (sorted_spring){place ? place[a] : 0, step, a, b, list->rest[i], list->scale[i]};
        if (!distance) continue;
        // radial: the ends' distances differ by more than half the length
        sorted[i].later = !(fabs(distance[a] - distance[b]) > 0.5 * (double)list->rest[i]);
        sorted[i].key = 0.5 * (distance[a] + distance[b]);
    }
    qsort(sorted, list->count, sizeof *sorted, compare_springs);
    for (size_t i = 0; i < list->count; i++) {
        list->pairs[2 * i] = sorted[i].a, list->pairs[2 * i + 1] = sorted[i].b;
        list->rest[i] = sorted[i].rest, list->scale[i] = sorted[i].scale;
    }
    sk_release(allocator, sorted);
    return true;
}

bool sk_order_by_direction(sk_springs *springs, const uint32_t *place) {
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++)
        if (!sort_list(springs->allocator, &springs->list[sort], NULL, place)) return false;
    return true;
}

/* Distance from the pins along the sheet, or place along the longest axis; parts that no pin reaches come last. */
static bool find_distances(const sk_sheet *sheet, const bool *pinned, double *distance) {
    size_t count = sheet->particle_count, pins = 0;
    for (size_t i = 0; i < count; i++) pins += pinned[i];
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], sheet->position[i][k]);
            high[k] = fmax(high[k], sheet->position[i][k]);
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    bool good = true;
    if (pins) {
        sk_geodesic *geodesic = sk_geodesic_create(sheet);
        uint32_t *nearest = sk_allocate(sheet->allocator, count * sizeof *nearest);
        good = geodesic && nearest && sk_geodesic_from(geodesic, pinned, distance, nearest);
        sk_geodesic_release(geodesic);
        sk_release(sheet->allocator, nearest);
    }
    for (size_t i = 0; i < count && good; i++)
        if (!pins || !(distance[i] < INFINITY)) distance[i] = (pins ? 1e12 : 0) + sheet->position[i][axis] - low[axis];
    return good;
}

typedef struct ranked {
    double key;
    uint32_t particle;
} ranked;

static int compare_ranked(const void *p, const void *q) {
    const ranked *a = p, *b = q;
    if (a->key != b->key) return a->key < b->key ? -1 : 1;
    return a->particle < b->particle ? -1 : a->particle > b->particle;
}

bool sk_order_outward(sk_springs *springs, const sk_sheet *sheet, const bool *pinned, uint32_t *rank) {
    sk_allocator *allocator = sheet->allocator;
    size_t count = sheet->particle_count;
    double *distance = sk_allocate(allocator, count * sizeof *distance);
    ranked *order = sk_allocate(allocator, count * sizeof *order);
    bool good = distance && order && find_distances(sheet, pinned, distance);
    for (int sort = 0; sort < SK_SPRING_SORTS && good; sort++)
        good = sort_list(allocator, &springs->list[sort], distance, NULL);
    // neighbours in the order of sweeps are neighbours in memory
    for (size_t i = 0; i < count && good; i++) order[i] = (ranked){distance[i], (uint32_t)i};
    if (good) qsort(order, count, sizeof *order, compare_ranked);
    for (size_t i = 0; i < count && good; i++) rank[order[i].particle] = (uint32_t)i;
    sk_release(allocator, distance);
    sk_release(allocator, order);
    return good;
}
