/* Studies for Python: rows of a study, run from any of its threads, and the folder that keeps them.
 *
 * Owns: a py_study, the study with its folder, if it has one, and the wish to stop. skein/_studies.py is the only caller;
 * of it only py_study_run() may be called from several threads at once. */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "io/study.h"
#include "render/view.h"

#define EXPORT __attribute__((visibility("default")))

typedef struct py_study {
    io_study *study;
    io_study_folder *folder;
    atomic_bool stopped;
} py_study;

typedef void (*py_report)(void *user, int status, const char *where, const char *message);
typedef struct hearer {
    py_report report;
    void *user;
} hearer;

EXPORT py_study *py_study_open(const char *text, size_t size, const char *path, py_report report, void *user);
EXPORT char *py_study_describe(const py_study *study);
EXPORT char *py_study_run(py_study *study, size_t row, int threads);
EXPORT void py_study_stop(py_study *study);
EXPORT bool py_study_keep(py_study *study, const char *folder, py_report report, void *user);
EXPORT char *py_study_row(const py_study *study, size_t row);
EXPORT bool py_study_add(py_study *study, const char *result, py_report report, void *user);
EXPORT bool py_study_tables(py_study *study, py_report report, void *user);
EXPORT void py_study_free(py_study *study);

static void pass_fault(void *user, const skein_error *error) {
    const hearer *to = user;
    to->report(to->user, (int)error->status, error->where, error->message);
}

static const skein_kind *const *kinds(void) {
    static const skein_kind *all[2];
    all[0] = render_view_kind();
    return all;
}

/* Reads a study; NULL after faults. */
py_study *py_study_open(const char *text, size_t size, const char *path, py_report report, void *user) {
    hearer to = {report, user};
    io_faults faults = {pass_fault, &to, 0, NULL};
    py_study *study = calloc(1, sizeof *study);
    if (study) study->study = io_study_read_text(text, size, path, kinds(), &faults);
    if (study && study->study) return study;
    free(study);
    return NULL;
}

/* Its name, rows, varied paths and measures, as JSON to be freed. */
char *py_study_describe(const py_study *study) {
    const char *name;
    json_t *varied = json_array(), *measures = json_array();
    for (size_t v = 0; (name = io_study_varied(study->study, v)) != NULL; v++)
        json_array_append_new(varied, json_string(name));
    for (size_t m = 0; (name = io_study_measure(study->study, m)) != NULL; m++)
        json_array_append_new(measures, json_string(name));
    json_t *json = json_pack("{s:s, s:I, s:o, s:o}", "name", io_study_name(study->study), "rows",
                             (json_int_t)io_study_rows(study->study), "varied", varied, "measures", measures);
    char *text = json_dumps(json, JSON_COMPACT);
    json_decref(json);
    return text;
}

static bool go_on(void *user) {
    return !atomic_load(&((py_study *)user)->stopped);
}

/* A result with the row's values and command, as JSON to be freed. */
static char *whole(const py_study *study, json_t *result, size_t row) {
    json_t *values = json_array();
    char *command = io_study_command(study->study, row);
    for (size_t v = 0; io_study_varied(study->study, v); v++)
        json_array_append_new(values, io_study_value(study->study, row, v));
    json_object_set_new(result, "values", values);
    json_object_set_new(result, "command", json_string(command ? command : ""));
    free(command);
    char *text = json_dumps(result, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(result);
    return text;
}

/* Runs a row; NULL without memory. */
char *py_study_run(py_study *study, size_t row, int threads) {
    json_t *result = io_study_run(study->study, row, threads, go_on, study);
    return result ? whole(study, result, row) : NULL;
}

/* Asks all rows that are under way to end. */
void py_study_stop(py_study *study) {
    atomic_store(&study->stopped, true);
}

/* From here on rows are kept in a folder, and those that are there count. */
bool py_study_keep(py_study *study, const char *folder, py_report report, void *user) {
    hearer to = {report, user};
    skein_error error = {SKEIN_OK, "", ""};
    study->folder = io_study_folder_open(study->study, folder, 1, 1, &error);
    if (!study->folder) pass_fault(&to, &error);
    return study->folder != NULL;
}

/* A row that is in the folder; NULL where it is to be run. */
char *py_study_row(const py_study *study, size_t row) {
    if (!study->folder || !io_study_folder_has(study->folder, row)) return NULL;
    return whole(study, json_deep_copy(io_study_folder_row(study->folder, row)), row);
}

/* Keeps what py_study_run() has given. */
bool py_study_add(py_study *study, const char *result, py_report report, void *user) {
    hearer to = {report, user};
    skein_error error = {SKEIN_ERROR_MEMORY, "study", "out of memory"};
    json_t *json = json_loads(result, 0, NULL);
    json_object_del(json, "values");
    json_object_del(json, "command");
    bool good = json && !io_study_folder_add(study->folder, json, &error);
    json_decref(json);
    if (!good) pass_fault(&to, &error);
    return good;
}

bool py_study_tables(py_study *study, py_report report, void *user) {
    hearer to = {report, user};
    skein_error error = {SKEIN_OK, "", ""};
    if (!io_study_folder_tables(study->folder, &error)) return true;
    pass_fault(&to, &error);
    return false;
}

void py_study_free(py_study *study) {
    if (!study) return;
    io_study_folder_close(study->folder);
    io_study_free(study->study);
    free(study);
}
