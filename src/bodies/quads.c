/* Every quad with known places of its corners gives those of the quads across its edges:
 *
 *     s---p---x      n = p - s leads out over the edge p q,
 *     | f | g |      so x stands at p + n and w at q + n;
 *     t---q---w      a particle with two different places is in no grid
 */
#include "bodies/quads.h"

#include <string.h>

enum { UNKNOWN = INT32_MIN };

typedef struct walk {
    const sk_sheet *sheet;
    const sk_springs *springs;
    sk_allocator *allocator;
    uint32_t *edge_of_corner;
    int32_t (*at)[2]; /* row and column of each particle */
    uint32_t *queue;  /* faces */
    bool *reached;
    size_t queued;
} walk;

static bool all_quads(const sk_sheet *sheet) {
    for (size_t f = 0; f < sheet->face_count; f++)
        if (sheet->face_start[f + 1] - sheet->face_start[f] != 4) return false;
    return sheet->face_count > 0;
}

/* Each face's corner to the edge that starts there; false where an edge has more than two faces. */
static bool find_edges(walk *w) {
    for (size_t e = 0; e < w->springs->edge_count; e++) {
        const sk_edge *edge = &w->springs->edges[e];
        if (edge->face_count > 2) return false;
        for (uint32_t side = 0; side < edge->face_count; side++) w->edge_of_corner[edge->corner[side]] = (uint32_t)e;
    }
    return true;
}

/* Puts a particle at `from` + n; false if it stands elsewhere already. */
static bool put(walk *w, uint32_t particle, uint32_t from, const int32_t n[2]) {
    int32_t at[2] = {w->at[from][0] + n[0], w->at[from][1] + n[1]};
    if (w->at[particle][0] == UNKNOWN) memcpy(w->at[particle], at, sizeof at);
    return w->at[particle][0] == at[0] && w->at[particle][1] == at[1];
}

static void reach(walk *w, uint32_t face) {
    w->reached[face] = true;
    w->queue[w->queued++] = face;
}

/* Tells the quad across the k-th edge of f. */
static bool cross(walk *w, uint32_t f, size_t k) {
    const uint32_t *corner = w->sheet->corners + w->sheet->face_start[f];
    const sk_edge *edge = &w->springs->edges[w->edge_of_corner[w->sheet->face_start[f] + k]];
    if (edge->face_count != 2) return true;
    int side = edge->face[0] == f;
    uint32_t p = corner[k], s = corner[(k + 3) % 4], g = edge->face[side];
    int32_t n[2] = {w->at[p][0] - w->at[s][0], w->at[p][1] - w->at[s][1]};
    const uint32_t *other = w->sheet->corners + w->sheet->face_start[g];
    size_t j = edge->corner[side] - w->sheet->face_start[g];
    if (!put(w, other[(j + 3) % 4], other[j], n) || !put(w, other[(j + 2) % 4], other[(j + 1) % 4], n)) return false;
    if (!w->reached[g]) reach(w, g);
    return true;
}

