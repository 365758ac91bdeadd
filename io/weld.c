/* See weld.h. A table of hashes with open addressing, at most half full. */
#include "io/weld.h"

#include <stdlib.h>
#include <string.h>

static size_t hash_of(const double position[3], size_t mask) {
    uint64_t hash = 0x9e3779b97f4a7c15u;
    for (int k = 0; k < 3; k++) {
        double x = position[k] + 0.0; // -0 is 0
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        hash = (hash ^ bits) * 0xff51afd7ed558ccdu;
        hash ^= hash >> 32;
    }
    return (size_t)hash & mask;
}

/* The slot of that place, or the free one for it. */
static size_t find(const io_weld *weld, const io_mesh *mesh, const double position[3]) {
    size_t mask = weld->slot_count - 1, slot = hash_of(position, mask);
    for (; weld->slots[slot]; slot = (slot + 1) & mask) {
        const double *p = mesh->positions + 3 * (size_t)(weld->slots[slot] - 1);
        if (p[0] == position[0] && p[1] == position[1] && p[2] == position[2]) break;
    }
    return slot;
}

static bool grow(io_weld *weld, const io_mesh *mesh) {
    io_weld larger = {NULL, weld->slot_count ? 2 * weld->slot_count : 256};
    larger.slots = calloc(larger.slot_count, sizeof *larger.slots);
    if (!larger.slots) return false;
    for (size_t i = 0; i < weld->slot_count; i++)
        if (weld->slots[i])
            larger.slots[find(&larger, mesh, mesh->positions + 3 * (size_t)(weld->slots[i] - 1))] = weld->slots[i];
    free(weld->slots);
    *weld = larger;
    return true;
}

bool io_weld_vertex(io_weld *weld, io_mesh *mesh, const double position[3], uint32_t *vertex) {
    if (2 * (mesh->vertex_count + 1) > weld->slot_count && !grow(weld, mesh)) return false;
    size_t slot = find(weld, mesh, position);
    if (!weld->slots[slot]) {
        if (mesh->vertex_count >= IO_MESH_MOST_VERTICES || !io_mesh_add_vertex(mesh, position)) return false;
        weld->slots[slot] = (uint32_t)mesh->vertex_count;
    }
    *vertex = weld->slots[slot] - 1;
    return true;
}

void io_weld_free(io_weld *weld) {
    free(weld->slots);
    *weld = (io_weld){NULL, 0};
}
