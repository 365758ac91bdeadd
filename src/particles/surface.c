/* Building a surface: which cells of grids have which triangles, and the triangles that are left over. */
#include "particles/surface.h"

#include <string.h>

enum { LEAST_SHARE = 5 }; /* a grid becomes a patch if it has a fifth of its cells' triangles */

#define NOWHERE UINT32_MAX /* wider than an enumerator may be */

/* Where a triangle lies: its patch, block, lane and tip (sk_patch). */
typedef struct triangle_place {
    uint32_t patch; /* NOWHERE: in none */
    int lane, tip;
    size_t block;
} triangle_place;

static uint32_t strips_of(const sk_particles *particles, uint32_t particle) {
    for (size_t i = 0; i < particles->strips.count; i++) {
        const sk_strips *strips = &particles->strips.data[i];
        if (particle >= strips->first_particle && particle - strips->first_particle < strips->count) return (uint32_t)i;
    }
    return NOWHERE;
}

/* A corner's offset from its triangle's first one, at `column`: 0 or 1 rows, -1 to 1 columns. False if farther away. */
static bool step_to(uint32_t apart, uint32_t column, uint32_t columns, int *row, int *step) {
    *row = apart >= columns || (column && apart == columns - 1);
    *step = (int)(apart - (*row ? columns : 0));
    return *step <= 1 && (uint32_t)((int)column + *step) < columns;
}

/* The place of a triangle whose corners are three corners of one cell; in no patch otherwise. `guess` is the patch of
 * the triangle before it. */
static triangle_place place_of(const sk_particles *particles, const uint32_t corner[3], uint32_t guess) {
    triangle_place place = {.patch = guess}, none = {.patch = NOWHERE};
    const sk_strips *strips = guess == NOWHERE ? NULL : &particles->strips.data[guess];
    if (!strips || corner[0] - strips->first_particle >= strips->count) place.patch = strips_of(particles, corner[0]);
    if (place.patch == NOWHERE) return none;
    strips = &particles->strips.data[place.patch];
    uint32_t at[3], first = UINT32_MAX;
    for (int k = 0; k < 3; k++) {
        if (corner[k] - strips->first_particle >= strips->count) return none;
        at[k] = particles->place[corner[k]];
        if (at[k] < first) first = at[k];
    }
    uint32_t column = first % strips->columns;
    int row[3], step[3], back = 0;
    for (int k = 0; k < 3; k++) {
        if (!step_to(at[k] - first, column, strips->columns, &row[k], &step[k])) return none;
        if (step[k] < 0) back = 1;
    }
    unsigned corners = 0;
    for (int k = 0; k < 3; k++) {
        if (step[k] + back > 1) return none;
        corners |= 1u << (2 * row[k] + step[k] + back);
    }
    static const int8_t tips[16] = {[0xf & ~8] = 1, [0xf & ~4] = 2, [0xf & ~2] = 3, [0xf & ~1] = 4};
    if (!tips[corners]) return none;
    column -= (uint32_t)back;
    place.tip = tips[corners] - 1;
    place.block = (size_t)(first / strips->columns) * strips->width + column % strips->width;
    place.lane = (int)(column / strips->width);
    return place;
}

/* Makes a patch for each grid; which ones have enough triangles is found later. */
static bool make_patches(sk_surface *surface, sk_allocator *allocator, const sk_particles *particles) {
    surface->patch_count = particles->strips.count;
    if (!surface->patch_count) return true;
    surface->patches = sk_allocate(allocator, surface->patch_count * sizeof *surface->patches);
    if (!surface->patches) return false;
    for (size_t i = 0; i < surface->patch_count; i++) {
        const sk_strips *strips = &particles->strips.data[i];
        sk_patch *patch = &surface->patches[i];
        patch->walk = (sk_walk){strips->first_slot, strips->rows, strips->width, 1};
        patch->has = sk_allocate(allocator, (size_t)strips->rows * strips->width * sizeof *patch->has);
        if (!patch->has) return false;
    }
    return true;
}

