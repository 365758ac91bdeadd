/* skein run SCENE: simulate, with progress, files and a report. */
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/outputs.h"
#include "app/report.h"

/* The signal that asked for an early end: the run stops after its frame, and what it has is written. */
static volatile sig_atomic_t interrupted;

static void on_interrupt(int number) {
    interrupted = number;
}

static void catch_interrupts(void) {
    // a second one ends the process at once
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)SA_RESETHAND | SA_RESTART};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* ---- progress ---- */

typedef struct progress {
    bool quiet, terminal;
    bool line_open; /* the cursor stands behind the bar */
    int frames;
    double start, last;
} progress;

static progress start_progress(int frames, bool quiet) {
    return (progress){
        .quiet = quiet || !frames, .terminal = isatty(STDERR_FILENO) != 0, .frames = frames, .start = app_seconds()};
}

/* On a terminal a bar that is drawn again in place, 20 times a second at most; else ten lines a run. */
static void show_progress(progress *p, int frame) {
    double now = app_seconds(), elapsed = now - p->start;
    bool due = p->terminal ? now - p->last >= 0.05 : frame % ((p->frames + 9) / 10) == 0;
    if (p->quiet || (!due && frame != p->frames)) return;
    p->last = now;
    char bar[31];
    for (int i = 0; i < 30; i++) bar[i] = i < (int)(30.0 * frame / p->frames) ? '#' : '.';
    bar[30] = 0;
    fprintf(stderr, "%s[%s] frame %d of %d, %.1f s, %.0f s left%s", p->terminal ? "\r" : "", bar, frame, p->frames,
            elapsed, elapsed / frame * (p->frames - frame), p->terminal ? "   " : "\n");
    p->line_open = p->terminal;
}

static void end_progress(progress *p) {
    if (p->line_open) fprintf(stderr, "\n");
    p->line_open = false;
}

/* ---- the run ---- */

static bool all_finite(const skein_real *xyzw, const skein_view *view) {
    for (size_t i = 0; i < view->count; i++) {
        const skein_real *p = xyzw + 4 * (size_t)view->slot_of[i];
        if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2])) return false;
    }
    return true;
}

static bool is_finite(const skein_world *world) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    return all_finite(x.xyzw, &x) && all_finite(v.xyzw, &v);
}

/* Measures the world as it stands; false after a printed fault. */
static bool measure(app_report *r) {
    skein_world *world = r->loaded->world;
    if (skein_world_statistics(world, &r->statistics)) {
        app_print_error(skein_world_error(world));
        return false;
    }
    if (r->statistics.max_stretch > r->worst_stretch) r->worst_stretch = r->statistics.max_stretch;
    return true;
}

/* Notes the state in the log, if there is one; false after a printed fault. */
static bool note_step(app_report *r) {
    if (!r->log) return true;
    if (!measure(r)) return false;
    app_log_line(r->log, &r->statistics);
    return true;
}

/* Steps one frame; false after a printed fault. */
static bool run_frame(app_report *r, progress *p) {
    skein_world *world = r->loaded->world;
    for (int s = 0; s < r->steps_per_frame; s++) {
        double start = app_seconds();
        skein_status status = skein_world_step(world, r->dt);
        r->seconds += app_seconds() - start;
        if (!status && note_step(r)) continue;
        end_progress(p);
        if (status) app_print_error(skein_world_error(world));
        return false;
    }
    r->frames++;
    if (is_finite(world)) return r->frames % 16 || measure(r);
    // said at once, instead of writing such files to the end
    end_progress(p);
    if (measure(r))
        fprintf(stderr,
                "skein: %s: blew up in frame %d: %zu of %zu particles are no longer finite; "
                "more substeps or less stiffness help\n",
                r->loaded->path, r->frames, r->statistics.nonfinite, r->statistics.particles);
    return false;
}

static bool run_frames(app_report *r, app_outputs *outputs, progress *p) {
    bool good = note_step(r) && (!outputs || app_outputs_frame(outputs, 0));
    while (good && r->frames < p->frames && !interrupted) {
        good = run_frame(r, p) && (!outputs || app_outputs_frame(outputs, r->frames));
        if (good) show_progress(p, r->frames);
    }
    end_progress(p);
    return good && measure(r);
}

static void note_file(void *user, const char *path) {
    app_report *report = user;
    json_array_append_new(report->files, json_string(path));
}

