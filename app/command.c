#include "app/command.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "io/exporters.h"
#ifdef SKEIN_RENDER
#include "render/picture.h"
#endif

double app_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- options ---- */

static void print_help(const app_command *command, const app_option *options, size_t option_count) {
    printf("usage: skein %s %s\n\n%s\n", command->name, command->usage, command->help);
    if (option_count) printf("\nOptions\n");
    for (size_t i = 0; i < option_count; i++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", options[i].name, options[i].argument ? options[i].argument : "");
        printf("  %-22s %s\n", left, options[i].help);
    }
}

static bool keep_value(app_option *option, const char *value) {
    if (!option->repeats) option->count = 0;
    const char **grown = realloc(option->values, (option->count + 2) * sizeof *grown);
    if (!grown) return false;
    option->values = grown;
    option->values[option->count++] = value;
    option->values[option->count] = NULL;
    return true;
}

int app_parse(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
              const char **words, size_t most_words, size_t *word_count) {
    *word_count = 0;
    for (int a = 0; a < argc; a++) {
        const char *argument = argv[a];
        if (!strcmp(argument, "--help") || !strcmp(argument, "-h")) {
            print_help(command, options, option_count);
            return EXIT_OK;
        }
        if (argument[0] != '-' || !argument[1]) {
            if (*word_count == most_words) {
                fprintf(stderr, "skein %s: '%s' is one argument too many; usage: skein %s %s\n", command->name, argument, command->name, command->usage);
                return EXIT_FAULT;
            }
            words[(*word_count)++] = argument;
            continue;
        }
        // --name value or --name=value
        const char *equals = strchr(argument, '=');
        size_t length = equals ? (size_t)(equals - argument) : strlen(argument);
        app_option *option = NULL;
        for (size_t i = 0; i < option_count; i++)
            if (strlen(options[i].name) == length && !strncmp(options[i].name, argument, length)) option = &options[i];
        if (!option) {
            fprintf(stderr, "skein %s: there is no option %s; `skein %s --help` shows all\n", command->name, argument, command->name);
            return EXIT_FAULT;
        }
        const char *value = option->argument ? (equals ? equals + 1 : a + 1 < argc ? argv[++a] : NULL) : option->name;
        if (!value || (equals && !option->argument)) {
            fprintf(stderr, "skein %s: %s takes %s\n", command->name, option->name, option->argument ? option->argument : "no value");
            return EXIT_FAULT;
        }
        if (!keep_value(option, value)) return EXIT_FAILURE_RUN;
    }
    return -1;
}

void app_options_free(app_option *options, size_t option_count) {
    for (size_t i = 0; i < option_count; i++) free(options[i].values);
}

const char *app_value(const app_option *options, size_t option_count, const char *name) {
    for (size_t i = 0; i < option_count; i++)
        if (!strcmp(options[i].name, name)) return options[i].count ? options[i].values[options[i].count - 1] : NULL;
    return NULL;
}

bool app_number(const char *name, const char *text, double least, double most, double *number) {
    char *end;
    errno = 0;
    *number = strtod(text, &end);
    if (end != text && !*end && *number >= least && *number <= most) return true;
    fprintf(stderr, "skein: %s %s: expected a number from %g to %g\n", name, text, least, most);
    return false;
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
    fprintf(stderr, "skein: %s%s\n", level == SKEIN_LOG_WARNING ? "warning: " : "", message);
}

const skein_kind *const *app_exporters(void) {
    static const skein_kind *all[16];
    size_t count = 0;
    for (size_t i = 0; io_exporter_at(i); i++) all[count++] = io_exporter_at(i);
#ifdef SKEIN_RENDER
    for (size_t i = 0; render_exporter_at(i); i++) all[count++] = render_exporter_at(i);
#endif
    all[count] = NULL;
    return all;
}

int app_load(const char *path, const char *const *sets, int threads, app_scene *loaded) {
    memset(loaded, 0, sizeof *loaded);
    double start = app_seconds();
    io_faults faults = {report_fault, NULL, 0};
    loaded->scene = io_scene_read(path, sets, app_exporters(), &faults);
    if (loaded->scene) {
        loaded->settings = *io_scene_get(loaded->scene);
        skein_world_desc desc = skein_default_world_desc();
        desc.log = print_log;
        desc.log_user = loaded;
        desc.thread_count = threads ? threads : loaded->settings.threads;
        loaded->world = io_scene_build(loaded->scene, &desc, &faults);
    }
    loaded->load_seconds = app_seconds() - start;
    if (loaded->world && !faults.count) return EXIT_OK;
    app_unload(loaded);
    if (faults.count > 1) fprintf(stderr, "skein: %zu faults\n", faults.count);
    return EXIT_FAULT;
}

void app_unload(app_scene *loaded) {
    skein_world_destroy(loaded->world);
    io_scene_free(loaded->scene);
    loaded->world = NULL;
    loaded->scene = NULL;
}
