/* The command `skein`: one file a subcommand. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/command.h"
#include "app/terminal.h"
#include "io/own_kinds.h"

static const app_command *const commands[] = {
    &app_run_command,     &app_view_command,      &app_render_command,     &app_check_command,
    &app_compare_command, &app_stability_command, &app_explain_command,    &app_list_command,
    &app_formula_command, &app_bench_command,     &app_study_command,      &app_fit_command,
    &app_record_command,  &app_verify_command,    &app_completion_command, &app_man_command};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

const app_command *app_command_at(size_t index) {
    return index < COMMAND_COUNT ? commands[index] : NULL;
}

static void print_help(FILE *to) {
    fprintf(to, "skein " SKEIN_VERSION ": real-time particle dynamics: cloth, jelly and rope\n\n"
                "usage: skein COMMAND [ARGUMENTS]\n\n");
    for (int c = 0; c < COMMAND_COUNT; c++) {
        const char *line = commands[c]->help;
        fprintf(to, "  %-10s %.*s\n", commands[c]->name, (int)strcspn(line, "\n"), line);
    }
    fprintf(to, "\n`skein COMMAND --help` teaches a command, `skein --version` names the version. A SCENE is\n"
                "a file, a scene's name (skein run birds), a mesh (skein run shirt.obj), or - for standard input.\n\n"
                "  skein run scenes/drape.json --out out/\n"
                "  skein view scenes/flag.json\n"
                "  skein render scenes/flag.json -o flag.mp4\n"
                "  skein list colliders\n");
}

static const app_command *find_command(const char *name) {
    for (int c = 0; c < COMMAND_COUNT; c++)
        if (!strcmp(name, commands[c]->name)) return commands[c];
    return NULL;
}

static int no_command(const char *name) {
    const char *names[COMMAND_COUNT];
    char hint[IO_HINT_SIZE];
    for (int c = 0; c < COMMAND_COUNT; c++) names[c] = commands[c]->name;
    io_hint(name, names, COMMAND_COUNT, hint);
    fprintf(stderr, "skein: there is no command '%s'%s `skein --help` shows all\n", name, hint[0] ? hint : ";");
    return EXIT_FAULT;
}

static int dispatch(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : NULL;
    const app_command *command = name ? find_command(name) : NULL;
    if (command) return app_command_run(command, argc - 2, argv + 2);
    bool asked = name && (!strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help"));
    if (asked && argc > 2) { // help COMMAND
        command = find_command(argv[2]);
        return command ? app_command_run(command, 1, (char *[]){"--help", NULL}) : no_command(argv[2]);
    }
    if (!name || asked) {
        print_help(asked ? stdout : stderr);
        return asked ? EXIT_OK : EXIT_FAULT;
    }
    if (strcmp(name, "--version")) return no_command(name);
    printf("skein " SKEIN_VERSION "%s\n", sizeof(skein_real) == 8 ? " (double)" : "");
    return EXIT_OK;
}

/* Kinds of other programs', before anybody asks for one. */
static bool load_kinds(void) {
    skein_error error = {SKEIN_OK, "", ""};
    if (!io_kinds_load(getenv("SKEIN_KINDS"), &error)) return true;
    app_print_error(&error);
    return false;
}

int main(int argc, char **argv) {
    // a standard stream that is closed must not become the first file that is opened
    for (int fd = 0; fd < 3; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDWR) != fd) return EXIT_FAILURE_RUN;
    // a full disk or a closed pipe is an error to report, not the end of the process
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    app_terminal_guard();
    if (!load_kinds()) return EXIT_FAULT;
    int status = dispatch(argc, argv);
    if (!fflush(stdout) && !ferror(stdout)) return status;
    fprintf(stderr, "skein: cannot write to standard output: %s\n", strerror(errno));
    return status ? status : EXIT_FAILURE_RUN;
}
