/* Recordings as CSV, and the list of formats that there are; HDF5 is in recording_hdf5.c, where it is built. */
#include "io/recording.h"

#include <stdlib.h>
#include <string.h>

#include "io/file.h"

typedef struct csv_file {
    io_output *output;
    size_t particles;
    uint64_t whole; /* bytes of whole samples in the file */
} csv_file;

static void abandon(void *data) {
    csv_file *file = data;
    if (!file) return;
    io_output_abandon(file->output);
    free(file);
}

static void *create(const char *path, const io_recorded *recorded, skein_error *error) {
    csv_file *file = calloc(1, sizeof *file);
    if (!file) {
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    file->particles = recorded->particles;
    file->output = io_output_open(path, error);
    if (!file->output) {
        free(file);
        return NULL;
    }
    io_output_printf(file->output, "time (s),particle,x (m),y (m),z (m),vx (m/s),vy (m/s),vz (m/s)\n");
    return file;
}

static skein_status add(void *data, double time, const double *x, const double *v, skein_error *error) {
    csv_file *file = data;
    const int digits = sizeof(skein_real) == sizeof(double) ? 17 : 9; // as many as it takes to read the same number
    for (size_t i = 0; i < file->particles; i++)
        io_output_printf(file->output, "%.17g,%zu,%.*g,%.*g,%.*g,%.*g,%.*g,%.*g\n", time, i, digits, x[3 * i], digits,
                         x[3 * i + 1], digits, x[3 * i + 2], digits, v[3 * i], digits, v[3 * i + 1], digits,
                         v[3 * i + 2]);
    io_output_flush(file->output); // what is there can be read if the program is killed
    skein_status status = io_output_status(file->output, error);
    if (!status) file->whole = io_output_written(file->output);
    return status;
}

static skein_status keep(void *data, const char *path, skein_error *error) {
    csv_file *file = data;
    if (!file->whole) {
        abandon(file);
        return io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    }
    skein_status status = io_output_keep(file->output, path, file->whole, NULL, error);
    free(file);
    return status;
}

static skein_status commit(void *data, skein_error *error) {
    csv_file *file = data;
    skein_status status = io_output_commit(file->output, error);
    free(file);
    return status;
}

const io_recording_format io_recording_csv = {"csv", ".csv", NULL, create, add, commit, keep, abandon};

const io_recording_format *io_recording_named(const char *name) {
    static const io_recording_format *const formats[] = {
        &io_recording_csv,
        &io_recording_hdf5,
    };
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++)
        if (!strcmp(formats[i]->name, name)) return formats[i];
    return NULL;
}
