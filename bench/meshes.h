/* Meshes made in code, the same every time. */
#ifndef SKEIN_BENCH_MESHES_H
#define SKEIN_BENCH_MESHES_H

#include <skein/skein.h>

typedef struct bench_mesh {
    skein_mesh mesh;
    double *positions;
    uint32_t *sizes, *vertices;
    char pins[48]; /* the two far corners' numbers */
} bench_mesh;

/* 1 m2 in the plane of x and z, of triangles: rows of differing length, sewn together by the shorter diagonals.
 * Its vertices are numbered along the rows, or in random order. */
bench_mesh bench_mesh_irregular(size_t vertex_count, bool shuffled);
/* n x n vertices and their quads as a file of a grid has them: numbered row by row. */
bench_mesh bench_mesh_quads(size_t n);
/* The same with a round hole; its vertices stay in the file, or are taken out and the rest numbered anew. */
bench_mesh bench_mesh_hole(size_t n, bool renumbered);
void bench_mesh_release(bench_mesh *mesh);

/* A number in [0, 1), the same sequence everywhere. */
double bench_random(uint64_t *state);

#endif
