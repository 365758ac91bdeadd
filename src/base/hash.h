/* Hashes: FNV-1a over 64-bit words for the state, and a mixer for hash tables. */
#ifndef SK_BASE_HASH_H
#define SK_BASE_HASH_H

#include <stdint.h>

#define SK_HASH_START 0xcbf29ce484222325u

static inline uint64_t sk_hash_word(uint64_t hash, uint64_t word) {
    hash = (hash ^ word) * 0x100000001b3u;
    return hash ^ hash >> 29;
}

/* Spreads a key over all 64 bits (the finaliser of splitmix64). */
static inline uint64_t sk_hash_mix(uint64_t key) {
    key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
    key = (key ^ key >> 27) * 0x94d049bb133111ebu;
    return key ^ key >> 31;
}

#endif
