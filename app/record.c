/* skein record SCENE -o FILE and skein verify FILE: a run with all that is done in it, done again and compared.
 *
 * The file is a recording of the library's (skein/record.h) whose note is JSON: the scene as it ran, where it was read
 * from (its meshes are found by that), and the command line. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>
#include <skein/record.h>

#include "app/progress.h"

/* ---- changes on the way ---- */

enum { MOST_CHANGES = 64 };

/* "120 colliders.ball.radius=0.3": before step 120, counted from 0. */
typedef struct change {
    unsigned long step;
    const char *path; /* and behind its end the value, as JSON or a word */
    size_t length;
    const char *value;
} change;

static bool read_change(const char *text, change *c) {
    char *end;
    c->step = strtoul(text, &end, 10);
    const char *path = end + strspn(end, " "), *equals = strchr(path, '=');
    c->path = path, c->value = equals ? equals + 1 : "", c->length = equals ? (size_t)(equals - path) : 0;
    if (end != text && path > end && c->length && c->length < 200) return true;
    fprintf(stderr, "skein record: --at '%s': expected a step, a path and a value: '120 colliders.0.radius=0.3'\n",
            text);
    return false;
}

static bool apply_change(skein_world *world, const change *c) {
    char path[200];
    json_t *value = json_loads(c->value, JSON_DECODE_ANY, NULL);
    skein_value given = {0, {0, 0, 0}, c->value};
    snprintf(path, sizeof path, "%.*s", (int)c->length, c->path);
    if (json_is_number(value)) given = skein_number(json_number_value(value));
    else if (json_is_boolean(value)) given = skein_number(json_is_true(value));
    else if (json_is_string(value)) given.text = json_string_value(value);
    else if (json_is_array(value) && json_array_size(value) <= 3) {
        given.count = (int)json_array_size(value);
        for (size_t k = 0; k < json_array_size(value); k++)
            given.number[k] = json_number_value(json_array_get(value, k));
    }
    if (!given.count && !strcmp(given.text, "infinite")) given = skein_number(INFINITY); // as --set and scenes have it
    skein_status status = skein_set_path(world, path, given);
    if (status) {
        fprintf(stderr, "skein record: --at: ");
        app_print_error(skein_world_error(world));
    }
    json_decref(value);
    return !status;
}

/* ---- recording ---- */

static bool put(void *user, const void *bytes, size_t size) {
    io_output_write(user, bytes, size);
    return io_output_status(user, NULL) == SKEIN_OK;
}

static bool run_recorded(const app_scene *loaded, const change *changes, size_t count, bool calm) {
    double dt;
    int per_frame = io_scene_steps_per_frame(&loaded->settings, &dt);
    app_progress p = app_progress_start("frame", loaded->settings.frames, calm);
    unsigned long step = 0;
    bool good = true;
    for (int frame = 1; frame <= loaded->settings.frames && good && !app_interrupted(); frame++) {
        for (int s = 0; s < per_frame && good; s++, step++) {
            for (size_t c = 0; c < count && good; c++)
                if (changes[c].step == step) good = apply_change(loaded->world, &changes[c]);
            good = good && app_step_frame(loaded, frame, 1, dt, &p);
        }
        if (good) app_progress_show(&p, frame);
    }
    app_progress_end(&p);
    return good;
}

static int record_scene(const app_scene *loaded, const app_arguments *arguments, const char *path, bool quiet) {
    change changes[MOST_CHANGES];
    size_t count = 0;
    const char *const *given = app_values(arguments, "--at");
    for (; given && given[count] && count < MOST_CHANGES; count++)
        if (!read_change(given[count], &changes[count])) return EXIT_FAULT;
    if (given && given[count]) {
        fprintf(stderr, "skein record: --at: more than %d changes\n", MOST_CHANGES);
        return EXIT_FAULT;
    }
    skein_error error = {SKEIN_OK, "", ""};
    char *note = io_scene_note(loaded->scene, loaded->path, arguments->argv, arguments->argc);
    io_output *output = note ? io_output_open(path, &error) : NULL;
    if (!output) {
        if (!note) fprintf(stderr, "skein: out of memory\n");
        else app_print_error(&error);
        free(note);
        return EXIT_FAILURE_RUN;
    }
    app_catch_interrupts();
    skein_recorder to = {.write = put, .user = output, .note = note};
    skein_status status = skein_record_begin(loaded->world, &to);
    free(note);
    bool ran = !status && run_recorded(loaded, changes, count, quiet || app_given(arguments, "--no-progress"));
    if (!status) status = skein_record_end(loaded->world);
    if (status) { // why is the file's to say
        if (!io_output_status(output, &error)) error = *skein_world_error(loaded->world);
        app_print_error(&error);
        io_output_abandon(output);
        return EXIT_FAILURE_RUN;
    }
    uint64_t size = io_output_place(output);
    if (io_output_commit(output, &error)) {
        app_print_error(&error);
        return EXIT_FAILURE_RUN;
    }
    if (!quiet)
        printf("state hash %016llx\nwrote %s (%.1f MB)\n", (unsigned long long)skein_world_hash(loaded->world), path,
               1e-6 * (double)size);
    return !ran ? EXIT_FAILURE_RUN : app_interrupted() ? EXIT_SIGNAL + app_interrupted() : EXIT_OK;
}

