/* skein completion SHELL: what completes its command line, made from the commands' tables.
 *
 * Names of scenes and kinds are asked for when they are completed (skein completion scenes, kinds), so that they are
 * those that are there then. */
#include <stdio.h>
#include <string.h>

#include "app/command.h"

/* ---- words that are asked for ---- */

static int print_scenes(void) {
    enum { MOST = 1024 };
    static char names[MOST][IO_SCENE_NAME_SIZE];
    size_t count = io_scene_names(names, MOST);
    for (size_t i = 0; i < count; i++) puts(names[i]);
    return EXIT_OK;
}

static int print_kinds(void) {
    for (size_t i = 0; app_list_word(i); i++) puts(app_list_word(i));
    return EXIT_OK;
}

/* The text with what a shell's single quotes would end at left out: help is words only. */
static void print_plain(const char *text) {
    for (; *text && *text != '\n'; text++)
        if (!strchr("'\"\\[]`$:", *text)) putchar(*text);
}

static bool is_choice(const app_option *option) {
    return option->argument && strchr(option->argument, '|');
}

/* "cpu|gpu|auto" with blanks. */
static void print_choices(const char *choices) {
    for (; *choices; choices++) putchar(*choices == '|' ? ' ' : *choices);
}

/* ---- bash ---- */

static void print_bash_command(const app_command *command) {
    printf("        %s)\n            options='--help", command->name);
    for (const app_option *o = command->options; o && o->name; o++) printf(" %s", o->name);
    printf("'\n");
    bool any = false;
    for (const app_option *o = command->options; o && o->name; o++) {
        if (!o->argument) continue;
        if (!any) printf("            case $previous in\n");
        any = true;
        printf("                %s) ", o->name);
        if (is_choice(o)) {
            printf("_skein_words '");
            print_choices(o->argument);
            printf("'; return ;;\n");
        } else if (o->takes == APP_TAKES_FILE) printf("_skein_files; return ;;\n");
        else if (o->takes == APP_TAKES_FOLDER) printf("_skein_folders; return ;;\n");
        else printf("COMPREPLY=(); return ;;\n");
    }
    if (any) printf("            esac\n");
    if (command->takes == APP_TAKES_SCENE)
        printf("            words=\"$(skein completion scenes 2>/dev/null)\" files=yes\n");
    if (command->takes == APP_TAKES_KIND) printf("            words=\"$(skein completion kinds 2>/dev/null)\"\n");
    if (command->takes == APP_TAKES_SHELL) printf("            words='bash zsh fish'\n");
    printf("            ;;\n");
}

static int print_bash(void) {
    printf(
        "# Completes skein in bash: source it, or put it where bash-completion looks. Made by `skein completion bash`.\n"
        "_skein_words() { COMPREPLY=($(compgen -W \"$1\" -- \"$current\")); }\n"
        "_skein_files() { compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -f -- \"$current\")); }\n"
        "_skein_folders() { compopt -o filenames 2>/dev/null; COMPREPLY=($(compgen -d -- \"$current\")); }\n"
        "_skein() {\n"
        "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} options='' words='' files=''\n"
        "    COMPREPLY=()\n"
        "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
        "        _skein_words 'help --help --version");
    for (size_t c = 0; app_command_at(c); c++) printf(" %s", app_command_at(c)->name);
    printf("'\n        return\n    fi\n    case ${COMP_WORDS[1]} in\n");
    for (size_t c = 0; app_command_at(c); c++) print_bash_command(app_command_at(c));
    printf("        help) words='");
    for (size_t c = 0; app_command_at(c); c++) printf("%s%s", c ? " " : "", app_command_at(c)->name);
    printf("' ;;\n"
           "    esac\n"
           "    case $current in\n"
           "        -*) _skein_words \"$options\" ;;\n"
           "        *)\n"
           "            _skein_words \"$words\"\n"
           "            if [ -n \"$files\" ]; then\n"
           "                compopt -o filenames 2>/dev/null\n"
           "                COMPREPLY+=($(compgen -f -- \"$current\"))\n"
           "            fi\n"
           "            ;;\n"
           "    esac\n"
           "}\n"
           "complete -F _skein skein\n");
    return EXIT_OK;
}

/* ---- zsh ---- */

