#ifdef SK_ISA

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

static void frame(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_state state = state_of(run, row);
    if (!sk_cells_frame(run->cells, run->allocator, &state, begin, end, (real)row->coefficient[0]))
        run->no_memory = true;
}

static void find(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_state state = state_of(run, row);
    if (!run->no_memory) sk_cells_find(run->cells, &state, begin, end);
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
    {{SK_ANY_ISA(frame)}, SK_ORDERED, false, "frame of cells"},
    {{SK_ANY_ISA(find)}, SK_FREE, false, "cell of each"},
    {{SK_ANY_ISA(rank)}, SK_ORDERED, false, "place of each"},
    {{SK_ANY_ISA(scatter)}, SK_FREE, false, "records to places"},
    {{SK_EACH_ISA(spread)}, SK_FREE, true, "positions, directions"},
};
#endif
