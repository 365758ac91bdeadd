/* Bits of masks in lists, without a branch on how many they are: one for each bit would often go wrong. */
#ifndef SK_CONTACT_BITS_H
#define SK_CONTACT_BITS_H

enum { SK_BITS_AFTER = 16 }; /* numbers behind a list that may be written over */

/* Adds `base` and the number of each bit to a list, in order, of a mask that has no more than `most`; returns how many there
 * are then. */
SK_INLINE size_t sk_list_bits(uint32_t *list, size_t count, uint64_t mask, int most, uint32_t base) {
#if SK_WIDTH == 64
    const __m512i lanes = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    for (int l = 0; l < most; l += SK_BITS_AFTER) {
        const __mmask16 some = (__mmask16)(mask >> l);
        __m512i number = _mm512_add_epi32(lanes, _mm512_set1_epi32((int)base + l));
        _mm512_storeu_si512(list + count, _mm512_maskz_compress_epi32(some, number));
        count += (size_t)__builtin_popcount(some);
    }
    return count;
#else
    (void)most;
    uint32_t *number = list + count;
    int left = __builtin_popcountll(mask);
    count += (size_t)left;
    for (; left > 0; left -= 4, number += 4)
        for (int j = 0; j < 4; j++) {
            number[j] = base + (uint32_t)__builtin_ctzll(mask | (uint64_t)1 << 63);
            mask &= mask - 1;
        }
    return count;
#endif
}

#endif