/* Marks the triangle's place as taken; false if it has none, or the place is taken already. */
static bool settle(sk_surface *surface, const triangle_place *place) {
    if (place->patch == NOWHERE) return false;
    const sk_patch *patch = &surface->patches[place->patch];
    if (!patch->has) return false;
    uint16_t *has = &patch->has[place->block][place->tip], bit = (uint16_t)(1u << place->lane);
    if (*has & bit) return false;
    *has |= bit;
    return true;
}

/* Divides the triangles into those of patches and the rest, and counts those of each patch. False: no memory. */
static bool deal(sk_surface *surface, sk_allocator *allocator, const sk_particles *particles,
                 const sk_triangles *triangles, size_t *filled) {
    uint32_t guess = NOWHERE, number = 0;
    sk_triangles *rest = &surface->rest;
    rest->count = 0;
    for (size_t t = 0; t < triangles->count; t++) {
        const uint32_t *corner = triangles->corner[t];
        if (!sk_particle_is_here(particles, corner[0])) continue;
        triangle_place place = place_of(particles, corner, guess);
        guess = place.patch;
        uint32_t at = number++;
        if (corner[0] == corner[1] && corner[0] == corner[2]) continue; // it was cut away
        if (settle(surface, &place)) {
            filled[place.patch]++;
            continue;
        }
        if (!sk_reserve(allocator, (void **)&rest->corner, &rest->capacity, rest->count + 1, sizeof *rest->corner) ||
            !sk_reserve(allocator, (void **)&surface->number, &surface->number_capacity, rest->count + 1,
                        sizeof *surface->number))
            return false;
        for (int k = 0; k < 3; k++) rest->corner[rest->count][k] = particles->slot_of[corner[k]];
        surface->number[rest->count++] = at;
    }
    return true;
}

/* Drops patches that are nearly empty, mostly of lattices. Returns whether there were any; all places are then free. */
static bool drop_thin_patches(sk_surface *surface, sk_allocator *allocator, const sk_particles *particles,
                              const size_t *filled) {
    bool dropped = false;
    for (size_t i = 0; i < surface->patch_count; i++) {
        const sk_strips *strips = &particles->strips.data[i];
        sk_patch *patch = &surface->patches[i];
        size_t whole = 2 * (size_t)(strips->rows - 1) * (strips->columns - 1);
        if (filled[i] && filled[i] * LEAST_SHARE >= whole) continue;
        dropped |= filled[i] > 0;
        sk_release(allocator, patch->has);
        *patch = (sk_patch){.has = NULL};
    }
    for (size_t i = 0; i < surface->patch_count && dropped; i++) {
        const sk_patch *patch = &surface->patches[i];
        if (patch->has) memset(patch->has, 0, patch->walk.rows * patch->walk.width * sizeof *patch->has);
    }
    return dropped;
}

bool sk_surface_arrange(sk_surface *surface, sk_allocator *allocator, const sk_particles *particles,
                        const sk_triangles *triangles) {
    sk_surface_release(surface, allocator);
    if (!triangles->count) return true;
    size_t *filled = sk_allocate(allocator, (particles->strips.count + 1) * sizeof *filled);
    bool good =
        filled && make_patches(surface, allocator, particles) && deal(surface, allocator, particles, triangles, filled);
    if (good && drop_thin_patches(surface, allocator, particles, filled))
        good = deal(surface, allocator, particles, triangles, filled);
    sk_release(allocator, filled);
    if (!good) sk_surface_release(surface, allocator);
    return good;
}

size_t sk_surface_rest_from(const sk_surface *surface, size_t number) {
    size_t low = 0, high = surface->rest.count;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (surface->number[middle] < number) low = middle + 1;
        else high = middle;
    }
    return low;
}

void sk_surface_release(sk_surface *surface, sk_allocator *allocator) {
    for (size_t i = 0; i < surface->patch_count && surface->patches; i++)
        sk_release(allocator, surface->patches[i].has);
    sk_release(allocator, surface->patches);
    sk_release(allocator, surface->rest.corner);
    sk_release(allocator, surface->number);
    *surface = (sk_surface){.patches = NULL};
}
