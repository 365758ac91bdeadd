/* HDF5 recordings, with an XDMF index beside them (xdmf.h). hdf5.h keeps the file readable while it grows; the index is
 * written anew now and then, as its own part file, seldom enough that it takes a fiftieth of the time. */
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "io/hdf5.h"
#include "io/recording.h"
#include "io/xdmf.h"

enum { MOST_SETS = 6 };

typedef struct h5_file {
    char *path, *index_path, *index_part; /* index_part: NULL as long as there is none */
    io_hdf5 *hdf5;
    io_xdmf index;
    size_t time_capacity;
    skein_real *samples[2];
    double indexed, pause; /* seconds: when the index was last written, and for how long it is good enough */
} h5_file;

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void release(h5_file *f) {
    if (f->index_part) unlink(f->index_part);
    free(f->index_part);
    free(f->index_path);
    free(f->path);
    free(f->index.times);
    free(f->samples[0]);
    free(f->samples[1]);
    free(f);
}

static void abandon(void *data) {
    h5_file *f = data;
    if (!f) return;
    io_hdf5_abandon(f->hdf5);
    release(f);
}

/* ---- what stands still ---- */

/* Faces of one size as count x size, of several as XDMF's mixed topology: for each its kind (3 polygon, 4 triangle, 5
 * quadrilateral), of a polygon its size, and its corners. NULL without memory. */
static uint32_t *lay_cells(const io_recorded *r, io_xdmf *index) {
    size_t length = 0, at = 0;
    bool mixed = false;
    for (size_t i = 0; i < r->cell_count; i++) {
        length += r->cell_sizes[i] + 2;
        mixed |= r->cell_sizes[i] != r->cell_sizes[0] || r->cell_sizes[i] > 4;
    }
    uint32_t *laid = malloc(length * sizeof *laid);
    for (size_t i = 0, corner = 0; laid && i < r->cell_count; corner += r->cell_sizes[i++]) {
        uint32_t size = r->cell_sizes[i];
        if (mixed) laid[at++] = size == 3 ? 4 : size == 4 ? 5 : size == 2 ? 2 : 3;
        if (mixed && size != 3 && size != 4) laid[at++] = size;
        memcpy(laid + at, r->cells + corner, size * sizeof *laid);
        at += size;
    }
    index->cell_count = r->cell_count;
    index->cell_size = mixed ? 0 : r->cell_sizes[0];
    index->cell_length = at;
    return laid;
}

static io_hdf5 *begin(const char *path, const io_recorded *r, h5_file *f, skein_error *error) {
    io_hdf5_set sets[MOST_SETS];
    size_t count = 0;
    uint32_t *cells = NULL;
    if (r->cell_count) {
        if (!(cells = lay_cells(r, &f->index))) {
            io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
            return NULL;
        }
        const io_xdmf *x = &f->index;
        sets[count++] = (io_hdf5_set){.name = io_xdmf_cells_name(x),
                                      .type = IO_HDF5_UINT32,
                                      .rank = x->cell_size ? 2 : 1,
                                      .dims = {x->cell_size ? x->cell_count : x->cell_length, x->cell_size},
                                      .data = cells,
                                      .notes = {{"about", x->cell_size ? "particles, from 0"
                                                                       : "XDMF mixed topology: 3 polygon (its size "
                                                                         "follows), 4 triangle, 5 quadrilateral"}}};
    }
    if (r->masses)
        sets[count++] = (io_hdf5_set){.name = "masses",
                                      .type = IO_HDF5_DOUBLE,
                                      .rank = 1,
                                      .dims = {r->particles},
                                      .data = r->masses,
                                      .notes = {{"unit", "kg"}}};
    sets[count++] = (io_hdf5_set){
        .name = "positions", .type = IO_HDF5_REAL, .rank = 3, .dims = {0, r->particles, 3}, .notes = {{"unit", "m"}}};
    if (r->scene)
        sets[count++] = (io_hdf5_set){.name = "scene",
                                      .type = IO_HDF5_TEXT,
                                      .size = (uint32_t)strlen(r->scene) + 1,
                                      .data = r->scene,
                                      .notes = {{"about", "the scene as it was run, JSON"}}};
    sets[count++] = (io_hdf5_set){.name = "time", .type = IO_HDF5_DOUBLE, .rank = 1, .notes = {{"unit", "s"}}};
    sets[count++] = (io_hdf5_set){
        .name = "velocities", .type = IO_HDF5_REAL, .rank = 3, .dims = {0, r->particles, 3}, .notes = {{"unit", "m/s"}}};
    io_hdf5_note notes[IO_HDF5_MOST_NOTES] = {{"skein", SKEIN_VERSION}, {"axes", "metres, y up"}};
    if (r->body && r->body[0]) notes[2] = (io_hdf5_note){"body", r->body};
    io_hdf5 *hdf5 = io_hdf5_begin(path, sets, count, notes, error);
    free(cells);
    return hdf5;
}

