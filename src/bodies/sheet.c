/* A sheet's steps from a mesh to particles: copying, placing, welding by cells, areas and faces of particles. */
#include "bodies/sheet.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "base/rotation.h"
#include "base/status.h"

void sk_sheet_release(sk_sheet *sheet) {
    sk_allocator *allocator = sheet->allocator;
    if (!allocator) return;
    sk_release(allocator, sheet->face_sizes);
    sk_release(allocator, sheet->face_vertices);
    sk_release(allocator, sheet->particle_of_vertex);
    sk_release(allocator, sheet->position);
    sk_release(allocator, sheet->face_start);
    sk_release(allocator, sheet->corners);
    sk_release(allocator, sheet->face_area);
    sk_release(allocator, sheet->particle_area);
    memset(sheet, 0, sizeof *sheet);
}

/* Room for the arrays whose sizes are known once vertices, faces and corners are counted. */
static skein_status reserve(sk_sheet *sheet, sk_allocator *allocator, size_t vertices, size_t faces, size_t corners,
                            skein_error *error) {
    memset(sheet, 0, sizeof *sheet);
    sheet->allocator = allocator;
    sheet->vertex_count = sheet->particle_count = vertices;
    sheet->face_count = faces;
    sheet->corner_count = corners;
    if (vertices > UINT32_MAX - 64 || corners > UINT32_MAX / 4)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "mesh",
                       "%zu vertices and %zu face corners are too many for 32-bit indices", vertices, corners);
    sheet->position = sk_allocate(allocator, vertices * sizeof *sheet->position);
    sheet->particle_of_vertex = sk_allocate(allocator, vertices * sizeof *sheet->particle_of_vertex);
    sheet->particle_area = sk_allocate(allocator, vertices * sizeof *sheet->particle_area);
    sheet->face_sizes = sk_allocate(allocator, faces * sizeof *sheet->face_sizes);
    sheet->face_area = sk_allocate(allocator, faces * sizeof *sheet->face_area);
    sheet->face_start = sk_allocate(allocator, (faces + 1) * sizeof *sheet->face_start);
    sheet->face_vertices = sk_allocate(allocator, corners * sizeof *sheet->face_vertices);
    sheet->corners = sk_allocate(allocator, corners * sizeof *sheet->corners);
    if (!sheet->position || !sheet->particle_of_vertex || !sheet->particle_area || !sheet->face_sizes ||
        !sheet->face_area || !sheet->face_start || !sheet->face_vertices || !sheet->corners)
        return sk_fail_memory(error, "the mesh");
    return SKEIN_OK;
}

skein_status sk_sheet_from_mesh(sk_sheet *sheet, sk_allocator *allocator, const skein_mesh *mesh, skein_error *error) {
    skein_status status =
        reserve(sheet, allocator, mesh->vertex_count, mesh->face_count, mesh->face_vertex_count, error);
    if (status) return status;
    if (!mesh->vertex_count || !mesh->face_count)
        return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "a cloth needs vertices and faces; the mesh has %zu and %zu",
                       mesh->vertex_count, mesh->face_count);
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++)
        if (!(fabs(mesh->positions[i]) <= 1e12))
            return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "vertex %zu: coordinates must be finite, under 1e12", i / 3);
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t size = mesh->face_sizes[f];
        if (size < 3 || size > mesh->face_vertex_count - corner)
            return sk_fail(error, SKEIN_ERROR_MESH, "mesh",
                           "face %zu has %u corners, and %zu are left: expected 3 or more", f, size,
                           mesh->face_vertex_count - corner);
        for (uint32_t k = 0; k < size; k++, corner++)
            if (mesh->face_vertices[corner] >= mesh->vertex_count)
                return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "face %zu names vertex %u, but there are only %zu", f,
                               mesh->face_vertices[corner], mesh->vertex_count);
    }
    if (corner != mesh->face_vertex_count)
        return sk_fail(error, SKEIN_ERROR_MESH, "mesh", "%zu corners belong to no face",
                       mesh->face_vertex_count - corner);
    memcpy(sheet->position, mesh->positions, mesh->vertex_count * sizeof *sheet->position);
    memcpy(sheet->face_sizes, mesh->face_sizes, mesh->face_count * sizeof *sheet->face_sizes);
    memcpy(sheet->face_vertices, mesh->face_vertices, corner * sizeof *sheet->face_vertices);
    return SKEIN_OK;
}