static void print_zsh_command(const app_command *command) {
    printf("        %s)\n            _arguments -S '--help[print this]'", command->name);
    for (const app_option *o = command->options; o && o->name; o++) {
        printf(" \\\n                '%s%s[", o->repeats ? "*" : "", o->name);
        print_plain(o->help);
        printf("]");
        if (is_choice(o)) {
            printf(":word:(");
            print_choices(o->argument);
            printf(")");
        } else if (o->argument) {
            printf(":%s:%s", o->argument,
                   o->takes == APP_TAKES_FILE     ? "_files"
                   : o->takes == APP_TAKES_FOLDER ? "_files -/"
                                                  : " ");
        }
        printf("'");
    }
    if (command->takes == APP_TAKES_SCENE)
        printf(" \\\n                '*:scene:{ _alternative \"scenes:scene:($(skein completion scenes 2>/dev/null))\" "
               "\"files:file:_files\" }'");
    if (command->takes == APP_TAKES_KIND)
        printf(" \\\n                ':kind:{ _values kind $(skein completion kinds 2>/dev/null) }'");
    if (command->takes == APP_TAKES_SHELL) printf(" \\\n                ':shell:(bash zsh fish)'");
    printf("\n            ;;\n");
}

static int print_zsh(void) {
    printf("#compdef skein\n"
           "# Completes skein in zsh: put it as _skein into a folder of $fpath. Made by `skein completion zsh`.\n"
           "_skein() {\n"
           "    local -a commands=(\n");
    for (size_t c = 0; app_command_at(c); c++) {
        printf("        '%s:", app_command_at(c)->name);
        print_plain(app_command_at(c)->help);
        printf("'\n");
    }
    printf("    )\n"
           "    if (( CURRENT == 2 )); then\n"
           "        _describe command commands\n"
           "        return\n"
           "    fi\n"
           "    local command=$words[2]\n"
           "    shift words\n"
           "    (( CURRENT-- ))\n"
           "    case $command in\n");
    for (size_t c = 0; app_command_at(c); c++) print_zsh_command(app_command_at(c));
    printf("        help) _describe command commands ;;\n"
           "    esac\n"
           "}\n"
           "if [ \"$funcstack[1]\" = _skein ]; then _skein \"$@\"; else compdef _skein skein; fi\n");
    return EXIT_OK;
}

/* ---- fish ---- */

static void print_fish_command(const app_command *command) {
    const char *name = command->name;
    printf("complete -c skein -n __fish_use_subcommand -a %s -d '", name);
    print_plain(command->help);
    printf("'\n");
    for (const app_option *o = command->options; o && o->name; o++) {
        const char *bare = o->name + strspn(o->name, "-");
        printf("complete -c skein -n '__fish_seen_subcommand_from %s' -%s %s -d '", name, o->name[1] == '-' ? "l" : "s",
               bare);
        print_plain(o->help);
        printf("'");
        if (is_choice(o)) {
            printf(" -x -a '");
            print_choices(o->argument);
            printf("'");
        } else if (o->argument) {
            printf(o->takes == APP_TAKES_FILE     ? " -r"
                   : o->takes == APP_TAKES_FOLDER ? " -x -a '(__fish_complete_directories)'"
                                                  : " -x");
        }
        printf("\n");
    }
    if (command->takes == APP_TAKES_SCENE)
        printf("complete -c skein -n '__fish_seen_subcommand_from %s' -F -a '(skein completion scenes 2>/dev/null)'\n",
               name);
    if (command->takes == APP_TAKES_KIND)
        printf("complete -c skein -n '__fish_seen_subcommand_from %s' -a '(skein completion kinds 2>/dev/null)'\n",
               name);
    if (command->takes == APP_TAKES_SHELL)
        printf("complete -c skein -n '__fish_seen_subcommand_from %s' -a 'bash zsh fish'\n", name);
}

static int print_fish(void) {
    printf("# Completes skein in fish. Made by `skein completion fish`.\ncomplete -c skein -f\n");
    for (size_t c = 0; app_command_at(c); c++) print_fish_command(app_command_at(c));
    return EXIT_OK;
}

/* ---- the command ---- */

static int completion(app_arguments *arguments) {
    static const struct {
        const char *word;
        int (*print)(void);
    } all[] = {{"bash", print_bash},
               {"zsh", print_zsh},
               {"fish", print_fish},
               {"scenes", print_scenes},
               {"kinds", print_kinds}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        if (!strcmp(app_word(arguments), all[i].word)) return all[i].print();
    fprintf(stderr, "skein completion: '%s': expected bash, zsh or fish\n", app_word(arguments));
    return EXIT_FAULT;
}

const app_command app_completion_command = {
    "completion",
    "bash|zsh|fish",
    "print what completes skein's command line in a shell\n\n"
    "  source <(skein completion bash)             for this session; the same in zsh\n"
    "  skein completion fish | source\n\n"
    "An installed skein has put it where the shells look. Besides options it completes the names of scenes and kinds.",
    NULL,
    "shell",
    false,
    APP_TAKES_SHELL,
    completion,
    NULL,
};
