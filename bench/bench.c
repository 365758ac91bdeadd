/* skein_bench: speed as ratios within one run. Each case is a row; medians of five.
 *
 *   skein_bench                 all cases
 *   skein_bench force sweep     those whose names begin so
 *   skein_bench --csv           as comma separated values
 */
#include "bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "world/world.h"

static bool csv;

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(void (*body)(void *data), void *data, double seconds) {
    double start = seconds_now();
    body(data);
    double once = seconds_now() - start, blocks[5];
    int calls = once > seconds ? 1 : (int)(seconds / (once > 1e-9 ? once : 1e-9)) + 1;
    for (int b = 0; b < 5; b++) {
        start = seconds_now();
        for (int i = 0; i < calls; i++) body(data);
        blocks[b] = (seconds_now() - start) / calls;
    }
    qsort(blocks, 5, sizeof *blocks, compare_doubles);
    return blocks[2];
}

void bench_report(const bench_result *r) {
    if (csv) {
        printf("%s,%s,%g,%s,%g,%s,%g,%g\n", r->name, r->size, r->ns, r->unit, r->other_ns, r->other ? r->other : "",
               r->stretch, r->other_stretch);
        return;
    }
    printf("%-16s %-14s %9.3f %-14s", r->name, r->size, r->ns, r->unit);
    if (r->other_ns > 0) printf(" %9.3f %-26s %7.2fx", r->other_ns, r->other, r->other_ns / r->ns);
    if (r->stretch >= 0) printf("   stretch %.2f %%", 100 * r->stretch);
    if (r->other_stretch >= 0) printf(" against %.2f %%", 100 * r->other_stretch);
    printf("\n");
    fflush(stdout);
}

/* ---- worlds ---- */

skein_world *bench_cloth(int n, const char *method, int substeps, int threads, bool drag) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    double far = INFINITY;
    skein_body_add(world, "cloth", NULL,
                   SKEIN_SETTINGS(SKEIN_PAIR("grid", n, n), SKEIN_TEXT("pins", "top corners"),
                                  SKEIN_REAL("density", 0.2), SKEIN_REAL("stretch.stiffness", 1e4),
                                  SKEIN_REAL("shear.stiffness", 1e4), SKEIN_REAL("bend.stiffness", 1e4),
                                  SKEIN_REAL("stretch.limit", far), SKEIN_REAL("stretch.tether", far)),
                   NULL);
    skein_force_add(world, "gravity", NULL, NULL);
    if (drag) skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL);
    skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps)));
    return world;
}

static void step_frame(void *world) {
    skein_world_step(world, 1.0 / 60);
}

/* Runs only the plan's rows of one kind, by threads as a step would. */
typedef struct row_runner {
    skein_world *world;
    sk_row_kind kind;
} row_runner;

static void run_rows_of_kind(void *data) {
    row_runner *r = data;
    sk_run run = sk_world_run_context(r->world);
    size_t first = 0, last;
    while (first < r->world->plan.count && r->world->plan.data[first].kind != r->kind) first++;
    for (last = first; last < r->world->plan.count && r->world->plan.data[last].kind == r->kind;) last++;
    sk_run_rows(&run, r->world->tasks, r->world->plan.data + first, last - first);
}

/* Brings X and V into the layout that rows expect, or back. */
static void run_layout_rows(skein_world *world, sk_row_kind kind) {
    row_runner r = {world, kind};
    run_rows_of_kind(&r);
}

static size_t constraint_count(skein_world *world) {
    skein_statistics s;
    skein_world_statistics(world, &s);
    return s.constraints;
}

/* ---- cases ---- */

