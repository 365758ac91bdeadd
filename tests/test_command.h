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
#include "io/mesh.h"
#include "io/pc2.h"
#include "sparing.h"

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

/* Writes JSON that has ' in the place of ". */
static inline void write_scene(const char *path, const char *text) {
    char *copy = strdup(text);
    for (char *at = copy; (at = strchr(at, '\'')) != NULL;) *at = '"';
    write_text(path, copy);
    free(copy);
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
    const char *in;    /* a file for its standard input, NULL: ours */
    const char *fail;  /* what failing/interpose.c is to make fail, NULL: it is not there */
} surroundings;

static inline int caught(const char *name) {
    int fd = open(in_folder(name), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    assert_true(fd >= 0);
    return fd;
}

#ifndef SKEIN_INTERPOSER
#define SKEIN_INTERPOSER "" /* only for the test that has one */
#endif

#ifndef SKEIN_COMMAND_SECONDS
#define SKEIN_COMMAND_SECONDS 200 /* then a process that hangs is ended */
#endif

/* Starts skein with arguments up to NULL. */
static inline pid_t start_skein(surroundings around, const char *const *arguments) {
    int out = around.out ? around.out : caught(".out"), err = around.err ? around.err : caught(".err");
    char *list[256] = {(char *)(uintptr_t)SKEIN_COMMAND};
    for (size_t i = 0; arguments[i]; i++) {
        assert_true(i + 2 < COUNT(list));
        list[i + 1] = (char *)(uintptr_t)arguments[i];
    }
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct rlimit limit = {around.file_limit, around.file_limit};
        alarm(SKEIN_COMMAND_SECONDS);
        if (around.fail) {
            setenv("SKEIN_FAIL", around.fail, 1);
            setenv("SKEIN_FAIL_LOG", in_folder(".calls"), 1);
            setenv("LD_PRELOAD", SKEIN_INTERPOSER, 1);
        }
        int in = around.in ? open(around.in, O_RDONLY) : STDIN_FILENO;
        bool good = dup2(in, 0) == 0 && dup2(out, 1) == 1 && dup2(err, 2) == 2 &&
                    (!around.file_limit || !setrlimit(RLIMIT_FSIZE, &limit));
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

static inline int longest_line(const char *text) {
    int longest = 0;
    for (; *text; text += strcspn(text, "\n"), text += *text == '\n')
        if ((int)strcspn(text, "\n") > longest) longest = (int)strcspn(text, "\n");
    return longest;
}

/* Runs the arguments and compares all that is said. */
#define assert_says(status_, out_, err_, ...)   \
    do {                                        \
        outcome said_ = SKEIN(__VA_ARGS__);     \
        assert_string_equal(said_.err, (err_)); \
        assert_string_equal(said_.out, (out_)); \
        assert_status(said_, (status_));        \
        outcome_free(&said_);                   \
    } while (0)

/* ---- Files that a run leaves -------------------------------------------------------------------------- */

static inline json_t *read_report(const char *path) {
    json_error_t error;
    json_t *report = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!report) fail_msg("%s:%d: %s", path, error.line, error.text);
    return report;
}

static inline double number_of(const json_t *report, const char *key) {
    const json_t *value = json_object_get(report, key);
    if (!json_is_number(value)) fail_msg("the report has no number '%s'", key);
    return json_number_value(value);
}

static inline const char *text_of(const json_t *report, const char *key) {
    const char *text = json_string_value(json_object_get(report, key));
    if (!text) fail_msg("the report has no text '%s'", key);
    return text;
}

/* What a body of a scene must look like in files. */
typedef struct shape {
    size_t vertex_count, face_count;
    uint32_t *corners; /* of all faces, in order */
    size_t corner_count;
} shape;

static inline shape shape_of_grid(uint32_t rows, uint32_t columns) {
    shape s = {rows * columns, (rows - 1) * (columns - 1), malloc(4 * rows * columns * sizeof *s.corners), 0};
    for (uint32_t r = 0; r + 1 < rows; r++)
        for (uint32_t c = 0; c + 1 < columns; c++) {
            uint32_t a = r * columns + c, quad[] = {a, a + columns, a + columns + 1, a + 1};
            for (int k = 0; k < 4; k++) s.corners[s.corner_count++] = quad[k];
        }
    return s;
}

static inline shape shape_of_mesh(const char *path) {
    io_mesh mesh;
    assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, NULL), SKEIN_OK);
    shape s = {mesh.vertex_count, mesh.face_count, malloc(mesh.face_vertex_count * sizeof *s.corners),
               mesh.face_vertex_count};
    memcpy(s.corners, mesh.face_vertices, mesh.face_vertex_count * sizeof *s.corners);
    io_mesh_free(&mesh);
    return s;
}

/* The OBJ has the input's vertices and faces in their order, the PC2 a sample of each frame, and its last one
 * is the OBJ. */
static inline void judge_files(const char *path_without_ending, const shape *s, uint32_t samples) {
    char path[700];
    skein_error error;
    io_mesh mesh;
    io_pc2_header header;
    snprintf(path, sizeof path, "%s.obj", path_without_ending);
    assert_int_equal(io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error), SKEIN_OK);
    assert_int_equal(mesh.vertex_count, s->vertex_count);
    assert_int_equal(mesh.face_count, s->face_count);
    assert_int_equal(mesh.face_vertex_count, s->corner_count);
    assert_memory_equal(mesh.face_vertices, s->corners, s->corner_count * sizeof *s->corners);

    snprintf(path, sizeof path, "%s.pc2", path_without_ending);
    io_pc2_reader *reader = io_pc2_open(path, &header, &error);
    assert_non_null(reader);
    assert_int_equal(header.points, s->vertex_count);
    assert_int_equal(header.samples, samples);
    assert_true(header.start == 0);
    double *positions = malloc(3 * s->vertex_count * sizeof *positions);
    assert_int_equal(io_pc2_read(reader, samples - 1, positions, &error), SKEIN_OK);
    for (size_t i = 0; i < 3 * s->vertex_count; i++) assert_true((float)positions[i] == (float)mesh.positions[i]);
    free(positions);
    io_pc2_close(reader);
    io_mesh_free(&mesh);
}

/* ---- A small scene ------------------------------------------------------------------------------------- */

static const char tiny[] = "{ 'name': 'my scene/1', 'frames': 4, 'output': ['obj', 'pc2'],\n"
                           "  'bodies': [ { 'type': 'cloth', 'name': 'sheet', 'grid': [5, 5], 'pins': 'corners' },\n"
                           "    { 'type': 'cloth', 'grid': [3, 3], 'position': [0, 1, 0] } ],\n"
                           "  'forces': [ { 'type': 'gravity', 'name': 'weight' } ],\n"
                           "  'colliders': [ { 'type': 'sphere', 'name': 'ball', 'centre': [0, -0.6, 0] } ] }\n";

static inline const char *tiny_scene(void) {
    static char path[512];
    snprintf(path, sizeof path, "%s/tiny.json", folder);
    write_scene(path, tiny);
    return path;
}

/* The hash of a run's end; the outcome is expected to be good. */
static inline uint64_t hash_of(outcome o) {
    const char *words = strstr(o.out, "state hash ");
    assert_status(o, 0);
    assert_non_null(words);
    uint64_t hash = strtoull(words + strlen("state hash "), NULL, 16);
    assert_true(hash != 0);
    outcome_free(&o);
    return hash;
}

#endif
