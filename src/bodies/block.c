/* A block's particles, strips, springs by direction and surface, for a given size. */
#include "bodies/block.h"

#include <stdlib.h>
#include <string.h>

#include "bodies/body.h"
#include "particles/selection.h"

enum { LEAST_COLUMNS = 96 }; /* of a row of strips: six a lane */

skein_status sk_block_begin(sk_block *block) {
    const uint32_t *n = block->size;
    const size_t most = UINT32_MAX - 64;
    if (n[0] > most / n[1] / n[2])
        return sk_fail(block->error, SKEIN_ERROR_LIMIT, "grid", "%u x %u x %u particles: a world holds at most %zu",
                       n[0], n[1], n[2], most);
    block->count = (size_t)n[0] * n[1] * n[2];
    block->position = sk_allocate(&block->world->allocator, block->count * sizeof *block->position);
    block->pinned = sk_allocate(&block->world->allocator, block->count * sizeof *block->pinned);
    return block->position && block->pinned ? SKEIN_OK : sk_fail_memory(block->error, "particles");
}

void sk_block_release(sk_block *block) {
    sk_release(&block->world->allocator, block->position);
    sk_release(&block->world->allocator, block->pinned);
}

skein_status sk_block_add_particles(sk_block *block, double mass, const double velocity[3], const char *pins,
                                    skein_status (*choose_words)(void *block, const char *words)) {
    sk_allocator *allocator = &block->world->allocator;
    sk_selectable things = {allocator,  block->position, block->count, NULL, block->count,
                            "particle", "the body",      choose_words, block};
    skein_status status = sk_selection_apply(pins, &things, "pins", block->pinned, block->error);
    if (status) return status;
    double *masses = sk_allocate(allocator, block->count * sizeof *masses);
    double(*velocities)[3] = sk_allocate(allocator, block->count * sizeof *velocities);
    if (!masses || !velocities) status = sk_fail_memory(block->error, "particles");
    for (size_t i = 0; i < block->count && !status; i++) {
        masses[i] = mass / (double)block->count;
        if (!block->pinned[i]) memcpy(velocities[i], velocity, sizeof velocities[i]);
    }
    if (!status)
        status = sk_world_add_particles(block->world, block->count, (const double *)block->position,
                                        (const double *)velocities, masses, block->error);
    for (size_t i = 0; i < block->count && !status; i++)
        if (block->pinned[i]) sk_particle_pin(&block->world->particles, block->body->first_particle + i, true);
    sk_release(allocator, masses);
    sk_release(allocator, velocities);
    return status;
}

/* ---- springs ---- */

/* The number of places along an axis that have a partner `step` away, and the first of them. */
static size_t places_along(uint32_t size, int32_t step, size_t *first) {
    size_t way = (size_t)abs(step);
    *first = step < 0 ? way : 0;
    return way < size ? size - way : 0;
}

static size_t springs_along(const sk_block *block, const int32_t step[3]) {
    size_t count = 1, first;
    for (int k = 0; k < 3; k++) count *= places_along(block->size[k], step[k], &first);
    return count;
}

/* Writes the springs of one direction, by their first particle; returns how many. */
static size_t lay_direction(const sk_block *block, const int32_t step[3], uint32_t *pairs) {
    size_t count[3], first[3], laid = 0;
    for (int k = 0; k < 3; k++) count[k] = places_along(block->size[k], step[k], &first[k]);
    size_t m = block->size[1], l = block->size[2];
    int64_t way = ((int64_t)step[0] * (int64_t)m + step[1]) * (int64_t)l + step[2];
    for (size_t i = first[0]; i < first[0] + count[0]; i++)
        for (size_t j = first[1]; j < first[1] + count[1]; j++)
            for (size_t k = first[2]; k < first[2] + count[2]; k++, laid++) {
                int64_t a = (int64_t)((i * m + j) * l + k + block->body->first_particle);
                pairs[2 * laid] = (uint32_t)a;
                pairs[2 * laid + 1] = (uint32_t)(a + way);
            }
    return laid;
}

skein_status sk_block_add_springs(sk_block *block, const char *label, sk_material material, bool measured,
                                  const sk_block_springs *springs, size_t count) {
    sk_allocator *allocator = &block->world->allocator;
    size_t total = 0, laid = 0;
    for (size_t d = 0; d < count; d++) total += springs_along(block, springs[d].step);
    uint32_t *pairs = sk_allocate(allocator, 2 * total * sizeof *pairs);
    real *rest = sk_allocate(allocator, total * sizeof *rest), *scale = sk_allocate(allocator, total * sizeof *scale);
    skein_status status = pairs && rest && scale ? SKEIN_OK : sk_fail_memory(block->error, "springs");
    for (size_t d = 0; d < count && !status; d++) {
        size_t end = laid + lay_direction(block, springs[d].step, pairs + 2 * laid);
        for (; laid < end; laid++) {
            rest[laid] = (real)springs[d].rest;
            scale[laid] = (real)springs[d].scale;
        }
    }
    if (!status)
        status = sk_world_add_body_batch(block->world, block->body, &sk_distance, label, material, measured, total,
                                         pairs, rest, scale, block->error);
    sk_release(allocator, pairs);
    sk_release(allocator, rest);
    sk_release(allocator, scale);
    return status;
}

/* Rows are layers along y, so that the particles on the ground fill few blocks, and contact skips all others. With rows
 * along x, four fifths of the blocks of a lattice of 20^3 had such a particle, and contact took a fifth of the time. */
