#include "space/cells.h"

#include <string.h>

/* Places beyond the last that a wide load may read. */
enum { PADDING = 16 };

/* Finite, and so far from overflow that the size of a box of such points is finite too. */
static bool is_finite(sk_vec4 p) {
    real most = SK_CELLS_FARTHEST;
    return sk_abs(p.x) <= most && sk_abs(p.y) <= most && sk_abs(p.z) <= most;
}

/* The box around the finite particles; a point where there are none. */
static void find_bounds(const sk_state *state, size_t first, size_t end, sk_vec3 *low, sk_vec3 *high) {
    bool any = false;
    *low = *high = (sk_vec3){0, 0, 0};
    for (size_t i = first; i < end; i++) {
        sk_vec4 p = sk_load(state->x, state->packed, state->slot_of[i]);
        if (!is_finite(p)) continue;
        if (!any) *low = *high = sk_xyz(p);
        any = true;
        *low = sk_v3(sk_min(low->x, p.x), sk_min(low->y, p.y), sk_min(low->z, p.z));
        *high = sk_v3(sk_max(high->x, p.x), sk_max(high->y, p.y), sk_max(high->z, p.z));
    }
}

static size_t cell_count(const sk_cells *cells) {
    return (size_t)cells->count_x * (size_t)cells->count_y * (size_t)cells->count_z;
}

/* Cells of `size` that cover the box, as a double so that it cannot overflow. */
static double cells_needed(sk_vec3 extent, double size) {
    return (SK_CELLS_ACROSS * (double)extent.x / size + 1) * ((double)extent.y / size + 1) *
           ((double)extent.z / size + 1);
}

/* At most so many cells for `count` particles. */
static double most_cells(size_t count) {
    return count < 500000000 ? 4.0 * (double)count + 64 : 2e9;
}

bool sk_cells_reserve(sk_cells *cells, sk_allocator *allocator, size_t count) {
    real **copies[6] = {&cells->x, &cells->y, &cells->z, &cells->ux, &cells->uy, &cells->uz};
    for (int k = 0; k < 6; k++)
        if (!sk_reserve(allocator, (void **)copies[k], &cells->copy_capacity[k], count + PADDING, sizeof(real)))
            return false;
    return sk_reserve(allocator, (void **)&cells->start, &cells->start_capacity, (size_t)most_cells(count) + 2,
                      sizeof *cells->start) &&
           sk_reserve(allocator, (void **)&cells->record, &cells->record_capacity, count + PADDING,
                      sizeof *cells->record) &&
           sk_reserve(allocator, (void **)&cells->place, &cells->place_capacity, count, sizeof *cells->place);
}

bool sk_cells_frame(sk_cells *cells, sk_allocator *allocator, const sk_state *state, size_t first, size_t end,
                    real radius) {
    sk_vec3 low, high;
    find_bounds(state, first, end, &low, &high);
    return sk_cells_frame_box(cells, allocator, low, high, first, end, radius);
}

bool sk_cells_frame_box(sk_cells *cells, sk_allocator *allocator, sk_vec3 low, sk_vec3 high, size_t first, size_t end,
                        real radius) {
    size_t count = end - first;
    double size = (double)radius;
    sk_vec3 extent = sk_sub(high, low);
    while (cells_needed(extent, size) > most_cells(count)) size *= 1.25;
    cells->origin = low;
    cells->size = (real)size;
    cells->per_x = (real)(SK_CELLS_ACROSS / size);
    cells->per_yz = (real)(1 / size);
    cells->count_x = (int32_t)(SK_CELLS_ACROSS * (double)extent.x / size) + 1;
    cells->count_y = (int32_t)((double)extent.y / size) + 1;
    cells->count_z = (int32_t)((double)extent.z / size) + 1;
    int32_t longest = cells->count_y > cells->count_z ? cells->count_y : cells->count_z;
    cells->slack = (real)(1e-4 + 4 * (sizeof(real) == sizeof(float) ? 1.2e-7 : 2.3e-16) * (double)longest);
    cells->first = first;
    cells->end = end;
    cells->count = 0;

    return sk_cells_reserve(cells, allocator, count);
}

void sk_cells_find(sk_cells *cells, const sk_state *state, size_t begin, size_t end) {
    for (size_t i = begin; i < end; i++) {
        sk_vec4 p = sk_load(state->x, state->packed, state->slot_of[i]);
        int32_t x = sk_cells_place(p.x, cells->origin.x, cells->per_x, cells->count_x);
        int32_t y = sk_cells_place(p.y, cells->origin.y, cells->per_yz, cells->count_y);
        int32_t z = sk_cells_place(p.z, cells->origin.z, cells->per_yz, cells->count_z);
        uint32_t cell = (uint32_t)x + (uint32_t)cells->count_x * ((uint32_t)y + (uint32_t)cells->count_y * (uint32_t)z);
        cells->place[i - cells->first] = is_finite(p) ? cell : SK_NOWHERE;
    }
}

void sk_cells_rank(sk_cells *cells) {
    size_t count = cell_count(cells), members = cells->end - cells->first;
    uint32_t *start = cells->start;
    memset(start, 0, (count + 2) * sizeof *start);
    for (size_t i = 0; i < members; i++)
        if (cells->place[i] != SK_NOWHERE) start[cells->place[i] + 2]++;
    uint32_t sum = 0;
    for (size_t c = 2; c < count + 2; c++) start[c] = sum += start[c];
    for (size_t i = 0; i < members; i++)
        if (cells->place[i] != SK_NOWHERE) cells->place[i] = start[cells->place[i] + 1]++;
    cells->count = start[count];
}

void sk_cells_scatter(sk_cells *cells, const sk_state *state, size_t begin, size_t end) {
    for (size_t i = begin; i < end; i++) {
        size_t place = cells->place[i - cells->first];
        if (place == SK_NOWHERE) continue;
        uint32_t slot = state->slot_of[i];
        sk_vec4 p = sk_load(state->x, state->packed, slot), v = sk_load(state->v, state->packed, slot);
        cells->record[place] = (sk_cell_record){
            .x = p.x, .y = p.y, .z = p.z, .slot = slot, .vx = v.x, .vy = v.y, .vz = v.z, .particle = (uint32_t)i};
    }
}

void sk_cells_release(sk_cells *cells, sk_allocator *allocator) {
    real *copies[6] = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
    for (int k = 0; k < 6; k++) sk_release(allocator, copies[k]);
    sk_release(allocator, cells->start);
    sk_release(allocator, cells->record);
    sk_release(allocator, cells->place);
    memset(cells, 0, sizeof *cells);
}
