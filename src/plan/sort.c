/* The kernels that sort particles into cells: thin wrappers of the functions in space/cells.h. */
#include "plan/sort.h"
#include "base/kernels.h"

#define SK_UNIT sort
SK_KERNELS(sk_op_kernel, frame);
SK_KERNELS(sk_op_kernel, find);
SK_KERNELS(sk_op_kernel, copy);

#ifdef SK_ISA

/* Which slots of the part at `slot` hold particles of the group. */
SK_INLINE sk_mask members(const sk_run *run, const sk_group *group, size_t slot) {
    typedef int32_t numbers __attribute__((vector_size(SK_PART * sizeof(int32_t))));
    numbers particle;
    memcpy(&particle, run->particle_of + slot, sizeof particle); // nobody is -1
    return __builtin_convertvector((particle >= (int32_t)group->first) & (particle < (int32_t)group->end), sk_mask);
}

/* Which positions are near enough to have a cell: finite, and within SK_CELLS_FARTHEST (space/cells.h). */
SK_INLINE sk_mask somewhere(sk_wide4 p) {
    sk_wide most = sk_splat(SK_CELLS_FARTHEST);
    return sk_at_most(sk_wide_abs(p.x), most) & sk_at_most(sk_wide_abs(p.y), most) & sk_at_most(sk_wide_abs(p.z), most);
}

void SK_KERNEL(frame)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    SK_VECTOR_ALIGNED real low[3][SK_LANES], high[3][SK_LANES];
    for (int i = 0; i < 3 * SK_LANES; i++) low[i / SK_LANES][i % SK_LANES] = SK_REAL_MAX;
    for (int i = 0; i < 3 * SK_LANES; i++) high[i / SK_LANES][i % SK_LANES] = -SK_REAL_MAX;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        sk_wide4 p = sk_load_part(run->vector[SK_X], slot, slot < op->packed);
        sk_mask counts = members(run, op->group, slot) & somewhere(p);
        const sk_wide at[3] = {p.x, p.y, p.z};
        for (int k = 0; k < 3; k++) {
            sk_wide *below = (sk_wide *)(void *)(low[k] + slot % SK_LANES);
            sk_wide *above = (sk_wide *)(void *)(high[k] + slot % SK_LANES);
            *below = sk_select(counts & sk_more(*below, at[k]), at[k], *below);
            *above = sk_select(counts & sk_more(at[k], *above), at[k], *above);
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
                            sk_v3(most[0], most[1], most[2]), op->group, (real)op->coefficient[0]))
        run->no_memory = true;
}

/* sk_cells_place() for a whole part. */
SK_INLINE sk_mask cell_along(sk_wide at, real origin, real per, int32_t count) {
    sk_wide place = (at - origin) * per, top = sk_splat((real)count);
    sk_mask above = sk_positive(place), inside = above & sk_more(top, place);
    sk_mask cell = __builtin_convertvector(sk_keep(inside, place), sk_mask);
    return cell | (above & ~inside & (sk_lane_int)(count - 1));
}

void SK_KERNEL(find)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_cells *cells = run->cells;
    if (run->no_memory) return;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        sk_wide4 p = sk_load_part(run->vector[SK_X], slot, slot < op->packed);
        sk_mask counts = members(run, op->group, slot) & somewhere(p);
        sk_mask x = cell_along(p.x, cells->origin.x, cells->per_x, cells->count_x),
                y = cell_along(p.y, cells->origin.y, cells->per_yz, cells->count_y),
                z = cell_along(p.z, cells->origin.z, cells->per_yz, cells->count_z);
        sk_mask cell =
            x + cells->count_x * ((y & cells->layer_y) + cells->layer * (z + cells->count_z * (y >> cells->shift_y)));
        cell |= ~counts; // SK_NOWHERE
        size_t first = op->group->first_slot;
        for (size_t l = 0; l < SK_PART; l++)
            if (slot + l >= first && slot + l < op->group->end_slot) cells->cell[slot + l - first] = (uint32_t)cell[l];
    }
}

/* Its elements are places in the order of cells; it handles the cells that begin within the range. */
void SK_KERNEL(copy)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_cells *cells = run->cells;
    sk_state state = {run->vector[SK_X], run->vector[SK_V], op->packed, run->particle_of};
    if (run->no_memory) return;
    sk_cells_settle(cells, &state, begin, end, &begin, &end);
    for (; !op->packed && begin + SK_PART <= end; begin += SK_PART) {
        sk_wide4 p = sk_gather(run->vector[SK_X], cells->slot + begin),
                 v = sk_gather(run->vector[SK_V], cells->slot + begin);
        sk_wide speed = sk_wide_sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        sk_mask flies = sk_positive(speed) & sk_at_most(speed, sk_splat((real)SK_REAL_MAX));
        sk_wide s = (real)1 / speed;
        sk_wide u[6] = {p.x, p.y, p.z, sk_keep(flies, s * v.x), sk_keep(flies, s * v.y), sk_keep(flies, s * v.z)};
        real *copies[6] = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
        for (int k = 0; k < 6; k++) memcpy(copies[k] + begin, &u[k], sizeof u[k]);
    }
    sk_cells_copy(cells, &state, begin, end);
}

#else

static void rank(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)op, (void)begin, (void)end;
    if (!run->no_memory) sk_cells_rank(run->cells);
}

const sk_sort_op sk_sort_ops[SK_SORT_OPS] = {
    {{SK_EACH_ISA(frame)}, SK_ORDERED, false, "frame of cells"},
    {{SK_EACH_ISA(find)}, SK_FREE, false, "cell of each"},
    {{SK_ANY_ISA(rank)}, SK_ORDERED, false, "place of each"},
    {{SK_EACH_ISA(copy)}, SK_FREE, true, "positions, directions"},
};
#endif
