/* A mesh that is no grid, for tests. */
#ifndef SKEIN_TESTS_IRREGULAR_H
#define SKEIN_TESTS_IRREGULAR_H

#include "helpers.h"

/* A square metre of triangles that are all different: points beside those of a grid, diagonals either way, numbers that say
 * nothing. */
static inline void add_irregular(skein_world *world, uint32_t side, const skein_setting *settings) {
    size_t count = (size_t)side * side, corners = 6 * (size_t)(side - 1) * (side - 1), faces = 0;
    double *positions = calloc(3 * count, sizeof *positions);
    uint32_t *vertices = calloc(corners, sizeof *vertices), *sizes = calloc(corners / 3, sizeof *sizes), seed = 1;
#define RANDOM() ((double)((seed = 1664525 * seed + 1013904223) >> 8) / (1 << 24))
#define NUMBER(r_, c_) ((uint32_t)(((r_) * side + (c_)) * (uint64_t)7919 % count))
    for (uint32_t r = 0; r < side; r++)
        for (uint32_t c = 0; c < side; c++) {
            double x = 0.6 * RANDOM() - 0.3, z = 0.6 * RANDOM() - 0.3, *p = positions + 3 * (size_t)NUMBER(r, c);
            p[0] = (c + (c && c + 1 < side ? x : 0)) / (side - 1) - 0.5;
            p[2] = (r + (r && r + 1 < side ? z : 0)) / (side - 1) - 0.5;
        }
    for (uint32_t r = 0; r + 1 < side; r++)
        for (uint32_t c = 0; c + 1 < side; c++) {
            uint32_t q[4] = {NUMBER(r, c), NUMBER(r + 1, c), NUMBER(r + 1, c + 1), NUMBER(r, c + 1)};
            uint32_t first = RANDOM() < 0.5 ? 0 : 1;
            for (uint32_t f = 0; f < 2; f++, sizes[faces++] = 3)
                for (uint32_t k = 0; k < 3; k++) vertices[3 * faces + k] = q[(first + 2 * f + k) % 4];
        }
    skein_mesh mesh = {.positions = positions, .vertex_count = count, .face_sizes = sizes, .face_count = faces,
                       .face_vertices = vertices, .face_vertex_count = corners};
    OK(world, skein_body_add(world, "cloth", &mesh, settings, NULL));
    free(positions);
    free(vertices);
    free(sizes);
}

#endif
