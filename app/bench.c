/* skein bench flock: how many birds a second, over sizes and densities. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/progress.h"

/* Birds fly by dt until they are measured; then by so little that they stay as near as they are, however many steps that
 * takes: else a fast card measures a flock that has gathered meanwhile. */
static const double dt = 1.0 / 60, measured_dt = 1e-6, reach = 6;

/* What a row of the table is about. */
typedef struct bench_case {
    size_t birds;
    double wanted; /* neighbours, as they are strewn */
    int after;     /* steps before it is measured */
} bench_case;

typedef struct bench_setup {
    const char *device;
    int threads, least_steps;
    double wake_seconds, seconds; /* not measured, and measured, at least */
} bench_setup;

static bool failed(const skein_world *world, skein_status status) {
    if (status) app_print_error(skein_world_error(world));
    return status != SKEIN_OK;
}

/* Birds strewn evenly in a cube, and a scout far off. Where `on` is "scout", the birds are sorted into cells as ever,
 * but only the scout looks at them: what that takes is what sorting takes. */
static bool fill(skein_world *world, const bench_case *c, const char *on) {
    double side = cbrt((double)c->birds * 4.18879 * reach * reach * reach / c->wanted);
    const skein_setting *birds = SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", (double)c->birds),
                                                SKEIN_VEC3("spread", side, side, side), SKEIN_REAL("speed", 5));
    const skein_setting *scout = SKEIN_SETTINGS(SKEIN_TEXT("name", "scout"), SKEIN_REAL("count", 1));
    const skein_setting *flocking = SKEIN_SETTINGS(
        SKEIN_REAL("separation", reach * 0.45), SKEIN_REAL("alignment", reach * 0.2),
        SKEIN_REAL("cohesion", reach * 0.35), SKEIN_TEXT("on", on), SKEIN_TEXT("neighbours", on[0] ? "birds" : ""));
    return !failed(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1)))) &&
           !failed(world, skein_body_add(world, "flock", NULL, birds, NULL)) &&
           (!on[0] || !failed(world, skein_body_add(world, "flock", NULL, scout, NULL))) &&
           !failed(world, skein_force_add(world, "flocking", flocking, NULL)) &&
           !failed(world, skein_force_add(world, "attraction", NULL, NULL)) &&
           !failed(world, skein_force_add(world, "speed_limit", NULL, NULL));
}

/* Seconds a step, as the mean over as many as fill so much time; negative after a printed fault. */
static double step_for(skein_world *world, int least_steps, double least_seconds) {
    double start = app_seconds(), seconds = 0;
    int steps = 0;
    for (; (steps < least_steps || seconds < least_seconds) && !app_interrupted(); seconds = app_seconds() - start) {
        if (failed(world, skein_world_step(world, measured_dt))) return -1;
        steps++;
        if (steps % 8 == 0 || steps >= least_steps) skein_world_wait(world);
    }
    skein_world_wait(world);
    return steps ? (app_seconds() - start) / steps : -1;
}

/* The same once the machine is awake: in the first step shaders and buffers are made, and a card that had nothing to do
 * while birds were strewn runs at a sixth of its clock for some tenths of a second (an H200). */
static double time_steps(skein_world *world, const bench_setup *setup) {
    if (step_for(world, 1, setup->wake_seconds) < 0) return -1;
    return step_for(world, setup->least_steps, setup->seconds);
}

/* Neighbours of a bird in the mean: counted for some of them. */
static double count_neighbours(const double *x, size_t birds) {
    size_t samples = birds < 1000 ? birds : (size_t)(2e8 / (double)birds) + 32, counted = 0, neighbours = 0;
    if (samples > birds) samples = birds;
    for (size_t s = 0; s < samples; s++, counted++) {
        const double *p = x + 3 * (s * (birds / samples));
        for (size_t i = 0; i < birds; i++) {
            double dx = x[3 * i] - p[0], dy = x[3 * i + 1] - p[1], dz = x[3 * i + 2] - p[2];
            neighbours += dx * dx + dy * dy + dz * dz < reach * reach;
        }
    }
    return (double)neighbours / (double)counted - 1;
}

static skein_world *make_world(const bench_setup *setup, const bench_case *c, const char *on) {
    skein_world_desc desc = skein_default_world_desc();
    skein_error error;
    desc.thread_count = setup->threads;
    skein_world *world = skein_world_create(&desc, &error);
    if (!world) app_print_error(&error);
    bool gpu = !strcmp(setup->device, "gpu");
    if (world && fill(world, c, on) && !(gpu && failed(world, skein_world_device_set(world, SKEIN_DEVICE_GPU))))
        return world;
    skein_world_destroy(world);
    return NULL;
}

/* Steps that are not measured. */
static bool run_up(skein_world *world, int steps) {
    for (int i = 0; i < steps && !app_interrupted(); i++)
        if (failed(world, skein_world_step(world, dt))) return false;
    return true;
}

/* What a step takes, with the birds at x, without anybody looking at neighbours: sorting, and then less than that. */
static double time_without(const bench_setup *setup, const bench_case *c, bool sorting, const double *x) {
    skein_world *world = make_world(setup, c, "scout");
    double seconds = -1;
    if (world && (sorting || !failed(world, skein_set_path(world, "forces.0.enabled", skein_number(0)))) &&
        !failed(world, skein_positions_set(world, 0, c->birds, x)))
        seconds = time_steps(world, setup);
    skein_world_destroy(world);
    return seconds;
}

