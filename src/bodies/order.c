/* Finding whether a mesh is a grid, and sorting springs: by direction, outward from pins, or scattered. */
#include "bodies/order.h"

#include <math.h>
#include <string.h>

#include "bodies/geodesic.h"

enum {
    MOST_STEP = 2, /* rows and columns that a grid's spring may lead over */
    BROAD = 128,   /* particles in a layer of a mesh as thick as an edge is long */
    WINDOW = 4096  /* springs or hinges scattered together: enough to fill groups, few enough to be near in memory */
};

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

/* What a spring or hinge is sorted by (a spring's direction and place, say), and its number. */
typedef struct keyed {
    uint64_t key;
    uint32_t number;
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

/* Puts a list in an order, given as its springs' numbers; false when there is no memory. */
static bool take_in_order(sk_allocator *allocator, struct sk_spring_list *list, const uint32_t *numbers) {
    size_t count = list->count;
    struct sk_spring_list sorted = {.pairs = sk_allocate(allocator, 2 * count * sizeof *sorted.pairs),
                                    .rest = sk_allocate(allocator, count * sizeof *sorted.rest),
                                    .scale = sk_allocate(allocator, count * sizeof *sorted.scale),
                                    .count = count};
    bool good = sorted.pairs && sorted.rest && sorted.scale;
    for (size_t i = 0; i < count && good; i++) {
        uint32_t from = numbers[i];
        sorted.pairs[2 * i] = list->pairs[2 * from], sorted.pairs[2 * i + 1] = list->pairs[2 * from + 1];
        sorted.rest[i] = list->rest[from], sorted.scale[i] = list->scale[from];
    }
    struct sk_spring_list unused = good ? *list : sorted;
    if (good) *list = sorted;
    sk_release(allocator, unused.pairs);
    sk_release(allocator, unused.rest);
    sk_release(allocator, unused.scale);
    return good;
}

/* The same, as keys that have been sorted. */
static bool take_in_order_of(sk_allocator *allocator, struct sk_spring_list *list, const keyed *keys) {
    uint32_t *numbers = sk_allocate(allocator, list->count * sizeof *numbers);
    for (size_t i = 0; i < list->count && numbers; i++) numbers[i] = keys[i].number;
    bool good = numbers && take_in_order(allocator, list, numbers);
    sk_release(allocator, numbers);
    return good;
}

/* Puts one list in the order of directions, each from lower places to higher ones. */
static bool sort_by_direction(sk_allocator *allocator, struct sk_spring_list *list, const uint32_t *place) {
    keyed *keys = sk_allocate(allocator, list->count * sizeof *keys);
    for (size_t i = 0; i < list->count && keys; i++) {
        uint32_t a = list->pairs[2 * i], b = list->pairs[2 * i + 1], at = place ? place[a] : a,
                 to = place ? place[b] : b;
        uint32_t low = at < to ? at : to, step = at < to ? to - at : at - to;
        if (low != at) list->pairs[2 * i] = b, list->pairs[2 * i + 1] = a;
        keys[i] = (keyed){(uint64_t)step << 32 | low, (uint32_t)i};
    }
    bool good = keys && sort_keys(allocator, &keys, list->count) && take_in_order_of(allocator, list, keys);
    sk_release(allocator, keys);
    return good;
}

bool sk_order_by_direction(sk_springs *springs, const uint32_t *place) {
    for (int sort = 0; sort < SK_SPRING_SORTS; sort++)
        if (!sort_by_direction(springs->allocator, &springs->list[sort], place)) return false;
    return true;
}

/* ---- outward ---- */

/* A distance, which is not negative, as a number in the same order. */
static uint64_t key_of(double distance) {
    uint64_t key;
    memcpy(&key, &distance, sizeof key);
    return key;
}

/* Every second one first, and then those between, outward both times: projections one after the other do work round a cycle
 * (methods/plan_builder_correct.c), and where layer follows layer of regular triangles, always the same. 61 x 61 of these, numbered by
 * chance, that swing by two corners had up to 3,700 % of stretch, and 13 so, without what bounds it besides (now 3 to 9 with it);
 * irregular ones are nearly as firm as in one way. As good: forth, and back in the other half; the same in windows of 256 springs, of which too
 * many do not fit into groups that walk. In windows of 64 some waves of triangles still had 115 %. */
static bool take_in_turns(sk_allocator *allocator, keyed **keys, size_t count) {
    keyed *from = *keys, *to = sk_allocate(allocator, count * sizeof *to);
    size_t next = 0, outward = 0;
    if (!to) return false;
    while (outward < count && !(from[outward].key >> 63)) outward++;
    for (size_t i = 0; i < outward; i += 2) to[next++] = from[i];
    for (size_t i = 1; i < outward; i += 2) to[next++] = from[i];
    for (size_t i = outward; i < count; i += 2) to[next++] = from[i];
    for (size_t i = outward + 1; i < count; i += 2) to[next++] = from[i];
    sk_release(allocator, from);
    *keys = to;
    return true;
}

/* First springs that lead outward, then those that go round; each by distance, and equal ones by their particles. */
static bool sort_outward(sk_allocator *allocator, struct sk_spring_list *list, const double *distance) {
    size_t count = list->count;
    keyed *keys = sk_allocate(allocator, count * sizeof *keys);
    for (size_t i = 0; i < count && keys; i++)
        keys[i] = (keyed){(uint64_t)list->pairs[2 * i] << 32 | list->pairs[2 * i + 1], (uint32_t)i};
    bool good = keys && sort_keys(allocator, &keys, count);
    for (size_t i = 0; i < count && good; i++) {
        size_t from = keys[i].number;
        double a = distance[list->pairs[2 * from]], b = distance[list->pairs[2 * from + 1]];
        // outward: the ends' distances differ by more than half the length
        bool later = !(fabs(a - b) > 0.5 * (double)list->rest[from]);
        keys[i].key = (uint64_t)later << 63 | key_of(0.5 * (a + b));
    }
    good = good && sort_keys(allocator, &keys, count) && take_in_turns(allocator, &keys, count) &&
           take_in_order_of(allocator, list, keys);
    sk_release(allocator, keys);
    return good;
}

typedef struct axis {
    int number;
    double low, length;
} axis;

static axis longest_axis(const sk_sheet *sheet) {
    axis longest = {0, 0, -INFINITY};
    for (int k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < sheet->particle_count; i++) {
            low = fmin(low, sheet->position[i][k]);
            high = fmax(high, sheet->position[i][k]);
        }
        if (high - low > longest.length) longest = (axis){k, low, high - low};
    }
    return longest;
}

