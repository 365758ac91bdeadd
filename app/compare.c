/* `skein compare`: its arguments become runs, the runs a table, CSV files and a plot. */
#include "app/compare.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/file.h"
#include "io/own_kinds.h"

/* ---- what is written ---- */

static const char *const outcomes[] = {"good", "blew up", "refused", "failed"};

static void print_table(const compare_run *runs, size_t count, const compare_run *reference) {
    bool rounded = false;
    printf("%-17s %10s %10s %12s %7s %10s %12s %10s %8s\n", "method", "step (ms)", "steps", "error (m)", "order",
           "stretch", "lost (J)", "ms a step", "cost");
    for (size_t r = 0; r < count; r++) {
        const compare_run *run = &runs[r];
        printf("%-17s %10.4g ", run->method, 1e3 * run->step);
        if (run->outcome == COMPARE_GOOD) {
            char order[16] = "-";
            if (run->rounded) snprintf(order, sizeof order, "rounded");
            else if (isfinite(run->order)) snprintf(order, sizeof order, "%.2f", run->order);
            rounded |= run->rounded;
            printf("%10llu %12.3g %7s %9.2f%% %12.4g %10.4g %8.3g\n", (unsigned long long)run->steps, run->error, order,
                   100 * run->stretch, run->loss, compare_ms_per_step(run), compare_cost(run));
        } else if (run->outcome == COMPARE_BLEW_UP)
            printf("%10s at step %llu, after %.4g s\n", outcomes[run->outcome], (unsigned long long)run->steps,
                   (double)run->steps * run->step);
        else printf("%10s\n", outcomes[run->outcome]);
    }
    printf("\nerror: root of the mean square distance to %s with steps of %.4g ms, over all particles and frames;\n"
           "lost: energy at the start less that at the end; cost: seconds of computing for a second of the scene\n",
           reference->method, 1e3 * reference->step);
    printf("order: p of error ~ step^p, from the step before it in the table\n");
    if (rounded)
        printf("rounded: the error is rounding's, which shorter steps do not lessen%s\n",
               sizeof(skein_real) == sizeof(float) ? "; a build with -DSKEIN_DOUBLE=ON goes further" : "");
    if (reference->outcome != COMPARE_GOOD) printf("(but the reference itself %s)\n", outcomes[reference->outcome]);
}

/* A number, or null where there is none. */
static void set_number(json_t *object, const char *name, double value) {
    json_object_set_new(object, name, isfinite(value) ? json_real(value) : json_null());
}

static json_t *describe(const compare_run *run) {
    json_t *json = json_object();
    json_object_set_new(json, "method", json_string(run->method));
    set_number(json, "step", run->step);
    json_object_set_new(json, "outcome", json_string(outcomes[run->outcome]));
    json_object_set_new(json, "steps", json_integer((json_int_t)run->steps));
    bool good = run->outcome == COMPARE_GOOD;
    set_number(json, "error", good ? run->error : NAN);
    set_number(json, "order", good ? run->order : NAN);
    json_object_set_new(json, "rounded", json_boolean(good && run->rounded));
    set_number(json, "largest_stretch", good ? run->stretch : NAN);
    set_number(json, "energy_lost", good ? run->loss : NAN);
    set_number(json, "ms_a_step", compare_ms_per_step(run));
    set_number(json, "cost", compare_cost(run));
    return json;
}

