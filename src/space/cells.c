/* Sorting into cells by counting: bounds and size, each particle's cell and place in the order, and the copies. */
#include "space/cells.h"

#include <string.h>

enum {
    PADDING = 16, /* places beyond the last that a wide load may read */
    LAYER = 8,    /* lines of a layer */
    FEW = 16,     /* up to this many lines are one layer */
    SMALL = 32,   /* up to this many members of a cell are sorted by insertion, more by heap sort */
};

/* Finite, and so far from overflow that the size of a box of such points is finite too. */
static bool is_finite(sk_vec4 p) {
    real most = SK_CELLS_FARTHEST;
    return sk_abs(p.x) <= most && sk_abs(p.y) <= most && sk_abs(p.z) <= most;
}

static bool is_in(const sk_group *group, uint32_t particle) {
    return particle != SK_NOBODY && particle >= group->first && particle < group->end;
}

/* The box around the finite particles; a point if there are none. */
static void find_bounds(const sk_state *state, const sk_group *group, sk_vec3 *low, sk_vec3 *high) {
    bool any = false;
    *low = *high = (sk_vec3){0, 0, 0};
    for (size_t slot = group->first_slot; slot < group->end_slot; slot++) {
        sk_vec4 p = sk_load(state->x, state->packed, slot);
        if (!is_in(group, state->particle_of[slot]) || !is_finite(p)) continue;
        if (!any) *low = *high = sk_xyz(p);
        any = true;
        *low = sk_v3(sk_min(low->x, p.x), sk_min(low->y, p.y), sk_min(low->z, p.z));
        *high = sk_v3(sk_max(high->x, p.x), sk_max(high->y, p.y), sk_max(high->z, p.z));
    }
}

static size_t cell_count(const sk_cells *cells) {
    size_t layers = ((size_t)cells->count_y + (size_t)cells->layer - 1) / (size_t)cells->layer;
    return (size_t)cells->count_x * (size_t)cells->layer * layers * (size_t)cells->count_z;
}

/* The number of cells of `size` that cover the box, as a double so that it cannot overflow. */
static double cells_needed(sk_vec3 extent, double size) {
    double lines = (double)extent.y / size + 1;
    if (lines > FEW) lines += LAYER;
    return (SK_CELLS_ACROSS * (double)extent.x / size + 1) * lines * ((double)extent.z / size + 1);
}

/* The largest number of cells for `count` particles. */
static double most_cells(size_t count) {
    return count < 500000000 ? 4.0 * (double)count + 64 : 2e9;
}

bool sk_cells_reserve(sk_cells *cells, sk_allocator *allocator, const sk_group *group) {
    size_t count = group->end - group->first;
    real **copies[6] = {&cells->x, &cells->y, &cells->z, &cells->ux, &cells->uy, &cells->uz};
    for (int k = 0; k < 6; k++)
        if (!sk_reserve(allocator, (void **)copies[k], &cells->copy_capacity[k], count + PADDING, sizeof(real)))
            return false;
    size_t had = cells->cell_capacity;
    bool good =
        sk_reserve(allocator, (void **)&cells->start, &cells->start_capacity, (size_t)most_cells(count) + 2,
                   sizeof *cells->start) &&
        sk_reserve(allocator, (void **)&cells->slot, &cells->slot_capacity, count + PADDING, sizeof *cells->slot) &&
        sk_reserve(allocator, (void **)&cells->cell, &cells->cell_capacity, group->end_slot - group->first_slot,
                   sizeof *cells->cell);
    // particles whose cell is not known yet are in none (SK_NOWHERE)
    if (good && cells->cell_capacity > had) memset(cells->cell, 0xff, cells->cell_capacity * sizeof *cells->cell);
    return good;
}

bool sk_cells_frame(sk_cells *cells, sk_allocator *allocator, const sk_state *state, const sk_group *group,
                    real radius) {
    sk_vec3 low, high;
    find_bounds(state, group, &low, &high);
    return sk_cells_frame_box(cells, allocator, low, high, group, radius);
}

bool sk_cells_frame_box(sk_cells *cells, sk_allocator *allocator, sk_vec3 low, sk_vec3 high, const sk_group *group,
                        real radius) {
    double size = (double)radius;
    sk_vec3 extent = sk_sub(high, low);
    while (cells_needed(extent, size) > most_cells(group->end - group->first - group->out)) size *= 1.25;
    cells->origin = low;
    cells->size = (real)size;
    cells->per_x = (real)(SK_CELLS_ACROSS / size);
    cells->per_yz = (real)(1 / size);
    cells->count_x = (int32_t)(SK_CELLS_ACROSS * (double)extent.x / size) + 1;
    cells->count_y = (int32_t)((double)extent.y / size) + 1;
    cells->count_z = (int32_t)((double)extent.z / size) + 1;
    bool few = cells->count_y <= FEW;
    cells->layer = few ? cells->count_y : LAYER;
    cells->layer_y = few ? INT32_MAX : LAYER - 1;
    cells->shift_y = few ? 31 : 3;
    int32_t longest = cells->count_y > cells->count_z ? cells->count_y : cells->count_z;
    cells->slack = (real)(1e-4 + 4 * (sizeof(real) == sizeof(float) ? 1.2e-7 : 2.3e-16) * (double)longest);
    cells->group = *group;
    cells->count = 0;
    return sk_cells_reserve(cells, allocator, group);
}

void sk_cells_find(sk_cells *cells, const sk_state *state, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot++) {
        sk_vec4 p = sk_load(state->x, state->packed, slot);
        int32_t x = sk_cells_place(p.x, cells->origin.x, cells->per_x, cells->count_x);
        int32_t y = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
        int32_t z = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
        bool counts = is_in(&cells->group, state->particle_of[slot]) && is_finite(p);
        cells->cell[slot - cells->group.first_slot] = counts ? (uint32_t)(x + sk_cells_line(cells, y, z)) : SK_NOWHERE;
    }
}

