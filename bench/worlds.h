/* Worlds to measure, and the same springs for whoever is measured beside them. */
#ifndef SKEIN_BENCH_WORLDS_H
#define SKEIN_BENCH_WORLDS_H

#include "bench/bench.h"
#include "bench/meshes.h"
#include "bench/plain.h"
#include "plan/op.h"

#define BENCH_RIGID ((double)__builtin_inf()) // a stiffness

/* A cloth of 1 m2 and 0.2 kg, without tethers and strain limits, which peers do not have. */
typedef struct bench_scene {
    int rows, columns;      /* a grid of particles, or */
    const bench_mesh *mesh; /* a mesh */
    const char *pins;       /* NULL: "top corners" of a grid, the two far corners of a mesh */
    const char *method;     /* NULL: xpbd */
    int substeps, threads;  /* 0: 10, and 1 */
    int iterations;         /* sweeps a substep; 0: 1 */
    double stiffness;       /* of all springs, N/m; 0: 1e4 */
    double damping;         /* N s/m */
    double drag;            /* 1/s */
    bool weightless;        /* no gravity */
} bench_scene;

skein_world *bench_world(int threads);
skein_world *bench_cloth(const bench_scene *scene);
/* n x n x n particles with springs along axes and across faces, 1 m3 of 1 kg; NULL, with a word why, in a build without
 * lattices. */
skein_world *bench_lattice(int n, const bench_scene *scene);
/* Ends the program with the world's own words if a call failed. */
void bench_need(skein_world *world, skein_status status);

/* The W's frame. */
void bench_step(void *world);
void bench_steps(skein_world *world, int count);

size_t bench_spring_count(const skein_world *world);
/* Shakes a resting world a little, so that nothing is at its rest length or still. */
void bench_shake(skein_world *world, double distance, double speed);
/* Of the measured edges, at these positions in the user's order; shorter edges count as not stretched. */
bench_stretch bench_stretch_at(const skein_world *world, const double *positions);
bench_stretch bench_stretch_now(const skein_world *world);

/* All springs of the world in its own order, each as the user's two particles; `pairs` is freed by the caller. */
uint32_t *bench_pairs(const skein_world *world);
/* The student's springs of a world, in its present state. Their order is
 *   as listed   direction by direction and row by row on grids, outward on meshes
 *   as walked   exactly as the ops of Skein's plan go: on grids all strips at once, on meshes group by group, and halves
 *               where they are swept forward and back
 * and particles are numbered as the user has them, or as they lie in the world. */
typedef enum bench_order { BENCH_AS_LISTED, BENCH_AS_WALKED } bench_order;
plain_system *bench_plain(const skein_world *world, bench_order order, bool as_they_lie, double h);
/* Sort by sort, each as a reader of the mesh's faces comes upon their ends. */
plain_system *bench_plain_as_filed(const skein_world *world, const skein_mesh *mesh, double h);

/* ---- ops of a plan alone ---- */

/* All rows of a kind of the world's plan, which repeats them as often as a frame would. Until it is destroyed, the
 * world must not be stepped. NULL if the plan has no such ops. */
typedef struct bench_ops bench_ops;
bench_ops *bench_ops_create(skein_world *world, sk_op_kind kind);
void bench_ops_destroy(bench_ops *ops);
void bench_ops_run(void *ops);      /* timed: all iterations */
void bench_ops_run_once(void *ops); /* the second iteration, in which all ops are due */
size_t bench_ops_iterations(const bench_ops *ops);
/* The forces that one iteration adds up, in the user's order. */
void bench_ops_forces(bench_ops *ops, double *out);

#endif
