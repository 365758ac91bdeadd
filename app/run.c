/* skein run SCENE: simulate, with progress, files and a report. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "app/outputs.h"

/* Set by the first interrupt: the run ends after its frame, and what it has is written. */
static volatile sig_atomic_t interrupted;

static void on_interrupt(int number) {
    (void)number;
    interrupted = 1;
    signal(SIGINT, SIG_DFL); // a second one ends the process at once
}

typedef struct run_report {
    const char *scene_path;
    const app_scene *loaded;
    int frames, steps_per_frame;
    double dt, seconds; /* seconds: spent in steps */
    skein_statistics statistics;
    double worst_stretch; /* over the whole run, sampled each frame; the end's is in the statistics */
    json_t *files;
} run_report;

/* ---- progress ---- */

/* On a terminal a bar that is drawn again in place; else a line every tenth of the run. */
static void show_progress(int frame, int frames, double start, bool quiet) {
    if (quiet || !frames) return;
    bool terminal = isatty(STDERR_FILENO);
    if (!terminal && frame % ((frames + 9) / 10) && frame != frames) return;
    double elapsed = app_seconds() - start, left = frame ? elapsed / frame * (frames - frame) : 0;
    char bar[31];
    int filled = (int)(30.0 * frame / frames);
    for (int i = 0; i < 30; i++) bar[i] = i < filled ? '#' : '.';
    bar[30] = 0;
    fprintf(stderr, "%s[%s] frame %d of %d, %.1f s, %.0f s left%s", terminal ? "\r" : "", bar, frame, frames, elapsed, left,
            terminal ? frame == frames ? "   \n" : "   " : "\n");
    fflush(stderr);
}

/* ---- the report ---- */

static void note_file(void *user, const char *path) {
    run_report *report = user;
    json_array_append_new(report->files, json_string(path));
}

/* A number for JSON, which has no NaN and no infinity. */
static json_t *finite_or_null(double x) {
    return isfinite(x) ? json_real(x) : json_null();
}

static double ms_per_step(const run_report *r) {
    return r->statistics.steps ? 1e3 * r->seconds / (double)r->statistics.steps : 0;
}

static double realtime_factor(const run_report *r) {
    return r->seconds > 0 ? r->statistics.time / r->seconds : 0;
}

