/* Loading the scenes that commands are given, with every fault and note on the terminal. */
#include <stdio.h>
#include <string.h>

#include <jansson.h>

#include "app/bounds.h"
#include "io/advice.h"
#include "io/exporters.h"
#include "io/printable.h"
#ifdef SKEIN_RENDER
#include "film/film.h"
#include "render/picture.h"
#include "render/view.h"
#endif

void app_print_error(const skein_error *error) {
    fprintf(stderr, "skein: %s%s%s\n", error->where, error->where[0] ? ": " : "", error->message);
    app_bounds_explain(error->status);
}

void app_keep_error(const skein_error *error, char out[APP_FAILURE_SIZE]) {
    snprintf(out, APP_FAILURE_SIZE, "%s%s%s", error->where, error->where[0] ? ": " : "", error->message);
}

static void keep(struct json_t *list, const char *where, const char *words) {
    if (list) json_array_append_new(list, json_sprintf("%s%s%s", where, where[0] ? ": " : "", words));
}

void app_report_fault(void *user, const skein_error *error) {
    const app_scene *loaded = user;
    app_print_error(error);
    if (loaded) keep(loaded->fault_list, error->where, error->message);
}

static void print_log(void *user, skein_log_level level, const char *message) {
    app_scene *loaded = user;
    if (level == SKEIN_LOG_WARNING) {
        loaded->warnings++;
        keep(loaded->warning_list, "", message);
    }
    if (loaded->quiet) return;
    char line[1024];
    snprintf(line, sizeof line, "%s", message);
    io_printable(line, false);
    fprintf(stderr, "skein: %s%s\n", level == SKEIN_LOG_WARNING ? "warning: " : "", line);
}

const skein_kind *const *app_exporters(void) {
    static const skein_kind *all[16];
    size_t count = 0;
    for (size_t i = 0; io_exporter_at(i); i++) all[count++] = io_exporter_at(i);
#ifdef SKEIN_RENDER
    for (size_t i = 0; render_exporter_at(i); i++) all[count++] = render_exporter_at(i);
    all[count++] = film_exporter();
    all[count++] = render_view_kind();
#endif
    all[count] = NULL;
    return all;
}

/* Standard input, read once for all the times that a command looks at the scene. */
static io_scene *read_stdin(const char *const *sets, io_faults *faults) {
    static io_bytes given;
    skein_error error;
    if (!given.data && io_stdin_read(IO_MOST_SCENE_BYTES, &given, &error)) {
        faults->report(faults->user, &error);
        faults->count++;
        return NULL;
    }
    return io_scene_read_text(given.data, given.size, IO_STDIN_NAME, sets, app_exporters(), faults);
}

/* Reads what the word means, and notes its path. */
static io_scene *read_scene(const char *word, const char *const *sets, io_faults *faults, char path[IO_PLACE_SIZE]) {
    if (!strcmp(word, "-")) {
        snprintf(path, IO_PLACE_SIZE, "%s", IO_STDIN_NAME);
        return read_stdin(sets, faults);
    }
    if (io_scene_find(word, path)) return io_scene_read(path, sets, app_exporters(), faults);
    io_scene_not_found(word, faults);
    return NULL;
}

static struct {
    const char *const *paths;
    bool all;
} may; // of this process: it loads scenes for one user

void app_allow_all(void) {
    may.all = true;
}

void app_allow(const char *const *paths) {
    may.paths = paths;
}

const io_reach *app_reach(const char *const *sets, io_reach *reach) {
    *reach = (io_reach){may.paths, sets};
    return may.all ? NULL : reach;
}

int app_load(const char *word, const char *const *sets, app_scene *loaded) {
    double start = app_seconds();
    io_reach reach;
    io_faults faults = {app_report_fault, loaded, 0, app_reach(sets, &reach)};
    loaded->scene = read_scene(word, sets, &faults, loaded->path);
    if (loaded->scene) {
        loaded->settings = *io_scene_get(loaded->scene);
        skein_world_desc desc = skein_default_world_desc();
        desc.log = print_log;
        desc.log_user = loaded;
        desc.thread_count = loaded->settings.threads;
        loaded->world = io_scene_build(loaded->scene, &desc, &faults);
    }
    loaded->load_seconds = app_seconds() - start;
    if (loaded->world) return EXIT_OK;
    app_unload(loaded);
    if (faults.count > 1) fprintf(stderr, "skein: %s: %zu faults\n", loaded->path, faults.count);
    return EXIT_FAULT;
}

int app_try(const char *word, const char *const *sets) {
    app_scene loaded = {.quiet = false};
    int status = app_load(word, sets, &loaded);
    if (!status) app_unload(&loaded);
    return status;
}

/* Errors may be printed where notes are not. */
static void print_advice(void *user, const char *line) {
    const app_scene *loaded = user;
    keep(loaded->warning_list, "", line);
    if (!loaded->quiet) fprintf(stderr, "skein: warning: %s: %s\n", loaded->path, line);
}

void app_advise(app_scene *loaded) {
    double dt;
    io_scene_steps_per_frame(&loaded->settings, &dt);
    loaded->warnings += io_advise(loaded->world, dt, (io_warnings){print_advice, loaded}, &loaded->needed);
}

void app_not_found(const char *word) {
    io_faults faults = {app_report_fault, NULL, 0, NULL};
    io_scene_not_found(word, &faults);
}

void app_unload(app_scene *loaded) {
    skein_world_destroy(loaded->world);
    io_scene_free(loaded->scene);
    loaded->world = NULL;
    loaded->scene = NULL;
}

const char *app_method(const app_scene *loaded) {
    return skein_object_kind(loaded->world, skein_object_at(loaded->world, SKEIN_METHOD, 0))->name;
}
