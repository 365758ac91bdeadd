/* HDF5 recordings, with an XDMF index beside them; built only where the HDF5 library is. The library writes its file by
 * itself, so it grows under a name of its own, and is renamed at the commit. */
#ifdef SKEIN_HDF5
#include <errno.h>
#include <hdf5.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"
#include "io/recording.h"

typedef struct h5_file {
    char *path, *part; /* the final name, and that while it grows */
    hid_t file, time, sets[2];
    size_t particles;
    hsize_t samples;
    double *times; /* for the index */
    size_t time_capacity;
} h5_file;

static const char *const set_names[2] = {"positions", "velocities"};

/* Samples as they are computed. */
static hid_t real_type(void) {
    return sizeof(skein_real) == sizeof(double) ? H5T_NATIVE_DOUBLE : H5T_NATIVE_FLOAT;
}

static void close_all(h5_file *f) {
    for (int k = 0; k < 2; k++)
        if (f->sets[k] >= 0) H5Dclose(f->sets[k]);
    if (f->time >= 0) H5Dclose(f->time);
    if (f->file >= 0) H5Fclose(f->file);
    f->sets[0] = f->sets[1] = f->time = f->file = -1;
}

static void release(h5_file *f) {
    free(f->path);
    free(f->part);
    free(f->times);
    free(f);
}

static void abandon(void *data) {
    h5_file *f = data;
    if (!f) return;
    close_all(f);
    if (f->part) remove(f->part);
    release(f);
}

static skein_status fail(const h5_file *f, skein_error *error) {
    return io_error_set(error, SKEIN_ERROR_FILE, f->path, "cannot write: %s",
                        errno ? strerror(errno) : "the HDF5 library failed");
}