static void bench_rows(const char *name, const char *method, sk_row_kind kind, void (*plain)(void *), int n) {
    skein_world *world = bench_cloth(n, method, 10, 1, false);
    for (int i = 0; i < 20 && kind == SK_ROW_PROJECT; i++) step_frame(world);
    skein_world_explain(world, 1.0 / 60, NULL, NULL);
    run_layout_rows(world, SK_ROW_PACK);
    row_runner r = {world, kind};
    double ours = bench_median(run_rows_of_kind, &r, 0.05) / (double)constraint_count(world) * 1e9;
    plain_cloth *cloth = plain_cloth_create(n, 1e4, 1.0 / 600);
    double theirs = bench_median(plain, cloth, 0.05) / (double)plain_cloth_springs(cloth) * 1e9;
    bench_result result = {name, "", ours, theirs, "ns/constraint", "plain loop", -1, -1};
    snprintf(result.size, sizeof result.size, "%d x %d", n, n);
    bench_report(&result);
    plain_cloth_destroy(cloth);
    skein_world_destroy(world);
}

static void bench_force(void) {
    for (int n = 64; n <= 256; n *= 2) bench_rows("force", "symplectic_euler", SK_ROW_FORCE, plain_cloth_force, n);
}

static void bench_sweep(void) {
    for (int n = 64; n <= 256; n *= 2) bench_rows("sweep", "xpbd", SK_ROW_PROJECT, plain_cloth_project, n);
}

/* A whole substep against its sweeps, and two threads against one. */
static void bench_substep(void) {
    for (int n = 128; n <= 256; n *= 2) {
        skein_world *world = bench_cloth(n, "xpbd", 10, 1, true), *two = bench_cloth(n, "xpbd", 10, 2, true);
        for (int i = 0; i < 20; i++) step_frame(world), step_frame(two);
        double frame = bench_median(step_frame, world, 0.1), frame_of_two = bench_median(step_frame, two, 0.1);
        run_layout_rows(world, SK_ROW_PACK);
        row_runner r = {world, SK_ROW_PROJECT};
        double sweeps = 10 * bench_median(run_rows_of_kind, &r, 0.05);
        bench_result whole = {"substep", "", frame * 1e3, sweeps * 1e3, "ms/frame", "its sweeps alone", -1, -1};
        bench_result threads = {"two threads", "", frame_of_two * 1e3, frame * 1e3, "ms/frame", "one thread", -1, -1};
        snprintf(whole.size, sizeof whole.size, "%d x %d", n, n);
        snprintf(threads.size, sizeof threads.size, "%d x %d", n, n);
        bench_report(&whole);
        bench_report(&threads);
        skein_world_destroy(world);
        skein_world_destroy(two);
    }
}

/* W1: falls from level, held by two corners. W2: the same cloth, not held, on a ball and a plane. */
static skein_world *frame_world(int n, bool drape) {
    skein_world *world = bench_cloth(n, "xpbd", 10, 1, true);
    if (!drape) return world;
    for (size_t i = 0; i < (size_t)n * (size_t)n; i++) skein_particle_hold(world, i, false);
    skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.8)), NULL);
    skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, -0.45, 0), SKEIN_REAL("radius", 0.35)),
                       NULL);
    return world;
}

static void bench_frames(void) {
    for (int drape = 0; drape < 2; drape++) {
        skein_world *world = frame_world(128, drape);
        double total = 0;
        int frames = 120;
        for (int f = 0; f < frames; f++) {
            double start = seconds_now();
            step_frame(world);
            total += seconds_now() - start;
        }
        skein_statistics s;
        skein_world_statistics(world, &s);
        bench_result result = {drape ? "W2" : "W1", "128 x 128", total / frames * 1e3, 0,
                               "ms/frame",          NULL,        s.p99_stretch,        -1};
        bench_report(&result);
        skein_world_destroy(world);
    }
}

int main(int argc, char **argv) {
    static const struct {
        const char *name;
        void (*run)(void);
    } cases[] = {{"force", bench_force}, {"sweep", bench_sweep}, {"substep", bench_substep}, {"frames", bench_frames}};
    bool any = false;
    for (int a = 1; a < argc; a++) {
        if (!strcmp(argv[a], "--csv")) csv = true;
        else any = true;
    }
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        bool wanted = !any;
        for (int a = 1; a < argc; a++) wanted |= !strncmp(cases[c].name, argv[a], strlen(argv[a]));
        if (wanted) cases[c].run();
    }
    return 0;
}
