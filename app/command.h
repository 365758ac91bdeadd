/* What the subcommands of `skein` share: options, faults on the terminal, loading a scene. */
#ifndef SKEIN_APP_COMMAND_H
#define SKEIN_APP_COMMAND_H

#include "io/reach.h"
#include "io/scene.h"

/* Exit statuses. A run that a signal ended early has 128 and the signal's number, as a shell would say. */
enum { EXIT_OK = 0, EXIT_FAILURE_RUN = 1, EXIT_FAULT = 2, EXIT_SIGNAL = 128 };

/* What an argument names, for the shell that completes it. */
typedef enum app_takes {
    APP_TAKES_ANY,
    APP_TAKES_SCENE,
    APP_TAKES_FILE,
    APP_TAKES_FOLDER,
    APP_TAKES_KIND,
    APP_TAKES_SHELL
} app_takes;

/* One option of a subcommand: a row of its table, from which come its help, the manual page and completion. */
typedef struct app_option {
    const char *name;     /* "--frames" */
    const char *argument; /* "N", or the words that it can be: "cpu|gpu|auto"; NULL for a switch */
    const char *help;
    bool repeats; /* else the last one counts */
    app_takes takes;
} app_option;

enum { APP_MOST_OPTIONS = 26 };

/* What was given: a list of values for each of the command's options, and its words. */
typedef struct app_list {
    const char **values; /* NULL-terminated, or NULL where there is none; of a switch its name */
    size_t count;
} app_list;
typedef struct app_arguments {
    const struct app_command *command;
    app_list words, given[APP_MOST_OPTIONS];
    int argc; /* as they were given, behind the command's name */
    char **argv;
} app_arguments;

/* A subcommand: its table row is its help. */
typedef struct app_command {
    const char *name, *usage, *help;
    const app_option *options; /* ended by one without a name; or NULL */
    const char *needed;        /* what its words are: "scene"; NULL where it does without */
    bool many;                 /* takes more than one word */
    app_takes takes;           /* what the words name */
    int (*run)(app_arguments *arguments);
    void (*print_more)(void); /* behind the help; or NULL */
} app_command;

extern const app_command app_run_command, app_render_command, app_check_command, app_compare_command,
    app_stability_command, app_explain_command, app_list_command, app_formula_command, app_view_command,
    app_bench_command, app_completion_command, app_man_command, app_record_command, app_verify_command,
    app_study_command, app_fit_command;

/* What `skein list` takes: its lists and all kinds, each once; NULL past the end. */
const char *app_list_word(size_t index);

/* Every subcommand; NULL past the end. */
const app_command *app_command_at(size_t index);

/* Sorts arguments into options and words and runs the command with them; or prints its help, for --help. Returns an
 * exit status. */
int app_command_run(const app_command *command, int argc, char **argv);
/* The first word, or NULL. */
const char *app_word(const app_arguments *arguments);
/* An option's last value, or NULL; all of them, NULL-terminated, or NULL. The name is one of the command's. */
const char *app_value(const app_arguments *arguments, const char *name);
const char *const *app_values(const app_arguments *arguments, const char *name);
bool app_given(const app_arguments *arguments, const char *name);
/* Adds a value as if it had been given; false when there is no memory. */
bool app_list_add(app_list *list, const char *value, bool repeats);

/* Options that several commands have. */
#define APP_SET_OPTION                                                                                            \
    {"--set", "PATH=VALUE", "change a value of the scene: bodies.0.stretch.stiffness=2e4; may be repeated", true, \
     APP_TAKES_ANY},                                                                                              \
        APP_ALLOW_OPTION
/* Scenes are read with app_reach(), and so a command that reads any has this. */
#define APP_ALLOW_OPTION                                                                                     \
    {                                                                                                        \
        "--allow-path", "PATH",                                                                              \
            "a folder (not /) whose files may be read, too, if the scene names them; may be repeated", true, \
            APP_TAKES_FOLDER                                                                                 \
    }
#define APP_BOUNDS_OPTIONS                                                                                            \
    {"--max-memory", "SIZE", "memory it may take: 500M, 2G; more is a failure that is told", false, APP_TAKES_ANY}, { \
        "--max-time", "SECONDS", "then it ends as by Ctrl-C, with what it has, and exit status 1", false,             \
            APP_TAKES_ANY                                                                                             \
    }
#define APP_THREADS_OPTION \
    { "--threads", "N", "threads to run on, 1 to 64; the result is the same", false, APP_TAKES_ANY }
