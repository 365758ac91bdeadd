#include "app/command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io/exporters.h"
#ifdef SKEIN_RENDER
#include "film/film.h"
#include "render/picture.h"
#include "render/view.h"
#endif

double app_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- options ---- */

static void print_help(const app_command *command, const app_option *options, size_t option_count) {
    printf("usage: skein %s %s\n\n%s\n\nOptions\n", command->name, command->usage, command->help);
    for (size_t i = 0; i < option_count; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", options[i].name, options[i].argument ? options[i].argument : "");
        printf("  %-20s %s\n", left, options[i].help);
    }
    printf("  %-20s %s\n", "--help", "print this");
}

bool app_option_add(app_option *option, const char *value) {
    if (!option->repeats) option->count = 0;
    const char **grown = realloc(option->values, (option->count + 2) * sizeof *grown);
    if (!grown) return false;
    option->values = grown;
    option->values[option->count++] = value;
    option->values[option->count] = NULL;
    return true;
}

static int unknown_option(const app_command *command, const app_option *options, size_t option_count,
                          const char *name) {
    const char *names[16];
    char hint[IO_HINT_SIZE];
    size_t count = 0;
    // without the dashes, which all have in common
    for (; count < option_count && count < 16; count++) names[count] = options[count].name + 2;
    io_hint(name + strspn(name, "-"), names, count, hint);
    fprintf(stderr, "skein %s: there is no option %s%s `skein %s --help` shows all\n", command->name, name,
            hint[0] ? hint : ";", command->name);
    return EXIT_FAULT;
}

/* One option and its value: --name value or --name=value. Moves *a on. Returns as app_parse does. */
static int parse_option(const app_command *command, int argc, char **argv, int *a, app_option *options,
                        size_t option_count) {
    char name[64];
    const char *argument = argv[*a], *equals = strchr(argument, '=');
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - argument) : 63, argument);
    app_option *option = NULL;
    for (size_t i = 0; i < option_count; i++)
        if (!strcmp(options[i].name, name)) option = &options[i];
    if (!option) return unknown_option(command, options, option_count, name);
    const char *value = equals ? equals + 1 : NULL;
    if (option->argument && !value && *a + 1 < argc) value = argv[++*a];
    if (!option->argument != !value) {
        fprintf(stderr, "skein %s: %s takes %s\n", command->name, name,
                option->argument ? option->argument : "no value");
        return EXIT_FAULT;
    }
    return app_option_add(option, value ? value : option->name) ? -1 : EXIT_FAILURE_RUN;
}

int app_parse_words(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
                    const char *needed, app_option *words) {
    int status = -1;
    bool only_words = false; // behind "--"
    for (int a = 0; a < argc && status < 0; a++) {
        const char *argument = argv[a];
        bool is_word = only_words || argument[0] != '-' || !argument[1];
        if (!is_word && !strcmp(argument, "--")) {
            only_words = true;
        } else if (!is_word && (!strcmp(argument, "--help") || !strcmp(argument, "-h"))) {
            print_help(command, options, option_count);
            status = EXIT_OK;
        } else if (!is_word) {
            status = parse_option(command, argc, argv, &a, options, option_count);
        } else if (words->count && !words->repeats) {
            fprintf(stderr, "skein %s: '%s' is one argument too many; usage: skein %s %s\n", command->name, argument,
                    command->name, command->usage);
            status = EXIT_FAULT;
        } else if (!app_option_add(words, argument)) {
            status = EXIT_FAILURE_RUN;
        }
    }
    if (status >= 0 || words->count || !needed) return status;
    fprintf(stderr, "skein %s: which %s? usage: skein %s %s\n", command->name, needed, command->name, command->usage);
    return EXIT_FAULT;
}

int app_parse(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
              const char *needed, const char **word) {
    app_option words = {.repeats = false};
    int status = app_parse_words(command, argc, argv, options, option_count, needed, &words);
    *word = words.count ? words.values[0] : NULL;
    app_options_free(&words, 1);
    return status;
}

void app_options_free(app_option *options, size_t option_count) {
    for (size_t i = 0; i < option_count; i++) free(options[i].values);
}

const char *app_value(const app_option *options, size_t option_count, const char *name) {
    for (size_t i = 0; i < option_count; i++)
        if (!strcmp(options[i].name, name)) return options[i].count ? options[i].values[options[i].count - 1] : NULL;
    return NULL;
}

static bool override_field(const app_command *command, const char *name, const char *given, app_option *sets,
                           char text[64]) {
    const skein_field *field = skein_field_find(io_scene_kind(), name + 2, NULL);
    char *end;
    skein_value value = skein_number(strtod(given, &end));
    skein_error error = {SKEIN_ERROR_VALUE, "", ""};
    if (end == given || *end) value.count = 4; // what no field takes, so that the field says what it does take
    bool good = field && !skein_field_check(field, &value, &error);
    snprintf(text, 64, "%s=%.17g", name + 2, value.number[0]);
    if (!good) fprintf(stderr, "skein %s: %s %s: %s\n", command->name, name, given, error.message);
    return good && app_option_add(sets, text);
}

bool app_override(const app_command *command, app_option *options, size_t option_count, app_override_texts texts) {
    static const char *const names[] = {"--frames", "--fps", "--threads"};
    bool good = true;
    for (int i = 0; i < 3 && good; i++) {
        const char *given = app_value(options, option_count, names[i]);
        good = !given || override_field(command, names[i], given, &options[0], texts[i]);
    }
    return good;
}

/* ---- scenes ---- */

void app_print_error(const skein_error *error) {
    fprintf(stderr, "skein: %s%s%s\n", error->where, error->where[0] ? ": " : "", error->message);
}

static void report_fault(void *user, const skein_error *error) {
    (void)user;
    app_print_error(error);
}

static void print_log(void *user, skein_log_level level, const char *message) {
    app_scene *loaded = user;
    if (level == SKEIN_LOG_WARNING) loaded->warnings++;
    if (loaded->quiet) return;
    fprintf(stderr, "skein: %s%s\n", level == SKEIN_LOG_WARNING ? "warning: " : "", message);
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

static int load(const char *path, const char *const *sets, bool quiet, app_scene *loaded) {
    memset(loaded, 0, sizeof *loaded);
    loaded->path = path;
    loaded->quiet = quiet;
    double start = app_seconds();
    io_faults faults = {report_fault, NULL, 0};
    loaded->scene = io_scene_read(path, sets, app_exporters(), &faults);
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
    if (faults.count > 1) fprintf(stderr, "skein: %s: %zu faults\n", path, faults.count);
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

void app_unload(app_scene *loaded) {
    skein_world_destroy(loaded->world);
    io_scene_free(loaded->scene);
    loaded->world = NULL;
    loaded->scene = NULL;
}

const char *app_method(const app_scene *loaded) {
    return skein_object_kind(loaded->world, skein_object_at(loaded->world, SKEIN_METHOD, 0))->name;
}
