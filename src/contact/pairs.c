/* The memory of pairs: arrays that grow by whole blocks, and the padding of the last one. */
#include <string.h>

#include "contact/touch.h"

enum { BLOCK = 16 };

bool sk_pairs_reserve(sk_pairs *pairs, sk_allocator *allocator, size_t need) {
    need = (need + BLOCK - 1) / BLOCK * BLOCK;
    if (need <= pairs->capacity) return true;
    real **reals[] = {&pairs->distance,  &pairs->thickness, &pairs->normal[0], &pairs->normal[1],
                      &pairs->normal[2], &pairs->share[0],  &pairs->share[1]};
    size_t capacity = pairs->capacity, grown = capacity;
    bool good = true;
    for (int c = 0; c < 4 && good; c++) {
        grown = capacity;
        good = sk_reserve(allocator, (void **)&pairs->corner[c], &grown, need, sizeof *pairs->corner[c]);
    }
    grown = capacity;
    good = good && sk_reserve(allocator, (void **)&pairs->key, &grown, need, sizeof *pairs->key);
    for (size_t i = 0; i < sizeof reals / sizeof *reals && good; i++) {
        grown = capacity;
        good = sk_reserve(allocator, (void **)reals[i], &grown, need, sizeof **reals[i]);
    }
    grown = capacity;
    good = good && sk_reserve(allocator, (void **)&pairs->settled, &grown, need, sizeof *pairs->settled);
    grown = capacity;
    good = good && sk_reserve(allocator, (void **)&pairs->closes, &grown, need, sizeof *pairs->closes);
    if (good) pairs->capacity = grown / BLOCK * BLOCK;
    return good;
}

void sk_pairs_pad(sk_pairs *pairs) {
    for (size_t k = pairs->count; k % BLOCK; k++) {
        for (int c = 0; c < 4; c++) pairs->corner[c][k] = 0;
        pairs->closes[k] = pairs->settled[k] = 0;
    }
}

sk_pairs sk_pairs_between(const sk_pairs *pairs, size_t begin, size_t end) {
    sk_pairs some = *pairs;
    for (int c = 0; c < 4; c++) some.corner[c] += begin;
    for (int c = 0; c < 3; c++) some.normal[c] += begin;
    for (int c = 0; c < 2; c++) some.share[c] += begin;
    some.key += begin, some.distance += begin, some.thickness += begin;
    some.settled += begin, some.closes += begin;
    some.count = end - begin;
    return some;
}

void sk_pairs_put(sk_pairs *pairs, size_t at, const sk_pairs *others, size_t first, size_t end) {
    size_t count = end - first;
    for (int c = 0; c < 4; c++) memcpy(pairs->corner[c] + at, others->corner[c] + first, count * sizeof(uint32_t));
    memcpy(pairs->key + at, others->key + first, count * sizeof(uint64_t));
    for (int c = 0; c < 3; c++) memcpy(pairs->normal[c] + at, others->normal[c] + first, count * sizeof(real));
    for (int c = 0; c < 2; c++) memcpy(pairs->share[c] + at, others->share[c] + first, count * sizeof(real));
    memcpy(pairs->distance + at, others->distance + first, count * sizeof(real));
    memcpy(pairs->thickness + at, others->thickness + first, count * sizeof(real));
    memcpy(pairs->settled + at, others->settled + first, count);
}

void sk_pairs_take(sk_pairs *pairs, const sk_pairs *others, size_t first, size_t end) {
    if (end > first) sk_pairs_put(pairs, pairs->count, others, first, end), pairs->count += end - first;
}

void sk_pairs_release(sk_pairs *pairs, sk_allocator *allocator) {
    for (int c = 0; c < 4; c++) sk_release(allocator, pairs->corner[c]);
    sk_release(allocator, pairs->key);
    for (int c = 0; c < 3; c++) sk_release(allocator, pairs->normal[c]);
    for (int c = 0; c < 2; c++) sk_release(allocator, pairs->share[c]);
    sk_release(allocator, pairs->distance);
    sk_release(allocator, pairs->thickness);
    sk_release(allocator, pairs->settled);
    sk_release(allocator, pairs->closes);
    *pairs = (sk_pairs){.count = 0};
}