static int record(app_arguments *arguments) {
    app_override_texts texts;
    const char *path = app_value(arguments, "-o");
    app_scene loaded = {.quiet = app_given(arguments, "--quiet")};
    if (!path) {
        fprintf(stderr, "skein record: which file? usage: skein record SCENE -o FILE\n");
        return EXIT_FAULT;
    }
    if (!app_override(arguments, texts)) return EXIT_FAULT;
    int status = app_load(app_word(arguments), app_values(arguments, "--set"), &loaded);
    if (!status) status = record_scene(&loaded, arguments, path, loaded.quiet);
    app_unload(&loaded);
    return status;
}

/* ---- verifying ---- */

/* The world of a recording's note. */
static io_scene *read_note(const char *note, const char *threads, const char *path) {
    json_t *root = json_loads(note, 0, NULL);
    const char *from = json_string_value(json_object_get(root, "path"));
    char *text = json_dumps(json_object_get(root, "scene"), JSON_COMPACT);
    char set[64];
    const char *const sets[] = {threads ? set : NULL, NULL};
    io_scene *scene = NULL;
    io_reach reach;
    io_faults faults = {app_report_fault, NULL, 0, app_reach(NULL, &reach)};
    snprintf(set, sizeof set, "threads=%.40s", threads ? threads : "");
    if (!text || !from)
        fprintf(stderr, "skein verify: %s: it has no scene: only `skein record` and the window write one\n", path);
    else scene = io_scene_read_text(text, strlen(text), from, sets, app_exporters(), &faults);
    free(text);
    json_decref(root);
    return scene;
}