/* The table for programs: metres, seconds, joules. */
static bool print_json(const char *path, const compare_run *runs, size_t count, const compare_run *reference) {
    json_t *root = json_object(), *list = json_array();
    json_object_set_new(root, "scene", json_string(path));
    json_object_set_new(root, "reference", describe(reference));
    for (size_t r = 0; r < count; r++) json_array_append_new(list, describe(&runs[r]));
    json_object_set_new(root, "runs", list);
    bool good = !json_dumpf(root, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    printf("\n");
    json_decref(root);
    return good;
}

static io_output *open_in(const char *folder, const char *name, skein_error *error) {
    char path[1200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return io_output_open(path, error);
}

static bool write_table(const char *folder, const compare_run *runs, size_t count) {
    skein_error error;
    io_output *o = open_in(folder, "compare.csv", &error);
    if (o) {
        io_output_printf(
            o, "method,step (s),outcome,steps,error (m),largest stretch,energy lost (J),time a step (ms),cost,order\n");
        for (size_t r = 0; r < count; r++) {
            const compare_run *run = &runs[r];
            io_output_printf(o, "%s,%.9g,%s,%llu,%.6g,%.6g,%.6g,%.6g,%.6g,%.4g\n", run->method, run->step,
                             outcomes[run->outcome], (unsigned long long)run->steps, run->error, run->stretch,
                             run->loss, compare_ms_per_step(run), compare_cost(run), run->order);
        }
        if (!io_output_commit(o, &error)) return true;
    }
    app_print_error(&error);
    return false;
}

static bool write_series(const char *folder, const compare_run *runs, size_t count) {
    skein_error error;
    io_output *o = open_in(folder, "series.csv", &error);
    if (o) {
        io_output_printf(o, "run,method,step (s),time (s),energy (J),largest stretch,error (m)\n");
        for (size_t r = 0; r < count; r++)
            for (size_t i = 0; i < runs[r].sample_count; i++) {
                const compare_sample *s = &runs[r].samples[i];
                io_output_printf(o, "%zu,%s,%.9g,%.9g,%.9g,%.9g,%.9g\n", r, runs[r].method, runs[r].step, s->time,
                                 s->energy, s->stretch, s->error);
            }
        if (!io_output_commit(o, &error)) return true;
    }
    app_print_error(&error);
    return false;
}

/* ---- arguments ---- */

/* The next part of a list with commas; false at its end. */
static bool next_part(const char **list, char *part, size_t size) {
    while (**list == ',' || **list == ' ') ++*list;
    size_t length = strcspn(*list, ", ");
    if (!length) return false;
    snprintf(part, size, "%.*s", (int)length, *list);
    *list += length;
    return true;
}

/* Every method with every step. Returns their number, 0 after a printed fault. */
static size_t plan_runs(const char *methods, const char *steps, compare_run runs[COMPARE_MOST_RUNS]) {
    size_t count = 0;
    char method[COMPARE_NAME], step[COMPARE_NAME];
    while (next_part(&methods, method, sizeof method)) {
        skein_error error = {SKEIN_OK, "", ""};
        if (!io_kind_find(SKEIN_METHOD, method, &error)) {
            fprintf(stderr, "skein compare: --methods: %s\n", error.message);
            return 0;
        }
        for (const char *rest = steps; next_part(&rest, step, sizeof step);) {
            char *end;
            double seconds = strtod(step, &end);
            if (*end || !(seconds >= 1e-7) || !(seconds <= 10)) {
                fprintf(stderr, "skein compare: --steps: '%s': expected seconds, 1e-7 to 10\n", step);
                return 0;
            }
            if (count == COMPARE_MOST_RUNS) {
                fprintf(stderr, "skein compare: more than %d runs: fewer methods or steps\n", COMPARE_MOST_RUNS);
                return 0;
            }
            compare_run *run = &runs[count++];
            *run = (compare_run){.step = seconds};
            snprintf(run->method, sizeof run->method, "%s", method);
        }
    }
    if (!count) fprintf(stderr, "skein compare: expected names of methods and steps in seconds, with commas between\n");
    return count;
}

/* The reference: rk4, or for what is rigid xpbd. */
static bool make_reference(compare_scene *scene, compare_run *reference, const compare_run *runs, size_t count) {
    static const char *const methods[] = {"rk4", "xpbd"};
    double least = INFINITY;
    for (size_t r = 0; r < count; r++) least = fmin(least, runs[r].step);
    for (size_t m = 0; m < 2; m++) {
        double step = compare_reference_step(scene, methods[m], least);
        if (!(step > 0)) continue;
        *reference = (compare_run){.step = step};
        snprintf(reference->method, sizeof reference->method, "%s", methods[m]);
        if (!scene->quiet) fprintf(stderr, "reference: %s, steps of %.4g ms\n", methods[m], 1e3 * step);
        return compare_run_one(scene, reference, true);
    }
    return false;
}

static int compare_all(compare_scene *scene, compare_run *runs, size_t count, const char *folder) {
    compare_run reference = {.outcome = COMPARE_FAILED};
    bool good = make_reference(scene, &reference, runs, count);
    for (size_t r = 0; r < count && good; r++) {
        if (!scene->quiet) fprintf(stderr, "%s, steps of %.4g ms\n", runs[r].method, 1e3 * runs[r].step);
        good = compare_run_one(scene, &runs[r], false);
    }
    if (good) {
        compare_orders(scene, runs, count);
        if (scene->json) good = print_json(scene->path, runs, count, &reference);
        else if (!scene->quiet) print_table(runs, count, &reference);
    } else fprintf(stderr, "skein compare: there is no reference, or no memory\n");
    if (good && folder) {
        if (mkdir(folder, 0777) && errno != EEXIST) {
            fprintf(stderr, "skein compare: --out %s: cannot be made: %s\n", folder, strerror(errno));
            good = false;
        }
        good = good && write_table(folder, runs, count) && write_series(folder, runs, count) &&
               compare_plot(folder, scene->path, runs, count);
        if (good && !scene->quiet && !scene->json)
            printf("wrote compare.csv, series.csv, compare.gnuplot and what it draws into %s\n", folder);
    }
    free(reference.samples);
    free(scene->reference);
    for (size_t r = 0; r < count; r++) free(runs[r].samples);
    return good ? EXIT_OK : EXIT_FAILURE_RUN;
}

static int compare(app_arguments *arguments) {
    static compare_run runs[COMPARE_MOST_RUNS];
    compare_scene scene = {.path = app_word(arguments),
                           .sets = app_values(arguments, "--set"),
                           .json = app_given(arguments, "--json"),
                           .quiet = app_given(arguments, "--quiet")};
    const char *methods = app_value(arguments, "--methods"), *steps = app_value(arguments, "--steps"),
               *frames = app_value(arguments, "--frames");
    size_t count = plan_runs(methods ? methods : "symplectic_euler,leapfrog,rk4,backward_euler,xpbd",
                             steps ? steps : "1e-3,5e-4,2.5e-4", runs);
    char *end = NULL;
    long wanted = frames ? strtol(frames, &end, 10) : 0;
    if (!count) return EXIT_FAULT;
    if (frames && (*end || wanted < 1 || wanted > 100000)) {
        fprintf(stderr, "skein compare: --frames %s: expected a whole number, 1 to 100000\n", frames);
        return EXIT_FAULT;
    }
    scene.frames = (int)wanted;
    int status = app_try(scene.path, scene.sets);
    return status ? status : compare_all(&scene, runs, count, app_value(arguments, "--out"));
}

static const app_option options[] = {
    APP_SET_OPTION,
    {"--methods", "A,B", "which methods; symplectic_euler,leapfrog,rk4,backward_euler,xpbd if not given", false,
     APP_TAKES_ANY},
    {"--steps", "S,S", "which steps, in seconds (substeps are not used); 1e-3,5e-4,2.5e-4 if not given", false,
     APP_TAKES_ANY},
    {"--frames", "N", "frames to run, instead of the scene's", false, APP_TAKES_ANY},
    {"--out", "FOLDER", "write compare.csv, series.csv, compare.png and compare.svg there", false, APP_TAKES_FOLDER},
    {"--json", NULL, "print the table as JSON; null is what a run that blew up has no number for", false, APP_TAKES_ANY},
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_compare_command = {
    "compare",
    "SCENE [--methods A,B,...] [--steps S,S,...] [--out FOLDER] [options]",
    "run a scene under several methods and steps, and say what each makes of it\n\n"
    "  skein compare scenes/hanging.json --methods leapfrog,rk4,xpbd --steps 2e-4,1e-4 --frames 30 --out out/\n\n"
    "For each run: how far it strays from a reference of much smaller steps, the order at which that falls with the\n"
    "step, its largest stretch, what energy it lost, and its time. A run that blows up is no error: the step at which\n"
    "it did is in the table. With --out, the same as CSV, a line a frame of every run in series.csv, and a plot\n"
    "(gnuplot draws it): energy, stretch and error over time, error and time by step, and error by cost.",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    compare,
    NULL,
};
