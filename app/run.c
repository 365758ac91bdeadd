/* skein run SCENE: simulate, with progress, files and a report. */
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

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
    if (r->frames == 0 && !r->statistics.steps) r->verdict = app_verdict_begin(r->loaded, &r->statistics);
    app_verdict_note(&r->verdict, &r->statistics);
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
    char parent[APP_FOLDER_SIZE];
    const char *place = app_outputs_file(folder, parent) ? parent : folder;
    if (!r->is_file) app_report_write(r, folder);
    if (!kept) return;
    if (p->failure[0])
        fprintf(stderr, "skein: the %d frame%s before that %s kept in %s/*.failed.*\n", r->frames,
                r->frames == 1 ? "" : "s", r->frames == 1 ? "is" : "are", place);
    else fprintf(stderr, "skein: what was written before that is kept in %s/*.failed.*\n", place);
}

/* Whether the log would get the name of a file that goes into the folder, too: the later one would replace it. */
static bool log_is_in_the_way(const app_report *r, const char *folder) {
    const char *slash = strrchr(r->log_path, '/'), *name = slash ? slash + 1 : r->log_path;
    char beside[IO_PLACE_SIZE];
    struct stat there, here;
    snprintf(beside, sizeof beside, "%.*s", slash ? (int)(slash - r->log_path) + 1 : 1, slash ? r->log_path : ".");
    if (stat(beside, &there) || stat(folder, &here) || there.st_ino != here.st_ino || there.st_dev != here.st_dev)
        return false;
    size_t stem = strcspn(name, ".");
    bool taken = !strcmp(name, "report.json");
    for (size_t i = 0; i < skein_object_count(r->loaded->world, SKEIN_BODY); i++) {
        skein_handle body = skein_object_at(r->loaded->world, SKEIN_BODY, i);
        skein_value value = {0, {0, 0, 0}, ""};
        skein_get(r->loaded->world, body, "name", &value);
        const char *own = value.text[0] ? value.text : skein_object_kind(r->loaded->world, body)->name;
        taken |= strlen(own) == stem && !strncmp(own, name, stem);
    }
    if (taken)
        fprintf(stderr, "skein run: --log %s: the run itself writes a file of that name into --out %s\n", r->log_path,
                folder);
    return taken;
}

/* What the run says at its end, and its exit status. */
static int conclude(app_report *r, const char *folder, bool good) {
    int signal_number = app_interrupted(); // a later one interrupts nothing that matters
    r->interrupted = signal_number != 0;
    good = app_verdict_end(&r->verdict, &r->statistics) && good;
    if (folder && !r->is_file) good = app_report_write(r, folder) && good;
    if (r->json) good = app_report_print_json(r) && good;
    else if (!r->quiet) app_report_print(r);
    return !good ? EXIT_FAILURE_RUN : signal_number ? EXIT_SIGNAL + signal_number : EXIT_OK;
}

static int simulate(app_report *r, const char *folder) {
    app_outputs *outputs = NULL;
    app_catch_interrupts();
    int status = folder ? app_outputs_begin(r->loaded, folder, r->calm, &outputs) : EXIT_OK;
    if (status) return status;
    char parent[APP_FOLDER_SIZE];
    const char *inside = folder && app_outputs_file(folder, parent) ? parent : folder;
    if (r->log_path && ((folder && log_is_in_the_way(r, inside)) || !(r->log = app_log_begin(r->log_path)))) {
        app_outputs_abandon(outputs);
        return EXIT_FAULT;
    }
    app_progress p = app_progress_start("frame", r->loaded->settings.frames, r->calm);
    bool ran = run_frames(r, outputs, &p);
    bool logged = app_log_finish(r->log); // of a run that failed, too: it may say why
    if (!ran) {
        keep_frames(r, outputs, folder, &p);
        return EXIT_FAILURE_RUN;
    }
    if (r->log && logged) note_file(r, r->log_path);
    bool good = (!outputs || app_outputs_finish(outputs, note_file, r)) && logged;
    return conclude(r, folder, good);
}

/* ---- the arguments ---- */

/* One file: as if the scene named that output alone, before what --set says of it. */
static bool want_file(app_arguments *arguments, const char *format, char text[64]) {
    if (!format) return true;
    snprintf(text, 64, "output=[{\"type\":\"%s\"}]", format);
    return app_set_first(arguments, text);
}

