/* Ops alone, beside the student's loop over the same springs: forces, sweeps of XPBD, and sweeps of other shapes. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/worlds.h"

#define SUBSTEP (1.0 / 600) // of bench_cloth's worlds, s
enum { MESH = 50000, QUICK_MESH = 1000 };

/* ---- that both do the same ---- */

static double norm(const double *x, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += x[i] * x[i];
    return sqrt(sum);
}

/* Both add up the same forces, but for rounding. */
static void check_forces(bench_ops *ops, plain_system *plain, const char *size) {
    size_t count = 3 * plain->particle_count;
    double *ours = bench_allocate(count, sizeof(double)), *gap = bench_allocate(count, sizeof(double));
    bench_ops_forces(ops, ours);
    plain_force(plain);
    for (size_t i = 0; i < count; i++) gap[i] = ours[i] - (double)plain->particles[i / 3].f[i % 3];
    double off = norm(gap, count) / norm(ours, count);
    if (!(off < 1e-3)) bench_fault("force, %s: the plain loop's forces differ by %g of theirs", size, off);
    free(ours);
    free(gap);
}

/* One sweep of each in the same order moves particles alike, but for rounding. */
static void check_sweep(skein_world *world, const char *size) {
    size_t count = 3 * skein_particle_count(world);
    double *before = bench_allocate(count, sizeof(double)), *gap = bench_allocate(count, sizeof(double)),
           *after = bench_allocate(count, sizeof(double));
    skein_positions_copy(world, 0, count / 3, before);
    plain_system *plain = bench_plain(world, BENCH_AS_WALKED, false, SUBSTEP);
    bench_ops *ops = bench_ops_create(world, SK_OP_PROJECT);
    plain_project(plain);
    if (ops) bench_ops_run_once(ops);
    bench_ops_destroy(ops);
    skein_positions_copy(world, 0, count / 3, after);
    for (size_t i = 0; i < count; i++) {
        gap[i] = after[i] - (double)plain->particles[i / 3].x[i % 3];
        after[i] -= before[i];
    }
    double off = norm(gap, count) / norm(after, count);
    if (!(off < 1e-2)) bench_fault("sweep, %s: the plain loop's moves differ by %g of theirs", size, off);
    plain_destroy(plain);
    free(before);
    free(gap);
    free(after);
}

/* ---- force ---- */

static void compare_forces(skein_world *world, const char *size, double bar) {
    bench_shake(world, 1e-4, 0.1);
    plain_system *plain = bench_plain(world, BENCH_AS_LISTED, false, 1);
    bench_ops *ops = bench_ops_create(world, SK_OP_FORCE);
    if (ops) {
        check_forces(ops, plain, size);
        bench_job jobs[] = {{.run = plain_force, .data = plain}, {.run = bench_ops_run, .data = ops}};
        double seconds[2], count = (double)plain->spring_count;
        bench_measure(jobs, 2, 0.05, seconds);
        bench_report(&(bench_result){.name = "force",
                                     .size = size,
                                     .ours = 1e9 * seconds[1] / count / (double)bench_ops_iterations(ops),
                                     .unit = "ns/constraint",
                                     .other = "plain loop",
                                     .theirs = 1e9 * seconds[0] / count,
                                     .faster = bar,
                                     .note = "stiffness 1e4 N/m, damping 1 N s/m, both"});
        bench_ops_destroy(ops);
    }
    plain_destroy(plain);
    skein_world_destroy(world);
}

static void run_force(void) {
    bench_scene scene = {.method = "symplectic_euler", .damping = 1};
    char size[40];
    for (int n = 64; n <= (bench_quick ? 64 : 256); n *= 2) {
        scene.rows = scene.columns = n;
        snprintf(size, sizeof size, "grid %d x %d", n, n);
        compare_forces(bench_cloth(&scene), size, n > 64 ? 8 : 0);
    }
    for (int n = bench_quick ? 6 : 20; n <= (bench_quick ? 6 : 40); n *= 2) {
        skein_world *lattice = bench_lattice(n, &scene);
        snprintf(size, sizeof size, "lattice %d^3", n);
        if (lattice) compare_forces(lattice, size, 8);
    }
    size_t vertices = bench_quick ? QUICK_MESH : MESH;
    bench_mesh mesh = bench_mesh_irregular(vertices, true);
    scene.mesh = &mesh;
    snprintf(size, sizeof size, "mesh of %zu, random numbers", vertices);
    compare_forces(bench_cloth(&scene), size, 2);
    bench_mesh_release(&mesh);
}

const bench_case bench_force = {
    "force", "damped spring forces beside the plain loop: grids, lattices, a randomly numbered mesh", run_force};

/* ---- sweep ---- */

typedef struct rival {
    plain_system *plain;
    const char *name;
    double bar;
} rival;

static void compare_sweeps(bench_ops *ops, const rival *rivals, size_t rival_count, const char *size) {
    bench_job jobs[BENCH_MOST_JOBS] = {{.run = bench_ops_run, .data = ops}};
    double seconds[BENCH_MOST_JOBS], count = (double)rivals->plain->spring_count;
    for (size_t i = 0; i < rival_count; i++) jobs[i + 1] = (bench_job){.run = plain_project, .data = rivals[i].plain};
    bench_measure(jobs, 1 + rival_count, 0.05, seconds);
    for (size_t i = 0; i < rival_count; i++)
        bench_report(&(bench_result){.name = "sweep",
                                     .size = size,
                                     .ours = 1e9 * seconds[0] / count / (double)bench_ops_iterations(ops),
                                     .unit = "ns/constraint",
                                     .other = rivals[i].name,
                                     .theirs = 1e9 * seconds[i + 1] / count,
                                     .faster = rivals[i].bar,
                                     .note = "XPBD, stiffness 1e4 N/m, undamped, both"});
}

