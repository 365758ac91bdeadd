/* Running the built command as its users do: a process of its own, its words and its exit status.
 *
 * Owns a temporary folder for each test (setup, teardown). Every process has a limit of time, so that a
 * command that hangs fails its test. */
#ifndef SKEIN_TEST_COMMAND_H
#define SKEIN_TEST_COMMAND_H

#define _GNU_SOURCE // nftw and pseudo terminals
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <jansson.h>

#include "io/file.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

/* ---- The temporary folder ------------------------------------------------------------------------ */

static char folder[64];

static inline int make_folder(void **state) {
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/skein-command-XXXXXX");
    return mkdtemp(folder) && !chdir(SKEIN_SOURCE_DIR) ? 0 : -1;
}

static inline int remove_entry(const char *path, const struct stat *info, int type, struct FTW *place) {
    (void)info, (void)type, (void)place;
    return remove(path);
}

static inline int remove_folder(void **state) {
    (void)state;
    return nftw(folder, remove_entry, 8, FTW_DEPTH | FTW_PHYS);
}

/* A path in the folder; good for the next hundred calls. */
static inline char *in_folder(const char *name) {
    static char paths[100][512];
    static int turn;
    char *path = paths[turn++ % 100];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static inline bool exists(const char *path) {
    struct stat info;
    return stat(path, &info) == 0;
}

/* Entries of a folder but for "." and "..". */
static inline int count_entries(const char *path) {
    DIR *open_folder = opendir(path);
    assert_non_null(open_folder);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(open_folder)) != NULL;)
        count += strcmp(entry->d_name, ".") && strcmp(entry->d_name, "..");
    closedir(open_folder);
    return count;
}

static inline void write_text(const char *path, const char *text) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* A file's text, to be freed. */
static inline char *read_text(const char *path) {
    io_bytes bytes;
    skein_error error = {SKEIN_OK, "", ""};
    if (io_file_read(path, (size_t)1 << 30, &bytes, &error)) {
        fprintf(stderr, "%s: %s\n", error.where, error.message);
        fail();
    }
    return bytes.data;
}

/* ---- Processes ------------------------------------------------------------------------------------ */

typedef struct outcome {
    int status;      /* the exit status; minus the signal's number for a process that one ended */
    char *out, *err; /* what it said; freed by outcome_free */
} outcome;

/* What a child finds besides its arguments. */
typedef struct surroundings {
    rlim_t file_limit; /* bytes, 0: none */
    int out;           /* a descriptor for its standard output, 0: caught */
    int err;           /* the same for its standard error */
} surroundings;

static inline int caught(const char *name) {
    int fd = open(in_folder(name), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    assert_true(fd >= 0);
    return fd;
}

/* Starts skein with arguments up to NULL. */
static inline pid_t start_skein(surroundings around, const char *const *arguments) {
    int out = around.out ? around.out : caught(".out"), err = around.err ? around.err : caught(".err");
    char *list[32] = {(char *)(uintptr_t)SKEIN_COMMAND};
    for (size_t i = 0; arguments[i]; i++) {
        assert_true(i + 2 < COUNT(list));
        list[i + 1] = (char *)(uintptr_t)arguments[i];
    }
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct rlimit limit = {around.file_limit, around.file_limit};
        alarm(200);
        bool good = dup2(out, 1) == 1 && dup2(err, 2) == 2 && (!around.file_limit || !setrlimit(RLIMIT_FSIZE, &limit));
        if (good) execv(SKEIN_COMMAND, list);
        _exit(127);
    }
    if (!around.out) close(out);
    if (!around.err) close(err);
    return child;
}

static inline outcome finish_skein(pid_t child) {
    int status;
    while (waitpid(child, &status, 0) < 0) assert_int_equal(errno, EINTR);
    return (outcome){WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
                     exists(in_folder(".out")) ? read_text(in_folder(".out")) : strdup(""),
                     exists(in_folder(".err")) ? read_text(in_folder(".err")) : strdup("")};
}

static inline void outcome_free(outcome *o) {
    free(o->out);
    free(o->err);
}

#define SKEIN(...) finish_skein(start_skein((surroundings){0}, (const char *const[]){__VA_ARGS__, NULL}))
#define SKEIN_IN(around_, ...) finish_skein(start_skein((around_), (const char *const[]){__VA_ARGS__, NULL}))

/* ---- Judging ---------------------------------------------------------------------------------------- */

static inline void check_status(const outcome *o, int status, const char *file, int line) {
    if (o->status == status) return;
    fprintf(stderr, "exit status %d, expected %d; it said:\n%s%s", o->status, status, o->out, o->err);
    _assert_int_equal((LargestIntegralType)o->status, (LargestIntegralType)status, file, line);
}
#define assert_status(outcome_, status_) check_status(&(outcome_), (status_), __FILE__, __LINE__)

static inline void check_contains(const char *text, const char *part, const char *file, int line) {
    if (strstr(text, part)) return;
    fprintf(stderr, "this has no '%s':\n%s", part, text);
    _assert_true(0, part, file, line);
}
#define assert_contains(text_, part_) check_contains((text_), (part_), __FILE__, __LINE__)

/* Runs the arguments and compares all that is said. */
#define assert_says(status_, out_, err_, ...)                                                                                  \
    do {                                                                                                                       \
        outcome said_ = SKEIN(__VA_ARGS__);                                                                                    \
        assert_string_equal(said_.err, (err_));                                                                                \
        assert_string_equal(said_.out, (out_));                                                                                \
        assert_status(said_, (status_));                                                                                       \
        outcome_free(&said_);                                                                                                  \
    } while (0)

#endif
