/* Which places of the cells a particle has to look at, as sixteens of candidates: for kernels, once for
 * each instruction set. */
#include "space/cells.h"

/* A number in all lanes, in the parts that the processor works on: of a whole one, or of a number beside a wide, gcc
 * makes sixteen stores where it knows no 64 bytes at once. */
SK_INLINE sk_wide all(real a) {
    parts p;
    for (int i = 0; i < native_parts; i++) p.native[i] = a - (native){0};
    return p.wide;
}

/* Where the nine lines of cells around a particle are, a line a lane; see sk_cells_ranges(), which this is wide. */
typedef struct nine_lines {
    sk_wide wall_y, wall_z, share_y, share_z; // the distance to the line, in cells, is wall + share * place in the cell
    sk_mask step_z;                           // in the array of cells
    sk_mask below, above;                     // lines at y - 1, at y + 1
} nine_lines;

SK_INLINE nine_lines rows_of(const sk_cells *cells) {
    nine_lines rows;
    for (int l = 0; l < SK_LANES; l++) {
        int dy = l < 9 ? l % 3 - 1 : 0, dz = l < 9 ? l / 3 - 1 : 0;
        rows.wall_y[l] = dy ? (real)(dy > 0) - cells->slack : 0;
        rows.wall_z[l] = dz ? (real)(dz > 0) - cells->slack : 0;
        rows.share_y[l] = (real)-dy, rows.share_z[l] = (real)-dz;
        rows.below[l] = -(dy < 0), rows.above[l] = -(dy > 0);
        rows.step_z[l] = (sk_lane_int)cells->count_x * cells->layer * dz;
    }
    return rows;
}

/* Which of the nine there are, a bit each. */
SK_INLINE uint32_t lines_inside(const sk_cells *cells, int32_t iy, int32_t iz) {
    uint32_t lines = 0x1ff;
    if (iy == 0) lines &= ~0x049u;
    if (iy + 1 == cells->count_y) lines &= ~0x124u;
    if (iz == 0) lines &= ~0x007u;
    if (iz + 1 == cells->count_z) lines &= ~0x1c0u;
    return lines;
}

/* Sixteens of candidates: where each begins, and which of them are candidates. */
enum { SIXTEENS = 64 };
typedef struct sixteen_lists {
    uint32_t place[SIXTEENS + SK_LANES];
    uint32_t some[SIXTEENS + SK_LANES]; // a bit for each that is a candidate
    size_t count;
} sixteen_lists;

/* Ranges of places, a lane each: where what is left of them begins, and how many that is. */
typedef struct nine_ranges {
#if SK_WIDTH == 64
    __m512i begin, left; // as they are worked on: stores of single lanes would hold up loads of all
#else
    int32_t begin[SK_LANES], left[SK_LANES];
#endif
} nine_ranges;

/* Lists the next sixteen of each range that is not used up; false when all are. Ranges take turns, so that rows of
 * fewer than sixteen, the most of them, are listed without a branch each. */
SK_INLINE bool list(nine_ranges *ranges, sixteen_lists *list) {
    size_t before = list->count;
#if SK_WIDTH == 64
    __mmask16 some = _mm512_cmpgt_epi32_mask(ranges->left, _mm512_setzero_si512());
    if (!some) return false;
    _mm512_storeu_si512(list->place + before, _mm512_maskz_compress_epi32(some, ranges->begin));
    const __m512i one = _mm512_set1_epi32(1), all = _mm512_set1_epi32(SK_LANES);
    __m512i bits = _mm512_sub_epi32(_mm512_sllv_epi32(one, _mm512_min_epi32(ranges->left, all)), one);
    _mm512_storeu_si512(list->some + before, _mm512_maskz_compress_epi32(some, bits));
    ranges->begin = _mm512_add_epi32(ranges->begin, _mm512_set1_epi32(SK_LANES));
    ranges->left = _mm512_sub_epi32(ranges->left, _mm512_set1_epi32(SK_LANES));
    list->count = before + (size_t)__builtin_popcount(some);
#else
    for (int r = 0; r < 9; r++) {
        list->place[list->count] = (uint32_t)ranges->begin[r];
        list->some[list->count] = ranges->left[r] < SK_LANES ? (1u << (ranges->left[r] & 15)) - 1 : 0xffffu;
        list->count += ranges->left[r] > 0;
        ranges->begin[r] += SK_LANES, ranges->left[r] -= SK_LANES;
    }
#endif
    return list->count != before;
}

/* The ranges of candidates of a particle at p: where each of nine rows begins, and how many are in it. */
SK_INLINE void find_ranges(const sk_cells *cells, const nine_lines *rows, sk_vec3 p, real reach, nine_ranges *ranges) {
    real py = (p.y - cells->origin.y) * cells->per_yz, pz = (p.z - cells->origin.z) * cells->per_yz;
    int32_t iy = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
    int32_t iz = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
    sk_wide my = rows->wall_y + rows->share_y * all(py - (real)iy),
            mz = rows->wall_z + rows->share_z * all(pz - (real)iz), size = all(cells->size);
    my = sk_keep(sk_positive(my), my) * size;
    mz = sk_keep(sk_positive(mz), mz) * size;
    sk_wide left = (all(reach * reach) - mz * mz) - my * my;
    sk_mask some = sk_positive(left);
    sk_wide half = sk_wide_sqrt(sk_keep(some, left)) * all((real)1.00001);
    sk_wide x = all(p.x), origin = all(cells->origin.x), per = all(cells->per_x);
    sk_wide low = ((x - half) - origin) * per, high = ((x + half) - origin) * per;
    sk_wide last = all((real)(cells->count_x - 1));
    low = sk_keep(sk_positive(low), low), high = sk_keep(sk_positive(high), high);
    low = sk_select(sk_more(last, low), low, last);
    high = sk_select(sk_more(last, high), high, last);
    int32_t line = sk_cells_line(cells, iy, iz);
    int32_t down = iy > 0 ? sk_cells_line(cells, iy - 1, iz) - line : 0,
            up = iy + 1 < cells->count_y ? sk_cells_line(cells, iy + 1, iz) - line : 0;
    const sk_mask none = {0};
    sk_mask base = rows->step_z + (none + line) + (rows->below & (none + down)) + (rows->above & (none + up));
    sk_mask first = (base + __builtin_convertvector(low, sk_mask)) & some,
            end = (base + __builtin_convertvector(high, sk_mask) + 1) & some;
    uint32_t inside = lines_inside(cells, iy, iz);
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    __mmask16 rows_inside = (__mmask16)inside;
    ranges->begin = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), rows_inside, (__m512i)first, cells->start, 4);
    __m512i to = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), rows_inside, (__m512i)end, cells->start, 4);
    ranges->left = _mm512_sub_epi32(to, ranges->begin);
#else
    int32_t begin[SK_LANES] = {0}, count[SK_LANES] = {0};
    for (int l = 0; l < 9; l++) {
        sk_lane_int from = inside >> l & 1 ? first[l] : 0, to = inside >> l & 1 ? end[l] : 0;
        begin[l] = (int32_t)cells->start[from];
        count[l] = (int32_t)cells->start[to] - begin[l];
    }
    memcpy(&ranges->begin, begin, sizeof begin);
    memcpy(&ranges->left, count, sizeof count);
#endif
}
