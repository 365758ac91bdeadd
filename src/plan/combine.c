/* The arithmetic of whole vectors, and turning their blocks from quads to packed and back. */
#ifdef SK_ISA

/* In a wide of four quads, and in the four wides of a packed block, the places of x, y and z. */
SK_INLINE sk_mask SK_ISA(written)(bool packed, int part) {
    if (packed) return part < 3 ? (sk_mask){-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1} : (sk_mask){0};
    return (sk_mask){-1, -1, -1, 0, -1, -1, -1, 0, -1, -1, -1, 0, -1, -1, -1, 0};
}

/* Runs VALUE, an expression of the part's wides p, q, r, over the blocks of [begin, end). */
#define FOR_PARTS(VALUE)                                                                                               \
    for (size_t slot = begin; slot < end; slot += SK_LANES) {                                                          \
        bool packed = slot < row->packed;                                                                              \
        for (int part = 0; part < 4; part++) {                                                                         \
            size_t at = slot / 4 + (size_t)part;                                                                       \
            dst[at] = SK_ISA(sk_select)(SK_ISA(written)(packed, part), (VALUE), dst[at]);                              \
        }                                                                                                              \
    }

static void SK_ISA(sum)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[row->dst];
    const sk_wide *p = (const sk_wide *)(const void *)run->vector[row->source[0]];
    const sk_wide *q = (const sk_wide *)(const void *)run->vector[row->source[1]];
    const sk_wide *r = (const sk_wide *)(const void *)run->vector[row->source[2]];
    sk_wide a = SK_ISA(sk_splat)((real)row->coefficient[0]), b = SK_ISA(sk_splat)((real)row->coefficient[1]);
    sk_wide c = SK_ISA(sk_splat)((real)row->coefficient[2]);
    if (row->source[0] == SK_NONE) FOR_PARTS((sk_wide){0})
    else if (row->source[1] == SK_NONE) FOR_PARTS(a * p[at])
    else if (row->source[2] == SK_NONE) FOR_PARTS(a * p[at] + b * q[at])
    else FOR_PARTS(a * p[at] + b * q[at] + c * r[at])
}

static void SK_ISA(difference)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[row->dst];
    const sk_wide *p = (const sk_wide *)(const void *)run->vector[row->source[0]];
    const sk_wide *q = (const sk_wide *)(const void *)run->vector[row->source[1]];
    sk_wide a = SK_ISA(sk_splat)((real)row->coefficient[0]);
    FOR_PARTS(a * (p[at] - q[at]))
}

/* The inverse mass belongs to the particle, so it is spread over its x, y and z first. */
static void SK_ISA(kick)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_wide *dst = (sk_wide *)(void *)run->vector[row->dst];
    const sk_wide *p = (const sk_wide *)(const void *)run->vector[row->source[0]];
    const sk_wide *q = (const sk_wide *)(const void *)run->vector[row->source[1]];
    const sk_wide *x = (const sk_wide *)(const void *)run->vector[SK_X];
    sk_wide a = SK_ISA(sk_splat)((real)row->coefficient[0]);
    for (size_t slot = begin; slot < end; slot += SK_LANES) {
        bool packed = slot < row->packed;
        for (int part = 0; part < 4; part++) {
            size_t at = slot / 4 + (size_t)part;
            sk_wide own = x[at];
            sk_wide w = packed ? x[slot / 4 + 3] : __builtin_shufflevector(own, own, 3, 3, 3, 3, 7, 7, 7, 7, 11, 11, 11, 11, 15, 15, 15, 15);
            dst[at] = SK_ISA(sk_select)(SK_ISA(written)(packed, part), p[at] + (a * w) * q[at], dst[at]);
        }
    }
}
#undef FOR_PARTS

static void SK_ISA(pack)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_LANES)
        SK_ISA(sk_store_block)(run->vector[row->dst], slot, true, SK_ISA(sk_load_block)(run->vector[row->dst], slot, false));
}

static void SK_ISA(unpack)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_LANES)
        SK_ISA(sk_store_block)(run->vector[row->dst], slot, false, SK_ISA(sk_load_block)(run->vector[row->dst], slot, true));
}

#else
#include "plan/row.h"

#define SK_KERNELS "plan/combine.c"
#include "base/for_each_isa.h"

const sk_kernels sk_combine_sum = {SK_EACH_ISA(sum)};
const sk_kernels sk_combine_difference = {SK_EACH_ISA(difference)};
const sk_kernels sk_combine_kick = {SK_EACH_ISA(kick)};
const sk_kernels sk_pack = {SK_EACH_ISA(pack)};
const sk_kernels sk_unpack = {SK_EACH_ISA(unpack)};
#endif
