#ifdef SK_ISA

/* Which of the sixteen slots from `slot` on have particles of the group. */
SK_INLINE sk_mask SK_ISA(members)(const sk_run *run, const sk_group *group, size_t slot) {
    typedef int32_t numbers __attribute__((vector_size(16 * sizeof(int32_t))));
    numbers particle;
    memcpy(&particle, run->particle_of + slot, sizeof particle); // nobody is -1
    return __builtin_convertvector((particle >= (int32_t)group->first) & (particle < (int32_t)group->end), sk_mask);
}

/* Those that are somewhere (space/cells.h). */
SK_INLINE sk_mask SK_ISA(somewhere)(sk_wide4 p) {
    sk_wide most = SK_ISA(sk_splat)(SK_CELLS_FARTHEST);
    return SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.x), most) & SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.y), most) &
           SK_ISA(sk_at_most)(SK_ISA(sk_wide_abs)(p.z), most);
}

static void SK_ISA(frame)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_wide far = SK_ISA(sk_splat)(SK_REAL_MAX), low[3] = {far, far, far}, high[3] = {-far, -far, -far};
    for (size_t slot = begin; slot < end; slot += SK_LANES) {
        sk_wide4 p = SK_ISA(sk_load_block)(run->vector[SK_X], slot, slot < row->packed);
        sk_mask counts = SK_ISA(members)(run, row->group, slot) & SK_ISA(somewhere)(p);
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
                            sk_v3(most[0], most[1], most[2]), row->group, (real)row->coefficient[0]))
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
    for (size_t slot = begin; slot < end; slot += SK_LANES) {
        sk_wide4 p = SK_ISA(sk_load_block)(run->vector[SK_X], slot, slot < row->packed);
        sk_mask counts = SK_ISA(members)(run, row->group, slot) & SK_ISA(somewhere)(p);
        sk_mask x = SK_ISA(cell_along)(p.x, cells->origin.x, cells->per_x, cells->count_x),
                y = SK_ISA(cell_along)(p.y, cells->origin.y, cells->per_yz, cells->count_y),
                z = SK_ISA(cell_along)(p.z, cells->origin.z, cells->per_yz, cells->count_z);
        sk_mask cell =
            x + cells->count_x * ((y & cells->layer_y) + cells->layer * (z + cells->count_z * (y >> cells->shift_y)));
        cell |= ~counts; // SK_NOWHERE
        size_t first = row->group->first_slot;
        for (size_t l = 0; l < SK_LANES; l++)
            if (slot + l >= first && slot + l < row->group->end_slot) cells->cell[slot + l - first] = (uint32_t)cell[l];
    }
}

/* Elements are places: here those of the cells that begin at them. */
static void SK_ISA(copy)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    sk_cells *cells = run->cells;
    sk_state state = {run->vector[SK_X], run->vector[SK_V], row->packed, run->particle_of};
    if (run->no_memory) return;
    sk_cells_settle(cells, &state, begin, end, &begin, &end);
    for (; !row->packed && begin + SK_LANES <= end; begin += SK_LANES) {
        sk_wide4 p = SK_ISA(sk_gather)(run->vector[SK_X], cells->slot + begin),
                 v = SK_ISA(sk_gather)(run->vector[SK_V], cells->slot + begin);
        sk_wide speed = SK_ISA(sk_wide_sqrt)(v.x * v.x + v.y * v.y + v.z * v.z);
        sk_mask flies = SK_ISA(sk_positive)(speed) & SK_ISA(sk_at_most)(speed, SK_ISA(sk_splat)((real)SK_REAL_MAX));
        sk_wide s = (real)1 / speed;
        sk_wide u[6] = {p.x,
                        p.y,
                        p.z,
                        SK_ISA(sk_keep)(flies, s * v.x),
                        SK_ISA(sk_keep)(flies, s * v.y),
                        SK_ISA(sk_keep)(flies, s * v.z)};
        real *copies[6] = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
        for (int k = 0; k < 6; k++) memcpy(copies[k] + begin, &u[k], sizeof u[k]);
    }
    sk_cells_copy(cells, &state, begin, end);
}

#else
#include "plan/sort.h"

static void rank(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    (void)row, (void)begin, (void)end;
    if (!run->no_memory) sk_cells_rank(run->cells);
}

#define SK_KERNELS "plan/sort.c"
#include "base/for_each_isa.h"

const sk_sort_row sk_sort_rows[SK_SORT_ROWS] = {
    {{SK_EACH_ISA(frame)}, SK_ORDERED, false, "frame of cells"},
    {{SK_EACH_ISA(find)}, SK_FREE, false, "cell of each"},
    {{SK_ANY_ISA(rank)}, SK_ORDERED, false, "place of each"},
    {{SK_EACH_ISA(copy)}, SK_FREE, true, "positions, directions"},
};
#endif
