/* What the subcommands of `skein` share: options, faults on the terminal, loading a scene. */
#ifndef SKEIN_APP_COMMAND_H
#define SKEIN_APP_COMMAND_H

#include "io/scene.h"

enum { EXIT_OK = 0, EXIT_FAILURE_RUN = 1, EXIT_FAULT = 2 };

/* One option of a subcommand. A value is kept as text; `repeats` ones collect into a list. */
typedef struct app_option {
    const char *name;     /* "--frames" */
    const char *argument; /* "N"; NULL for a switch */
    const char *help;
    bool repeats;
    const char **values;  /* filled in: NULL-terminated; [0] is the value, or the name of a switch */
    size_t count;
} app_option;

/* A subcommand: its table row is its help. */
typedef struct app_command {
    const char *name, *usage, *help;
    int (*run)(int argc, char **argv);
} app_command;

extern const app_command app_run_command, app_check_command, app_explain_command, app_list_command;

/* Sorts arguments into options and words; prints help for --help. Returns -1 to go on, else an exit status. */
int app_parse(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
              const char **words, size_t most_words, size_t *word_count);
void app_options_free(app_option *options, size_t option_count);
/* The option's last value, or NULL. */
const char *app_value(const app_option *options, size_t option_count, const char *name);
/* Reads a number from an option; false (and a message) if it is none or out of range. */
bool app_number(const char *name, const char *text, double least, double most, double *number);

/* Prints "skein: where: message" to standard error. */
void app_print_error(const skein_error *error);

/* A scene read, with its world built. */
typedef struct app_scene {
    io_scene *scene;
    io_scene_settings settings;
    skein_world *world;
    double load_seconds;
    size_t warnings;
} app_scene;

/* Reads, checks and builds; every fault is printed. `threads` 0: the scene's own. Returns an exit status. */
int app_load(const char *path, const char *const *sets, int threads, app_scene *loaded);
void app_unload(app_scene *loaded);

/* Every exporter there is, NULL-terminated. */
const skein_kind *const *app_exporters(void);

double app_seconds(void); /* of a clock that only goes forward */

#endif
