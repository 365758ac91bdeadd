/* The tables of a study: table.csv and table.h5 with a row for each run that is there, and timings.csv, which no other
 * run has alike, apart. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/hdf5.h"
#include "io/study_inside.h"

/* Columns behind those that are varied and measured, and "row" before them. */
static const struct {
    const char *name, *unit, *about;
    bool is_number;
} columns[] = {
    {"row", "", "of the study, from 0", true},
    {"outcome", "", "good; blew up, beyond bounds, refused, failed or crashed: measures are nan but of the second",
     false},
    {"frames", "", "that were run", true},
    {"steps", "", "that were taken", true},
    {"time", "s", "simulated", true},
    {"state_hash", "", "of positions and velocities at the end", false},
    {"scene_hash", "", "of the scene with the row's changes", false},
    {"skein", "", "the version that ran it", false},
    {"precision", "", "of its numbers", false},
    {"command", "", "that does the row again, in this folder", false},
    {"said", "", "what was wrong", false},
};

const char *io_study_column_at(size_t index) {
    return index < COUNT_OF(columns) ? columns[index].name : NULL;
}

/* ---- cells ---- */

static double measured(const json_t *result, size_t m) {
    const json_t *x = json_array_get(json_object_get(result, "measures"), m);
    return json_is_number(x) ? json_number_value(x) : (double)NAN;
}

/* A value as it stands in a table: a number, a word, or JSON. NULL without memory; free it. */
static char *cell_of(const json_t *value) {
    char text[32];
    if (json_is_integer(value)) return study_short_json(value);
    if (json_is_number(value)) return strdup(io_study_number(json_number_value(value), text));
    if (json_is_string(value)) return strdup(json_string_value(value));
    return study_short_json(value);
}

static char *value_cell(const io_study *study, size_t row, size_t v) {
    json_t *value = io_study_value(study, row, v);
    char *text = value ? cell_of(value) : NULL;
    json_decref(value);
    return text;
}

static char *column_cell(const io_study *study, const json_t *result, size_t row, size_t c) {
    if (!strcmp(columns[c].name, "command")) return io_study_command(study, row);
    const json_t *value = json_object_get(result, columns[c].name);
    return value ? cell_of(value) : strdup("");
}

/* ---- CSV ---- */

/* A cell, in quotes where it has to be (RFC 4180). */
static void put_cell(io_output *o, const char *text) {
    if (!text) {
        io_output_fail_memory(o);
        return;
    }
    if (!strpbrk(text, ",\"\n\r")) {
        io_output_write(o, text, strlen(text));
        return;
    }
    io_output_write(o, "\"", 1);
    for (; *text; text++) io_output_write(o, *text == '"' ? "\"\"" : text, *text == '"' ? 2 : 1);
    io_output_write(o, "\"", 1);
}

static void put_and_free(io_output *o, char *text) {
    io_output_write(o, ",", 1);
    put_cell(o, text);
    free(text);
}

static void put_row(io_output *o, const io_study *study, const json_t *result, size_t row) {
    char text[32];
    io_output_count(o, row);
    for (size_t v = 0; v < study->varied_count; v++) put_and_free(o, value_cell(study, row, v));
    for (size_t m = 0; m < study->wanted_count; m++) {
        io_output_write(o, ",", 1);
        put_cell(o, io_study_number(measured(result, m), text));
    }
    for (size_t c = 1; c < COUNT_OF(columns); c++) put_and_free(o, column_cell(study, result, row, c));
    io_output_write(o, "\n", 1);
}

static io_output *open_in(const char *folder, const char *name, skein_error *error) {
    char path[IO_PLACE_SIZE];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return io_output_open(path, error);
}

static skein_status write_csv(const io_study *study, json_t *const *rows, const char *folder, skein_error *error) {
    io_output *o = open_in(folder, "table.csv", error);
    if (!o) return error->status;
    put_cell(o, columns[0].name);
    for (size_t v = 0; v < study->varied_count; v++) put_and_free(o, strdup(study->varied[v].path));
    for (size_t m = 0; m < study->wanted_count; m++) put_and_free(o, strdup(study->wanted[m].name));
    for (size_t c = 1; c < COUNT_OF(columns); c++) put_and_free(o, strdup(columns[c].name));
    io_output_write(o, "\n", 1);
    for (size_t row = 0; row < study->rows; row++)
        if (rows[row]) put_row(o, study, rows[row], row);
    return io_output_commit(o, error);
}

static skein_status write_timings(const io_study *study, json_t *const *rows, const char *folder, skein_error *error) {
    io_output *o = open_in(folder, "timings.csv", error);
    if (!o) return error->status;
    io_output_printf(o, "row,seconds\n");
    for (size_t row = 0; row < study->rows; row++)
        if (rows[row]) io_output_printf(o, "%zu,%.6g\n", row, json_number_value(json_object_get(rows[row], "seconds")));
    return io_output_commit(o, error);
}

/* ---- HDF5: a set for each column ---- */

typedef struct column {
    io_hdf5_set set;
    void *data;
} column;

static int by_name(const void *a, const void *b) {
    return strcmp(((const column *)a)->set.name, ((const column *)b)->set.name);
}

/* Whether all values of a varied field are numbers. */
static bool is_numeric(const io_study *study, size_t v) {
    const study_varied *field = &study->varied[v];
    for (size_t i = 0; field->values && i < json_array_size(field->values); i++)
        if (!json_is_number(json_array_get(field->values, i))) return false;
    return true;
}

