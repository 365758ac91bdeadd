/* Finding a particle's candidate neighbours in the cells, in groups of sixteen places: for kernels, once for each
 * instruction set. */
#include "space/cells.h"

/* The nine lines of cells around a particle, one in each lane: the wide version of sk_cells_ranges(). */
enum { LINES = 9, LINE_VECTORS = (LINES + SK_PART - 1) / SK_PART };
typedef struct nine_lines {
    // the distance to the line, in cells, is wall + share * place in the cell
    sk_wide wall_y[LINE_VECTORS], wall_z[LINE_VECTORS], share_y[LINE_VECTORS], share_z[LINE_VECTORS];
    sk_mask step_z[LINE_VECTORS];                     // cells from the particle's line to one at z - 1 or z + 1
    sk_mask below[LINE_VECTORS], above[LINE_VECTORS]; // lines at y - 1, at y + 1
} nine_lines;

SK_INLINE nine_lines lines_of(const sk_cells *cells) {
    nine_lines lines;
    for (int i = 0; i < LINE_VECTORS * SK_PART; i++) {
        int dy = i < LINES ? i % 3 - 1 : 0, dz = i < LINES ? i / 3 - 1 : 0, v = i / SK_PART, l = i % SK_PART;
        lines.wall_y[v][l] = dy ? (real)(dy > 0) - cells->slack : 0;
        lines.wall_z[v][l] = dz ? (real)(dz > 0) - cells->slack : 0;
        lines.share_y[v][l] = (real)-dy, lines.share_z[v][l] = (real)-dz;
        lines.below[v][l] = -(dy < 0), lines.above[v][l] = -(dy > 0);
        lines.step_z[v][l] = (sk_lane_int)cells->count_x * cells->layer * dz;
    }
    return lines;
}

/* Which of the nine lines exist, a bit for each. */
SK_INLINE uint32_t lines_inside(const sk_cells *cells, int32_t iy, int32_t iz) {
    uint32_t lines = 0x1ff;
    if (iy == 0) lines &= ~0x049u;
    if (iy + 1 == cells->count_y) lines &= ~0x124u;
    if (iz == 0) lines &= ~0x007u;
    if (iz + 1 == cells->count_z) lines &= ~0x1c0u;
    return lines;
}

/* Groups of sixteen places: where each begins, and which of its places are candidates. */
enum { SIXTEENS = 64 };
typedef struct sixteen_lists {
    uint32_t place[SIXTEENS + SK_LANES];
    uint32_t some[SIXTEENS + SK_LANES]; // a bit for each that is a candidate
    size_t count;
} sixteen_lists;

/* Ranges of places, one in each lane: where the rest of each begins, and how many places are left. */
typedef struct nine_ranges {
#if SK_WIDTH == 64
    __m512i begin, left; // vectors: storing single lanes would delay loads of the whole
#else
    int32_t begin[SK_LANES], left[SK_LANES];
#endif
} nine_ranges;

/* Lists the next sixteen places of each range that has any left; false if none has. Ranges take turns, so that those of
 * fewer than sixteen, which most are, need no branch each. */
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

/* The ranges of candidates for a particle at p: for each of nine lines, where the range begins and its length. */
SK_INLINE void find_ranges(const sk_cells *cells, const nine_lines *lines, sk_vec3 p, real reach, nine_ranges *ranges) {
    real py = (p.y - cells->origin.y) * cells->per_yz, pz = (p.z - cells->origin.z) * cells->per_yz;
    int32_t iy = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
    int32_t iz = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
    int32_t line = sk_cells_line(cells, iy, iz);
    int32_t down = iy > 0 ? sk_cells_line(cells, iy - 1, iz) - line : 0,
            up = iy + 1 < cells->count_y ? sk_cells_line(cells, iy + 1, iz) - line : 0;
    sk_wide x = sk_splat(p.x), origin = sk_splat(cells->origin.x), per = sk_splat(cells->per_x);
    sk_wide size = sk_splat(cells->size), last = sk_splat((real)(cells->count_x - 1));
    const sk_mask none = {0};
    sk_mask first[LINE_VECTORS], end[LINE_VECTORS];
    for (int v = 0; v < LINE_VECTORS; v++) {
        sk_wide my = lines->wall_y[v] + lines->share_y[v] * sk_splat(py - (real)iy),
                mz = lines->wall_z[v] + lines->share_z[v] * sk_splat(pz - (real)iz);
        my = sk_keep(sk_positive(my), my) * size;
        mz = sk_keep(sk_positive(mz), mz) * size;
        sk_wide left = (sk_splat(reach * reach) - mz * mz) - my * my;
        sk_mask some = sk_positive(left);
        sk_wide half = sk_wide_sqrt(sk_keep(some, left)) * sk_splat((real)1.00001);
        sk_wide low = ((x - half) - origin) * per, high = ((x + half) - origin) * per;
        low = sk_keep(sk_positive(low), low), high = sk_keep(sk_positive(high), high);
        low = sk_select(sk_more(last, low), low, last);
        high = sk_select(sk_more(last, high), high, last);
        sk_mask base =
            lines->step_z[v] + (none + line) + (lines->below[v] & (none + down)) + (lines->above[v] & (none + up));
        first[v] = (base + __builtin_convertvector(low, sk_mask)) & some;
        end[v] = (base + __builtin_convertvector(high, sk_mask) + 1) & some;
    }
    uint32_t inside = lines_inside(cells, iy, iz);
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    __mmask16 rows_inside = (__mmask16)inside;
    ranges->begin =
        _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), rows_inside, (__m512i)first[0], cells->start, 4);
    __m512i to = _mm512_mask_i32gather_epi32(_mm512_setzero_si512(), rows_inside, (__m512i)end[0], cells->start, 4);
    ranges->left = _mm512_sub_epi32(to, ranges->begin);
#else
    int32_t begin[SK_LANES] = {0}, count[SK_LANES] = {0};
    for (int i = 0; i < LINES; i++) {
        bool there = inside >> i & 1;
        sk_lane_int from = there ? first[i / SK_PART][i % SK_PART] : 0, to = there ? end[i / SK_PART][i % SK_PART] : 0;
        begin[i] = (int32_t)cells->start[from];
        count[i] = (int32_t)cells->start[to] - begin[i];
    }
    memcpy(&ranges->begin, begin, sizeof begin);
    memcpy(&ranges->left, count, sizeof count);
#endif
}
