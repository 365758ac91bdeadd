/* Meshes made in code. Nothing here is timed. */
#include "bench/meshes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/bench.h"

double bench_random(uint64_t *state) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (double)(*state >> 11) / 9007199254740992.0;
}

static bench_mesh allocate_mesh(size_t vertices, size_t faces, size_t corners) {
    return (bench_mesh){.positions = bench_allocate(vertices * 3, sizeof(double)),
                        .sizes = bench_allocate(faces, sizeof(uint32_t)),
                        .vertices = bench_allocate(corners, sizeof(uint32_t))};
}

static void finish(bench_mesh *m, size_t vertices, size_t pin, size_t other_pin) {
    m->mesh.positions = m->positions;
    m->mesh.vertex_count = vertices;
    m->mesh.face_sizes = m->sizes;
    m->mesh.face_vertices = m->vertices;
    snprintf(m->pins, sizeof m->pins, "%zu %zu", pin, other_pin);
}

void bench_mesh_release(bench_mesh *m) {
    free(m->positions);
    free(m->sizes);
    free(m->vertices);
    *m = (bench_mesh){0};
}

static void add_face(bench_mesh *m, const uint32_t *corners, uint32_t size) {
    m->sizes[m->mesh.face_count++] = size;
    memcpy(m->vertices + m->mesh.face_vertex_count, corners, size * sizeof *corners);
    m->mesh.face_vertex_count += size;
}

/* ---- irregular ---- */

/* The first vertex of each row, and one past the last. Lengths differ by up to a tenth from row to row, so that no
 * difference of numbers is common, as in a mesh that a triangulator made. */
static size_t *deal_rows(size_t vertices, size_t rows, uint64_t *seed) {
    size_t *first = bench_allocate(rows + 1, sizeof *first), even = vertices / rows;
    for (size_t r = 0; r < rows; r++) {
        size_t shift = (size_t)(0.1 * (double)even * bench_random(seed));
        size_t length = r % 2 ? even + shift : even - shift;
        first[r + 1] = first[r] + length;
    }
    first[rows] = vertices; // the last row takes what is left
    return first;
}

static double distance2(const double *p, const double *q) {
    double x = p[0] - q[0], z = p[2] - q[2];
    return x * x + z * z;
}

/* Triangles between the rows [a, a_end) and [b, b_end). */
static void sew(bench_mesh *m, uint32_t a, uint32_t a_end, uint32_t b, uint32_t b_end) {
    while (a + 1 < a_end || b + 1 < b_end) {
        bool along_a = b + 1 == b_end;
        if (a + 1 < a_end && b + 1 < b_end)
            along_a = distance2(m->positions + 3 * (a + 1), m->positions + 3 * b) <
                      distance2(m->positions + 3 * a, m->positions + 3 * (b + 1));
        add_face(m, (uint32_t[]){a, b, along_a ? a + 1 : b + 1}, 3);
        if (along_a) a++;
        else b++;
    }
}

/* Gives every vertex a random number; `order` receives the new numbers. */
static void shuffle(bench_mesh *m, size_t count, uint32_t *order, uint64_t *seed) {
    double *placed = bench_allocate(count * 3, sizeof *placed);
    for (size_t i = count; i-- > 1;) {
        size_t j = (size_t)(bench_random(seed) * (double)(i + 1));
        uint32_t kept = order[i];
        order[i] = order[j], order[j] = kept;
    }
    for (size_t i = 0; i < count; i++) memcpy(placed + 3 * order[i], m->positions + 3 * i, 3 * sizeof *placed);
    for (size_t k = 0; k < m->mesh.face_vertex_count; k++) m->vertices[k] = order[m->vertices[k]];
    free(m->positions);
    m->positions = placed;
}

bench_mesh bench_mesh_irregular(size_t vertices, bool shuffled) {
    uint64_t seed = 20;
    size_t rows = (size_t)sqrt((double)vertices);
    size_t *first = deal_rows(vertices, rows, &seed);
    bench_mesh m = allocate_mesh(vertices, 2 * vertices, 6 * vertices);
    for (size_t r = 0; r < rows; r++) {
        size_t length = first[r + 1] - first[r];
        for (size_t c = 0; c < length; c++) {
            double *p = m.positions + 3 * (first[r] + c), step = 1 / (double)(length - 1);
            bool border = c == 0 || c + 1 == length, edge = r == 0 || r + 1 == rows;
            p[0] = (double)c * step + (border ? 0 : 0.5 * step * (bench_random(&seed) - 0.5));
            p[1] = 0;
            p[2] = ((double)r + (edge ? 0 : 0.5 * (bench_random(&seed) - 0.5))) / (double)(rows - 1);
        }
    }
    for (size_t r = 0; r + 1 < rows; r++)
        sew(&m, (uint32_t)first[r], (uint32_t)first[r + 1], (uint32_t)first[r + 1], (uint32_t)first[r + 2]);
    uint32_t *number = bench_allocate(vertices, sizeof *number);
    for (size_t i = 0; i < vertices; i++) number[i] = (uint32_t)i;
    if (shuffled) shuffle(&m, vertices, number, &seed);
    finish(&m, vertices, number[0], number[first[1] - 1]);
    free(number);
    free(first);
    return m;
}

/* ---- grids ---- */

bench_mesh bench_mesh_quads(size_t n) {
    bench_mesh m = allocate_mesh(n * n, n * n, 4 * n * n);
    for (size_t i = 0; i < n * n; i++) {
        double *p = m.positions + 3 * i;
        p[0] = (double)(i % n) / (double)(n - 1), p[1] = 0, p[2] = (double)(i / n) / (double)(n - 1);
    }
    for (uint32_t r = 0; r + 1 < n; r++)
        for (uint32_t c = 0; c + 1 < n; c++) {
            uint32_t at = r * (uint32_t)n + c;
            add_face(&m, (uint32_t[]){at, at + (uint32_t)n, at + (uint32_t)n + 1, at + 1}, 4);
        }
    finish(&m, n * n, 0, n - 1);
    return m;
}

bench_mesh bench_mesh_hole(size_t n, bool renumbered) {
    bench_mesh whole = bench_mesh_quads(n), m = allocate_mesh(n * n, n * n, 4 * n * n);
    uint32_t *number = bench_allocate(n * n, sizeof *number), count = 0; // the new number, from 1; 0: in no face
    for (size_t f = 0; f < whole.mesh.face_count; f++) {
        const uint32_t *corners = whole.vertices + 4 * f;
        const double *p = whole.positions + 3 * corners[0];
        if (hypot(p[0] - 0.5, p[2] - 0.5) < 0.2) continue;
        add_face(&m, corners, 4);
        for (int k = 0; k < 4; k++) number[corners[k]] = 1;
    }
    for (size_t i = 0; i < n * n; i++)
        if (number[i] || !renumbered) {
            memcpy(m.positions + 3 * count, whole.positions + 3 * i, 3 * sizeof *m.positions);
            number[i] = ++count;
        }
    for (size_t k = 0; k < m.mesh.face_vertex_count; k++) m.vertices[k] = number[m.vertices[k]] - 1;
    finish(&m, count, 0, n - 1);
    free(number);
    bench_mesh_release(&whole);
    return m;
}