static int simulate(app_report *r, const char *folder, bool quiet) {
    app_outputs *outputs = NULL;
    catch_interrupts();
    int status = folder ? app_outputs_begin(r->loaded, folder, &outputs) : EXIT_OK;
    if (status) return status;
    if (r->log_path && !(r->log = app_log_begin(r->log_path))) {
        app_outputs_abandon(outputs);
        return EXIT_FAULT;
    }
    progress p = start_progress(r->loaded->settings.frames, quiet);
    bool ran = run_frames(r, outputs, &p);
    bool logged = app_log_finish(r->log); // of a run that failed, too: it may say why
    if (!ran) {
        app_outputs_abandon(outputs);
        return EXIT_FAILURE_RUN;
    }
    int signal_number = interrupted; // a later one interrupts nothing that matters
    r->interrupted = signal_number != 0;
    if (r->log && logged) note_file(r, r->log_path);
    bool good = (!outputs || app_outputs_finish(outputs, note_file, r)) && logged;
    if (folder) good = app_report_write(r, folder) && good;
    app_report_print(r);
    return !good ? EXIT_FAILURE_RUN : signal_number ? EXIT_SIGNAL + signal_number : EXIT_OK;
}

/* ---- the arguments ---- */

/* An option that stands for a field of the scene becomes one more --set; `text` holds that. False after a
 * printed fault. */
static bool override_field(app_option *options, size_t option_count, const char *name, app_option *sets,
                           char text[64]) {
    const char *given = app_value(options, option_count, name);
    if (!given) return true;
    const skein_field *field = skein_field_find(io_scene_kind(), name + 2, NULL);
    char *end;
    skein_value value = skein_number(strtod(given, &end));
    skein_error error = {SKEIN_ERROR_VALUE, "", ""};
    if (end == given || *end) value.count = 4; // what no field takes, so that the field says what it does take
    bool good = field && !skein_field_check(field, &value, &error);
    snprintf(text, 64, "%s=%.17g", name + 2, value.number[0]);
    if (!good) fprintf(stderr, "skein run: %s %s: %s\n", name, given, error.message);
    return good && app_option_add(sets, text);
}

static int run(int argc, char **argv) {
    app_option options[] = {
        {"--set", "PATH=VALUE", "change a value of the scene: bodies.0.stretch.stiffness=2e4; may be repeated", true,
         NULL, 0},
        {"--out", "FOLDER", "write the scene's outputs and report.json there (made if missing)", false, NULL, 0},
        {"--frames", "N", "frames to run, instead of the scene's", false, NULL, 0},
        {"--fps", "N", "frames a second of simulated time, instead of the scene's", false, NULL, 0},
        {"--threads", "N", "threads to run on, 1 to 64; the result is the same", false, NULL, 0},
        {"--log", "FILE", "write a line a step there, as CSV: energies, momenta, stretch, contacts", false, NULL, 0},
        {"--quiet", NULL, "no progress", false, NULL, 0},
    };
    enum { COUNT = sizeof options / sizeof *options };
    static const char *const fields[] = {"--frames", "--fps", "--threads"};
    char texts[3][64];
    const char *path;
    int status = app_parse(&app_run_command, argc, argv, options, COUNT, "scene", &path);
    for (int i = 0; i < 3 && status < 0; i++)
        if (!override_field(options, COUNT, fields[i], &options[0], texts[i])) status = EXIT_FAULT;
    if (status < 0) {
        app_scene loaded;
        status = app_load(path, options[0].values, &loaded);
        if (!status) {
            app_report report = {
                .loaded = &loaded, .files = json_array(), .log_path = app_value(options, COUNT, "--log")};
            report.steps_per_frame = io_scene_steps_per_frame(&loaded.settings, &report.dt);
            status =
                simulate(&report, app_value(options, COUNT, "--out"), app_value(options, COUNT, "--quiet") != NULL);
            json_decref(report.files);
        }
        app_unload(&loaded);
    }
    app_options_free(options, COUNT);
    return status;
}

const app_command app_run_command = {
    "run",
    "SCENE [--out FOLDER] [options]",
    "simulate a scene; with --out, write meshes, point caches, a picture and report.json\n\n"
    "  skein run scenes/drape.json --out out/\n"
    "  skein run scenes/flag.json --frames 240 --fps 60 --threads 2 --set bodies.0.stretch.stiffness=2e4\n\n"
    "The outputs are the scene's: by default an OBJ of each body at the end, a PC2 point cache of the whole\n"
    "run (for Blender's Mesh Cache modifier), and a PNG of the last frame. Files appear under their names\n"
    "only when they are complete. Interrupted (Ctrl-C), a run writes what it has.\n\n"
    "Exit status 0: done; 1: the run failed, or a file could not be written; 2: a fault in the scene or the\n"
    "arguments; 130: interrupted.",
    run,
};
