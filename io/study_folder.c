/* The folder of a study: what it is about, and its rows, each of which outlives the process that ran it.
 *
 *   study.json, scene.json     the study as it was begun; another one is refused
 *   rows.journal               the rows (io/snapshot.h), in the order in which they came; of a part, rows.3-of-40.journal
 *   table.csv, table.h5        made of the rows, in their order; timings.csv beside them
 *
 * One process writes a part's journal, under a lock that goes with it however it ends. Readers take all journals. */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "io/snapshot.h"
#include "io/study_inside.h"

enum { ROW = 1 }; /* the sort of a journal's entry */

struct io_study_folder {
    const io_study *study;
    char *path;
    char name[80]; /* of its own journal */
    size_t part, parts, missing, done;
    json_t **rows; /* a result or NULL for each */
    io_journal *journal;
    int lock;
    time_t synced;
};

/* ---- rows ---- */

/* A row that crashed is tried again. */
static bool is_done(const json_t *result) {
    const char *outcome = json_string_value(json_object_get(result, "outcome"));
    return outcome && strcmp(outcome, "crashed") != 0;
}

static bool is_of_part(const io_study_folder *f, size_t row) {
    return row % f->parts == f->part - 1;
}

static void keep_row(io_study_folder *f, const json_t *result) {
    const json_t *number = json_object_get(result, "row");
    size_t row = (size_t)json_integer_value(number);
    if (!json_is_integer(number) || row >= io_study_rows(f->study)) return;
    json_decref(f->rows[row]);
    f->rows[row] = json_incref((json_t *)(uintptr_t)result);
}

static bool take_row(void *user, uint64_t sort, const void *bytes, size_t size) {
    json_t *result = sort == ROW ? json_loadb(bytes, size, 0, NULL) : NULL;
    if (result) keep_row(user, result);
    json_decref(result);
    return true;
}

static void count(io_study_folder *f) {
    f->missing = f->done = 0;
    for (size_t row = 0; row < io_study_rows(f->study); row++)
        if (f->rows[row] && is_done(f->rows[row])) f->done++;
        else if (is_of_part(f, row)) f->missing++;
}

/* ---- opening ---- */

static char *name_in(const char *folder, const char *name) {
    size_t size = strlen(folder) + strlen(name) + 2;
    char *path = malloc(size);
    if (path) snprintf(path, size, "%s/%s", folder, name);
    return path;
}

/* Makes sure that the file has this text: writes it where there is none, and refuses another. */
static skein_status want_text(const char *folder, const char *name, const char *text, skein_error *error) {
    char *path = name_in(folder, name);
    io_bytes there = {NULL, 0};
    skein_status status = SKEIN_OK;
    if (!path) return io_error_set(error, SKEIN_ERROR_MEMORY, folder, "out of memory");
    if (!access(path, F_OK)) {
        status = io_file_read(path, IO_MOST_SCENE_BYTES, &there, error);
        if (!status && (there.size != strlen(text) || memcmp(there.data, text, there.size) != 0))
            status = io_error_set(error, SKEIN_ERROR_VALUE, path,
                                  "the folder has rows of another study than this: take another folder, or remove it");
        io_bytes_free(&there);
    } else {
        io_output *output = io_output_open(path, error);
        if (output) io_output_write(output, text, strlen(text));
        status = output ? io_output_commit(output, error) : error->status;
    }
    free(path);
    return status;
}

/* Makes a folder, and those that it lies in. */
static bool make_folders(const char *path) {
    char *part = strdup(path);
    bool good = part != NULL;
    for (size_t length = 0; good && path[length];) {
        length += strspn(path + length, "/");
        length += strcspn(path + length, "/");
        part[length] = 0;
        good = !mkdir(part, 0777) || errno == EEXIST;
        part[length] = path[length];
    }
    free(part);
    return good;
}

static bool is_journal(const char *name) {
    size_t length = strlen(name);
    return !strncmp(name, "rows.", 5) && length > 8 && !strcmp(name + length - 8, ".journal");
}

/* Reads the rows of all journals but one. */
static skein_status read_others(io_study_folder *f, const char *own, skein_error *error) {
    DIR *folder = opendir(f->path);
    skein_status status = SKEIN_OK;
    if (!folder) return io_error_set(error, SKEIN_ERROR_FILE, f->path, "cannot be read: %s", strerror(errno));
    for (struct dirent *entry; !status && (entry = readdir(folder)) != NULL;) {
        struct stat info;
        if (!is_journal(entry->d_name) || !strcmp(entry->d_name, own)) continue;
        char *path = name_in(f->path, entry->d_name);
        if (!path) status = io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
        else if (!stat(path, &info) && info.st_size >= 16) // a shorter one has been killed as it began
            status = io_journal_read(path, UINT64_MAX, take_row, f, NULL, error);
        free(path);
    }
    closedir(folder);
    return status;
}

