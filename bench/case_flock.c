/* What a bird costs: beside the plain loop over a grid, beside all pairs, gathered, and as flocks grow. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/plain_flock.h"
#include "bench/worlds.h"

/* Zones of 3, 1.33 and 2.33 m, as in scenes/birds.json; nothing moves far in so short a step. */
static const double separation = 3, alignment = 4.0 / 3, cohesion = 7.0 / 3, dt = 1e-6;

static void step(void *world) {
    bench_need(world, skein_world_step(world, dt));
}

/* The side of a cube in which birds strewn evenly have so many neighbours each in the mean. Those near its walls have
 * fewer: of a ball of radius r, the part 1 - 9/8 p + 6/(5 pi) p^2 - p^3/(8 pi) is inside, with p = r/side. */
static double side_for(double count, double neighbours, double reach) {
    double full = cbrt(count / neighbours * 4.18879 * reach * reach * reach), side = full;
    for (int turn = 0; turn < 20; turn++) {
        double p = reach / side, inside = 1 - 1.125 * p + 0.381972 * p * p - 0.0397887 * p * p * p;
        side = full * cbrt(inside);
    }
    return side;
}

/* Birds strewn evenly, with so many neighbours each in the mean; `rules`: all that scenes/birds.json has. */
static skein_world *flock(double count, double neighbours, bool rules) {
    skein_world *world = bench_world(1);
    double reach = separation + alignment + cohesion;
    double side = side_for(count, neighbours, reach);
    bench_need(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    bench_need(world, skein_body_add(world, "flock", NULL,
                                     SKEIN_SETTINGS(SKEIN_REAL("count", count), SKEIN_VEC3("spread", side, side, side)),
                                     NULL));
    bench_need(world,
               skein_force_add(world, "flocking",
                               SKEIN_SETTINGS(SKEIN_REAL("separation", separation), SKEIN_REAL("alignment", alignment),
                                              SKEIN_REAL("cohesion", cohesion)),
                               NULL));
    if (rules) {
        bench_need(world, skein_force_add(world, "attraction", NULL, NULL));
        bench_need(world, skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("radius", 10)), NULL));
        bench_need(world, skein_force_add(world, "speed_limit", NULL, NULL));
    }
    step(world);
    return world;
}

static plain_flock *plain(const skein_world *world) {
    size_t count = skein_particle_count(world);
    double *x = bench_allocate(3 * count, sizeof *x), *v = bench_allocate(3 * count, sizeof *v);
    skein_positions_copy(world, 0, count, x);
    skein_velocities_copy(world, 0, count, v);
    plain_flock *f = plain_flock_create(count, x, v, separation, alignment, cohesion, dt);
    if (!f) bench_stop("no memory");
    free(x);
    free(v);
    return f;
}

/* Both sides must come to the same changes of velocity: in a step long enough for them to show, of copies. */
static void compare(double count, double neighbours, void (*run)(void *)) {
    skein_world *world = flock(count, neighbours, false);
    plain_flock *f = plain(world);
    size_t n = skein_particle_count(world);
    double *v0 = bench_allocate(3 * n, sizeof *v0), *v = bench_allocate(3 * n, sizeof *v), off = 0, all = 0;
    skein_velocities_copy(world, 0, n, v0);
    bench_need(world, skein_world_step(world, 0.01));
    skein_velocities_copy(world, 0, n, v);
    f->dt = 0.01f;
    run(f);
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            size_t at = 3 * (size_t)f->id[i] + (size_t)k;
            off += pow((double)f->to_v[k][i] - v[at], 2), all += pow(v[at] - v0[at], 2);
        }
    if (!(sqrt(off / all) < 1e-4)) bench_stop("the plain flock flies otherwise: %g", sqrt(off / all));
    free(v0);
    free(v);
    plain_flock_destroy(f);
    skein_world_destroy(world);
}

static void against_plain(double count, double neighbours, bool pairs, double grid_bar, double pairs_bar) {
    compare(bench_quick ? 500 : 3000, neighbours, plain_flock_grid);
    compare(bench_quick ? 500 : 3000, neighbours, plain_flock_all_pairs);
    skein_world *world = flock(count, neighbours, false);
    plain_flock *grid = plain(world), *all = plain(world);
    bench_job jobs[] = {{.run = step, .data = world},
                        {.run = plain_flock_grid, .data = grid},
                        {.run = plain_flock_all_pairs, .data = all}};
    double seconds[3];
    bench_measure(jobs, pairs ? 3 : 2, 0.05, seconds);
    char size[64];
    snprintf(size, sizeof size, "%.0f, %.0f neighbours", count, neighbours);
    for (int i = 1; i < (pairs ? 3 : 2); i++)
        bench_report(&(bench_result){.name = "flock",
                                     .size = size,
                                     .ours = 1e9 * seconds[0] / count,
                                     .unit = "ns/bird",
                                     .other = i == 1 ? "plain grid" : "all pairs",
                                     .theirs = 1e9 * seconds[i] / count,
                                     .faster = i == 1 ? grid_bar : pairs_bar});
    plain_flock_destroy(grid);
    plain_flock_destroy(all);
    skein_world_destroy(world);
}

static void growing(void) {
    static const double counts[] = {1e4, 1e5, 1e6};
    int count = bench_quick ? 1 : 3;
    skein_world *worlds[3];
    bench_job jobs[3];
    double seconds[3];
    for (int i = 0; i < count; i++) {
        worlds[i] = flock(bench_quick ? 1000 : counts[i], 30, true);
        jobs[i] = (bench_job){.run = step, .data = worlds[i]};
    }
    bench_measure(jobs, (size_t)count, 0.1, seconds);
    for (int i = 0; i < count; i++) {
        double n = (double)skein_particle_count(worlds[i]);
        char size[40];
        snprintf(size, sizeof size, "%.0f, all rules", n);
        seconds[i] /= n;
        bench_report(&(bench_result){.name = "flock, growing",
                                     .size = size,
                                     .ours = 1e9 * seconds[i],
                                     .unit = "ns/bird",
                                     .other = i ? "the smallest" : NULL,
                                     .theirs = i ? 1e9 * seconds[0] : 0,
                                     .as_long = i ? 1.15 : 0,
                                     .under = i ? 0 : 200,
                                     .note = "30 neighbours"});
        skein_world_destroy(worlds[i]);
    }
}

static void run_flock(void) {
    against_plain(bench_quick ? 500 : 16384, 30, true, 3, 40);
    against_plain(bench_quick ? 500 : 16384, 500, false, 0, 0);
    growing();
}

const bench_case bench_flock = {"flock", "birds beside the plain loops; 10,000 to 1,000,000 of them", run_flock};
