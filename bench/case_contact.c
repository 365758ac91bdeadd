/* Contact: a sheet that falls in a heap, by the worst frame and the mean, and what contact costs where nothing touches. */
#include <stdio.h>
#include <time.h>

#include "bench/worlds.h"

static void report(const char *name, const char *size, double ours, const char *unit, double under) {
    bench_report(&(bench_result){.name = name,
                                 .size = size,
                                 .ours = ours,
                                 .unit = unit,
                                 .under = under,
                                 .note = "a sheet of 1 m on its edge, 10 substeps, 4 mm thick; 10 s"});
}

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static skein_world *sheet(int side, bool touching, double tilt, const char *pins, int threads, double sleep) {
    skein_world *world = bench_world(threads);
    bench_need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    bench_need(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    bench_need(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5)), NULL));
    bench_need(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", pins),
                                             SKEIN_VEC3("position", 0, pins[0] ? 2 : 0.55, 0),
                                             SKEIN_VEC3("rotation", 90 - tilt, 10, 0), SKEIN_REAL("sleep", sleep)),
                              NULL));
    if (touching)
        bench_need(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.004)), NULL));
    return world;
}

static double seconds_of_step(skein_world *world) {
    const double start = seconds_now();
    bench_step(world);
    return seconds_now() - start;
}

static void report_threads(const char *name, const char *size, const double seconds[2]) {
    bench_report(&(bench_result){.name = name,
                                 .size = size,
                                 .ours = 1e3 * seconds[1],
                                 .unit = "ms/frame",
                                 .other = "one thread",
                                 .theirs = 1e3 * seconds[0],
                                 .faster = 1.5,
                                 .note = "frame by frame in turns"});
}

/* One that may fall asleep. */
static void heap_that_sleeps(int side, double tilt, const char *size) {
    const int frames = bench_quick ? 10 : 600, last = bench_quick ? 5 : 60;
    skein_world *world = sheet(side, true, tilt, "", 1, 0.02);
    double sum = 0, rest = 0;
    for (int i = 0; i < frames; i++) {
        const double seconds = seconds_of_step(world);
        sum += seconds / frames;
        if (i >= frames - last) rest += seconds / last;
    }
    report("heap that may sleep, mean", size, 1e3 * sum, "ms/frame", 25);
    report("heap that may sleep, at rest", size, 1e3 * rest, "ms/frame", 16.7);
    skein_world_destroy(world);
}

/* Each frame is timed alone: the worst one is the impact. A second world takes two threads. */
static void heap(int side, double tilt) {
    char size[40];
    snprintf(size, sizeof size, "%d x %d, %g deg", side, side, tilt);
    const int frames = bench_quick ? 10 : 600, last = bench_quick ? 5 : 60; // those at rest
    skein_world *world[2];
    for (int t = 0; t < 2; t++) world[t] = sheet(side, true, tilt, "", 1 + t, 0);
    double sum[2] = {0, 0}, rest[2] = {0, 0}, worst = 0;
    uint64_t crossings = 0;
    for (int i = 0; i < frames; i++) {
        for (int t = 0; t < 2; t++) {
            const double seconds = seconds_of_step(world[t]);
            sum[t] += seconds / frames;
            if (i >= frames - last) rest[t] += seconds / last;
            if (!t && seconds > worst) worst = seconds;
        }
        skein_statistics s;
        bench_need(world[0], skein_world_statistics(world[0], &s));
        crossings += s.crossings;
    }
    if (skein_world_hash(world[0]) != skein_world_hash(world[1]))
        bench_fault("heap, %s: two threads have other bits", size);
    report("heap, crossings", size, (double)crossings, "in all", 1);
    report("heap, mean", size, 1e3 * sum[0], "ms/frame", 25);
    report("heap, worst", size, 1e3 * worst, "ms/frame", 100);
    report("heap, at rest", size, 1e3 * rest[0], "ms/frame", 16.7);
    report_threads("heap, two threads", size, sum);
    report_threads("heap at rest, two threads", size, rest);
    for (int t = 0; t < 2; t++) skein_world_destroy(world[t]);
    heap_that_sleeps(side, tilt, size);
}

/* A sheet that hangs still: pairs are kept, and each substep looks whether they may be. */
static void nothing_touches(int side) {
    char size[40];
    snprintf(size, sizeof size, "%d x %d", side, side);
    skein_world *touching = sheet(side, true, 0, "top edge", 1, 0), *free = sheet(side, false, 0, "top edge", 1, 0);
    for (int i = 0; i < (bench_quick ? 5 : 300); i++) bench_step(touching), bench_step(free);
    bench_job jobs[] = {{.run = bench_step, .data = touching}, {.run = bench_step, .data = free}};
    double seconds[2];
    bench_measure(jobs, 2, 0.2, seconds);
    bench_report(&(bench_result){.name = "nothing touches",
                                 .size = size,
                                 .ours = 1e3 * seconds[0],
                                 .unit = "ms/frame",
                                 .other = "without contact",
                                 .theirs = 1e3 * seconds[1],
                                 .as_long = 1.1,
                                 .note = "hanging still by its top edge"});
    skein_world_destroy(touching);
    skein_world_destroy(free);
}

/* A sheet that is let go level and swings: it touches nothing, and courses do not hold for long. */
static void swings(int side) {
    char size[40];
    snprintf(size, sizeof size, "%d x %d", side, side);
    const int frames = bench_quick ? 5 : 60;
    double seconds[2] = {0, 0};
    for (int touching = 0; touching < 2; touching++) {
        skein_world *world = sheet(side, touching, 90, "top corners", 1, 0);
        double start = seconds_now();
        for (int i = 0; i < frames; i++) bench_step(world);
        seconds[touching] = (seconds_now() - start) / frames;
        skein_world_destroy(world);
    }
    bench_report(&(bench_result){.name = "swings, touches nothing",
                                 .size = size,
                                 .ours = 1e3 * seconds[1],
                                 .unit = "ms/frame",
                                 .other = "without contact",
                                 .theirs = 1e3 * seconds[0],
                                 .as_long = 1.1,
                                 .note = "let go level, by two corners; 1 s"});
}

static void run_contact(void) {
    nothing_touches(bench_quick ? 12 : 100);
    swings(bench_quick ? 12 : 100);
    static const double tilts[] = {1, 3, 7, 12, 20};
    for (int i = 0; i < (bench_quick ? 1 : 5); i++) heap(bench_quick ? 12 : 100, tilts[i]);
}

const bench_case bench_contact = {"contact", "a sheet in a heap, and the cost of contact where nothing touches",
                                  run_contact};
