/* skein run SCENE: simulate, with progress, files and a report. */
#include <stdio.h>

#include "app/compile.h"
#include "app/flocks.h"
#include "app/outputs.h"
#include "app/progress.h"
#include "app/report.h"

/* ---- the run ---- */

/* Every sixteenth frame, and the last; more would cost more than steps do. */
static bool note_flocks(app_report *r) {
    if (r->frames % 16 && r->frames != r->loaded->settings.frames && !app_interrupted()) return true;
    if (r->flocks_noted == r->frames + 1) return true;
    r->flocks_noted = r->frames + 1;
    return app_flocks_note(r->flocks, r->loaded->world);
}

/* Measures the world as it stands; false after a printed fault. */
static bool measure(app_report *r) {
    skein_world *world = r->loaded->world;
    if (skein_world_statistics(world, &r->statistics) || !note_flocks(r)) {
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

/* Notes where it runs; a film's context is gone at the end of the run. */
static void note_device(app_report *r) {
    skein_device_info info = skein_world_device(r->loaded->world);
    snprintf(r->device, sizeof r->device, "%s", info.name);
    r->device_bytes = info.bytes;
}

/* Steps one frame; false after a printed fault. */
static bool run_frame(app_report *r, app_progress *p) {
    bool here = skein_world_device(r->loaded->world).device == SKEIN_DEVICE_CPU;
    for (int s = 0; s < r->steps_per_frame; s++) {
        double start = app_seconds();
        if (!app_step_frame(r->loaded, r->frames + 1, 1, r->dt, p)) return false;
        if (s + 1 == r->steps_per_frame) skein_world_wait(r->loaded->world);
        r->seconds += app_seconds() - start;
        if (note_step(r)) continue;
        app_progress_end(p);
        return false;
    }
    r->frames++;
    note_device(r);
    return !here || r->frames % 16 || measure(r); // from a card the state would have to come for it
}

static bool run_frames(app_report *r, app_outputs *outputs, app_progress *p) {
    note_device(r);
    bool good = measure(r) && note_step(r) && (!outputs || app_outputs_frame(outputs, 0));
    while (good && r->frames < p->frames && !app_interrupted()) {
        good = run_frame(r, p) && (!outputs || app_outputs_frame(outputs, r->frames));
        if (good) app_progress_show(p, r->frames);
    }
    app_progress_end(p);
    return good && measure(r);
}

static void note_file(void *user, const char *path) {
    app_report *report = user;
    json_array_append_new(report->files, json_string(path));
}

/* A run that failed keeps the frames before that, if there are any, and says so. */
static void keep_frames(app_report *r, app_outputs *outputs, const char *folder, const app_progress *p) {
    if (!outputs || !r->frames) {
        app_outputs_abandon(outputs);
        return;
    }
    const char *why = p->failure[0] ? p->failure : app_outputs_failure(outputs);
    snprintf(r->failure, sizeof r->failure, "%s", why[0] ? why : "the state could not be measured");
    skein_world_statistics(r->loaded->world, &r->statistics); // as it is, whatever that is
    app_outputs_keep(outputs, note_file, r);
    bool kept = json_array_size(r->files) > 0;
    app_report_write(r, folder);
    if (!kept) return;
    if (p->failure[0])
        fprintf(stderr, "skein: the %d frame%s before that %s kept in %s/*.failed.*\n", r->frames,
                r->frames == 1 ? "" : "s", r->frames == 1 ? "is" : "are", folder);
    else fprintf(stderr, "skein: what was written before that is kept in %s/*.failed.*\n", folder);
}

static int simulate(app_report *r, const char *folder, bool quiet) {
    app_outputs *outputs = NULL;
    app_catch_interrupts();
    int status = folder ? app_outputs_begin(r->loaded, folder, quiet, &outputs) : EXIT_OK;
    if (status) return status;
    if (r->log_path && !(r->log = app_log_begin(r->log_path))) {
        app_outputs_abandon(outputs);
        return EXIT_FAULT;
    }
    app_progress p = app_progress_start("frame", r->loaded->settings.frames, quiet);
    bool ran = run_frames(r, outputs, &p);
    bool logged = app_log_finish(r->log); // of a run that failed, too: it may say why
    if (!ran) {
        keep_frames(r, outputs, folder, &p);
        return EXIT_FAILURE_RUN;
    }
    int signal_number = app_interrupted(); // a later one interrupts nothing that matters
    r->interrupted = signal_number != 0;
    if (r->log && logged) note_file(r, r->log_path);
    bool good = (!outputs || app_outputs_finish(outputs, note_file, r)) && logged;
    if (folder) good = app_report_write(r, folder) && good;
    app_report_print(r);
    return !good ? EXIT_FAILURE_RUN : signal_number ? EXIT_SIGNAL + signal_number : EXIT_OK;
}

/* ---- the arguments ---- */

static int run(app_arguments *arguments) {
    app_override_texts texts;
    app_scene loaded;
    bool quiet = app_given(arguments, "--quiet");
    if (!app_override(arguments, texts)) return EXIT_FAULT;
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status && app_given(arguments, "--compile")) loaded.warnings += app_compile(loaded.world, quiet);
    if (!status) status = app_device(&loaded, app_value(arguments, "--device"));
    if (!status) {
        app_report report = {.loaded = &loaded,
                             .files = json_array(),
                             .flocks = json_array(),
                             .log_path = app_value(arguments, "--log")};
        report.steps_per_frame = io_scene_steps_per_frame(&loaded.settings, &report.dt);
        status = simulate(&report, app_value(arguments, "--out"), quiet);
        json_decref(report.files);
        json_decref(report.flocks);
    }
    app_unload(&loaded);
    return status;
}

static const app_option options[] = {
    APP_SET_OPTION,
    {"--out", "FOLDER", "write the scene's outputs and report.json there (made if missing)", false, APP_TAKES_FOLDER},
    {"--frames", "N", "frames to run, instead of the scene's", false, APP_TAKES_ANY},
    {"--fps", "N", "frames a second of simulated time, instead of the scene's", false, APP_TAKES_ANY},
    APP_THREADS_OPTION,
    APP_DEVICE_OPTION,
    APP_COMPILE_OPTION,
    {"--log", "FILE", "write a line a step there, as CSV: energies, momenta, stretch, contacts", false, APP_TAKES_FILE},
    {"--quiet", NULL, "no progress", false, APP_TAKES_ANY},
    APP_END_OF_OPTIONS};

const app_command app_run_command = {
    "run",
    "SCENE [--out FOLDER] [options]",
    "simulate a scene; with --out, write meshes, point caches, a picture and report.json\n\n"
    "  skein run scenes/drape.json --out out/\n"
    "  skein run scenes/flag.json --frames 240 --fps 60 --threads 2 --set bodies.0.stretch.stiffness=2e4\n\n"
    "The outputs are the scene's: by default an OBJ of each body at the end, a PC2 point cache of the whole\n"
    "run (for Blender's Mesh Cache modifier), and a PNG of the last frame; with \"film\" among them a film, too\n"
    "(or see skein render). All but films appear under their names only when they are complete. Interrupted\n"
    "(Ctrl-C), a run writes what it has.\n\n"
    "On a graphics card (--device gpu) the same plan runs as OpenGL compute shaders, for rules that have one: loose\n"
    "particles under forces, contact and neighbours; not yet cloth, jelly and rope. Numbers agree to rounding.\n\n"
    "Exit status 0: done; 1: the run failed, or a file could not be written; 2: a fault in the scene or the\n"
    "arguments; 130: interrupted.",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    run,
    NULL,
};
