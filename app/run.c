/* skein run SCENE: simulate, with progress, files and a report. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "app/blow_up.h"
#include "app/compile.h"
#include "app/flocks.h"
#include "app/keep.h"
#include "app/outputs.h"
#include "app/progress.h"
#include "app/ranks.h"
#include "app/report.h"

/* ---- the run ---- */

/* Every sixteenth frame, and the last; more would cost more than steps do. */
static bool note_flocks(app_report *r) {
    if (r->frames % 16 && r->frames != r->loaded->settings.frames && !app_interrupted()) return true;
    if (r->flocks_noted == r->frames + 1) return true;
    r->flocks_noted = r->frames + 1;
    return app_flocks_note(r->flocks, r->loaded->world);
}

/* Crossings of the state that was measured, and its frame, which counts once. */
static void note_crossings(app_report *r) {
    uint64_t steps = (uint64_t)r->steps_per_frame, frame = (r->statistics.steps + steps - 1) / steps + 1;
    if (!r->statistics.crossings) return;
    if (r->statistics.crossings > r->worst_crossings) r->worst_crossings = r->statistics.crossings;
    if (r->crossed_noted != frame) r->crossed_frames++;
    r->crossed_noted = frame;
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
    if (r->statistics.most_over_limit > r->worst_over_limit) r->worst_over_limit = r->statistics.most_over_limit;
    note_crossings(r);
    return true;
}

/* Whether there is contact, whose promise is one for every frame. */
static bool has_contact(skein_world *world) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++)
        if (!strcmp(skein_object_kind(world, skein_object_at(world, SKEIN_FORCE, i))->name, "contact")) return true;
    return false;
}

/* Notes the state in the log, if there is one; false after a printed fault. */
static bool note_step(app_report *r) {
    if (!r->log) return true;
    if (!measure(r)) return false;
    app_log_line(r->log, &r->statistics);
    return !r->keep || app_keep_line(r->keep, app_log_last(r->log));
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
    if (r->parts && !app_shared_record(r->shared, r->parts, r->frames, skein_world_time(r->loaded->world)))
        return false;
    // from a card the state would have to come for it
    return r->counts_crossings ? measure(r) : !here || r->frames % 16 || measure(r);
}

/* The first frame, or all those before the snapshot that the run goes on from. */
static bool begin_frames(app_report *r, app_outputs *outputs, const app_kept *kept) {
    note_device(r);
    if (kept && !app_kept_go_on(kept, r, outputs, &r->keep)) return false;
    if (r->frames) return true;
    return measure(r) && note_step(r) && (!outputs || app_outputs_frame(outputs, 0)) &&
           app_keep_frame(r->keep, r, false);
}

static bool run_frames(app_report *r, app_outputs *outputs, app_progress *p, const app_kept *kept) {
    bool good = begin_frames(r, outputs, kept);
    int begun = r->frames;
    if (good && r->good) app_good_note(r->good, r);
    while (good && r->frames < p->frames && !app_interrupted()) {
        good =
            run_frame(r, p) && (!outputs || app_outputs_frame(outputs, r->frames)) && app_keep_frame(r->keep, r, false);
        if (good && r->good) app_good_note(r->good, r);
        if (good) app_progress_show(p, r->frames);
    }
    app_progress_end(p);
    if (good && r->keep && r->frames > begun) good = app_keep_frame(r->keep, r, true);
    return good && measure(r);
}

static void note_file(void *user, const char *path) {
    app_report *report = user;
    json_array_append_new(report->files, json_string(path));
}

/* A run that failed keeps the frames before that, if there are any, and says so. */
static void keep_frames(app_report *r, app_outputs *outputs, const char *folder, const app_progress *p) {
    if (!outputs || (!r->frames && !p->failure[0])) {
        app_outputs_abandon(outputs);
        return;
    }
    const char *why = p->failure[0]                  ? p->failure
                      : app_keep_failure(r->keep)[0] ? app_keep_failure(r->keep)
                                                     : app_outputs_failure(outputs);
    snprintf(r->failure, sizeof r->failure, "%s", why[0] ? why : "the state could not be measured");
    skein_world_statistics(r->loaded->world, &r->statistics); // as it is, whatever that is
    if (r->frames) app_outputs_keep(outputs, note_file, r);
    else app_outputs_leave(outputs); // there is no frame, but a report
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
    if (r->shared) app_shared_measure(r->shared);
    good = app_verdict_end(&r->verdict, &r->statistics) && good;
    if (folder && !r->is_file) good = app_report_write(r, folder) && good;
    if (r->json) good = app_report_print_json(r) && good;
    else if (!r->quiet) app_report_print(r);
    return !good ? EXIT_FAILURE_RUN : signal_number ? EXIT_SIGNAL + signal_number : EXIT_OK;
}