/* A grid, or a lattice, in motion; `world` is destroyed. */
static void sweep_regular(skein_world *world, const char *size, double bar) {
    check_sweep(world, size);
    rival rivals[] = {
        {bench_plain(world, BENCH_AS_LISTED, false, SUBSTEP), "plain loop, type order", bar},
        {bench_plain(world, BENCH_AS_WALKED, false, SUBSTEP), "plain loop, as walked", 0},
    };
    bench_ops *ops = bench_ops_create(world, SK_OP_PROJECT);
    if (ops) compare_sweeps(ops, rivals, 2, size);
    bench_ops_destroy(ops);
    for (int i = 0; i < 2; i++) plain_destroy(rivals[i].plain);
    skein_world_destroy(world);
}

static void sweep_mesh(size_t vertices, bool shuffled) {
    char size[40];
    snprintf(size, sizeof size, "mesh of %zu%s", vertices, shuffled ? ", random numbers" : "");
    bench_mesh mesh = bench_mesh_irregular(vertices, shuffled);
    skein_world *world = bench_cloth(&(bench_scene){.mesh = &mesh});
    bench_steps(world, 20);
    check_sweep(world, size);
    rival rivals[] = {
        {bench_plain_as_filed(world, &mesh.mesh, SUBSTEP), "plain loop, file's order", 4},
        {bench_plain(world, BENCH_AS_LISTED, true, SUBSTEP), "plain loop, same order", 1.5},
        {bench_plain(world, BENCH_AS_WALKED, true, SUBSTEP), "plain loop, as walked", 0},
    };
    bench_ops *ops = bench_ops_create(world, SK_OP_PROJECT);
    if (ops) compare_sweeps(ops, rivals, 3, size);
    bench_ops_destroy(ops);
    for (int i = 0; i < 3; i++) plain_destroy(rivals[i].plain);
    skein_world_destroy(world);
    bench_mesh_release(&mesh);
}

static void run_sweep(void) {
    char size[40];
    for (int n = 64; n <= (bench_quick ? 64 : 256); n *= 2) {
        snprintf(size, sizeof size, "grid %d x %d", n, n);
        skein_world *cloth = bench_cloth(&(bench_scene){.rows = n, .columns = n});
        bench_steps(cloth, 20);
        sweep_regular(cloth, size, 10);
    }
    int n = bench_quick ? 6 : 20;
    skein_world *lattice = bench_lattice(n, &(bench_scene){0});
    snprintf(size, sizeof size, "lattice %d^3", n);
    if (lattice) {
        bench_shake(lattice, 1e-3, 0); // nothing holds it: it would only fall
        sweep_regular(lattice, size, 0);
    }
    sweep_mesh(bench_quick ? QUICK_MESH : MESH, false);
    sweep_mesh(bench_quick ? QUICK_MESH : MESH, true);
}

const bench_case bench_sweep = {"sweep", "sweeps of XPBD beside the plain loop: grids, an irregular mesh", run_sweep};

/* ---- shapes ---- */

static void run_shapes(void) {
    int n = bench_quick ? 64 : 128;
    bench_mesh quads = bench_mesh_quads((size_t)n), hole = bench_mesh_hole((size_t)n, false),
               renumbered = bench_mesh_hole((size_t)n, true);
    const struct {
        const char *size;
        bench_scene scene;
    } shapes[] = {{NULL, {.rows = n, .columns = n}},
                  {"grid 100 x 100", {.rows = 100, .columns = 100}},
                  {"grid 127 x 65", {.rows = 127, .columns = 65}},
                  {"grid as a file's mesh", {.mesh = &quads}},
                  {"the same with a hole", {.mesh = &hole}},
                  {"hole, numbered anew", {.mesh = &renumbered}}};
    enum { SHAPES = sizeof shapes / sizeof *shapes };
    skein_world *worlds[SHAPES];
    bench_job jobs[SHAPES];
    double seconds[SHAPES];
    for (int i = 0; i < SHAPES; i++) {
        worlds[i] = bench_cloth(&shapes[i].scene);
        bench_steps(worlds[i], 20);
        bench_ops *ops = bench_ops_create(worlds[i], SK_OP_PROJECT);
        if (!ops) bench_stop("no sweeps to compare");
        jobs[i] = (bench_job){.run = bench_ops_run, .data = ops};
    }
    bench_measure(jobs, SHAPES, 0.05, seconds);
    for (int i = 0; i < SHAPES; i++)
        seconds[i] /= (double)bench_spring_count(worlds[i]) * (double)bench_ops_iterations(jobs[i].data);
    char other[40];
    snprintf(other, sizeof other, "grid %d x %d", n, n);
    for (int i = 1; i < SHAPES; i++)
        bench_report(&(bench_result){.name = "shapes",
                                     .size = shapes[i].size,
                                     .ours = 1e9 * seconds[i],
                                     .unit = "ns/constraint",
                                     .other = other,
                                     .theirs = 1e9 * seconds[0],
                                     .as_long = 1.3});
    for (int i = 0; i < SHAPES; i++) {
        bench_ops_destroy(jobs[i].data);
        skein_world_destroy(worlds[i]);
    }
    bench_mesh_release(&quads);
    bench_mesh_release(&hole);
    bench_mesh_release(&renumbered);
}

const bench_case bench_shapes = {"shapes", "a constraint's sweep on other grids against one of 128 x 128", run_shapes};