skein_status sk_block_add_strips(sk_block *block) {
    const uint32_t *n = block->size;
    uint32_t rows = n[1], columns = n[0] * n[2], *place = NULL;
    // a row of too few columns would leave lanes empty: then all is one row
    if (columns < LEAST_COLUMNS) columns *= rows, rows = 1;
    else if (!(place = sk_allocate(&block->world->allocator, block->count * sizeof *place)))
        return sk_fail_memory(block->error, "the order of particles");
    for (uint32_t i = 0, at = 0; i < n[0] && place; i++)
        for (uint32_t j = 0; j < n[1]; j++)
            for (uint32_t k = 0; k < n[2]; k++, at++) place[at] = (j * n[0] + i) * n[2] + k;
    skein_status status =
        sk_world_add_strips(block->world, block->body, rows, columns, (uint32_t)block->count, place, block->error);
    sk_release(&block->world->allocator, place);
    return status;
}

/* ---- the surface ---- */

static size_t particle_at(const sk_block *block, const uint32_t at[3]) {
    return ((size_t)at[0] * block->size[1] + at[1]) * block->size[2] + at[2];
}

/* Writes quads on both ends of an axis, or once if both ends are the same particles. Returns the corner after the
 * last. */
static uint32_t *lay_faces(const sk_block *block, int axis, uint32_t *corner) {
    int b = (axis + 1) % 3, c = (axis + 2) % 3;
    static const uint32_t turn[2][4][2] = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (int side = block->size[axis] > 1 ? 0 : 1; side < 2; side++)
        for (uint32_t p = 0; p + 1 < block->size[b]; p++)
            for (uint32_t q = 0; q + 1 < block->size[c]; q++)
                for (int k = 0; k < 4; k++) {
                    uint32_t at[3];
                    at[axis] = side ? block->size[axis] - 1 : 0;
                    at[b] = p + turn[side][k][0];
                    at[c] = q + turn[side][k][1];
                    *corner++ = (uint32_t)particle_at(block, at);
                }
    return corner;
}

static size_t count_quads(const sk_block *block) {
    size_t count = 0;
    for (int axis = 0; axis < 3; axis++)
        count += (size_t)(block->size[axis] > 1 ? 2 : 1) * (block->size[(axis + 1) % 3] - 1) *
                 (block->size[(axis + 2) % 3] - 1);
    return count;
}

/* Only particles on the surface are vertices. `faces` comes with particles as corners and leaves with vertices. */
static bool number_vertices(const sk_block *block, uint32_t *faces, size_t corners) {
    sk_allocator *allocator = &block->world->allocator;
    sk_body *body = block->body;
    uint32_t *vertex = sk_allocate(allocator, block->count * sizeof *vertex);
    if (!vertex) return false;
    const uint32_t *n = block->size;
    uint32_t at[3] = {0, 0, 0};
    for (size_t i = 0; i < block->count; i++) {
        bool outside = false;
        for (int k = 0; k < 3; k++) outside |= at[k] == 0 || at[k] + 1 == n[k];
        vertex[i] = outside ? (uint32_t)body->vertex_count++ : UINT32_MAX;
        if (++at[2] == n[2]) at[2] = 0, at[1]++;
        if (at[1] == n[1]) at[1] = 0, at[0]++;
    }
    body->particle_of_vertex = sk_allocate(allocator, body->vertex_count * sizeof *body->particle_of_vertex);
    for (size_t i = 0; i < block->count && body->particle_of_vertex; i++)
        if (vertex[i] != UINT32_MAX) body->particle_of_vertex[vertex[i]] = body->first_particle + (uint32_t)i;
    for (size_t k = 0; k < corners; k++) faces[k] = vertex[faces[k]];
    sk_release(allocator, vertex);
    return body->particle_of_vertex != NULL;
}

skein_status sk_block_add_surface(sk_block *block) {
    sk_allocator *allocator = &block->world->allocator;
    sk_body *body = block->body;
    size_t quads = count_quads(block);
    body->face_vertices = sk_allocate(allocator, 4 * quads * sizeof *body->face_vertices);
    body->face_sizes = sk_allocate(allocator, quads * sizeof *body->face_sizes);
    uint32_t(*triangles)[3] = sk_allocate(allocator, 2 * quads * sizeof *triangles);
    skein_status status = SKEIN_OK;
    if (body->face_vertices && body->face_sizes && triangles) {
        uint32_t *corner = body->face_vertices;
        for (int axis = 0; axis < 3; axis++) corner = lay_faces(block, axis, corner);
        for (size_t q = 0; q < quads; q++) {
            body->face_sizes[q] = 4;
            for (int t = 0; t < 2; t++)
                for (int k = 0; k < 3; k++)
                    triangles[2 * q + (size_t)t][k] =
                        body->first_particle + body->face_vertices[4 * q + (size_t)(k ? k + t : 0)];
        }
        body->face_count = quads;
        body->face_vertex_count = 4 * quads;
        if (!number_vertices(block, body->face_vertices, 4 * quads)) status = sk_fail_memory(block->error, "faces");
        else status = sk_world_add_triangles(block->world, 2 * quads, (const uint32_t(*)[3])triangles, block->error);
    } else {
        status = sk_fail_memory(block->error, "faces");
    }
    sk_release(allocator, triangles);
    return status;
}