static int simulate(app_report *r, const char *folder, const app_kept *kept, int every) {
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
    if (every && !kept && !(r->keep = app_keep_begin(r, folder, every))) {
        app_outputs_abandon(outputs);
        app_log_finish(r->log);
        return EXIT_FAILURE_RUN;
    }
    app_progress p = app_progress_start("frame", r->loaded->settings.frames, r->calm);
    bool ran = run_frames(r, outputs, &p, kept);
    bool logged = app_log_finish(r->log); // of a run that failed, too: it may say why
    if (!ran) {
        keep_frames(r, outputs, folder, &p);
        if (r->good && p.failure[0]) app_blow_up_leave(r->good, r, inside);
        app_keep_end(r->keep, false);
        return EXIT_FAILURE_RUN;
    }
    if (r->log && logged) note_file(r, r->log_path);
    bool good = (!outputs || app_outputs_finish(outputs, note_file, r)) && logged;
    app_keep_end(r->keep, good);
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

/* --snapshots N: frames from one to the next; 0 where it is not given, -1 after a printed fault. */
static int snapshots_of(const app_arguments *arguments) {
    const char *given = app_value(arguments, "--snapshots");
    char *end;
    if (!given) return 0;
    long every = strtol(given, &end, 10);
    if (end != given && !*end && every >= 1 && every <= 1000000) return (int)every;
    fprintf(stderr, "skein run: --snapshots %s: expected a number of frames, 1 to 1000000\n", given);
    return -1;
}

/* What a run that goes on has already said. */
static bool check_resumed(const app_arguments *arguments) {
    static const char *const said[] = {"--out", "--set", "--fps", "--up", "--scale", "--log"};
    for (size_t i = 0; i < sizeof said / sizeof *said; i++)
        if (app_given(arguments, said[i])) {
            fprintf(stderr,
                    "skein run: %s: a run that goes on (--resume) keeps what it was begun with; --frames, --threads "
                    "and --device may be given\n",
                    said[i]);
            return false;
        }
    if (!app_word(arguments)) return true;
    fprintf(stderr, "skein run: '%s' and --resume: a run that goes on has its scene; name one of the two\n",
            app_word(arguments));
    return false;
}

/* Loads and runs, rank 0's world stepped by all; `kept` is NULL for a run that begins. */
static int run_whole(app_arguments *arguments, const char *folder, const app_kept *kept, app_shared *shared) {
    bool quiet = app_given(arguments, "--quiet"), calm = quiet || app_given(arguments, "--no-progress");
    app_scene loaded = {.quiet = quiet};
    char parent[APP_FOLDER_SIZE], output[64];
    const char *format = folder ? app_outputs_file(folder, parent) : NULL;
    const char *device = app_value(arguments, "--device"), *log = kept ? kept->log : app_value(arguments, "--log");
    int every = snapshots_of(arguments);
    if (every < 0 || (!kept && !want_file(arguments, format, output))) return EXIT_FAULT;
    if (kept && kept->device[0] && !device) device = kept->device;
    const char *scene = kept ? kept->scene : app_word(arguments);
    int status = app_load(scene, app_values(arguments, "--set"), &loaded);
    if (!status && app_given(arguments, "--compile")) loaded.warnings += app_compile(loaded.world, calm);
    if (!status) status = app_device(&loaded, device);
    if (!status) status = app_shared_lead(shared, &loaded, scene, app_values(arguments, "--set"));
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
                             .log_path = log && log[0] ? log : NULL,
                             .shared = shared->ranks ? shared : NULL,
                             .parts = shared->ranks && app_given(arguments, "--parts") ? folder : NULL};
        report.steps_per_frame = io_scene_steps_per_frame(&loaded.settings, &report.dt);
        report.counts_crossings = has_contact(loaded.world);
        app_good good = {NULL, 0, 0, 0};
        if (folder) report.good = &good;
        status = simulate(&report, folder, kept, every);
        app_good_free(&good);
        json_decref(report.files);
        json_decref(report.flocks);
    }
    app_unload(&loaded);
    return status;
}

/* The same, by all ranks of an MPI job where this is one of them. */
static int run_scene(app_arguments *arguments, const char *folder, const app_kept *kept) {
    app_shared shared = {.rank = 0};
    int status = app_shared_join(&shared, arguments);
    if (status) return status;
    if (shared.rank)
        return app_shared_serve(&shared, kept ? kept->scene : app_word(arguments), app_values(arguments, "--set"));
    status = run_whole(arguments, folder, kept, &shared);
    app_shared_leave(&shared);
    return status;
}

