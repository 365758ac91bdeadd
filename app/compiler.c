/* Finding the C compiler, and running it. */
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/compile.h"

extern char **environ;

/* The arithmetic's flags are the library's own (CMakeLists.txt): without them the bits would be others. */
static const char *const flags[] = {"-std=gnu17",
                                    "-O3",
#ifdef __x86_64__
                                    "-march=native",
#else
                                    "-mcpu=native",
#endif
                                    "-ffp-contract=off",
                                    "-fno-math-errno",
                                    "-Wno-psabi",
                                    "-fPIC",
                                    "-shared",
#ifdef SKEIN_DOUBLE
                                    "-DSKEIN_DOUBLE",
#endif
                                    NULL};

const char *app_compiler_flags(void) {
    static char all[256];
    if (!all[0])
        for (size_t i = 0; flags[i]; i++) strcat(strcat(all, flags[i]), " ");
    return all;
}

/* ---- finding ---- */

/* Whether a shell would find it. */
static bool can_run(const char *name) {
    if (strchr(name, '/')) return !access(name, X_OK);
    const char *path = getenv("PATH");
    for (path = path ? path : "/usr/bin:/bin"; *path; path += strcspn(path, ":"), path += *path == ':') {
        char at[4096];
        int length = (int)strcspn(path, ":");
        snprintf(at, sizeof at, "%.*s/%s", length, length ? path : ".", name);
        if (!access(at, X_OK)) return true;
    }
    return false;
}

bool app_compiler_find(app_compiler *c) {
    static const char *const usual[] = {"cc", "gcc", "clang"};
    const char *asked = getenv("CC");
    *c = (app_compiler){.text = ""};
    if (asked && asked[0]) {
        size_t count = 0;
        snprintf(c->text, sizeof c->text, "%s", asked);
        c->arguments[0] = c->text;
        if (can_run(c->text)) return true; // one with blanks in its path
        for (char *word = strtok(c->text, " \t"); word && count < 32; word = strtok(NULL, " \t"))
            c->arguments[count++] = word; // or one with options, or a launcher
        c->arguments[count] = NULL;
        return count && can_run(c->arguments[0]);
    }
    for (size_t i = 0; i < sizeof usual / sizeof *usual; i++) {
        c->arguments[0] = usual[i];
        if (can_run(usual[i])) return true;
    }
    return false;
}

/* ---- running ---- */

/* The first lines of a file, indented. */
static void read_words(const char *path, char *words, size_t size) {
    FILE *file = fopen(path, "r");
    size_t length = strlen(words);
    char line[400];
    for (int i = 0; i < 4 && file && fgets(line, sizeof line, file); i++) {
        line[strcspn(line, "\n")] = '\0';
        length += (size_t)snprintf(words + length, length < size ? size - length : 0, "\n    %.200s", line);
        if (length >= size) break;
    }
    if (file) fclose(file);
}

bool app_compiler_run(const app_compiler *c, const char *folder, char *words, size_t size) {
    char include[2100], source[2100], out[2100], log[2100];
    char *arguments[128];
    size_t count = 0;
    snprintf(include, sizeof include, "-I%s", folder);
    snprintf(source, sizeof source, "%s/formula.c", folder);
    snprintf(out, sizeof out, "%s/formula.so", folder);
    snprintf(log, sizeof log, "%s/formula.log", folder);
    for (size_t i = 0; c->arguments[i]; i++) arguments[count++] = (char *)(uintptr_t)c->arguments[i];
    for (size_t i = 0; flags[i]; i++) arguments[count++] = (char *)(uintptr_t)flags[i];
    char *const rest[] = {include, (char[]){"-o"}, out, source};
    for (size_t i = 0; i < sizeof rest / sizeof *rest; i++) arguments[count++] = rest[i];
    arguments[count] = NULL;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    posix_spawnattr_t attributes; // an interruption is held back here, but the compiler is to hear it
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    pid_t child;
    int status = 0, failure = posix_spawnp(&child, arguments[0], &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (failure) {
        snprintf(words, size, "%s: %s", arguments[0], strerror(failure));
        return false;
    }
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    if (WIFEXITED(status) && !WEXITSTATUS(status) && !access(out, R_OK)) return true;
    snprintf(words, size, "%s failed (%s %d)", arguments[0], WIFSIGNALED(status) ? "signal" : "status",
             WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status));
    read_words(log, words, size);
    return false;
}
