/* What a user gets who says nothing but how many particles: a swing of the default cloth, its time and its stretch. */
#include <stdio.h>

#include "bench/worlds.h"

static void report(double ours, const char *unit, double under) {
    bench_report(&(bench_result){.name = "default cloth",
                                 .size = bench_quick ? "16 x 16" : "128 x 128",
                                 .ours = ours,
                                 .unit = unit,
                                 .under = under,
                                 .note = "let go from level, two corners held, 10 substeps, drag 1; 5 s"});
}

/* The stretch is that of the worst of all frames; the time is that of the last ones. */
static void run_default(void) {
    int side = bench_quick ? 16 : 128, frames = bench_quick ? 20 : 300;
    skein_world *world = bench_world(1);
    bench_need(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", "top corners")), NULL));
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
    report(1e3 * seconds, "ms/frame", 1.3);
    report(100 * p99, "% p99, worst", 1);
    report(100 * most, "% most, worst", 3);
    skein_world_destroy(world);
}

const bench_case bench_default = {"default", "the default cloth: time a frame, and stretch while it swings", run_default};