static void print_difference(const skein_world *world, const skein_difference *d, const char *path) {
    skein_surface surface;
    skein_value name = {0, {0, 0, 0}, ""};
    const skein_kind *kind = skein_object_kind(world, d->body);
    double x[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    printf("%s: differs after step %llu: ", path, (unsigned long long)d->steps);
    if (kind && !skein_body_surface(world, d->body, &surface)) {
        skein_get(world, d->body, "name", &name);
        printf("body %s, particle %u of it (%s%u)", name.text[0] ? name.text : kind->name,
               d->particle - surface.first_particle, d->exact ? "" : "or one of the 63 after it; ", d->particle);
    } else printf("particle %u%s", d->particle, d->exact ? "" : " or one of the 63 after it");
    printf(": %s%s%s\n", d->position ? "position" : "", d->position && d->velocity ? " and " : "",
           d->velocity ? "velocity" : "");
    if (skein_positions_copy(world, d->particle, 1, x) || skein_velocities_copy(world, d->particle, 1, v)) return;
    if (d->exact)
        printf("replayed, it is at %.9g %.9g %.9g m with %.9g %.9g %.9g m/s\n", x[0], x[1], x[2], v[0], v[1], v[2]);
    if (d->blocks > 1) printf("%u lots of 64 particles differ; this is the first\n", d->blocks);
}

static int verify_bytes(const io_bytes *bytes, const char *path, const app_arguments *arguments) {
    skein_recording_info info;
    skein_error error;
    if (skein_recording_look(bytes->data, bytes->size, &info, &error)) {
        fprintf(stderr, "skein verify: %s: %s\n", path, error.message);
        return EXIT_FAULT;
    }
    if (info.real_size != sizeof(skein_real)) {
        fprintf(stderr, "skein verify: %s: a recording of a skein built in %s: verify it with that one\n", path,
                info.real_size == 8 ? "double" : "float");
        return EXIT_FAULT;
    }
    io_scene *scene = read_note(info.note, app_value(arguments, "--threads"), path);
    io_reach reach;
    io_faults faults = {app_report_fault, NULL, 0, app_reach(NULL, &reach)};
    skein_world_desc desc = skein_default_world_desc();
    if (scene) desc.thread_count = io_scene_get(scene)->threads;
    skein_world *world = scene ? io_scene_build(scene, &desc, &faults) : NULL;
    skein_difference d;
    int status = EXIT_FAULT;
    if (world && skein_replay(world, bytes->data, bytes->size, &d)) {
        fprintf(stderr, "skein verify: %s: %s\n", path, skein_world_error(world)->message);
        status = EXIT_FAILURE_RUN;
    } else if (world && d.found) {
        print_difference(world, &d, path);
        status = EXIT_FAILURE_RUN;
    } else if (world) {
        printf("%s: %llu steps, the same to the bit; state hash %016llx\n", path, (unsigned long long)d.steps,
               (unsigned long long)skein_world_hash(world));
        if (d.stopped[0]) printf("recording stopped there: %s\n", d.stopped);
        else if (!d.is_whole) printf("the recording breaks off there\n");
        status = EXIT_OK;
    }
    skein_world_destroy(world);
    io_scene_free(scene);
    return status;
}

static int verify(app_arguments *arguments) {
    int status = EXIT_OK;
    for (size_t i = 0; i < arguments->words.count; i++) {
        io_bytes bytes;
        skein_error error;
        const char *path = arguments->words.values[i];
        int one = EXIT_FAULT;
        if (io_file_read(path, SIZE_MAX / 4, &bytes, &error)) app_print_error(&error);
        else {
            one = verify_bytes(&bytes, path, arguments);
            io_bytes_free(&bytes);
        }
        if (one > status) status = one;
    }
    return status;
}

static const app_option record_options[] = {
    {"-o", "FILE", "where the recording goes", false, APP_TAKES_FILE},
    APP_SET_OPTION,
    APP_BOUNDS_OPTIONS,
    {"--at", "'STEP PATH=VALUE'",
     "set a field on the way, before that step: '120 colliders.0.radius=0.3'; may be repeated", true, APP_TAKES_ANY},
    {"--frames", "N", "frames to run, instead of the scene's", false, APP_TAKES_ANY},
    {"--fps", "N", "frames a second of simulated time, instead of the scene's", false, APP_TAKES_ANY},
    APP_THREADS_OPTION,
    APP_NO_PROGRESS_OPTION,
    APP_QUIET_OPTION,
    APP_END_OF_OPTIONS};

const app_command app_record_command = {
    "record",
    "SCENE -o FILE [options]",
    "run a scene and record all that is done in it, for `skein verify`\n\n"
    "  skein record scenes/flag.json -o flag.skeinrec --frames 240\n"
    "  skein record scenes/drape.json -o drape.skeinrec --at '60 colliders.0.radius=0.4'\n\n"
    "The file holds the scene, the state at the beginning, every change and, before each step, sums over the state\n"
    "that name a particle that comes out otherwise: half a byte a particle and step (docs/recording.md). Meshes stay\n"
    "where they are.\n\n"
    "Exit status 0: done; 1: the run failed or the file could not be written; 2: a fault in the scene or the\n"
    "arguments; 130: interrupted, and recorded until then.",
    record_options,
    "scene",
    false,
    APP_TAKES_SCENE,
    record,
    NULL,
};

static const app_option verify_options[] = {APP_THREADS_OPTION, APP_ALLOW_OPTION, APP_BOUNDS_OPTIONS,
                                            APP_END_OF_OPTIONS};

const app_command app_verify_command = {
    "verify",
    "FILE... [--threads N]",
    "do again what was recorded, and name the first step and particle that differ\n\n"
    "  skein verify flag.skeinrec\n\n"
    "On another machine, with other threads or with another compiler, the bits are the same; where they are not, the\n"
    "first step, the body and the particle are named, and whether its position or its velocity differs.\n\n"
    "Exit status 0: all is the same; 1: something differs, or could not be replayed; 2: it is no recording, or one\n"
    "of a newer version.",
    verify_options,
    "recording",
    true,
    APP_TAKES_FILE,
    verify,
    NULL,
};