bool sk_order_is_broad(const sk_springs *springs, const sk_sheet *sheet) {
    const struct sk_spring_list *edges = &springs->list[SK_STRETCH];
    double sum = 0;
    for (size_t i = 0; i < edges->count; i++) sum += (double)edges->rest[i];
    double edge = edges->count ? sum / (double)edges->count : 0, length = longest_axis(sheet).length;
    return length > 0 && (double)sheet->particle_count * edge >= BROAD * length;
}

/* Distance from the pins along the sheet, or place along the longest axis; parts that no pin reaches come last. */
static bool find_distances(const sk_sheet *sheet, const bool *pinned, double *distance) {
    size_t count = sheet->particle_count, pins = 0;
    for (size_t i = 0; i < count; i++) pins += pinned[i];
    axis along = longest_axis(sheet);
    bool good = true;
    if (pins) {
        sk_geodesic *geodesic = sk_geodesic_create(sheet);
        uint32_t *nearest = sk_allocate(sheet->allocator, count * sizeof *nearest);
        good = geodesic && nearest && sk_geodesic_from(geodesic, pinned, distance, nearest);
        sk_geodesic_release(geodesic);
        sk_release(sheet->allocator, nearest);
    }
    for (size_t i = 0; i < count && good; i++)
        if (!pins || !(distance[i] < INFINITY))
            distance[i] = (pins ? 1e12 : 0) + sheet->position[i][along.number] - along.low;
    return good;
}