/* A run that goes on is called as it was. */
static int resume(app_arguments *arguments, const char *where) {
    app_kept kept;
    int status = app_kept_read(where, &kept);
    if (status) return status;
    int every = snapshots_of(arguments);
    app_allow_all(); // what the run named is in its folder in full, and was looked at when it began
    if (every > 0) kept.every = every;
    bool good = (!kept.up[0] || app_give(arguments, "--up", kept.up)) &&
                (!kept.scale[0] || app_give(arguments, "--scale", kept.scale));
    status = good ? run_scene(arguments, kept.out[0] ? kept.out : NULL, &kept) : EXIT_FAILURE_RUN;
    app_kept_free(&kept);
    return status;
}

static int run(app_arguments *arguments) {
    app_override_texts texts;
    const char *folder = app_value(arguments, "--out"), *where = app_value(arguments, "--resume");
    if (!where && !app_word(arguments)) {
        fprintf(stderr, "skein run: which scene? usage: skein run %s\n", app_run_command.usage);
        return EXIT_FAULT;
    }
    if (folder && !strcmp(folder, "-")) {
        fprintf(stderr, "skein run: --out -: a run writes many files into a folder; --json prints its report\n");
        return EXIT_FAULT;
    }
    char parent[APP_FOLDER_SIZE];
    if (app_given(arguments, "--parts") &&
        (!app_is_rank() || (!where && (!folder || app_outputs_file(folder, parent))))) {
        fprintf(stderr,
                "skein run: --parts: the ranks of an MPI job write them (mpirun -n 8 skein run ...), into the folder "
                "that --out names\n");
        return EXIT_FAULT;
    }
    if (app_given(arguments, "--snapshots") && !folder && !where) {
        fprintf(stderr, "skein run: --snapshots: they are kept beside what a run writes: name a folder with --out\n");
        return EXIT_FAULT;
    }
    if (where && !check_resumed(arguments)) return EXIT_FAULT;
    if (!app_override(arguments, texts)) return EXIT_FAULT;
    return where ? resume(arguments, where) : run_scene(arguments, folder, NULL);
}

static const app_option options[] = {
    APP_SET_OPTION,
    APP_BOUNDS_OPTIONS,
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
    {"--parts", NULL, "each rank of an MPI job writes its own particles after each frame: FOLDER/parts.xdmf, parts/",
     false, APP_TAKES_ANY},
    {"--snapshots", "N", "every N frames keep what --resume can go on from, in FOLDER/resume", false, APP_TAKES_ANY},
    {"--resume", "FOLDER", "go on from the last snapshot with the run that wrote into FOLDER, as if never broken off",
     false, APP_TAKES_FOLDER},
    {"--json", NULL, "print the report as JSON instead of a summary", false, APP_TAKES_ANY},
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_run_command = {
    "run",
    "SCENE [--out FOLDER] [options] | --resume FOLDER",
    "simulate a scene; with --out, write meshes, point caches, a picture and report.json\n\n"
    "  skein run scenes/drape.json --out out/\n"
    "  skein run scenes/flag.json --frames 240 --fps 60 --threads 2 --set bodies.0.stretch.stiffness=2e4\n"
    "  skein run scenes/flag.json --out flag.mdd --fps 24 --up z --scale 100\n\n"
    "The outputs are the scene's: by default an OBJ of each body at the end, a PC2 point cache of the whole\n"
    "run (for Blender's Mesh Cache modifier), and a PNG of the last frame; with \"film\" among them a film, too\n"
    "(or see skein render). `skein list exporters` has all formats and their options. A file behind --out is that\n"
    "format alone, by its ending, without a report: as with --set 'output=[{\"type\": \"mdd\"}]'. All but films\n"
    "appear under their names only when they are complete. Interrupted (Ctrl-C), a run writes what it has.\n\n"
    "Killed, a run with --snapshots goes on: `skein run --resume out/` reaches the state hash of an unbroken run, and\n"
    "all files come out equal (docs/recording.md).\n\n"
    "On a graphics card (--device gpu) the same plan runs as OpenGL compute shaders, for rules that have one: loose\n"
    "particles under forces, contact and neighbours; not yet cloth, jelly and rope. Numbers agree to rounding.\n\n"
    "Exit status 0: done; 1: the run failed, or ended far beyond its bounds (an edge longer than the scene's\n"
    "most_stretch allows, energy that came from nowhere), or a file could not be written; 2: a fault in the scene\n"
    "or the arguments; 130: interrupted.",
    options,
    NULL, // or a folder: run() says which
    false,
    APP_TAKES_SCENE,
    run,
    NULL,
};
