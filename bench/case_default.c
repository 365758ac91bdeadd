/* What a user gets who says nothing but how many particles: a swing of the default cloth, its time and its stretch, as a
 * grid and as a mesh that is none. */
#include <stdio.h>

#include "bench/worlds.h"

typedef struct bars {
    double time, p99, most; /* ms a frame, %, % */
} bars;

static void report(const char *name, const char *size, double ours, const char *unit, double under) {
    bench_report(&(bench_result){.name = name,
                                 .size = size,
                                 .ours = ours,
                                 .unit = unit,
                                 .under = under,
                                 .note = "let go from level, two corners held, 10 substeps, drag 1; 5 s"});
}

/* The stretch is that of the worst of all frames; the time is that of the last ones. */
static void swing(const char *name, const char *size, const skein_mesh *mesh, const skein_setting *settings,
                  bars under) {
    int frames = bench_quick ? 20 : 300;
    skein_world *world = bench_world(1);
    bench_need(world, skein_body_add(world, "cloth", mesh, settings, NULL));
    bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    bench_need(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
    bench_need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    double p99 = 0, most = 0, seconds;
    for (int i = 0; i < frames; i++) {
        bench_step(world);
        bench_stretch now = bench_stretch_now(world);
        if (now.p99 > p99) p99 = now.p99;
        if (now.most > most) most = now.most;
    }
    bench_job job = {.run = bench_step, .data = world};
    bench_measure(&job, 1, 0.2, &seconds);
    report(name, size, 1e3 * seconds, "ms/frame", under.time);
    report(name, size, 100 * p99, "% p99, worst", under.p99);
    report(name, size, 100 * most, "% most, worst", under.most);
    skein_world_destroy(world);
}

static void run_default(void) {
    int side = bench_quick ? 16 : 128;
    swing("default cloth", bench_quick ? "16 x 16" : "128 x 128", NULL,
          SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", "top corners")), (bars){1.3, 1, 3});
    bench_mesh mesh = bench_mesh_irregular((size_t)(side * side), true);
    swing("default mesh", bench_quick ? "256" : "16,384", &mesh.mesh, SKEIN_SETTINGS(SKEIN_TEXT("pins", mesh.pins)),
          (bars){0, 0, 26});
    bench_mesh_release(&mesh);
}

const bench_case bench_default = {"default", "the default cloth: time a frame, and stretch while it swings",
                                  run_default};