static void *create(const char *path, const io_recorded *r, skein_error *error) {
    if (r->particles == 0 || r->particles > UINT32_MAX / 24) { // a chunk is under 4 GB
        io_error_set(error, SKEIN_ERROR_LIMIT, path, "an HDF5 recording holds 1 to %lu particles, not %zu",
                     (unsigned long)UINT32_MAX / 24, r->particles);
        return NULL;
    }
    h5_file *f = calloc(1, sizeof *f);
    if (f) {
        f->path = strdup(path);
        f->index_path = io_xdmf_path(path);
        for (int k = 0; k < 2; k++) f->samples[k] = malloc(3 * r->particles * sizeof **f->samples);
    }
    if (!f || !f->path || !f->index_path || !f->samples[0] || !f->samples[1]) {
        if (f) release(f);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    f->index.particles = r->particles;
    f->hdf5 = begin(path, r, f, error);
    if (f->hdf5) return f;
    release(f);
    return NULL;
}

/* ---- the index ---- */

static skein_status write_index(h5_file *f, const char *h5_path, const char *path, skein_error *error) {
    io_output *output = io_output_open(path, error);
    if (!output) return error->status;
    io_xdmf_write(output, &f->index, h5_path);
    return io_output_commit(output, error);
}

/* Writes the part anew, beside the old one, and then takes its place. A failure is told when the index is written. */
static void renew_index_part(h5_file *f) {
    double start = seconds_now();
    io_output *output = io_output_open(f->index_path, NULL);
    const char *name = output ? io_output_part(output) : NULL;
    if (name && !f->index_part) f->index_part = strdup(name);
    if (name && f->index_part) {
        io_xdmf_write(output, &f->index, f->path);
        if (!io_output_status(output, NULL)) {
            io_output_keep(output, f->index_part, UINT64_MAX, NULL, NULL);
            output = NULL;
        }
    }
    io_output_abandon(output);
    f->indexed = seconds_now();
    f->pause = 0.25 + 50 * (f->indexed - start);
}

/* ---- samples ---- */

static skein_status add(void *data, double time, const double *x, const double *v, skein_error *error) {
    h5_file *f = data;
    if (!io_grow(&f->index.times, &f->time_capacity, f->index.samples + 1, sizeof *f->index.times))
        return io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
    f->index.times[f->index.samples] = time;
    for (size_t i = 0; i < 3 * f->index.particles; i++) {
        f->samples[0][i] = (skein_real)x[i];
        f->samples[1][i] = (skein_real)v[i];
    }
    skein_status status = io_hdf5_add(f->hdf5, (const void *const[]){f->samples[0], &time, f->samples[1]}, error);
    if (status) return status;
    f->index.samples++;
    if (io_hdf5_readable(f->hdf5) == f->index.samples && seconds_now() - f->indexed >= f->pause) renew_index_part(f);
    return SKEIN_OK;
}

static skein_status commit(void *data, skein_error *error) {
    h5_file *f = data;
    skein_status status = io_hdf5_commit(f->hdf5, error);
    if (!status) status = write_index(f, f->path, f->index_path, error);
    release(f);
    return status;
}

static skein_status keep(void *data, const char *path, skein_error *error) {
    h5_file *f = data;
    f->index.samples = (size_t)io_hdf5_round_off(f->hdf5);
    if (!f->index.samples) {
        abandon(f);
        return io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    }
    char *index_path = io_xdmf_path(path);
    skein_status status = io_hdf5_keep(f->hdf5, path, error);
    if (!status && index_path) status = write_index(f, path, index_path, error);
    free(index_path);
    release(f);
    return status;
}

const io_recording_format io_recording_hdf5 = {"hdf5", ".h5", ".xdmf", create, add, commit, keep, abandon};