skein_status sk_sheet_from_grid(sk_sheet *sheet, sk_allocator *allocator, const int32_t grid[2], const double size[2],
                                skein_error *error) {
    if (grid[0] < 2 || grid[1] < 2)
        return sk_fail(error, SKEIN_ERROR_VALUE, "grid", "a grid of %d x %d particles: expected 2 or more each way",
                       grid[0], grid[1]);
    size_t rows = (size_t)grid[0], columns = (size_t)grid[1], faces = (rows - 1) * (columns - 1);
    skein_status status = reserve(sheet, allocator, rows * columns, faces, 4 * faces, error);
    if (status) return status;
    sheet->grid_rows = (uint32_t)rows;
    sheet->grid_columns = (uint32_t)columns;
    for (size_t r = 0; r < rows; r++)
        for (size_t c = 0; c < columns; c++) {
            double *p = sheet->position[r * columns + c];
            p[0] = ((double)c / (double)(columns - 1) - 0.5) * size[0];
            p[2] = ((double)r / (double)(rows - 1) - 0.5) * size[1];
        }
    uint32_t *corner = sheet->face_vertices;
    for (size_t r = 0, f = 0; r + 1 < rows; r++)
        for (size_t c = 0; c + 1 < columns; c++, f++) {
            uint32_t a = (uint32_t)(r * columns + c), below = a + (uint32_t)columns;
            sheet->face_sizes[f] = 4;
            *corner++ = a, *corner++ = below, *corner++ = below + 1, *corner++ = a + 1;
        }
    return SKEIN_OK;
}

void sk_points_transform(double (*points)[3], size_t count, double scale, const double degrees[3],
                         const double offset[3]) {
    double s[3], c[3];
    for (int k = 0; k < 3; k++) sk_sincos_degrees(degrees[k], &s[k], &c[k]);
    for (size_t i = 0; i < count; i++) {
        double *p = points[i], x = p[0] * scale, y = p[1] * scale, z = p[2] * scale, t;
        t = c[0] * y - s[0] * z, z = s[0] * y + c[0] * z, y = t;
        t = c[1] * x + s[1] * z, z = c[1] * z - s[1] * x, x = t;
        t = c[2] * x - s[2] * y, y = s[2] * x + c[2] * y, x = t;
        p[0] = x + offset[0], p[1] = y + offset[1], p[2] = z + offset[2];
    }
}

void sk_sheet_transform(sk_sheet *sheet, double scale, const double degrees[3], const double offset[3]) {
    sk_points_transform(sheet->position, sheet->vertex_count, scale, degrees, offset);
}

/* ---- welding ---- */

static uint64_t cell_key(const int64_t cell[3]) {
    return sk_hash_mix((uint64_t)cell[0] * 0x9e3779b97f4a7c15u ^ (uint64_t)cell[1] * 0xc2b2ae3d27d4eb4fu ^
                       (uint64_t)cell[2] * 0x165667b19e3779f9u);
}

/* The first particle within `distance` of p among those already placed in the chains, or UINT32_MAX. */
static uint32_t find_near(const sk_sheet *sheet, const uint32_t *head, const uint32_t *next, size_t mask,
                          const double p[3], double distance) {
    uint32_t best = UINT32_MAX;
    int64_t centre[3], cell[3];
    for (int k = 0; k < 3; k++) centre[k] = (int64_t)floor(p[k] / distance);
    for (int n = 0; n < 27; n++) {
        for (int k = 0, m = n; k < 3; k++, m /= 3) cell[k] = centre[k] + m % 3 - 1;
        for (uint32_t i = head[cell_key(cell) & mask]; i != UINT32_MAX; i = next[i]) {
            const double *q = sheet->position[i];
            double d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
            if (i < best && d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= distance * distance) best = i;
        }
    }
    return best;
}

