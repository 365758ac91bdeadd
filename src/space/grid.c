#include "space/grid.h"

#include <string.h>

#include "base/layout.h"

/* Finite, and so far from overflow that the size of a box of such points is finite too. */
static bool is_finite(sk_vec4 p) {
    real most = SK_REAL_MAX / 4;
    return sk_abs(p.x) <= most && sk_abs(p.y) <= most && sk_abs(p.z) <= most;
}

/* The box around the finite particles; false when there is none. */
static bool find_bounds(const sk_vec4 *positions, size_t packed, const uint32_t *slot_of, size_t count, sk_vec3 *low,
                        sk_vec3 *high) {
    bool any = false;
    for (size_t i = 0; i < count; i++) {
        sk_vec4 p = sk_load(positions, packed, slot_of[i]);
        if (!is_finite(p)) continue;
        if (!any) *low = *high = sk_xyz(p);
        any = true;
        *low = sk_v3(sk_min(low->x, p.x), sk_min(low->y, p.y), sk_min(low->z, p.z));
        *high = sk_v3(sk_max(high->x, p.x), sk_max(high->y, p.y), sk_max(high->z, p.z));
    }
    return any;
}

/* Cells of `size` that cover the box, as a double so that it cannot overflow. */
static double cells_needed(sk_vec3 extent, double size) {
    return ((double)extent.x / size + 1) * ((double)extent.y / size + 1) * ((double)extent.z / size + 1);
}

bool sk_grid_reserve(sk_grid *grid, sk_allocator *allocator, size_t count) {
    return sk_reserve(allocator, (void **)&grid->cell_start, &grid->cell_start_capacity, 4 * count + 66,
                      sizeof(uint32_t)) &&
           sk_reserve(allocator, (void **)&grid->slot, &grid->slot_capacity, count, sizeof(uint32_t)) &&
           sk_reserve(allocator, (void **)&grid->position, &grid->position_capacity, count, sizeof(sk_vec4)) &&
           sk_reserve(allocator, (void **)&grid->cell_of, &grid->cell_of_capacity, count, sizeof(uint32_t));
}

bool sk_grid_build(sk_grid *grid, sk_allocator *allocator, const sk_vec4 *positions, size_t packed,
                   const uint32_t *slot_of, size_t count, real radius) {
    // the grid's frame: cells grow until there are not too many of them
    sk_vec3 low = {0, 0, 0}, high = {0, 0, 0};
    find_bounds(positions, packed, slot_of, count, &low, &high);
    double size = radius, most = 4.0 * (double)count + 64;
    sk_vec3 extent = sk_sub(high, low);
    while (cells_needed(extent, size) > most) size *= 1.25;
    grid->cell_size = (real)size;
    grid->origin = low;
    grid->cells_x = (int32_t)((double)extent.x / size) + 1;
    grid->cells_y = (int32_t)((double)extent.y / size) + 1;
    grid->cells_z = (int32_t)((double)extent.z / size) + 1;
    size_t cells = (size_t)grid->cells_x * (size_t)grid->cells_y * (size_t)grid->cells_z;

    if (!sk_grid_reserve(grid, allocator, count)) return grid->count = 0, false;

    // counting sort, stable in the user's order: count, sum up, scatter
    uint32_t *start = grid->cell_start;
    memset(start, 0, (cells + 2) * sizeof *start);
    for (size_t i = 0; i < count; i++) {
        sk_vec4 p = sk_load(positions, packed, slot_of[i]);
        grid->cell_of[i] = SK_NO_CELL;
        if (!is_finite(p)) continue;
        int32_t x = sk_grid_place(p.x, low.x, grid->cell_size, grid->cells_x);
        int32_t y = sk_grid_place(p.y, low.y, grid->cell_size, grid->cells_y);
        int32_t z = sk_grid_place(p.z, low.z, grid->cell_size, grid->cells_z);
        grid->cell_of[i] = (uint32_t)(x + grid->cells_x * (y + grid->cells_y * z));
        start[grid->cell_of[i] + 2]++;
    }
    for (size_t c = 2; c < cells + 2; c++) start[c] += start[c - 1];
    for (size_t i = 0; i < count; i++) {
        if (grid->cell_of[i] == SK_NO_CELL) continue;
        uint32_t place = start[grid->cell_of[i] + 1]++;
        grid->slot[place] = slot_of[i];
        grid->position[place] = sk_load(positions, packed, slot_of[i]);
    }
    grid->count = start[cells];
    return true;
}

void sk_grid_release(sk_grid *grid, sk_allocator *allocator) {
    sk_release(allocator, grid->cell_start);
    sk_release(allocator, grid->slot);
    sk_release(allocator, grid->position);
    sk_release(allocator, grid->cell_of);
    memset(grid, 0, sizeof *grid);
}
