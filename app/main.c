/* The command `skein`: one file a subcommand. */
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "app/command.h"

static const app_command *const commands[] = {&app_run_command, &app_check_command, &app_explain_command, &app_list_command};
enum { COMMAND_COUNT = sizeof commands / sizeof *commands };

static void print_help(FILE *to) {
    fprintf(to, "skein " SKEIN_VERSION ": real-time particle dynamics: cloth, jelly, rope and flocks\n\n"
                "usage: skein COMMAND [ARGUMENTS]\n\n");
    for (int c = 0; c < COMMAND_COUNT; c++) {
        const char *line = commands[c]->help;
        fprintf(to, "  %-8s %.*s\n", commands[c]->name, (int)strcspn(line, "\n"), line);
    }
    fprintf(to, "\n`skein COMMAND --help` teaches a command. First steps:\n\n"
                "  skein run scenes/drape.json --out out/\n"
                "  skein list colliders\n");
}

int main(int argc, char **argv) {
    // a full disk or a closed pipe is an error to report, not the end of the process
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    const char *name = argc > 1 ? argv[1] : "";
    for (int c = 0; c < COMMAND_COUNT; c++)
        if (!strcmp(name, commands[c]->name)) return commands[c]->run(argc - 2, argv + 2);
    if (!strcmp(name, "--version")) {
        printf("skein " SKEIN_VERSION "%s\n", sizeof(skein_real) == 8 ? " (double)" : "");
        return EXIT_OK;
    }
    bool asked = !strcmp(name, "--help") || !strcmp(name, "-h") || !strcmp(name, "help");
    if (!asked && name[0]) fprintf(stderr, "skein: there is no command '%s'\n\n", name);
    print_help(asked ? stdout : stderr);
    return asked ? EXIT_OK : EXIT_FAULT;
}
