/* Loading the scenes that commands are given, with every fault and note on the terminal. */
#include <stdio.h>
#include <string.h>

#include "app/command.h"
#include "io/exporters.h"
#include "io/printable.h"
#ifdef SKEIN_RENDER
#include "film/film.h"
#include "render/picture.h"
#include "render/view.h"
#endif

void app_print_error(const skein_error *error) {
    fprintf(stderr, "skein: %s%s%s\n", error->where, error->where[0] ? ": " : "", error->message);
}

void app_keep_error(const skein_error *error, char out[APP_FAILURE_SIZE]) {
    snprintf(out, APP_FAILURE_SIZE, "%s%s%s", error->where, error->where[0] ? ": " : "", error->message);
}

static void report_fault(void *user, const skein_error *error) {
    (void)user;
    app_print_error(error);
}

static void print_log(void *user, skein_log_level level, const char *message) {
    app_scene *loaded = user;
    if (level == SKEIN_LOG_WARNING) loaded->warnings++;
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

static int load(const char *word, const char *const *sets, bool quiet, app_scene *loaded) {
    memset(loaded, 0, sizeof *loaded);
    loaded->quiet = quiet;
    double start = app_seconds();
    io_faults faults = {report_fault, NULL, 0};
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

int app_load(const char *path, const char *const *sets, app_scene *loaded) {
    return load(path, sets, false, loaded);
}

int app_load_quietly(const char *path, const char *const *sets, app_scene *loaded) {
    return load(path, sets, true, loaded);
}

int app_try(const char *path, const char *const *sets) {
    app_scene loaded;
    int status = app_load(path, sets, &loaded);
    if (!status) app_unload(&loaded);
    return status;
}

void app_not_found(const char *word) {
    io_faults faults = {report_fault, NULL, 0};
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