bool sk_order_outward(sk_springs *springs, const sk_sheet *sheet, const bool *pinned, uint32_t *rank) {
    sk_allocator *allocator = sheet->allocator;
    size_t count = sheet->particle_count;
    double *distance = sk_allocate(allocator, count * sizeof *distance);
    keyed *order = sk_allocate(allocator, count * sizeof *order);
    bool good = distance && order && find_distances(sheet, pinned, distance);
    for (int sort = 0; sort < SK_SPRING_SORTS && good; sort++)
        good = sort_outward(allocator, &springs->list[sort], distance);
    // neighbours in the order of sweeps are neighbours in memory
    for (size_t i = 0; i < count && good; i++) order[i] = (keyed){key_of(distance[i]), (uint32_t)i};
    good = good && sort_keys(allocator, &order, count);
    for (size_t i = 0; i < count && good; i++) rank[order[i].number] = (uint32_t)i;
    sk_release(allocator, distance);
    sk_release(allocator, order);
    return good;
}

/* ---- scattered ---- */

static size_t common_divisor(size_t a, size_t b) {
    while (b) {
        size_t rest = a % b;
        a = b, b = rest;
    }
    return a;
}

/* Steps through each window by the golden ratio of its size, so that elements near each other in the file are far apart
 * in the order. */
void sk_order_scatter(uint32_t *numbers, size_t count) {
    size_t windows = count / WINDOW + 1;
    for (size_t w = 0; w < windows; w++) {
        size_t first = w * count / windows, size = (w + 1) * count / windows - first;
        size_t step = (size_t)(0.6180339887498949 * (double)size);
        while (common_divisor(step, size) > 1) step++;
        for (size_t i = 0, at = 0; i < size; i++, at = (at + step) % size) numbers[first + i] = (uint32_t)(first + at);
    }
}

bool sk_order_scattered(sk_springs *springs) {
    bool good = true;
    for (int sort = 0; sort < SK_SPRING_SORTS && good; sort++) {
        struct sk_spring_list *list = &springs->list[sort];
        uint32_t *numbers = sk_allocate(springs->allocator, list->count * sizeof *numbers);
        if (numbers) sk_order_scatter(numbers, list->count);
        good = numbers && take_in_order(springs->allocator, list, numbers);
        sk_release(springs->allocator, numbers);
    }
    return good;
}

/* ---- hinges ---- */

bool sk_order_hinges(sk_allocator *allocator, uint32_t (**corners)[4], size_t count, const uint32_t *rank) {
    uint32_t(*from)[4] = *corners, (*to)[4] = sk_allocate(allocator, count * sizeof *to);
    uint32_t *numbers = sk_allocate(allocator, count * sizeof *numbers);
    keyed *keys = sk_allocate(allocator, count * sizeof *keys);
    bool good = to && numbers && keys;
    if (good && !rank) sk_order_scatter(numbers, count);
    for (size_t i = 0; i < count && good && rank; i++) {
        keys[i] = (keyed){0, (uint32_t)i};
        for (int k = 0; k < 4; k++) keys[i].key += rank[from[i][k]];
    }
    if (good && rank) good = sort_keys(allocator, &keys, count);
    for (size_t i = 0; i < count && good && rank; i++) numbers[i] = keys[i].number;
    for (size_t i = 0; i < count && good; i++) memcpy(to[i], from[numbers[i]], sizeof *to);
    sk_release(allocator, numbers);
    sk_release(allocator, keys);
    sk_release(allocator, good ? from : to);
    if (good) *corners = to;
    return good;
}