/* Gives every particle a row and a column; false if the mesh is no grid. */
static bool walk_all(walk *w) {
    static const int32_t square[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (size_t i = 0; i < w->sheet->particle_count; i++) w->at[i][0] = UNKNOWN;
    for (size_t k = 0; k < 4; k++) memcpy(w->at[w->sheet->corners[k]], square[k], sizeof square[k]);
    reach(w, 0);
    for (size_t next = 0; next < w->queued; next++)
        for (size_t k = 0; k < 4; k++)
            if (!cross(w, w->queue[next], k)) return false;
    for (size_t i = 0; i < w->sheet->particle_count; i++)
        if (w->at[i][0] == UNKNOWN) return false;
    return w->queued == w->sheet->face_count;
}

/* One of the eight ways to lay a grid: bit 0 turns the rows round, bit 1 the columns, bit 2 swaps them. */
static uint32_t place_in(const int32_t at[2], const uint32_t size[2], int way) {
    uint32_t row = (uint32_t)at[0], column = (uint32_t)at[1];
    if (way & 1) row = size[0] - 1 - row;
    if (way & 2) column = size[1] - 1 - column;
    return way & 4 ? column * size[0] + row : row * size[1] + column;
}

/* Pins in the first rows, then in the first columns; then the first particles, as a mesh is mostly numbered. */
static int best_way(const walk *w, const uint32_t size[2], const bool *pinned) {
    int best = 0;
    uint64_t least[4] = {UINT64_MAX, 0, 0, 0};
    for (int way = 0; way < 8; way++) {
        uint32_t columns = way & 4 ? size[0] : size[1];
        uint64_t cost[4] = {0, 0, place_in(w->at[0], size, way), place_in(w->at[1], size, way)};
        for (size_t i = 0; i < w->sheet->particle_count; i++) {
            if (!pinned[i]) continue;
            uint32_t place = place_in(w->at[i], size, way);
            cost[0] += place / columns, cost[1] += place % columns;
        }
        int k = 0;
        while (k < 3 && cost[k] == least[k]) k++;
        if (cost[k] < least[k]) best = way, memcpy(least, cost, sizeof least);
    }
    return best;
}

/* From rows and columns to places; leaves the grid empty if two particles share one, or too few have any. */
static bool lay(walk *w, const bool *pinned, sk_quad_grid *grid) {
    size_t count = w->sheet->particle_count;
    int32_t least[2] = {INT32_MAX, INT32_MAX}, most[2] = {INT32_MIN, INT32_MIN};
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) {
            if (w->at[i][k] < least[k]) least[k] = w->at[i][k];
            if (w->at[i][k] > most[k]) most[k] = w->at[i][k];
        }
    uint32_t size[2] = {(uint32_t)(most[0] - least[0]) + 1, (uint32_t)(most[1] - least[1]) + 1};
    uint64_t places = (uint64_t)size[0] * size[1];
    if (size[0] < 3 || size[1] < 3 || places > 2 * (uint64_t)count) return true;
    for (size_t i = 0; i < count; i++) w->at[i][0] -= least[0], w->at[i][1] -= least[1];
    bool *taken = sk_allocate(w->allocator, (size_t)places);
    uint32_t *place = sk_allocate(w->allocator, count * sizeof *place);
    bool memory = taken && place, good = memory;
    int way = good ? best_way(w, size, pinned) : 0;
    for (size_t i = 0; i < count && good; i++) {
        place[i] = place_in(w->at[i], size, way);
        good = !taken[place[i]];
        taken[place[i]] = true;
    }
    sk_release(w->allocator, taken);
    if (good) *grid = (sk_quad_grid){size[(way & 4) != 0], size[(way & 4) == 0], place};
    else sk_release(w->allocator, place);
    return memory;
}

bool sk_quads_find(const sk_sheet *sheet, const sk_springs *springs, const bool *pinned, sk_quad_grid *grid) {
    *grid = (sk_quad_grid){0, 0, NULL};
    if (!all_quads(sheet)) return true;
    walk w = {.sheet = sheet, .springs = springs, .allocator = sheet->allocator};
    w.edge_of_corner = sk_allocate(w.allocator, 4 * sheet->face_count * sizeof *w.edge_of_corner);
    w.at = sk_allocate(w.allocator, sheet->particle_count * sizeof *w.at);
    w.queue = sk_allocate(w.allocator, sheet->face_count * sizeof *w.queue);
    w.reached = sk_allocate(w.allocator, sheet->face_count * sizeof *w.reached);
    bool memory = w.edge_of_corner && w.at && w.queue && w.reached;
    if (memory && find_edges(&w) && walk_all(&w)) memory = lay(&w, pinned, grid);
    sk_release(w.allocator, w.edge_of_corner);
    sk_release(w.allocator, w.at);
    sk_release(w.allocator, w.queue);
    sk_release(w.allocator, w.reached);
    return memory;
}