/* One row of the table; false after a printed fault. */
static bool measure(const bench_setup *setup, const bench_case *c) {
    skein_world *world = make_world(setup, c, "");
    bool good = world && run_up(world, c->after);
    double seconds = good ? time_steps(world, setup) : -1;
    double bytes = seconds > 0 ? (double)skein_world_device(world).bytes : 0;
    double *x = seconds > 0 ? malloc(c->birds * 3 * sizeof *x) : NULL;
    if (seconds > 0 && !x) fprintf(stderr, "skein bench: there is no memory to count neighbours\n");
    good = x && !failed(world, skein_positions_copy(world, 0, c->birds, x));
    skein_world_destroy(world);
    double neighbours = good ? count_neighbours(x, c->birds) : -1;
    double sorted = good ? time_without(setup, c, true, x) : -1;
    double bare = sorted > 0 ? time_without(setup, c, false, x) : -1;
    free(x);
    if (!(bare > 0)) return false;
    double share = fmax(sorted - bare, 0) / seconds, birds = (double)c->birds;
    printf("%10zu %6d %10.1f %10.3f %10.2f %10.3f %7.0f %%", c->birds, c->after, neighbours, 1e3 * seconds,
           1e-6 * birds / seconds, 1e9 * seconds / (birds * fmax(neighbours, 1)), 100 * fmin(share, 1));
    if (bytes > 0) printf(" %10.0f", bytes / birds);
    putchar('\n');
    fflush(stdout);
    return true;
}

static bool number_of(const app_arguments *arguments, const char *name, double least, double most, double *out) {
    const char *given = app_value(arguments, name);
    char *end;
    if (!given) return true;
    *out = strtod(given, &end);
    if (end != given && !*end && *out >= least && *out <= most) return true;
    fprintf(stderr, "skein bench: %s %s: expected a number from %g to %g\n", name, given, least, most);
    return false;
}

/* The table: sizes grow fourfold, at three densities, and then as the flock has gathered. */
static int print_table(const bench_setup *setup, double least, double most, int after) {
    static const double densities[] = {7, 30, 120};
    bool gpu = !strcmp(setup->device, "gpu");
    printf("%10s %6s %10s %10s %10s %10s %9s%s\n", "birds", "after", "neighbours", "ms a step", "million/s",
           "ns a pair", "sorting", gpu ? "  B a bird" : "");
    app_catch_interrupts();
    for (double birds = least; birds <= most; birds *= 4) {
        for (size_t d = 0; d < sizeof densities / sizeof *densities && !app_interrupted(); d++)
            if (!measure(setup, &(bench_case){(size_t)birds, densities[d], 0})) return EXIT_FAILURE_RUN;
        if (after && !app_interrupted() && !measure(setup, &(bench_case){(size_t)birds, densities[1], after}))
            return EXIT_FAILURE_RUN;
    }
    return app_interrupted() ? EXIT_SIGNAL + app_interrupted() : EXIT_OK;
}

static int bench(app_arguments *arguments) {
    const char *what = app_word(arguments), *device = app_value(arguments, "--device");
    double threads = 1, least = 1024, most = 65536, after = 0;
    bench_setup setup = {.device = device ? device : "cpu", .least_steps = 3, .seconds = 0.3};
    if (strcmp(what, "flock")) {
        fprintf(stderr, "skein bench: there is no benchmark '%s': there is flock\n", what);
        return EXIT_FAULT;
    }
    if (!number_of(arguments, "--threads", 1, 64, &threads) || !number_of(arguments, "--least", 1, 1e8, &least) ||
        !number_of(arguments, "--most", 1, 1e8, &most) || !number_of(arguments, "--after", 0, 1e6, &after) ||
        !number_of(arguments, "--seconds", 0, 1e4, &setup.seconds))
        return EXIT_FAULT;
    if (least > most) {
        fprintf(stderr, "skein bench: --least %.0f --most %.0f: the first size is more than the last\n", least, most);
        return EXIT_FAULT;
    }
    setup.threads = (int)threads;
    if (!strcmp(setup.device, "gpu")) setup.wake_seconds = 1;
    return print_table(&setup, least, most, (int)after);
}

static const app_option options[] = {
    {"--device", "cpu|gpu", "where it is measured; cpu if not given", false, APP_TAKES_ANY},
    {"--threads", "N", "threads on the processor, 1 to 64", false, APP_TAKES_ANY},
    {"--least", "N", "birds of the first size; 1,024 if not given", false, APP_TAKES_ANY},
    {"--most", "N", "birds of the last size; 65,536 if not given", false, APP_TAKES_ANY},
    {"--after", "STEPS", "measure each size once more after so many steps, when the flock has gathered", false,
     APP_TAKES_ANY},
    {"--seconds", "S", "time for each number, at least; 0.3 if not given", false, APP_TAKES_ANY},
    APP_END_OF_OPTIONS};

const app_command app_bench_command = {
    "bench",
    "flock [--device gpu] [options]",
    "measure how fast a flock flies, over sizes and densities\n\n"
    "Birds are strewn evenly, so densely that each has about 7, 30 or 120 neighbours in reach, and fly under flocking,\n"
    "attraction and a speed limit. Neighbours are counted; \"ns a pair\" is the time of a step over all pairs of a bird\n"
    "and a neighbour, and \"sorting\" the share of putting birds into cells. Flocks gather while they fly: --after says\n"
    "what they cost then.\n\n"
    "  skein bench flock --threads 2 --after 1000\n"
    "  skein bench flock --device gpu --least 1048576 --most 33554432",
    options,
    "benchmark",
    false,
    APP_TAKES_ANY,
    bench,
    NULL,
};