#define APP_NO_PROGRESS_OPTION \
    { "--no-progress", NULL, "no progress on the terminal, only what is said at the end", false, APP_TAKES_ANY }
#define APP_QUIET_OPTION \
    { "--quiet", NULL, "say nothing but errors", false, APP_TAKES_ANY }
#define APP_DEVICE_OPTION                                                                                     \
    {                                                                                                         \
        "--device", "cpu|gpu|auto", "where steps are computed: auto is on a graphics card if one can", false, \
            APP_TAKES_ANY                                                                                     \
    }
#define APP_COMPILE_OPTION                                                                                        \
    {                                                                                                             \
        "--compile", NULL, "compile formulas with $CC, cc, gcc or clang; kept in $SKEIN_CACHE or ~/.cache/skein", \
            false, APP_TAKES_ANY                                                                                  \
    }
#define APP_END_OF_OPTIONS \
    { NULL, NULL, NULL, false, APP_TAKES_ANY }

/* The options --frames, --fps and --threads stand for fields of the scene: those that were given become one
 * more value each of --set, and `texts` holds it. False after a printed fault. */
typedef char app_override_texts[3][64];
bool app_override(app_arguments *arguments, app_override_texts texts);

/* The same of --follow BODY, for the view's camera. */
typedef char app_follow_text[600];
bool app_follow(app_arguments *arguments, app_follow_text text);
#define APP_FOLLOW_OPTION                                                                                         \
    {                                                                                                             \
        "--follow", "BODY", "a body that the camera goes along with: its name, its number from 0, or all", false, \
            APP_TAKES_ANY                                                                                         \
    }

/* One more value of --set, before all that were given; it has to live as long as the arguments. False without memory.
 */
bool app_set_first(app_arguments *arguments, const char *set);

/* An option as if it had been given; the value has to live as long as the arguments. False without memory. */
bool app_give(app_arguments *arguments, const char *name, const char *value);

/* Prints "skein: where: message" to standard error. */
void app_print_error(const skein_error *error);
/* The same as what scenes' faults go to; `user` is the app_scene that keeps them, or NULL. */
void app_report_fault(void *user, const skein_error *error);
/* Keeps the same words for a report. */
enum { APP_FAILURE_SIZE = 1280 };
void app_keep_error(const skein_error *error, char out[APP_FAILURE_SIZE]);

/* A scene read, with its world built. */
typedef struct app_scene {
    char path[IO_PLACE_SIZE]; /* as messages have it */
    io_scene *scene;
    io_scene_settings settings;
    skein_world *world;
    double load_seconds;
    double needed; /* substeps for the method, as app_advise() found: 1 where there is no limit */
    size_t warnings;
    bool quiet;                               /* no notes and no warnings on the terminal */
    struct json_t *fault_list, *warning_list; /* where their texts are kept, too; or NULL */
} app_scene;

/* Reads, checks and builds what a word means: a scene's file or name, a mesh, "-" for standard input. Every fault is
 * printed; `loaded` is all zero but for `quiet` and the lists. Returns an exit status. */
int app_load(const char *word, const char *const *sets, app_scene *loaded);
/* Which files scenes may have read, from now on: all (of a folder that a run of skein's left), or what --allow-path names. */
void app_allow_all(void);
void app_allow(const char *const *paths);
/* The same as faults have it, with what the user set; NULL for all. `reach` has to last as long. */
const io_reach *app_reach(const char *const *sets, io_reach *reach);
/* Only looks whether it can be loaded. */
int app_try(const char *word, const char *const *sets);
void app_unload(app_scene *loaded);
/* Says what the scene will suffer from, with the remedy: a step that is not stable, rounding. To be called once it
 * stands as it will run. */
void app_advise(app_scene *loaded);
/* Says that the word means no scene. */
void app_not_found(const char *word);
/* What the option --device asks for: "cpu", "gpu", "auto" or NULL. Says on the terminal what it chose unless that is
 * plain. Returns an exit status. */
int app_device(app_scene *loaded, const char *word);
/* The name of the method's kind. */
const char *app_method(const app_scene *loaded);

/* Every exporter there is, and the view's kind where pictures are; NULL-terminated. */
const skein_kind *const *app_exporters(void);

/* The commit that it was built from, of twelve digits, with "-changed" behind it; "unknown" where git did not tell. */
extern const char app_commit[];

double app_seconds(void); /* of a clock that only goes forward */

#endif
