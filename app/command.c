/* Options: a command's table of them, and what was given. */
#include "app/command.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app/bounds.h"

double app_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- what was given ---- */

static size_t place_of(const app_command *command, const char *name) {
    size_t place = 0;
    while (command->options && command->options[place].name && strcmp(command->options[place].name, name)) place++;
    return place;
}

static const app_option *find_option(const app_command *command, const char *name) {
    const app_option *option = command->options ? &command->options[place_of(command, name)] : NULL;
    return option && option->name ? option : NULL;
}

const char *app_word(const app_arguments *arguments) {
    return arguments->words.count ? arguments->words.values[0] : NULL;
}

const char *const *app_values(const app_arguments *arguments, const char *name) {
    return arguments->given[place_of(arguments->command, name)].values;
}

const char *app_value(const app_arguments *arguments, const char *name) {
    const app_list *list = &arguments->given[place_of(arguments->command, name)];
    return list->count ? list->values[list->count - 1] : NULL;
}

bool app_given(const app_arguments *arguments, const char *name) {
    return app_value(arguments, name) != NULL;
}

bool app_list_add(app_list *list, const char *value, bool repeats) {
    if (!repeats) list->count = 0;
    const char **grown = realloc(list->values, (list->count + 2) * sizeof *grown);
    if (!grown) return false;
    list->values = grown;
    list->values[list->count++] = value;
    list->values[list->count] = NULL;
    return true;
}

/* ---- help and faults ---- */

static void print_help(const app_command *command) {
    printf("usage: skein %s %s\n\n%s\n\nOptions\n", command->name, command->usage, command->help);
    for (const app_option *option = command->options; option && option->name; option++) {
        char left[64];
        snprintf(left, sizeof left, "%s %s", option->name, option->argument ? option->argument : "");
        printf("  %-21s %s\n", left, option->help);
    }
    printf("  %-21s %s\n", "--help", "print this");
    if (command->print_more) command->print_more();
}

/* "cpu|gpu|auto" as "cpu, gpu or auto". */
static const char *in_words(const char *choices, char *text, size_t size) {
    size_t length = 0;
    for (; *choices && length + 8 < size; choices++) {
        const char *between = *choices != '|' ? NULL : strchr(choices + 1, '|') ? ", " : " or ";
        if (between) length += (size_t)snprintf(text + length, size - length, "%s", between);
        else text[length++] = *choices;
    }
    text[length] = 0;
    return text;
}

/* The commands that have the option: "run|render|explain". False where there is none. */
static bool others_with(const char *name, char *text, size_t size) {
    size_t length = 0;
    for (size_t c = 0; app_command_at(c) && length < size; c++)
        if (find_option(app_command_at(c), name))
            length +=
                (size_t)snprintf(text + length, size - length, "%s%s", length ? "|" : "", app_command_at(c)->name);
    return length > 0;
}

/* The name that was meant, or another command that has the option, if there is either. */
static int unknown_option(const app_command *command, const char *name) {
    const char *names[APP_MOST_OPTIONS];
    char hint[IO_HINT_SIZE], others[160], words[200];
    size_t count = 0;
    // without the dashes, which all have in common
    for (const app_option *o = command->options; o && o->name; o++) names[count++] = o->name + strspn(o->name, "-");
    io_hint(name + strspn(name, "-"), names, count, hint);
    const char *meant = strchr(hint, '\''), *end = meant ? strchr(meant + 1, '\'') : NULL;
    fprintf(stderr, "skein %s: there is no option %s", command->name, name);
    if (end) fprintf(stderr, "; did you mean --%.*s?", (int)(end - meant - 1), meant + 1);
    else if (others_with(name, others, sizeof others))
        fprintf(stderr, " here, only for %s;", in_words(others, words, sizeof words));
    else fprintf(stderr, ";");
    fprintf(stderr, " `skein %s --help` shows all\n", command->name);
    return EXIT_FAULT;
}

/* ---- sorting ---- */

/* Whether the value is one of the words "cpu|gpu|auto"; any is where the argument is no list of words. */
static bool is_one_of(const char *words, const char *value) {
    size_t length = strlen(value);
    if (!strchr(words, '|')) return true;
    for (const char *at = words; at; at = strchr(at, '|')) {
        at += *at == '|';
        if (strcspn(at, "|") == length && !strncmp(at, value, length)) return true;
    }
    return false;
}

