/* The memory of pairs: arrays that grow by whole blocks, and the padding of the last one. */
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
    for (size_t i = 0; i < sizeof reals / sizeof *reals && good; i++) {
        grown = capacity;
        good = sk_reserve(allocator, (void **)reals[i], &grown, need, sizeof **reals[i]);
    }
    grown = capacity;
    good = good && sk_reserve(allocator, (void **)&pairs->settled, &grown, need, sizeof *pairs->settled);
    if (good) pairs->capacity = grown / BLOCK * BLOCK;
    return good;
}

void sk_pairs_pad(sk_pairs *pairs) {
    for (size_t k = pairs->count; k % BLOCK; k++)
        for (int c = 0; c < 4; c++) pairs->corner[c][k] = 0;
}

void sk_pairs_release(sk_pairs *pairs, sk_allocator *allocator) {
    for (int c = 0; c < 4; c++) sk_release(allocator, pairs->corner[c]);
    for (int c = 0; c < 3; c++) sk_release(allocator, pairs->normal[c]);
    for (int c = 0; c < 2; c++) sk_release(allocator, pairs->share[c]);
    sk_release(allocator, pairs->distance);
    sk_release(allocator, pairs->thickness);
    sk_release(allocator, pairs->settled);
    *pairs = (sk_pairs){.count = 0};
}