/* Joins vertices to the first one near; positions are packed so that particles come in the file's order. */
static skein_status join(sk_sheet *sheet, double distance, skein_error *error) {
    sk_allocator *allocator = sheet->allocator;
    size_t buckets = 16;
    while (buckets < sheet->vertex_count) buckets *= 2;
    uint32_t *head = sk_allocate(allocator, buckets * sizeof *head);
    uint32_t *next = sk_allocate(allocator, sheet->vertex_count * sizeof *next);
    skein_status status = head && next ? SKEIN_OK : sk_fail_memory(error, "welding");
    if (!status) memset(head, 0xff, buckets * sizeof *head);
    uint32_t count = 0;
    for (size_t v = 0; v < sheet->vertex_count && !status; v++) {
        double p[3];
        memcpy(p, sheet->position[v], sizeof p);
        uint32_t near = find_near(sheet, head, next, buckets - 1, p, distance);
        if (near == UINT32_MAX) {
            near = count++;
            memcpy(sheet->position[near], p, sizeof p);
            int64_t cell[3];
            for (int k = 0; k < 3; k++) cell[k] = (int64_t)floor(p[k] / distance);
            size_t bucket = cell_key(cell) & (buckets - 1);
            next[near] = head[bucket];
            head[bucket] = near;
        }
        sheet->particle_of_vertex[v] = near;
    }
    sk_release(allocator, head);
    sk_release(allocator, next);
    sheet->particle_count = count;
    return status;
}

/* The area of a face and its normal (Newell's), which is as long, also where the face is not flat or not convex. */
static double measure_face(const sk_sheet *sheet, const uint32_t *corners, size_t size, double normal[3]) {
    double n[3] = {0, 0, 0};
    for (size_t k = 0; k < size; k++) {
        const double *o = sheet->position[corners[0]], *a = sheet->position[corners[k]],
                     *b = sheet->position[corners[(k + 1) % size]];
        double u[3] = {a[0] - o[0], a[1] - o[1], a[2] - o[2]}, w[3] = {b[0] - o[0], b[1] - o[1], b[2] - o[2]};
        n[0] += u[1] * w[2] - u[2] * w[1];
        n[1] += u[2] * w[0] - u[0] * w[2];
        n[2] += u[0] * w[1] - u[1] * w[0];
    }
    for (int k = 0; k < 3; k++) normal[k] = 0.5 * n[k];
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

skein_status sk_sheet_weld(sk_sheet *sheet, double distance, skein_error *error) {
    for (size_t v = 0; v < sheet->vertex_count; v++) sheet->particle_of_vertex[v] = (uint32_t)v;
    if (distance > 0) {
        skein_status status = join(sheet, distance, error);
        if (status) return status;
    }
    // faces of particles, without corners that fell together
    size_t filled = 0, from = 0;
    for (size_t f = 0; f < sheet->face_count; from += sheet->face_sizes[f], f++) {
        sheet->face_start[f] = filled;
        uint32_t *face = sheet->corners + filled;
        size_t size = 0;
        for (uint32_t k = 0; k < sheet->face_sizes[f]; k++) {
            uint32_t p = sheet->particle_of_vertex[sheet->face_vertices[from + k]];
            if (size && face[size - 1] == p) continue;
            face[size++] = p;
        }
        while (size > 1 && face[0] == face[size - 1]) size--;
        if (size < 3) size = 0;
        filled += size;

        // its area, shared out to the corners; a sliver counts as none
        double normal[3], area = size ? measure_face(sheet, face, size, normal) : 0, longest = 0;
        for (size_t k = 0; k < size; k++) {
            const double *a = sheet->position[face[k]], *b = sheet->position[face[(k + 1) % size]];
            double square =
                (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
            if (square > longest) longest = square;
        }
        if (!(area > 1e-9 * longest)) {
            area = 0;
            if (!sheet->flat_faces++) sheet->first_flat_face = (uint32_t)f;
        }
        sheet->face_area[f] = area;
        for (size_t k = 0; k < size; k++) sheet->particle_area[face[k]] += area / (double)size;
    }
    sheet->face_start[sheet->face_count] = filled;
    return SKEIN_OK;
}

bool sk_sheet_is_flat(const sk_sheet *sheet) {
    const double nearly = 1e-3;
    double first[3] = {0, 0, 0}, length = 0;
    for (size_t f = 0; f < sheet->face_count; f++) {
        const uint32_t *face = sheet->corners + sheet->face_start[f];
        size_t size = sheet->face_area[f] > 0 ? sheet->face_start[f + 1] - sheet->face_start[f] : 0;
        for (size_t k = 1; k + 1 < size; k++) {
            const uint32_t triangle[3] = {face[0], face[k], face[k + 1]};
            double normal[3], along = 0, area = measure_face(sheet, triangle, 3, normal);
            if (!(length > 0)) memcpy(first, normal, sizeof first), length = area;
            for (int i = 0; i < 3; i++) along += first[i] * normal[i];
            if (!(along >= (1 - 0.5 * nearly * nearly) * length * area)) return false;
        }
    }
    return length > 0;
}