/* SK_NOWHERE is larger than any cell's number. */
void sk_cells_rank(sk_cells *cells) {
    size_t count = cell_count(cells), slots = cells->group.end_slot - cells->group.first_slot;
    uint32_t *start = cells->start;
    memset(start, 0, (count + 2) * sizeof *start);
    for (size_t k = 0; k < slots; k++)
        if (cells->cell[k] < count) start[cells->cell[k] + 2]++;
    uint32_t sum = 0;
    for (size_t c = 2; c < count + 2; c++) start[c] = sum += start[c];
    for (size_t k = 0; k < slots; k++)
        if (cells->cell[k] < count) cells->slot[start[cells->cell[k] + 1]++] = (uint32_t)(cells->group.first_slot + k);
    cells->count = start[count];
}

/* ---- the order within a cell ---- */

/* Moves a heap's root down to where both below it are smaller. */
static void sink(uint32_t *slot, size_t root, size_t count, const uint32_t *particle_of) {
    uint32_t moved = slot[root];
    for (size_t child; (child = 2 * root + 1) < count; root = child) {
        if (child + 1 < count && particle_of[slot[child + 1]] > particle_of[slot[child]]) child++;
        if (particle_of[slot[child]] < particle_of[moved]) break;
        slot[root] = slot[child];
    }
    slot[root] = moved;
}

/* For many particles in one cell: heap sort needs no memory, and its time does not grow with their square. */
static void sort_as_heap(uint32_t *slot, size_t count, const uint32_t *particle_of) {
    for (size_t root = count / 2; root-- > 0;) sink(slot, root, count, particle_of);
    for (size_t end = count; end-- > 1;) {
        uint32_t last = slot[end];
        slot[end] = slot[0];
        slot[0] = last;
        sink(slot, 0, end, particle_of);
    }
}

/* Moves the last of `count` members of a cell forward to its place among the others, which are in order. */
static void move_forwards(uint32_t *slot, size_t count, const uint32_t *particle_of) {
    uint32_t moved = slot[count - 1], particle = particle_of[moved];
    size_t at = count - 1;
    for (; at > 0 && particle_of[slot[at - 1]] > particle; at--) slot[at] = slot[at - 1];
    slot[at] = moved;
}

/* The first place from `place` on where a cell begins. (Other threads may be moving members within cells meanwhile.) */
static size_t next_beginning(const sk_cells *cells, size_t place) {
    size_t low = 0, high = cell_count(cells);
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (cells->start[middle] < place) low = middle + 1;
        else high = middle;
    }
    return cells->start[low];
}

/* (Going from cell to cell took three times as long: branches on the number of members cannot be predicted.) */
void sk_cells_settle(sk_cells *cells, const sk_state *state, size_t begin, size_t end, size_t *first, size_t *last) {
    *first = begin < cells->count ? begin : cells->count, *last = end < cells->count ? end : cells->count;
    if (cells->in_order || *first == *last) return;
    *first = next_beginning(cells, *first), *last = next_beginning(cells, *last);
    // cells ascend from place to place; cell and particle as one number must, too: one branch, hardly ever taken
    uint64_t before = 0;
    for (size_t place = *first; place < *last; place++) {
        uint32_t member = cells->slot[place], cell = cells->cell[member - cells->group.first_slot];
        uint64_t here = (uint64_t)cell << 32 | state->particle_of[member];
        if (here < before) {
            uint32_t *slot = cells->slot + cells->start[cell];
            size_t ahead = place - cells->start[cell], members = cells->start[cell + 1] - cells->start[cell];
            if (ahead < SMALL) move_forwards(slot, ahead + 1, state->particle_of);
            else sort_as_heap(slot, members, state->particle_of);
            here = (uint64_t)cell << 32 | state->particle_of[cells->slot[place]];
        }
        before = here;
    }
}

void sk_cells_copy(sk_cells *cells, const sk_state *state, size_t begin, size_t end) {
    for (size_t place = begin; place < end; place++) {
        uint32_t slot = cells->slot[place];
        sk_vec4 p = sk_load(state->x, state->packed, slot), v = sk_load(state->v, state->packed, slot);
        real speed = sk_sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
        bool flies = speed > 0 && speed <= (real)SK_REAL_MAX;
        real per = flies ? 1 / speed : 0;
        cells->x[place] = p.x, cells->y[place] = p.y, cells->z[place] = p.z;
        cells->ux[place] = flies ? per * v.x : 0, cells->uy[place] = flies ? per * v.y : 0;
        cells->uz[place] = flies ? per * v.z : 0;
    }
}

bool sk_cells_sort(sk_cells *cells, sk_allocator *allocator, const sk_state *state, const sk_group *group, real radius) {
    size_t first, last;
    if (!sk_cells_frame(cells, allocator, state, group, radius)) return false;
    sk_cells_find(cells, state, group->first_slot, group->end_slot);
    sk_cells_rank(cells);
    sk_cells_settle(cells, state, 0, cells->count, &first, &last);
    sk_cells_copy(cells, state, first, last);
    return true;
}

void sk_cells_release(sk_cells *cells, sk_allocator *allocator) {
    real *copies[6] = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
    for (int k = 0; k < 6; k++) sk_release(allocator, copies[k]);
    sk_release(allocator, cells->start);
    sk_release(allocator, cells->slot);
    sk_release(allocator, cells->cell);
    memset(cells, 0, sizeof *cells);
}