/* One option and its value: --name value or --name=value. Moves *a on. Returns -1 to go on, else an exit status. */
static int parse_option(app_arguments *arguments, int argc, char **argv, int *a) {
    char name[64];
    const app_command *command = arguments->command;
    const char *argument = argv[*a], *equals = strchr(argument, '=');
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - argument) : 63, argument);
    const app_option *option = find_option(command, name);
    if (!option) return unknown_option(command, name);
    const char *value = equals ? equals + 1 : NULL;
    if (option->argument && !value && *a + 1 < argc) value = argv[++*a];
    if (!option->argument != !value) {
        fprintf(stderr, "skein %s: %s takes %s\n", command->name, name,
                option->argument ? option->argument : "no value");
        return EXIT_FAULT;
    }
    if (value && !is_one_of(option->argument, value)) {
        char words[200];
        fprintf(stderr, "skein %s: %s %s: expected %s\n", command->name, name, value,
                in_words(option->argument, words, sizeof words));
        return EXIT_FAULT;
    }
    app_list *given = &arguments->given[option - command->options];
    return app_list_add(given, value ? value : option->name, option->repeats) ? -1 : EXIT_FAILURE_RUN;
}

/* Returns -1 to go on, else an exit status. */
static int parse(app_arguments *arguments, int argc, char **argv) {
    const app_command *command = arguments->command;
    int status = -1;
    bool only_words = false; // behind "--"
    for (int a = 0; a < argc && status < 0; a++) {
        const char *argument = argv[a];
        bool is_word = only_words || argument[0] != '-' || !argument[1];
        if (!is_word && !strcmp(argument, "--")) {
            only_words = true;
        } else if (!is_word && (!strcmp(argument, "--help") || !strcmp(argument, "-h"))) {
            print_help(command);
            status = EXIT_OK;
        } else if (!is_word) {
            status = parse_option(arguments, argc, argv, &a);
        } else if (arguments->words.count && !command->many) {
            fprintf(stderr, "skein %s: '%s' is one argument too many; usage: skein %s %s\n", command->name, argument,
                    command->name, command->usage);
            status = EXIT_FAULT;
        } else if (!app_list_add(&arguments->words, argument, true)) {
            status = EXIT_FAILURE_RUN;
        }
    }
    if (status >= 0 || arguments->words.count || !command->needed) return status;
    fprintf(stderr, "skein %s: which %s? usage: skein %s %s\n", command->name, command->needed, command->name,
            command->usage);
    return EXIT_FAULT;
}

int app_command_run(const app_command *command, int argc, char **argv) {
    app_arguments arguments = {.command = command, .argc = argc, .argv = argv};
    int status = parse(&arguments, argc, argv);
    app_allow(app_values(&arguments, "--allow-path"));
    if (status < 0) status = app_bounds_set(&arguments) ? command->run(&arguments) : EXIT_FAULT;
    status = app_bounds_end(&arguments, status);
    free(arguments.words.values);
    for (int i = 0; i < APP_MOST_OPTIONS; i++) free(arguments.given[i].values);
    return status;
}

/* ---- options for fields of the scene ---- */

static bool override_field(app_arguments *arguments, const char *name, const char *given, char text[64]) {
    const skein_field *field = skein_field_find(io_scene_kind(), name + 2, NULL);
    char *end;
    skein_value value = skein_number(strtod(given, &end));
    skein_error error = {SKEIN_ERROR_VALUE, "", ""};
    if (end == given || *end) value.count = 4; // what no field takes, so that the field says what it does take
    bool good = field && !skein_field_check(field, &value, &error);
    snprintf(text, 64, "%s=%.17g", name + 2, value.number[0]);
    if (!good) fprintf(stderr, "skein %s: %s %s: %s\n", arguments->command->name, name, given, error.message);
    return good && app_list_add(&arguments->given[place_of(arguments->command, "--set")], text, true);
}

bool app_set_first(app_arguments *arguments, const char *set) {
    app_list *sets = &arguments->given[place_of(arguments->command, "--set")];
    if (!app_list_add(sets, set, true)) return false;
    memmove(sets->values + 1, sets->values, (sets->count - 1) * sizeof *sets->values);
    sets->values[0] = set;
    return true;
}

bool app_give(app_arguments *arguments, const char *name, const char *value) {
    return app_list_add(&arguments->given[place_of(arguments->command, name)], value, false);
}

bool app_override(app_arguments *arguments, app_override_texts texts) {
    static const char *const names[] = {"--frames", "--fps", "--threads"};
    bool good = true;
    for (int i = 0; i < 3 && good; i++) {
        const char *given = find_option(arguments->command, names[i]) ? app_value(arguments, names[i]) : NULL;
        good = !given || override_field(arguments, names[i], given, texts[i]);
    }
    return good;
}

bool app_follow(app_arguments *arguments, app_follow_text text) {
    const char *given = app_value(arguments, "--follow");
    json_t *name = given ? json_string(given) : NULL;
    char *json = name ? json_dumps(name, JSON_ENCODE_ANY) : NULL;
    int length = snprintf(text, sizeof(app_follow_text), "view.camera.follow=%s", json ? json : "");
    bool good = !given || (json && length < (int)sizeof(app_follow_text));
    if (!good) fprintf(stderr, "skein %s: --follow: no body's name is as long\n", arguments->command->name);
    json_decref(name);
    free(json);
    return good && (!given || app_list_add(&arguments->given[place_of(arguments->command, "--set")], text, true));
}
