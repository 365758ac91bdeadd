/* Colliders by distances sampled from a mesh (`field`) beside the same mesh as a collider (`mesh`): what a point costs, what
 * making one takes, and a cloth that lies on one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/worlds.h"

enum { POINTS = 20000 };

/* A torus of radii 0.35 and 0.15 m, with `around` quads around its tube and twice as many along it. */
static skein_handle add_torus(skein_world *world, const char *kind, uint32_t around, const skein_setting *settings) {
    const double turn = 6.283185307179586;
    uint32_t along = 2 * around, count = around * along;
    double(*position)[3] = bench_allocate(count, sizeof *position);
    uint32_t *size = bench_allocate(count, sizeof *size), (*corner)[4] = bench_allocate(count, sizeof *corner);
    for (uint32_t i = 0; i < along; i++)
        for (uint32_t j = 0; j < around; j++) {
            double a = turn * i / along, b = turn * j / around, r = 0.35 + 0.15 * cos(b);
            double place[3] = {r * cos(a), 0.15 * sin(b), r * sin(a)};
            uint32_t at = i * around + j, next = (i + 1) % along * around, up = (j + 1) % around;
            uint32_t quad[4] = {at, i * around + up, next + up, next + j};
            for (int k = 0; k < 3; k++) position[at][k] = place[k];
            for (int k = 0; k < 4; k++) corner[at][k] = quad[k];
            size[at] = 4;
        }
    skein_mesh mesh = {.positions = &position[0][0],
                       .vertex_count = count,
                       .face_sizes = size,
                       .face_count = count,
                       .face_vertices = &corner[0][0],
                       .face_vertex_count = 4 * (size_t)count};
    skein_handle handle;
    bench_need(world, skein_collider_add_mesh(world, kind, &mesh, settings, &handle));
    free(position), free(size), free(corner);
    return handle;
}

/* ---- points ---- */

typedef struct asking {
    skein_world *world;
    skein_handle collider;
    double (*point)[3], *distance, (*normal)[3];
} asking;

static void ask(void *data) {
    asking *a = data;
    bench_need(a->world,
               skein_collider_probe(a->world, a->collider, POINTS, &a->point[0][0], a->distance, &a->normal[0][0]));
}

/* Points strewn in the box around it. */
static void strew(asking *a) {
    uint32_t seed = 1;
    a->point = bench_allocate(POINTS, sizeof *a->point);
    a->distance = bench_allocate(POINTS, sizeof *a->distance);
    a->normal = bench_allocate(POINTS, sizeof *a->normal);
    for (size_t i = 0; i < 3 * POINTS; i++) {
        seed = 1664525 * seed + 1013904223;
        a->point[i / 3][i % 3] = ((double)(seed >> 8) / (1 << 24) - 0.5) * (i % 3 == 1 ? 0.4 : 1.1);
    }
}

static void forget(asking *a) {
    skein_world_destroy(a->world);
    free(a->point), free(a->distance), free(a->normal);
}

/* The mesh is the truth: where a field is farther off than half a cell, it is none. */
static void compare(const asking *mesh, const asking *field, double cell) {
    for (size_t i = 0; i < POINTS; i++)
        if (fabs(mesh->distance[i]) < 0.1 && !(fabs(mesh->distance[i] - field->distance[i]) < cell / 2))
            bench_stop("field: point %zu is %g m off, %g by the mesh", i, field->distance[i], mesh->distance[i]);
}

static void points(uint32_t around) {
    const double cell = 0.0125;
    asking of[2];
    bench_job jobs[2];
    double seconds[2];
    char size[64];
    for (int k = 0; k < 2; k++) {
        of[k].world = bench_world(1);
        of[k].collider =
            add_torus(of[k].world, k ? "mesh" : "field", around, k ? NULL : SKEIN_SETTINGS(SKEIN_REAL("cell", cell)));
        strew(&of[k]);
        ask(&of[k]);
        jobs[k] = (bench_job){.run = ask, .data = &of[k]};
    }
    compare(&of[1], &of[0], cell);
    bench_measure(jobs, 2, bench_quick ? 0 : 0.1, seconds);
    snprintf(size, sizeof size, "%u triangles", 4 * around * around);
    bench_report(&(bench_result){.name = "field, points",
                                 .size = size,
                                 .ours = 1e6 * seconds[0] / POINTS,
                                 .unit = "us/point",
                                 .other = "mesh",
                                 .theirs = 1e6 * seconds[1] / POINTS,
                                 .faster = 10,
                                 .note = "distance and normal of scattered points, cells of 1.25 cm"});
    forget(&of[0]), forget(&of[1]);
}

/* ---- making, and a cloth ---- */

static void make(void *data) {
    skein_world *world = bench_world(1);
    add_torus(world, "field", *(const uint32_t *)data, SKEIN_SETTINGS(SKEIN_REAL("cell", 0.0125)));
    skein_world_destroy(world);
}

static void lay(uint32_t around) {
    skein_world *worlds[2];
    bench_job jobs[2], making = {.run = make, .data = &around, .calls = 1};
    double seconds[2], once;
    for (int k = 0; k < 2; k++) {
        worlds[k] = bench_cloth(&(bench_scene){.rows = 64, .columns = 64, .pins = "", .drag = 1});
        add_torus(worlds[k], k ? "mesh" : "field", around,
                  k ? SKEIN_SETTINGS(SKEIN_VEC3("position", 0, -0.3, 0))
                    : SKEIN_SETTINGS(SKEIN_VEC3("position", 0, -0.3, 0), SKEIN_REAL("cell", 0.0125)));
        bench_steps(worlds[k], bench_quick ? 2 : 60);
        jobs[k] = (bench_job){.run = bench_step, .data = worlds[k], .calls = bench_quick ? 1 : 20};
    }
    bench_measure(jobs, 2, 0, seconds);
    bench_report(&(bench_result){.name = "field, a cloth on it",
                                 .size = "64 x 64",
                                 .ours = 1e3 * seconds[0],
                                 .unit = "ms/frame",
                                 .other = "mesh",
                                 .theirs = 1e3 * seconds[1],
                                 .faster = 2,
                                 .note = "14,400 triangles, 10 substeps"});
    bench_measure(&making, 1, 0, &once);
    bench_report(&(bench_result){.name = "field, making",
                                 .size = "14400 triangles",
                                 .ours = once,
                                 .unit = "s",
                                 .under = 1,
                                 .note = "86 x 28 x 86 cells"});
    skein_world_destroy(worlds[0]), skein_world_destroy(worlds[1]);
}

static void run_field(void) {
    static const uint32_t around[] = {20, 60, 100};
    for (int i = 0; i < (bench_quick ? 1 : 3); i++) points(around[i]);
    lay(bench_quick ? 20 : 60);
}

const bench_case bench_field = {"field", "colliders by sampled distances beside the mesh that they are of", run_field};