/* --up and --scale, for all outputs that know them; false after a printed fault. */
static bool set_outputs(const app_arguments *arguments, io_scene *scene) {
    static const char *const names[] = {"--up", "--scale"};
    for (size_t i = 0; i < 2; i++) {
        const char *given = app_value(arguments, names[i]);
        if (!given) continue;
        char *end;
        skein_value value = i ? skein_number(strtod(given, &end)) : (skein_value){0, {0, 0, 0}, given};
        if (i && (end == given || *end)) value.count = 4; // what no field takes: the field says what it does take
        skein_error error = {SKEIN_OK, "", ""};
        size_t count;
        if (io_scene_exports_set(scene, names[i] + 2, &value, &count, &error))
            fprintf(stderr, "skein run: %s %s: %s\n", names[i], given, error.message);
        else if (!count)
            fprintf(stderr, "skein run: %s %s: none of the scene's outputs has it (a glTF file is y up, always)\n",
                    names[i], given);
        else continue;
        return false;
    }
    return true;
}

static int run(app_arguments *arguments) {
    app_override_texts texts;
    bool quiet = app_given(arguments, "--quiet"), calm = quiet || app_given(arguments, "--no-progress");
    const char *folder = app_value(arguments, "--out");
    app_scene loaded = {.quiet = quiet};
    if (!app_override(arguments, texts)) return EXIT_FAULT;
    if (folder && !strcmp(folder, "-")) {
        fprintf(stderr, "skein run: --out -: a run writes many files into a folder; --json prints its report\n");
        return EXIT_FAULT;
    }
    char parent[APP_FOLDER_SIZE], output[64];
    const char *format = folder ? app_outputs_file(folder, parent) : NULL;
    if (!want_file(arguments, format, output)) return EXIT_FAULT;
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status && app_given(arguments, "--compile")) loaded.warnings += app_compile(loaded.world, calm);
    if (!status) status = app_device(&loaded, app_value(arguments, "--device"));
    if (!status && !set_outputs(arguments, loaded.scene)) status = EXIT_FAULT;
    if (!status) {
        app_advise(&loaded);
        app_report report = {.loaded = &loaded,
                             .arguments = arguments,
                             .quiet = quiet,
                             .calm = calm,
                             .json = app_given(arguments, "--json"),
                             .files = json_array(),
                             .flocks = json_array(),
                             .is_file = format != NULL,
                             .log_path = app_value(arguments, "--log")};
        report.steps_per_frame = io_scene_steps_per_frame(&loaded.settings, &report.dt);
        status = simulate(&report, folder);
        json_decref(report.files);
        json_decref(report.flocks);
    }
    app_unload(&loaded);
    return status;
}

static const app_option options[] = {
    APP_SET_OPTION,
    {"--out", "FOLDER", "write the scene's outputs and report.json there (made if missing); or one FILE", false,
     APP_TAKES_FILE},
    {"--frames", "N", "frames to run, instead of the scene's", false, APP_TAKES_ANY},
    {"--fps", "N", "frames a second of simulated time, instead of the scene's", false, APP_TAKES_ANY},
    {"--up", "y|z", "the axis that points up in all meshes and caches that are written; y if not given", false,
     APP_TAKES_ANY},
    {"--scale", "S", "length of a metre in them: 100 for centimetres; 1 if not given", false, APP_TAKES_ANY},
    APP_THREADS_OPTION,
    APP_DEVICE_OPTION,
    APP_COMPILE_OPTION,
    {"--log", "FILE", "write a line a step there, as CSV: energies, momenta, stretch, contacts", false, APP_TAKES_FILE},
    {"--json", NULL, "print the report as JSON instead of a summary", false, APP_TAKES_ANY},
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_run_command = {
    "run",
    "SCENE [--out FOLDER] [options]",
    "simulate a scene; with --out, write meshes, point caches, a picture and report.json\n\n"
    "  skein run scenes/drape.json --out out/\n"
    "  skein run scenes/flag.json --frames 240 --fps 60 --threads 2 --set bodies.0.stretch.stiffness=2e4\n"
    "  skein run scenes/flag.json --out flag.mdd --fps 24 --up z --scale 100\n\n"
    "The outputs are the scene's: by default an OBJ of each body at the end, a PC2 point cache of the whole\n"
    "run (for Blender's Mesh Cache modifier), and a PNG of the last frame; with \"film\" among them a film, too\n"
    "(or see skein render). `skein list exporters` has all formats and their options. A file behind --out is that\n"
    "format alone, by its ending, without a report: as with --set 'output=[{\"type\": \"mdd\"}]'. All but films\n"
    "appear under their names only when they are complete. Interrupted (Ctrl-C), a run writes what it has.\n\n"
    "On a graphics card (--device gpu) the same plan runs as OpenGL compute shaders, for rules that have one: loose\n"
    "particles under forces, contact and neighbours; not yet cloth, jelly and rope. Numbers agree to rounding.\n\n"
    "Exit status 0: done; 1: the run failed, or ended far beyond its bounds (an edge longer than the scene's\n"
    "most_stretch allows, energy that came from nowhere), or a file could not be written; 2: a fault in the scene\n"
    "or the arguments; 130: interrupted.",
    options,
    "scene",
    false,
    APP_TAKES_SCENE,
    run,
    NULL,
};
