/* Pairs of features: what is kept of each, in which order they are, and the kernels that look at many of them. */
#ifndef SK_CONTACT_PAIRS_H
#define SK_CONTACT_PAIRS_H

#include <string.h>

#include "base/isa.h"
#include "base/memory.h"
#include "base/vector.h"

/* Pairs, one array a number, padded to whole blocks of sixteen. Corners: a vertex and a triangle's three, or an edge's two
 * and another's two. The normal leads from the second feature to the first; `share` says where on them they are nearest:
 * u, v of a triangle's second and third corner, or how far along each edge. */
typedef struct sk_pairs {
    uint32_t *corner[4];
    uint64_t *key; /* the order of pairs: both leaves, and which of their features */
    real *distance, *thickness, *normal[3], *share[2];
    uint8_t *settled; /* of a bound: planes divide it, or what is pinned takes all the room; */
    uint8_t *closes;  /* or they have to; what kernels find out */
    size_t count, capacity;
} sk_pairs;

/* `settled`: those before SK_IS_DIVIDED are looked at again. */
enum { SK_GOES_ALONG = 1, SK_GOES_ALONG_AGAIN, SK_IS_DIVIDED, SK_IS_FORCED };

/* Nearest points of all pairs, from the places x of their corners; and which are near: `closes`. */
typedef void sk_closest_kernel(const sk_vec4 *x, sk_pairs *pairs);

/* Finds out which pairs, of places x before a substep, might lose their gap by any shares of these ways (w: their length)
 * and which do by all of them: `closes`. Pairs need their distance and normal. */
enum { SK_CLOSES = 1, SK_MAY_CLOSE = 2, SK_IS_NEAR = 4 };
typedef struct sk_closing_values {
    real least, rounding; /* m: what is less does not close at all; how well a distance is known */
    real longest;         /* of all ways, m */
} sk_closing_values;
typedef void sk_closing_kernel(const sk_vec4 *x, const sk_vec4 *way, const sk_closing_values *values, sk_pairs *pairs);

/* Takes over those pairs that may come near or close on their vertices' ways, from x (w: their reach) to `end`, with where they
 * are nearest at x; there is room for as many, and a block. */
typedef struct sk_nearing_values {
    real near, rounding, closing, per; /* m; m; share of a step; steps that the way has, inverse */
    real shares; /* of any shares of the way: what is left of a gap that counts as closed; 0: all of the way */
} sk_nearing_values;
typedef void sk_nearing_kernel(const sk_vec4 *x, const sk_vec4 *end, const sk_nearing_values *values,
                               const sk_pairs *pairs, sk_pairs *fresh);

/* Some of the pairs that are kept: twice where a pair is, and one more if it is a late one. */
typedef struct sk_pair_list {
    uint32_t *data;
    size_t count, capacity;
} sk_pair_list;

/* Those that may close, with their corners. */
typedef struct sk_closing_pair {
    uint32_t entry, corner[4];
} sk_closing_pair;
/* One that may have too little room where its corners stand, by its sort and key; and whether it had when the round began. */
typedef struct sk_yielding {
    uint64_t key;
    uint32_t corner[4];
    sk_vec3 normal;
    uint8_t sort;
    bool now;
} sk_yielding;
typedef struct sk_yielding_list {
    sk_yielding *data;
    size_t count, capacity;
} sk_yielding_list;
/* One that planes divide: it stays known when it is let go. */
typedef struct sk_divided {
    uint64_t key;
    uint32_t corner[4];
    sk_vec3 normal;
    real thickness;
} sk_divided;
typedef struct sk_divided_list {
    sk_divided *data;
    size_t count, capacity;
} sk_divided_list;
typedef struct sk_closing_list {
    sk_closing_pair *data;
    size_t count, capacity;
} sk_closing_list;

/* Whether features whose corners go straight from x[0] to x[1] come nearer than that on the way. */
typedef bool sk_passes_kernel(const sk_vec3 x[2][4], real near);

/* A pair's key, and where it is. */
typedef struct sk_pair_place {
    uint64_t key;
    uint32_t at;
} sk_pair_place;

enum { SK_CORNERS, SK_EDGES, SK_PAIR_SORTS }; /* vertex and triangle, edge and edge: the order of pairs */

/* ---- pairs.c ---- */

/* Room for `need` pairs; false when there is no memory. */
bool sk_pairs_reserve(sk_pairs *pairs, sk_allocator *allocator, size_t need);
/* Fills the last block up with pairs of nobody. */
void sk_pairs_pad(sk_pairs *pairs);
/* Pairs [begin, end) as pairs of their own; begin is a multiple of sixteen. */
sk_pairs sk_pairs_between(const sk_pairs *pairs, size_t begin, size_t end);
/* Puts pairs [first, end) of others from `at` on. */
void sk_pairs_put(sk_pairs *pairs, size_t at, const sk_pairs *others, size_t first, size_t end);
/* Adds all of pairs [first, end) of others; there is room. */
void sk_pairs_take(sk_pairs *pairs, const sk_pairs *others, size_t first, size_t end);
void sk_pairs_release(sk_pairs *pairs, sk_allocator *allocator);
static inline void sk_pairs_copy(sk_pairs *to, const sk_pairs *from, size_t k) {
    for (int c = 0; c < 4; c++) to->corner[c][to->count] = from->corner[c][k];
    to->key[to->count] = from->key[k];
    to->settled[to->count] = from->settled[k];
    to->thickness[to->count] = from->thickness[k];
    to->distance[to->count++] = from->distance[k];
}
/* With its normal, and where its features are nearest. */
static inline void sk_pairs_copy_all(sk_pairs *to, const sk_pairs *from, size_t k) {
    for (int c = 0; c < 3; c++) to->normal[c][to->count] = from->normal[c][k];
    for (int c = 0; c < 2; c++) to->share[c][to->count] = from->share[c][k];
    sk_pairs_copy(to, from, k);
}

/* Of the eight pairs from k on, a multiple of eight, those of which kernels have found `what`: a bit in the byte of each. */
static inline uint64_t sk_pairs_that(const sk_pairs *pairs, size_t k, uint64_t what) {
    uint64_t found;
    memcpy(&found, pairs->closes + k, sizeof found);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    found = __builtin_bswap64(found);
#endif
    size_t left = pairs->count - k; // the rest of a block is nobody's
    if (left < sizeof found) found &= ((uint64_t)1 << 8 * left) - 1;
    return found & what * 0x0101010101010101u;
}
static inline size_t sk_first_of(uint64_t found) {
    return (size_t)__builtin_ctzll(found) / 8;
}

/* Keys of pairs say of which leaves they are, in order; the key of two leaves' first pair. */
static inline uint64_t sk_leaves_key(uint32_t a, uint32_t b) {
    return (uint64_t)a << 36 | (uint64_t)b << 8;
}
static inline size_t sk_first_leaf(uint64_t key) {
    return (size_t)(key >> 36);
}
static inline size_t sk_second_leaf(uint64_t key) {
    return (size_t)(key >> 8 & 0xfffffff);
}

/* ---- closest.c ---- */

/* By sort of pairs. */
extern sk_closest_kernel *const sk_closest[SK_PAIR_SORTS][SK_ISA_COUNT];
/* passing.c */
extern sk_passes_kernel *const sk_passes[SK_PAIR_SORTS][SK_ISA_COUNT];
/* search/nearing.c */
extern sk_closing_kernel *const sk_closing[SK_PAIR_SORTS][SK_ISA_COUNT];
extern sk_nearing_kernel *const sk_nearing[SK_PAIR_SORTS][SK_ISA_COUNT];

#endif