static bool write_report(const run_report *r, const char *folder) {
    const skein_statistics *s = &r->statistics;
    const skein_world *world = r->loaded->world;
    char path[1024], hash[24];
    snprintf(path, sizeof path, "%s/report.json", folder);
    snprintf(hash, sizeof hash, "%016" PRIx64, s->state_hash);
    json_t *root = json_object();
    json_object_set_new(root, "skein", json_string(SKEIN_VERSION));
    json_object_set_new(root, "scene", json_string(r->scene_path));
    json_object_set_new(root, "method", json_string(skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name));
    json_object_set_new(root, "precision", json_string(sizeof(skein_real) == 8 ? "double" : "float"));
    json_object_set_new(root, "frames", json_integer(r->frames));
    json_object_set_new(root, "fps", json_real(r->loaded->settings.fps));
    json_object_set_new(root, "step", json_real(r->dt));
    json_object_set_new(root, "steps", json_integer((json_int_t)s->steps));
    json_object_set_new(root, "substeps", json_integer((json_int_t)s->substeps));
    json_object_set_new(root, "time", finite_or_null(s->time));
    json_object_set_new(root, "particles", json_integer((json_int_t)s->particles));
    json_object_set_new(root, "held_particles", json_integer((json_int_t)s->held_particles));
    json_object_set_new(root, "constraints", json_integer((json_int_t)s->constraints));
    json_object_set_new(root, "contacts", json_integer((json_int_t)s->contacts));
    json_object_set_new(root, "load_seconds", json_real(r->loaded->load_seconds));
    json_object_set_new(root, "run_seconds", json_real(r->seconds));
    json_object_set_new(root, "ms_per_step", json_real(ms_per_step(r)));
    json_object_set_new(root, "realtime_factor", json_real(realtime_factor(r)));
    json_object_set_new(root, "kinetic_energy", finite_or_null(s->kinetic_energy));
    json_object_set_new(root, "max_stretch", finite_or_null(s->max_stretch));
    json_object_set_new(root, "p99_stretch", finite_or_null(s->p99_stretch));
    json_object_set_new(root, "worst_stretch_of_run", finite_or_null(r->worst_stretch));
    json_object_set_new(root, "max_penetration", finite_or_null(s->max_penetration));
    json_object_set_new(root, "nonfinite_particles", json_integer((json_int_t)s->nonfinite));
    json_object_set_new(root, "memory_bytes", json_integer((json_int_t)s->memory_bytes));
    json_object_set_new(root, "warnings", json_integer((json_int_t)r->loaded->warnings));
    json_object_set_new(root, "interrupted", json_boolean(interrupted));
    json_object_set_new(root, "state_hash", json_string(hash));
    json_object_set(root, "files", r->files);
    char *text = json_dumps(root, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    json_decref(root);
    skein_error error = {SKEIN_ERROR_MEMORY, "", "no memory for the report"};
    io_output *output = text ? io_output_open(path, &error) : NULL;
    skein_status status = SKEIN_ERROR_FILE;
    if (output) {
        io_output_write(output, text, strlen(text));
        io_output_write(output, "\n", 1);
        status = io_output_commit(output, &error);
    }
    free(text);
    if (status) app_print_error(&error);
    return !status;
}

static void print_report(const run_report *r, const char *folder) {
    const skein_statistics *s = &r->statistics;
    printf("%zu particles, %zu constraints; %d frames, %" PRIu64 " steps of %.4g ms%s\n", s->particles, s->constraints, r->frames,
           s->steps, 1e3 * r->dt, interrupted ? " (interrupted)" : "");
    printf("%.3f ms a step, %.2f times real time\n", ms_per_step(r), realtime_factor(r));
    printf("kinetic energy %.3g J, stretch at most %.2f %% (99 %% of edges under %.2f %%), penetration at most %.2g mm\n",
           s->kinetic_energy, 100 * s->max_stretch, 100 * s->p99_stretch, 1e3 * s->max_penetration);
    printf("state hash %016" PRIx64 "\n", s->state_hash);
    size_t index;
    json_t *file;
    json_array_foreach(r->files, index, file) printf("wrote %s\n", json_string_value(file));
    if (folder) printf("wrote %s/report.json\n", folder);
}

/* ---- the run ---- */

/* Steps one frame; false after a printed fault. */
static bool run_frame(run_report *r) {
    skein_world *world = r->loaded->world;
    double start = app_seconds();
    for (int s = 0; s < r->steps_per_frame; s++)
        if (skein_world_step(world, r->dt)) {
            app_print_error(skein_world_error(world));
            return false;
        }
    r->seconds += app_seconds() - start;
    return true;
}

static int simulate(run_report *r, const char *folder, bool quiet) {
    skein_world *world = r->loaded->world;
    app_outputs *outputs = folder ? app_outputs_begin(r->loaded, folder) : NULL;
    if (folder && !outputs) return EXIT_FAULT;
    int frames = r->loaded->settings.frames;
    double start = app_seconds();
    bool good = !outputs || app_outputs_frame(outputs, 0);
    if (good && skein_world_explain(world, r->dt, NULL, NULL)) {
        app_print_error(skein_world_error(world));
        app_outputs_abandon(outputs);
        return EXIT_FAULT;
    }
    signal(SIGINT, on_interrupt);
    for (int frame = 1; good && frame <= frames && !interrupted; frame++) {
        good = run_frame(r) && (!outputs || app_outputs_frame(outputs, frame));
        r->frames = frame;
        show_progress(frame, frames, start, quiet);
        // a run that blew up is said at once, with the frame, instead of being written to the end
        if (good && frame % 16 && frame != frames) continue;
        if (!good || skein_world_statistics(world, &r->statistics)) {
            good = false;
            break;
        }
        if (r->statistics.max_stretch > r->worst_stretch) r->worst_stretch = r->statistics.max_stretch;
        if (r->statistics.nonfinite) {
            fprintf(stderr, "\nskein: %s: blew up by frame %d: %zu particles are no longer finite; more substeps or a softer material help\n",
                    r->scene_path, frame, r->statistics.nonfinite);
            good = false;
        }
    }
    if (good) good = !skein_world_statistics(world, &r->statistics);
    if (!good) {
        app_outputs_abandon(outputs);
        return EXIT_FAILURE_RUN;
    }
    if (outputs) good = app_outputs_finish(outputs, note_file, r) && write_report(r, folder);
    print_report(r, folder);
    return good ? EXIT_OK : EXIT_FAILURE_RUN;
}

static int run(int argc, char **argv) {
    app_option options[] = {
        {"--out", "FOLDER", "write the scene's outputs and report.json there (made if missing)", false, NULL, 0},
        {"--frames", "N", "frames to run, instead of the scene's", false, NULL, 0},
        {"--fps", "N", "frames a second of simulated time", false, NULL, 0},
        {"--threads", "N", "threads to run on, 1 to 64; the result is the same", false, NULL, 0},
        {"--set", "PATH=VALUE", "change a value of the scene: bodies.0.stretch.stiffness=2e4; may be repeated", true, NULL, 0},
        {"--quiet", NULL, "no progress", false, NULL, 0},
    };
    enum { COUNT = sizeof options / sizeof *options };
    const char *words[1];
    size_t word_count;
    int status = app_parse(&app_run_command, argc, argv, options, COUNT, words, 1, &word_count);
    if (status < 0 && !word_count) {
        fprintf(stderr, "skein run: which scene? usage: skein run %s\n", app_run_command.usage);
        status = EXIT_FAULT;
    }
    double frames = -1, fps = 0, threads = 0;
    const char *text;
    if (status < 0 && (text = app_value(options, COUNT, "--frames")) && !app_number("--frames", text, 0, 1e8, &frames)) status = EXIT_FAULT;
    if (status < 0 && (text = app_value(options, COUNT, "--fps")) && !app_number("--fps", text, 1e-3, 1e6, &fps)) status = EXIT_FAULT;
    if (status < 0 && (text = app_value(options, COUNT, "--threads")) && !app_number("--threads", text, 1, 64, &threads)) status = EXIT_FAULT;
    if (status < 0) {
        app_scene loaded;
        status = app_load(words[0], options[4].values, (int)threads, &loaded);
        if (!status) {
            if (frames >= 0) loaded.settings.frames = (int)frames;
            if (fps > 0) loaded.settings.fps = fps;
            run_report report = {.scene_path = words[0], .loaded = &loaded, .files = json_array()};
            report.steps_per_frame = io_scene_steps_per_frame(&loaded.settings, &report.dt);
            status = simulate(&report, app_value(options, COUNT, "--out"), app_value(options, COUNT, "--quiet") != NULL);
            json_decref(report.files);
        }
        app_unload(&loaded);
    }
    app_options_free(options, COUNT);
    return status;
}

const app_command app_run_command = {
    "run", "SCENE [--out FOLDER] [options]",
    "simulate a scene; with --out, write meshes, point caches, a picture and report.json\n\n"
    "  skein run scenes/drape.json --out out/\n"
    "  skein run scenes/flag.json --frames 240 --fps 60 --threads 2 --set bodies.0.stretch.stiffness=2e4\n\n"
    "The outputs are the scene's: by default an OBJ of each body at the end, a PC2 point cache of the whole\n"
    "run (for Blender's Mesh Cache modifier), and a PNG of the last frame. Files appear under their names\n"
    "only when they are complete. Exit status 2: a fault in the scene or the arguments; 1: the run failed.",
    run,
};