/* Texts of one size, one behind the other, from a function of the rows. False without memory. */
static bool fill_texts(column *c, const io_study *study, json_t *const *rows, size_t count, size_t which,
                       char *(*cell)(const io_study *, const json_t *, size_t, size_t)) {
    size_t longest = 0, n = 0;
    char **texts = calloc(count + 1, sizeof *texts);
    bool good = texts != NULL;
    for (size_t row = 0; good && row < study->rows; row++) {
        if (!rows[row]) continue;
        texts[n] = cell(study, rows[row], row, which);
        good = texts[n] != NULL;
        if (good && strlen(texts[n]) > longest) longest = strlen(texts[n]);
        n++;
    }
    c->set.type = IO_HDF5_TEXT;
    c->set.size = (uint32_t)longest + 1;
    char *data = good ? calloc(count, longest + 1) : NULL;
    for (size_t i = 0; data && i < count; i++) memcpy(data + i * (longest + 1), texts[i], strlen(texts[i]));
    for (size_t i = 0; texts && i < n; i++) free(texts[i]);
    free(texts);
    c->data = data;
    return data != NULL;
}

static char *varied_text(const io_study *study, const json_t *result, size_t row, size_t v) {
    (void)result;
    return value_cell(study, row, v);
}

static bool fill_numbers(column *c, const io_study *study, json_t *const *rows, size_t count, size_t which,
                         double (*number)(const io_study *, const json_t *, size_t, size_t)) {
    double *data = malloc(count * sizeof *data);
    size_t n = 0;
    c->set.type = IO_HDF5_DOUBLE;
    for (size_t row = 0; data && row < study->rows; row++)
        if (rows[row]) data[n++] = number(study, rows[row], row, which);
    c->data = data;
    return data != NULL;
}

static double varied_number(const io_study *study, const json_t *result, size_t row, size_t v) {
    (void)result;
    json_t *value = io_study_value(study, row, v);
    double x = value ? json_number_value(value) : (double)NAN;
    json_decref(value);
    return x;
}

static double measure_number(const io_study *study, const json_t *result, size_t row, size_t m) {
    (void)study, (void)row;
    return measured(result, m);
}

static double column_number(const io_study *study, const json_t *result, size_t row, size_t c) {
    (void)study, (void)row;
    return json_number_value(json_object_get(result, columns[c].name));
}

/* All columns, unsorted; returns how many, or 0 without memory. */
static size_t fill(column *all, const io_study *study, json_t *const *rows, size_t count) {
    size_t n = 0;
    bool good = true;
    for (size_t v = 0; good && v < study->varied_count; v++) {
        column *c = &all[n++];
        c->set = (io_hdf5_set){.name = study->varied[v].path, .notes = {{"about", "varied"}}};
        good = is_numeric(study, v) ? fill_numbers(c, study, rows, count, v, varied_number)
                                    : fill_texts(c, study, rows, count, v, varied_text);
    }
    for (size_t m = 0; good && m < study->wanted_count; m++) {
        column *c = &all[n++];
        c->set = (io_hdf5_set){.name = study->wanted[m].name,
                               .notes = {{"about", "measured"}, {"unit", io_study_measure_unit(study, m)}}};
        good = fill_numbers(c, study, rows, count, m, measure_number);
    }
    for (size_t k = 0; good && k < COUNT_OF(columns); k++) {
        column *c = &all[n++];
        c->set =
            (io_hdf5_set){.name = columns[k].name, .notes = {{"about", columns[k].about}, {"unit", columns[k].unit}}};
        good = columns[k].is_number ? fill_numbers(c, study, rows, count, k, column_number)
                                    : fill_texts(c, study, rows, count, k, column_cell);
    }
    for (size_t i = 0; i < n; i++) {
        all[i].set.rank = 1;
        all[i].set.dims[0] = count;
        all[i].set.data = all[i].data;
    }
    return good ? n : 0;
}

static skein_status write_hdf5(const io_study *study, json_t *const *rows, const char *folder, skein_error *error) {
    char path[IO_PLACE_SIZE];
    size_t count = 0;
    for (size_t row = 0; row < study->rows; row++) count += rows[row] != NULL;
    if (!count) return SKEIN_OK;
    snprintf(path, sizeof path, "%s/table.h5", folder);
    enum { MOST = IO_STUDY_MOST_VARIED + IO_STUDY_MOST_MEASURES + COUNT_OF(columns) };
    _Static_assert((int)MOST <= (int)IO_HDF5_MOST_SETS, "a set for each column");
    column *all = calloc(MOST, sizeof *all);
    io_hdf5_set *sets = calloc(MOST, sizeof *sets);
    size_t n = all && sets ? fill(all, study, rows, count) : 0;
    skein_status status = n ? SKEIN_OK : io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
    if (n) {
        qsort(all, n, sizeof *all, by_name);
        for (size_t i = 0; i < n; i++) sets[i] = all[i].set;
        const io_hdf5_note notes[IO_HDF5_MOST_NOTES] = {
            {"skein", SKEIN_VERSION},
            {"name", study->name},
            {strlen(study->text) < 60000 ? "study" : NULL, study->text}}; // else it is in study.json alone
        io_hdf5 *file = io_hdf5_begin(path, sets, n, notes, error);
        status = file ? io_hdf5_commit(file, error) : error->status;
    }
    for (size_t i = 0; all && i < MOST; i++) free(all[i].data);
    free(all);
    free(sets);
    return status;
}

skein_status io_study_write_tables(const io_study *study, json_t *const *rows, const char *folder, skein_error *error) {
    skein_status status = write_csv(study, rows, folder, error);
    if (!status) status = write_timings(study, rows, folder, error);
    return status ? status : write_hdf5(study, rows, folder, error);
}
