/* Recordings: the positions and velocities of a body's particles over a run, as numbers for other programs.
 *
 *   csv    a line for each particle of each sample: time,particle,x,y,z,vx,vy,vz
 *   hdf5   NAME.h5: /time (samples), /positions and /velocities (samples x particles x 3), and beside it NAME.xdmf, an
 *          index that ParaView reads (only where the HDF5 library was there at the build)
 *
 * Owns: the files' layout. Called by the exporters and by tests. Invariant: a file stands under its final name only
 * when it is complete. */
#ifndef SKEIN_IO_RECORDING_H
#define SKEIN_IO_RECORDING_H

#include <skein/skein.h>

/* How a sort of recording is written; each call as those below. */
typedef struct io_recording_format {
    const char *name;   /* of the exporter */
    const char *ending; /* of its file: ".csv" */
    const char *second; /* of the one beside it, or NULL */
    void *(*create)(const char *path, size_t particles, skein_error *error);
    skein_status (*add)(void *file, double time, const double *positions, const double *velocities, skein_error *error);
    skein_status (*commit)(void *file, skein_error *error); /* frees, in any case */
    void (*abandon)(void *file);                            /* NULL is allowed */
} io_recording_format;

extern const io_recording_format io_recording_csv;
#ifdef SKEIN_HDF5
extern const io_recording_format io_recording_hdf5;
#endif

/* The format of an exporter's name, or NULL. */
const io_recording_format *io_recording_named(const char *name);

#endif
