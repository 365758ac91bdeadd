#ifdef SK_ISA

/* Where sixteen of the user's particles are, in quads. */
SK_INLINE sk_wide3 SK_ISA(places)(const sk_run *run, size_t particle) {
    sk_wide4 x = SK_ISA(sk_gather)(run->vector[SK_X], run->slot_of + particle);
    return (sk_wide3){x.x, x.y, x.z};
}

/* Those that are somewhere (space/cells.h). */
SK_INLINE sk_mask SK_ISA(somewhere)(sk_wide3 p) {
    sk_wide most = SK_ISA(sk_splat)(SK_CELLS_FARTHEST);
    return SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.x), most) & SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.y), most) &
           SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.z), most);
}

static void SK_ISA(frame)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_state state = {run->vector[SK_X], run->vector[SK_V], row->packed, run->slot_of};
    real radius = (real)row->coefficient[0];
    if (row->packed || end - begin < SK_LANES) {
        if (!sk_cells_frame(run->cells, run->allocator, &state, begin, end, radius)) run->no_memory = true;
        return;
    }
    sk_wide far = SK_ISA(sk_splat)(SK_REAL_MAX), low[3] = {far, far, far}, high[3] = {-far, -far, -far};
    for (size_t i = begin; i < end; i += SK_LANES) {
        // the last sixteen, some of them again
        sk_wide3 p = SK_ISA(places)(run, i + SK_LANES <= end ? i : end - SK_LANES);
        sk_mask counts = SK_ISA(somewhere)(p);
        const sk_wide at[3] = {p.x, p.y, p.z};
        for (int k = 0; k < 3; k++) {
            low[k] = SK_ISA(sk_select)(counts & SK_ISA(sk_more)(low[k], at[k]), at[k], low[k]);
            high[k] = SK_ISA(sk_select)(counts & SK_ISA(sk_more)(at[k], high[k]), at[k], high[k]);
        }
    }
    real least[3], most[3];
    for (int k = 0; k < 3; k++) {
        least[k] = low[k][0], most[k] = high[k][0];
        for (int l = 1; l < SK_LANES; l++)
            least[k] = sk_min(least[k], low[k][l]), most[k] = sk_max(most[k], high[k][l]);
        if (least[k] > most[k]) least[k] = most[k] = 0; // nobody
    }
    if (!sk_cells_frame_box(run->cells, run->allocator, sk_v3(least[0], least[1], least[2]),
                            sk_v3(most[0], most[1], most[2]), begin, end, radius))
        run->no_memory = true;
}

/* sk_cells_place() of sixteen. */
SK_INLINE sk_mask SK_ISA(cell_along)(sk_wide at, real origin, real per, int32_t count) {
    sk_wide place = (at - origin) * per, top = SK_ISA(sk_splat)((real)count);
    sk_mask above = SK_ISA(sk_positive)(place), inside = above & SK_ISA(sk_more)(top, place);
    sk_mask cell = __builtin_convertvector(SK_ISA(sk_keep)(inside, place), sk_mask);
    return cell | (above & ~inside & (sk_lane_int)(count - 1));
}

static void SK_ISA(find)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_cells *cells = run->cells;
    if (run->no_memory) return;
    if (!row->packed)
        for (; begin + SK_LANES <= end; begin += SK_LANES) {
            sk_wide3 p = SK_ISA(places)(run, begin);
            sk_mask x = SK_ISA(cell_along)(p.x, cells->origin.x, cells->per_x, cells->count_x),
                    y = SK_ISA(cell_along)(p.y, cells->origin.y, cells->per_yz, cells->count_y),
                    z = SK_ISA(cell_along)(p.z, cells->origin.z, cells->per_yz, cells->count_z);
            sk_mask cell = x + cells->count_x * (y + cells->count_y * z), nowhere = ~SK_ISA(somewhere)(p);
            cell |= nowhere; // SK_NOWHERE
            uint32_t *to = cells->place + (begin - cells->first);
            for (int l = 0; l < SK_LANES; l++) to[l] = (uint32_t)cell[l];
        }
    sk_state state = {run->vector[SK_X], run->vector[SK_V], row->packed, run->slot_of};
    sk_cells_find(cells, &state, begin, end);
}

/* Sixteen places at a time: elements begin at a multiple of sixteen, and there is room behind the last. */
static void SK_ISA(spread)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row;
    sk_cells *cells = run->cells;
    static const uint32_t every_other[SK_LANES] = {0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30};
    if (run->no_memory) return;
    if (end > cells->count) end = cells->count;
    for (size_t place = begin; place < end; place += SK_LANES) {
        const sk_vec4 *x = (const sk_vec4 *)(const void *)&cells->record[place];
        sk_wide4 p = SK_ISA(sk_gather)(x, every_other), v = SK_ISA(sk_gather)(x + 1, every_other);
        sk_wide speed = SK_ISA(sk_wide_sqrt)(v.x * v.x + v.y * v.y + v.z * v.z);
        sk_mask flies = SK_ISA(sk_positive)(speed) & SK_ISA(sk_at_most)(speed, SK_ISA(sk_splat)((real)SK_REAL_MAX));
        sk_wide s = SK_ISA(sk_keep)(flies, (real)1 / speed);
        sk_wide u[6] = {p.x, p.y, p.z, s * v.x, s * v.y, s * v.z};
        real *copies[6] = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
        for (int k = 0; k < 6; k++) memcpy(copies[k] + place, &u[k], sizeof u[k]);
    }
}

#else
#include "plan/sort.h"

static sk_state state_of(const sk_run *run, const sk_row *row) {
    return (sk_state){run->vector[SK_X], run->vector[SK_V], row->packed, run->slot_of};
}

static void rank(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    if (!run->no_memory) sk_cells_rank(run->cells);
}

static void scatter(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_state state = state_of(run, row);
    if (!run->no_memory) sk_cells_scatter(run->cells, &state, begin, end);
}

#define SK_KERNELS "plan/sort.c"
#include "base/for_each_isa.h"

const sk_sort_row sk_sort_rows[SK_SORT_ROWS] = {
    {{SK_EACH_ISA(frame)}, SK_ORDERED, false, "frame of cells"},
    {{SK_EACH_ISA(find)}, SK_FREE, false, "cell of each"},
    {{SK_ANY_ISA(rank)}, SK_ORDERED, false, "place of each"},
    {{SK_ANY_ISA(scatter)}, SK_FREE, false, "records to places"},
    {{SK_EACH_ISA(spread)}, SK_FREE, true, "positions, directions"},
};
#endif
