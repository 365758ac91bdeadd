/* What the subcommands of `skein` share: options, faults on the terminal, loading a scene. */
#ifndef SKEIN_APP_COMMAND_H
#define SKEIN_APP_COMMAND_H

#include "io/scene.h"

/* Exit statuses. A run that a signal ended early has 128 and the signal's number, as a shell would say. */
enum { EXIT_OK = 0, EXIT_FAILURE_RUN = 1, EXIT_FAULT = 2, EXIT_SIGNAL = 128 };

/* One option of a subcommand. A value is kept as text; `repeats` ones collect into a list. */
typedef struct app_option {
    const char *name;     /* "--frames" */
    const char *argument; /* "N"; NULL for a switch */
    const char *help;
    bool repeats;
    const char **values; /* filled in: NULL-terminated; [0] is the value, or the name of a switch */
    size_t count;
} app_option;

/* A subcommand: its table row is its help. */
typedef struct app_command {
    const char *name, *usage, *help;
    int (*run)(int argc, char **argv);
} app_command;

extern const app_command app_run_command, app_render_command, app_check_command, app_compare_command,
    app_stability_command, app_explain_command, app_list_command, app_formula_command, app_view_command,
    app_bench_command;

/* Sorts arguments into options and at most one word (NULL if there is none, which is a fault where it is
 * `needed`, as in "scene"); prints help for --help. Returns -1 to go on, else an exit status. */
int app_parse(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
              const char *needed, const char **word);
/* The same where `words` `repeats`: all of them, in order; free it as an option. */
int app_parse_words(const app_command *command, int argc, char **argv, app_option *options, size_t option_count,
                    const char *needed, app_option *words);
void app_options_free(app_option *options, size_t option_count);
/* The option's last value, or NULL. */
const char *app_value(const app_option *options, size_t option_count, const char *name);
/* Adds a value as if it had been given; false when there is no memory. */
bool app_option_add(app_option *option, const char *value);

/* The options --frames, --fps and --threads stand for fields of the scene: those that were given become one
 * more value each of the first option, --set, and `texts` holds it. False after a printed fault. */
typedef char app_override_texts[3][64];
bool app_override(const app_command *command, app_option *options, size_t option_count, app_override_texts texts);

/* Prints "skein: where: message" to standard error. */
void app_print_error(const skein_error *error);

/* A scene read, with its world built. */
typedef struct app_scene {
    const char *path;
    io_scene *scene;
    io_scene_settings settings;
    skein_world *world;
    double load_seconds;
    size_t warnings;
    bool quiet;
} app_scene;

/* Reads, checks and builds; every fault is printed. Returns an exit status. */
int app_load(const char *path, const char *const *sets, app_scene *loaded);
/* The same without notes on the terminal: only faults. */
int app_load_quietly(const char *path, const char *const *sets, app_scene *loaded);
/* Only looks whether it can be loaded. */
int app_try(const char *path, const char *const *sets);
void app_unload(app_scene *loaded);
/* The option --device, and what it asks for: "cpu", "gpu", "auto" or NULL. Says on the terminal what it chose unless
 * that is plain. Returns an exit status. */
extern const app_option app_device_option;
int app_device(app_scene *loaded, const char *word);
/* The name of the method's kind. */
const char *app_method(const app_scene *loaded);

/* Every exporter there is, and the view's kind where pictures are; NULL-terminated. */
const skein_kind *const *app_exporters(void);

double app_seconds(void); /* of a clock that only goes forward */

#endif
