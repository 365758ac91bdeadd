/* skein man: the manual page, made from the commands' tables. */
#include <stdio.h>
#include <string.h>

#include "app/command.h"

/* A line of troff: a dot or an apostrophe at its start, backslashes and dashes are not what they look like. */
static void print_text(const char *text, size_t length) {
    if (length && (*text == '.' || *text == '\'')) printf("\\&");
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '\\') printf("\\e");
        else if (text[i] == '-') printf("\\-");
        else putchar(text[i]);
    }
}

static void print_line(const char *text) {
    print_text(text, strlen(text));
    printf("\n");
}

/* Paragraphs as they stand: examples are set in by blanks and keep their lines. */
static void print_help(const char *help) {
    bool kept = false;
    while (*help) {
        size_t length = strcspn(help, "\n");
        bool example = length && *help == ' ';
        if (example != kept) printf(example ? ".nf\n" : ".fi\n");
        kept = example;
        if (!length) printf(".PP\n");
        else {
            print_text(help, length);
            printf("\n");
        }
        help += length + (help[length] == '\n');
    }
    if (kept) printf(".fi\n");
}

static void print_command(const app_command *command) {
    printf(".SS ");
    print_line(command->name);
    printf(".B skein %s\n", command->name);
    print_line(command->usage);
    printf(".PP\n");
    print_help(command->help);
    for (const app_option *o = command->options; o && o->name; o++) {
        printf(".TP\n.B ");
        print_text(o->name, strlen(o->name));
        if (o->argument) {
            printf(" ");
            print_text(o->argument, strlen(o->argument));
        }
        printf("\n");
        print_line(o->help);
    }
}

static int man(app_arguments *arguments) {
    (void)arguments;
    printf(".TH SKEIN 1 \"\" \"skein " SKEIN_VERSION "\" \"User Commands\"\n"
           ".SH NAME\nskein \\- real\\-time particle dynamics: cloth, jelly, rope and flocks\n"
           ".SH SYNOPSIS\n.B skein\n.I command\n[\\fIarguments\\fR]\n"
           ".SH DESCRIPTION\n"
           "Everything is particles under rules, and a method that turns rules into motion. A\n"
           ".I SCENE\n"
           "is a file, the name of one that came with skein (birds), a mesh (shirt.obj), or \\- for standard input.\n"
           "Every command prints its options for\n.BR \\-\\-help .\n"
           ".SH COMMANDS\n");
    for (size_t c = 0; app_command_at(c); c++) print_command(app_command_at(c));
    printf(
        ".SH ENVIRONMENT\n"
        ".TP\n.B SKEIN_SCENES\nthe folder of the scenes that have names, instead of those that came with skein\n"
        ".TP\n.B SKEIN_KINDS\nshared objects with kinds of one's own, separated by colons: they are listed and scenes name "
        "them as any other\n"
        ".TP\n.B SKEIN_CACHE\nthe folder where compiled formulas are kept\n"
        ".TP\n.B SKEIN_SIMD\nthe widest instruction set to use: sse, avx2 or avx512; the result is the same\n"
        ".SH EXIT STATUS\n"
        ".TP\n.B 0\ndone\n"
        ".TP\n.B 1\na run failed or ended far beyond its bounds, or a file could not be written\n"
        ".TP\n.B 2\na fault in the scene or the arguments\n"
        ".TP\n.B 130\ninterrupted: what there is was written\n");
    return EXIT_OK;
}

const app_command app_man_command = {
    "man",
    "",
    "print the manual page\n\n"
    "  skein man | man -l -\n"
    "  skein man >~/.local/share/man/man1/skein.1\n\n"
    "An installed skein has it: man skein.",
    NULL,
    NULL,
    false,
    APP_TAKES_ANY,
    man,
    NULL,
};