/* A set of no samples yet, that grows along its first axis, in chunks of one sample (times: of 1,024). */
static hid_t make_set(const h5_file *f, const char *name, hid_t type, int rank) {
    hsize_t size[3] = {0, f->particles, 3}, most[3] = {H5S_UNLIMITED, f->particles, 3};
    hsize_t chunk[3] = {rank == 1 ? 1024 : 1, f->particles, 3};
    hid_t space = H5Screate_simple(rank, size, most), list = H5Pcreate(H5P_DATASET_CREATE);
    hid_t set = -1;
    if (space >= 0 && list >= 0 && H5Pset_chunk(list, rank, chunk) >= 0)
        set = H5Dcreate2(f->file, name, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    if (list >= 0) H5Pclose(list);
    if (space >= 0) H5Sclose(space);
    return set;
}

static void *create(const char *path, size_t particles, skein_error *error) {
    h5_file *f = calloc(1, sizeof *f);
    size_t size = strlen(path) + sizeof ".part";
    if (f) f->path = strdup(path), f->part = malloc(size);
    if (!f || !f->path || !f->part) {
        if (f) release(f);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    f->file = f->time = f->sets[0] = f->sets[1] = -1;
    if (particles == 0 || particles > UINT32_MAX / 24) { // a chunk is under 4 GB
        io_error_set(error, SKEIN_ERROR_LIMIT, path, "an HDF5 recording holds 1 to %lu particles, not %zu",
                     (unsigned long)UINT32_MAX / 24, particles);
        release(f);
        return NULL;
    }
    snprintf(f->part, size, "%s.part", path);
    f->particles = particles;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL); // faults are told once, below
    errno = 0;
    FILE *first = fopen(f->part, "wb"); // which says why it cannot be; the HDF5 library does not
    if (!first) {
        fail(f, error);
        release(f);
        return NULL;
    }
    fclose(first);
    f->file = H5Fcreate(f->part, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (f->file >= 0) {
        f->time = make_set(f, "time", H5T_NATIVE_DOUBLE, 1);
        for (int k = 0; k < 2; k++) f->sets[k] = make_set(f, set_names[k], real_type(), 3);
    }
    if (f->time >= 0 && f->sets[0] >= 0 && f->sets[1] >= 0) return f;
    fail(f, error);
    abandon(f);
    return NULL;
}

/* Appends one sample to a set: `size` elements after the first axis. */
static bool append(const h5_file *f, hid_t set, int rank, const double *numbers) {
    hsize_t all[3] = {f->samples + 1, f->particles, 3}, at[3] = {f->samples, 0, 0}, one[3] = {1, f->particles, 3};
    if (H5Dset_extent(set, all) < 0) return false;
    hid_t there = H5Dget_space(set), here = H5Screate_simple(rank, one, NULL);
    bool good = there >= 0 && here >= 0 && H5Sselect_hyperslab(there, H5S_SELECT_SET, at, NULL, one, NULL) >= 0 &&
                H5Dwrite(set, H5T_NATIVE_DOUBLE, here, there, H5P_DEFAULT, numbers) >= 0;
    if (here >= 0) H5Sclose(here);
    if (there >= 0) H5Sclose(there);
    return good;
}

static skein_status add(void *data, double time, const double *x, const double *v, skein_error *error) {
    h5_file *f = data;
    if (!io_grow(&f->times, &f->time_capacity, f->samples + 1, sizeof *f->times))
        return io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
    f->times[f->samples] = time;
    errno = 0;
    if (!append(f, f->time, 1, &time) || !append(f, f->sets[0], 3, x) || !append(f, f->sets[1], 3, v))
        return fail(f, error);
    f->samples++;
    return SKEIN_OK;
}

/* A part of a set in the index: sample `k` of all. */
static void write_item(io_output *output, const h5_file *f, const char *name, const char *set, hsize_t k) {
    io_output_printf(output,
                     "          <DataItem ItemType=\"HyperSlab\" Dimensions=\"%zu 3\">\n"
                     "            <DataItem Dimensions=\"3 3\" Format=\"XML\">%llu 0 0 1 1 1 1 %zu 3</DataItem>\n"
                     "            <DataItem Dimensions=\"%llu %zu 3\" NumberType=\"Float\" Precision=\"%zu\" "
                     "Format=\"HDF\">%s:/%s</DataItem>\n"
                     "          </DataItem>\n",
                     f->particles, (unsigned long long)k, f->particles, (unsigned long long)f->samples, f->particles,
                     sizeof(skein_real), name, set);
}

/* NAME.xdmf beside NAME.h5: one grid of points a sample. */
static skein_status write_index(const h5_file *f, skein_error *error) {
    size_t length = strlen(f->path);
    char *path = malloc(length + sizeof ".xdmf");
    if (!path) return io_error_set(error, SKEIN_ERROR_MEMORY, f->path, "out of memory");
    if (length > 3 && !strcmp(f->path + length - 3, ".h5")) length -= 3;
    snprintf(path, length + sizeof ".xdmf", "%.*s.xdmf", (int)length, f->path);
    const char *slash = strrchr(f->path, '/'), *name = slash ? slash + 1 : f->path;
    io_output *output = io_output_open(path, error);
    free(path);
    if (!output) return error->status;
    io_output_printf(output, "<?xml version=\"1.0\"?>\n<Xdmf Version=\"3.0\">\n  <Domain>\n"
                             "    <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n");
    for (hsize_t k = 0; k < f->samples; k++) {
        io_output_printf(output,
                         "      <Grid Name=\"particles\">\n        <Time Value=\"%.17g\"/>\n"
                         "        <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"%zu\"/>\n"
                         "        <Geometry GeometryType=\"XYZ\">\n",
                         f->times[k], f->particles);
        write_item(output, f, name, set_names[0], k);
        io_output_printf(output, "        </Geometry>\n        <Attribute Name=\"velocity\" "
                                 "AttributeType=\"Vector\" Center=\"Node\">\n");
        write_item(output, f, name, set_names[1], k);
        io_output_printf(output, "        </Attribute>\n      </Grid>\n");
    }
    io_output_printf(output, "    </Grid>\n  </Domain>\n</Xdmf>\n");
    return io_output_commit(output, error);
}

static skein_status commit(void *data, skein_error *error) {
    h5_file *f = data;
    errno = 0;
    bool good = H5Fflush(f->file, H5F_SCOPE_LOCAL) >= 0;
    close_all(f);
    if (!good || rename(f->part, f->path)) {
        skein_status status = fail(f, error);
        abandon(f);
        return status;
    }
    skein_status status = write_index(f, error);
    release(f);
    return status;
}

const io_recording_format io_recording_hdf5 = {"hdf5", ".h5", ".xdmf", create, add, commit, abandon};

#else
typedef int io_recording_hdf5_is_not_built; // a file has something in it
#endif
