/* Building the enclosure of a batch: its vertices, and the check that the surface is closed. */
#include "constraints/enclosure.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/status.h"

/* ---- edges ---- */

typedef struct edge {
    uint32_t low, high; /* particles */
    uint32_t triangle;
    bool upwards; /* its triangle runs from low to high */
} edge;

static int compare_edges(const void *p, const void *q) {
    const edge *a = p, *b = q;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    if (a->high != b->high) return a->high < b->high ? -1 : 1;
    return a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

static void list_edges(const sk_batch *batch, edge *edges) {
    for (size_t t = 0; t < batch->count; t++)
        for (size_t k = 0; k < 3; k++) {
            uint32_t a = batch->particle[3 * t + k], b = batch->particle[3 * t + (k + 1) % 3];
            edges[3 * t + k] = (edge){a < b ? a : b, a < b ? b : a, (uint32_t)t, a < b};
        }
    qsort(edges, 3 * batch->count, sizeof *edges, compare_edges);
}

/* "the edge from particle 3 at (0, 1, 0) to particle 4 at (1, 1, 0)" */
static void name_edge(const edge *e, const sk_particles *particles, char *text, size_t size) {
    sk_vec4 a = particles->vector[SK_X][particles->slot_of[e->low]];
    sk_vec4 b = particles->vector[SK_X][particles->slot_of[e->high]];
    snprintf(text, size, "the edge from particle %u at (%.4g, %.4g, %.4g) to particle %u at (%.4g, %.4g, %.4g)", e->low,
             (double)a.x, (double)a.y, (double)a.z, e->high, (double)b.x, (double)b.y, (double)b.z);
}

static skein_status check_closed(const sk_batch *batch, const edge *edges, const sk_particles *particles,
                                 skein_error *error) {
    size_t count = 3 * batch->count, open = 0;
    const edge *first_open = NULL;
    char name[200];
    for (size_t i = 0, same; i < count; i += same) {
        for (same = 1; i + same < count; same++)
            if (edges[i + same].low != edges[i].low || edges[i + same].high != edges[i].high) break;
        if (same == 1) {
            if (!open++) first_open = &edges[i];
        } else if (same > 2) {
            name_edge(&edges[i], particles, name, sizeof name);
            return sk_fail(error, SKEIN_ERROR_VALUE, "",
                           "the surface is not closed: %s belongs to %zu triangles, not 2", name, same);
        } else if (edges[i].upwards == edges[i + 1].upwards) {
            name_edge(&edges[i], particles, name, sizeof name);
            return sk_fail(error, SKEIN_ERROR_VALUE, "",
                           "the surface has no inside: at %s triangles %u and %u are turned opposite ways", name,
                           edges[i].triangle, edges[i + 1].triangle);
        }
    }
    if (!open) return SKEIN_OK;
    name_edge(first_open, particles, name, sizeof name);
    return sk_fail(error, SKEIN_ERROR_VALUE, "",
                   "the surface is open: %s belongs to one triangle only (%zu such edge%s); a closed surface has two at "
                   "every edge",
                   name, open, open == 1 ? "" : "s");
}

/* ---- vertices ---- */

static int compare_indices(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void find_vertices(const sk_batch *batch, sk_enclosure *e) {
    memcpy(e->vertex, batch->particle, 3 * batch->count * sizeof *e->vertex);
    qsort(e->vertex, 3 * batch->count, sizeof *e->vertex, compare_indices);
    for (size_t i = 0; i < 3 * batch->count; i++)
        if (!i || e->vertex[i] != e->vertex[i - 1]) e->vertex[e->vertex_count++] = e->vertex[i];
    for (size_t t = 0; t < batch->count; t++)
        for (size_t k = 0; k < 3; k++) {
            const uint32_t *found =
                bsearch(&batch->particle[3 * t + k], e->vertex, e->vertex_count, sizeof *e->vertex, compare_indices);
            e->corner[k][t] = (uint32_t)(found - e->vertex);
        }
}

static void find_slots(sk_enclosure *e, const sk_particles *particles) {
    for (size_t v = 0; v < e->vertex_count; v++) e->slot[v] = particles->slot_of[e->vertex[v]];
}

static skein_status check(const sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                          skein_error *error) {
    edge *edges = sk_allocate(allocator, 3 * batch->count * sizeof *edges);
    if (!edges) return sk_fail_memory(error, "the edges of a closed surface");
    list_edges(batch, edges);
    skein_status status = check_closed(batch, edges, particles, error);
    sk_release(allocator, edges);
    return status;
}

static bool make_lists(const sk_batch *batch, sk_enclosure *e, sk_allocator *allocator) {
    e->lane_count = (batch->count + SK_LANES - 1) / SK_LANES * SK_LANES;
    e->vertex = sk_allocate(allocator, 3 * batch->count * sizeof *e->vertex);
    for (size_t k = 0; k < 3; k++) e->corner[k] = sk_allocate(allocator, e->lane_count * sizeof *e->corner[k]);
    if (!e->vertex || !e->corner[0] || !e->corner[1] || !e->corner[2]) return false;
    find_vertices(batch, e);
    e->slot = sk_allocate(allocator, e->vertex_count * sizeof *e->slot);
    e->place = sk_allocate(allocator, 3 * e->vertex_count * sizeof *e->place);
    e->gradient = sk_allocate(allocator, 3 * e->vertex_count * sizeof *e->gradient);
    return e->slot && e->place && e->gradient;
}

skein_status sk_enclosure_create(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                                 skein_error *error) {
    if (!batch->count) return sk_fail(error, SKEIN_ERROR_VALUE, "", "a closed surface has triangles: none were given");
    if (batch->count > UINT32_MAX / 4)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "%zu triangles are too many", batch->count);
    skein_status status = check(batch, allocator, particles, error);
    if (status) return status;
    batch->enclosure = sk_allocate(allocator, sizeof *batch->enclosure);
    if (!batch->enclosure || !make_lists(batch, batch->enclosure, allocator))
        return sk_fail_memory(error, "a closed surface");
    find_slots(batch->enclosure, particles);
    return SKEIN_OK;
}

void sk_enclosure_turn(sk_enclosure *e) {
    uint32_t *second = e->corner[1];
    e->corner[1] = e->corner[2], e->corner[2] = second;
}

void sk_enclosure_release(sk_enclosure *e, sk_allocator *allocator) {
    if (!e) return;
    void *arrays[] = {e->vertex, e->slot, e->corner[0], e->corner[1], e->corner[2], e->place, e->gradient};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, e);
}

bool sk_enclosure_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles) {
    find_slots(batch->enclosure, particles);
    if (!sk_reserve(allocator, (void **)&batch->sweeps, &batch->sweep_capacity, 1, sizeof(sk_sweep))) return false;
    batch->sweeps[0] = (sk_sweep){.batch = batch, .element_count = batch->count, .group_count = 1};
    snprintf(batch->sweeps[0].label, sizeof batch->sweeps[0].label, "%.47s", batch->label);
    batch->sweep_count = 1;
    batch->lane_count = SK_LANES;
    return true;
}
