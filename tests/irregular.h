/* A mesh that is no grid, for tests. */
#ifndef SKEIN_TESTS_IRREGULAR_H
#define SKEIN_TESTS_IRREGULAR_H

#include "helpers.h"

#include <math.h>

/* Triangles that are all different: points beside those of a grid of `rows` by `columns`, diagonals either way, numbers that say
 * nothing. `rolled` joins the last column to the first. x and z are in cells; the caller frees all three arrays. */
static inline skein_mesh irregular_mesh(uint32_t rows, uint32_t columns, bool rolled) {
    size_t count = (size_t)rows * columns, across = columns - (rolled ? 0 : 1),
           corners = 6 * (size_t)(rows - 1) * across, faces = 0;
    double *positions = calloc(3 * count, sizeof *positions);
    uint32_t *vertices = calloc(corners, sizeof *vertices), *sizes = calloc(corners / 3, sizeof *sizes), seed = 1;
#define RANDOM() ((double)((seed = 1664525 * seed + 1013904223) >> 8) / (1 << 24))
#define NUMBER(r_, c_) ((uint32_t)(((r_)*columns + (c_) % columns) * (uint64_t)7919 % count))
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < columns; c++) {
            double x = 0.6 * RANDOM() - 0.3, z = 0.6 * RANDOM() - 0.3, *p = positions + 3 * (size_t)NUMBER(r, c);
            p[0] = c + (rolled || (c && c + 1 < columns) ? x : 0);
            p[2] = r + (r && r + 1 < rows ? z : 0);
        }
    for (uint32_t r = 0; r + 1 < rows; r++)
        for (uint32_t c = 0; c < across; c++) {
            uint32_t q[4] = {NUMBER(r, c), NUMBER(r + 1, c), NUMBER(r + 1, c + 1), NUMBER(r, c + 1)};
            uint32_t first = RANDOM() < 0.5 ? 0 : 1;
            for (uint32_t f = 0; f < 2; f++, sizes[faces++] = 3)
                for (uint32_t k = 0; k < 3; k++) vertices[3 * faces + k] = q[(first + 2 * f + k) % 4];
        }
#undef RANDOM
#undef NUMBER
    return (skein_mesh){.positions = positions,
                        .vertex_count = count,
                        .face_sizes = sizes,
                        .face_count = faces,
                        .face_vertices = vertices,
                        .face_vertex_count = corners};
}

static inline void add_and_free(skein_world *world, skein_mesh mesh, double *positions, const skein_setting *settings) {
    OK(world, skein_body_add(world, "cloth", &mesh, settings, NULL));
    free(positions);
    free((void *)mesh.face_vertices);
    free((void *)mesh.face_sizes);
}

/* A square metre of them, level. */
static inline void add_irregular(skein_world *world, uint32_t side, const skein_setting *settings) {
    skein_mesh mesh = irregular_mesh(side, side, false);
    double *p = (double *)mesh.positions;
    for (size_t i = 0; i < 3 * mesh.vertex_count; i++) p[i] = i % 3 == 1 ? 0 : p[i] / (side - 1) - 0.5;
    add_and_free(world, mesh, p, settings);
}

/* A tube of them along z, with edges of about `edge` metres. */
static inline void add_irregular_tube(skein_world *world, uint32_t along, uint32_t around, double edge,
                                      const skein_setting *settings) {
    skein_mesh mesh = irregular_mesh(along, around, true);
    double *p = (double *)mesh.positions, turn = 2 * acos(-1.0) / around;
    for (size_t i = 0; i < 3 * mesh.vertex_count; i += 3) {
        double angle = turn * p[i], radius = edge / turn;
        p[i] = radius * cos(angle), p[i + 1] = radius * sin(angle), p[i + 2] *= edge;
    }
    add_and_free(world, mesh, p, settings);
}

/* A closed surface of them: `rows` rings of `around` points and two poles, on an ellipsoid with these half axes, m. */
static inline void add_irregular_sack(skein_world *world, uint32_t rows, uint32_t around, const double half[3],
                                      const skein_setting *settings) {
    const double pi = acos(-1.0);
    skein_mesh mesh = irregular_mesh(rows, around, true);
    const size_t count = mesh.vertex_count, faces = mesh.face_count + 2 * (size_t)around;
    double *p = realloc((double *)mesh.positions, 3 * (count + 2) * sizeof *p);
    uint32_t *v = realloc((uint32_t *)mesh.face_vertices, 3 * faces * sizeof *v),
             *sizes = realloc((uint32_t *)mesh.face_sizes, faces * sizeof *sizes);
    for (size_t i = 0; i < count; i++) {
        const double turn = 2 * pi * p[3 * i] / around, down = pi * (p[3 * i + 2] + 1) / (rows + 1);
        p[3 * i] = half[0] * sin(down) * cos(turn), p[3 * i + 1] = half[1] * cos(down),
              p[3 * i + 2] = half[2] * sin(down) * sin(turn);
    }
    for (size_t pole = 0; pole < 2; pole++) {
        double *at = p + 3 * (count + pole);
        at[0] = at[2] = 0, at[1] = pole ? -half[1] : half[1];
        for (uint32_t c = 0; c < around; c++) { // as irregular_mesh numbers them
            uint32_t ring[2], *t = v + 3 * (mesh.face_count + pole * around + c);
            for (uint32_t k = 0; k < 2; k++)
                ring[k] = (uint32_t)((pole * (rows - 1) * around + (c + k) % around) * (uint64_t)7919 % count);
            t[0] = (uint32_t)(count + pole), t[1] = ring[pole], t[2] = ring[1 - pole];
        }
    }
    for (size_t f = mesh.face_count; f < faces; f++) sizes[f] = 3;
    mesh = (skein_mesh){.positions = p,
                        .vertex_count = count + 2,
                        .face_sizes = sizes,
                        .face_count = faces,
                        .face_vertices = v,
                        .face_vertex_count = 3 * faces};
    add_and_free(world, mesh, p, settings);
}

#endif
