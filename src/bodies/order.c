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

/* ---- by direction ---- */

/* A spring's direction and place, and its number. */
typedef struct keyed {
    uint64_t key;
    uint32_t spring;
} keyed;

enum { DIGIT_BITS = 11, DIGITS = 6, DIGIT_VALUES = 1 << DIGIT_BITS };

static size_t digit_of(uint64_t key, int d) {
    return key >> (d * DIGIT_BITS) & (DIGIT_VALUES - 1);
}

/* Sorts by key, equal ones as they came: digit by digit, without those that are the same in all keys. Large cloths have
 * millions of springs, and comparing them took a third of the time in which they are built. */
static bool sort_keys(sk_allocator *allocator, keyed **keys, size_t count) {
    keyed *from = *keys, *to = sk_allocate(allocator, count * sizeof *to);
    uint32_t(*counts)[DIGIT_VALUES] = sk_allocate(allocator, DIGITS * sizeof *counts);
    bool good = to && counts;
    for (size_t i = 0; i < count && good; i++)
        for (int d = 0; d < DIGITS; d++) counts[d][digit_of(from[i].key, d)]++;
    for (int d = 0; d < DIGITS && good; d++) {
        uint32_t *start = counts[d], next = 0;
        if (!count || start[digit_of(from[0].key, d)] == count) continue;
        for (size_t v = 0; v < DIGIT_VALUES; v++) {
            uint32_t first = next;
            next += start[v];
            start[v] = first;
        }
        for (size_t i = 0; i < count; i++) to[start[digit_of(from[i].key, d)]++] = from[i];
        keyed *sorted = to;
        to = from, from = sorted;
    }
    sk_release(allocator, counts);
    sk_release(allocator, to);
    *keys = from;
    return good;
}

/* Puts one list in the order of directions, each from lower places to higher ones. */
static bool sort_by_direction(sk_allocator *allocator, struct sk_spring_list *list, const uint32_t *place) {
    size_t count = list->count;
    keyed *keys = sk_allocate(allocator, count * sizeof *keys);
    struct sk_spring_list sorted = {.pairs = sk_allocate(allocator, 2 * count * sizeof *sorted.pairs),
                                    .rest = sk_allocate(allocator, count * sizeof *sorted.rest),
                                    .scale = sk_allocate(allocator, count * sizeof *sorted.scale),
                                    .count = count};
    bool good = keys && sorted.pairs && sorted.rest && sorted.scale;
    for (size_t i = 0; i < count && good; i++) {
        uint32_t a = list->pairs[2 * i], b = list->pairs[2 * i + 1], at = place ? place[a] : a, to = place ? place[b] : b;
        uint32_t low = at < to ? at : to, step = at < to ? to - at : at - to;
        if (low != at) list->pairs[2 * i] = b, list->pairs[2 * i + 1] = a;
        keys[i] = (keyed){(uint64_t)step << 32 | low, (uint32_t)i};
    }
    good = good && sort_keys(allocator, &keys, count);
    for (size_t i = 0; i < count && good; i++) {
        uint32_t from = keys[i].spring;
        sorted.pairs[2 * i] = list->pairs[2 * from], sorted.pairs[2 * i + 1] = list->pairs[2 * from + 1];
        sorted.rest[i] = list->rest[from], sorted.scale[i] = list->scale[from];
    }
    struct sk_spring_list unused = good ? *list : sorted;
    if (good) *list = sorted;
    sk_release(allocator, unused.pairs);
    sk_release(allocator, unused.rest);
    sk_release(allocator, unused.scale);
    sk_release(allocator, keys);
    return good;
}

bool sk_order_by_direction(sk_springs *springs, const uint32_t *place) {
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++)
        if (!sort_by_direction(springs->allocator, &springs->list[sort], place)) return false;
    return true;
}

/* ---- outward ---- */

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

static bool sort_outward(sk_allocator *allocator, struct sk_spring_list *list, const double *distance) {
    sorted_spring *sorted = sk_allocate(allocator, list->count * sizeof *sorted);
    if (!sorted) return false;
    for (size_t i = 0; i < list->count; i++) {
        uint32_t a = list->pairs[2 * i], b = list->pairs[2 * i + 1];
        // radial: the ends' distances differ by more than half the length
        bool later = !(fabs(distance[a] - distance[b]) > 0.5 * (double)list->rest[i]);
        sorted[i] = (sorted_spring){0.5 * (distance[a] + distance[b]), later, a, b, list->rest[i], list->scale[i]};
    }
    qsort(sorted, list->count, sizeof *sorted, compare_springs);
    for (size_t i = 0; i < list->count; i++) {
        list->pairs[2 * i] = sorted[i].a, list->pairs[2 * i + 1] = sorted[i].b;
        list->rest[i] = sorted[i].rest, list->scale[i] = sorted[i].scale;
    }
    sk_release(allocator, sorted);
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
        good = sort_outward(allocator, &springs->list[sort], distance);
    // neighbours in the order of sweeps are neighbours in memory
    for (size_t i = 0; i < count && good; i++) order[i] = (ranked){distance[i], (uint32_t)i};
    if (good) qsort(order, count, sizeof *order, compare_ranked);
    for (size_t i = 0; i < count && good; i++) rank[order[i].particle] = (uint32_t)i;
    sk_release(allocator, distance);
    sk_release(allocator, order);
    return good;
}