/* Takes the part for this process alone, and reads what is there of it. */
static skein_status open_journal(io_study_folder *f, const char *name, skein_error *error) {
    char *path = name_in(f->path, name);
    uint64_t end = 0;
    struct stat info;
    skein_status status = path ? SKEIN_OK : io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
    if (!status && (f->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666)) < 0)
        status = io_error_set(error, SKEIN_ERROR_FILE, path, "cannot write: %s", strerror(errno));
    if (!status && flock(f->lock, LOCK_EX | LOCK_NB))
        status =
            io_error_set(error, SKEIN_ERROR_FILE, path, "another process is at work on %s: wait for it, or stop it",
                         f->parts > 1 ? "this part" : "this study");
    if (!status && !fstat(f->lock, &info) && info.st_size >= 16)
        status = io_journal_read(path, UINT64_MAX, take_row, f, &end, error);
    if (!status) f->journal = end ? io_journal_go_on(path, end, error) : io_journal_begin(path, error);
    if (!status && !f->journal) status = error->status;
    free(path);
    return status;
}

io_study_folder *io_study_folder_open(const io_study *study, const char *path, size_t part, size_t parts,
                                      skein_error *error) {
    io_study_folder *f = calloc(1, sizeof *f);
    if (f) *f = (io_study_folder){.study = study, .name = "rows.journal", .part = part, .parts = parts, .lock = -1};
    if (f) f->path = strdup(path), f->rows = calloc(io_study_rows(study) + 1, sizeof *f->rows);
    skein_status status = SKEIN_OK;
    if (!f || !f->path || !f->rows) status = io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    else if (!make_folders(path))
        status = io_error_set(error, SKEIN_ERROR_FILE, path, "cannot be made: %s", strerror(errno));
    if (f && parts > 1) snprintf(f->name, sizeof f->name, "rows.%zu-of-%zu.journal", part, parts);
    if (!status) status = want_text(path, "scene.json", io_study_scene_text(study), error);
    if (!status) status = want_text(path, "study.json", io_study_text(study), error);
    if (!status) status = read_others(f, f->name, error);
    if (!status) status = open_journal(f, f->name, error);
    if (status) {
        io_study_folder_close(f);
        return NULL;
    }
    count(f);
    return f;
}

void io_study_folder_close(io_study_folder *f) {
    if (!f) return;
    if (f->journal) io_journal_sync(f->journal, NULL);
    io_journal_end(f->journal);
    if (f->lock >= 0) close(f->lock);
    for (size_t row = 0; f->rows && row < io_study_rows(f->study); row++) json_decref(f->rows[row]);
    free(f->rows);
    free(f->path);
    free(f);
}

/* ---- looking and adding ---- */

skein_status io_study_folder_look(io_study_folder *f, skein_error *error) {
    skein_status status = read_others(f, f->name, error);
    count(f);
    return status;
}

bool io_study_folder_has(const io_study_folder *f, size_t row) {
    return f->rows[row] && is_done(f->rows[row]);
}

size_t io_study_folder_missing(const io_study_folder *f) {
    return f->missing;
}

size_t io_study_folder_done(const io_study_folder *f) {
    return f->done;
}

size_t io_study_folder_next(const io_study_folder *f, size_t row) {
    for (; row < io_study_rows(f->study); row++)
        if (is_of_part(f, row) && !io_study_folder_has(f, row)) return row;
    return SIZE_MAX;
}

const json_t *io_study_folder_row(const io_study_folder *f, size_t row) {
    return f->rows[row];
}

int io_study_folder_lock(const io_study_folder *f) {
    return f->lock;
}

skein_status io_study_folder_add(io_study_folder *f, const json_t *result, skein_error *error) {
    char *text = json_dumps(result, JSON_COMPACT | JSON_REAL_PRECISION(17));
    if (!text) return io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
    skein_status status = io_journal_add(f->journal, ROW, text, strlen(text), error);
    // against a power cut now and then: many rows a second would wait for the disk
    if (!status && time(NULL) - f->synced >= 2) {
        status = io_journal_sync(f->journal, error);
        f->synced = time(NULL);
    }
    free(text);
    if (status) return status;
    size_t row = (size_t)json_integer_value(json_object_get(result, "row"));
    bool was_done = io_study_folder_has(f, row);
    keep_row(f, result);
    if (was_done || !io_study_folder_has(f, row)) return SKEIN_OK;
    f->done++;
    f->missing -= is_of_part(f, row);
    return SKEIN_OK;
}

/* ---- tables ---- */

/* Removes what processes that are gone have left half written ("table.csv.PID.part"). */
static void remove_parts(const char *path) {
    DIR *folder = opendir(path);
    for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length < 6 || strcmp(entry->d_name + length - 5, ".part") != 0) continue;
        size_t at = length - 5;
        while (at && strchr("0123456789", entry->d_name[at - 1])) at--;
        long pid = strtol(entry->d_name + at, NULL, 10);
        bool ours = !strncmp(entry->d_name, "table.", 6) || !strncmp(entry->d_name, "timings.", 8) ||
                    !strncmp(entry->d_name, "plot.", 5);
        if (!ours || pid <= 0 || !kill((pid_t)pid, 0) || errno != ESRCH) continue;
        char *name = name_in(path, entry->d_name);
        if (name) unlink(name);
        free(name);
    }
    if (folder) closedir(folder);
}

skein_status io_study_folder_tables(const io_study_folder *f, skein_error *error) {
    if (f->done == io_study_rows(f->study)) remove_parts(f->path);
    return io_study_write_tables(f->study, f->rows, f->path, error);
}
