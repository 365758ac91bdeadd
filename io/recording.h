/* Recordings: the positions and velocities of a body's particles over a run, as numbers for other programs.
 *
 *   csv    a line for each particle of each sample: time,particle,x,y,z,vx,vy,vz
 *   hdf5   NAME.h5: /time (samples), /positions and /velocities (samples x particles x 3), /masses (particles), /faces
 *          or /edges, /scene; units as attributes; and beside it NAME.xdmf, an index that ParaView reads
 *
 * Owns: the files' layout. Called by the exporters and by tests. Invariant: a file stands under its final name only
 * when it is complete; while it grows, under its part's name, all samples but those of the last moment can be read. */
#ifndef SKEIN_IO_RECORDING_H
#define SKEIN_IO_RECORDING_H

#include <skein/skein.h>

/* What is recorded. Pointers need to live only until the recording is begun. */
typedef struct io_recorded {
    size_t particles;
    const double *masses;       /* particles, kg; NULL: not told */
    const uint32_t *cell_sizes; /* cell_count: 2 of an edge, 3 and more of a face */
    const uint32_t *cells;      /* particles, from 0, cell after cell */
    size_t cell_count;          /* 0: loose particles */
    const char *body, *scene;   /* the body's name, and the scene as JSON; NULL: not told */
} io_recorded;

/* How a sort of recording is written; each call as those below. */
typedef struct io_recording_format {
    const char *name;   /* of the exporter */
    const char *ending; /* of its file: ".csv" */
    const char *second; /* of the one beside it, or NULL */
    void *(*create)(const char *path, const io_recorded *recorded, skein_error *error);
    skein_status (*add)(void *file, double time, const double *positions, const double *velocities, skein_error *error);
    skein_status (*commit)(void *file, skein_error *error); /* frees, in any case */
    /* Keeps the whole samples that there are, under another path (with the ending), and frees; after a failure to add
     * one, too. Where there is none it fails, and nothing is left. */
    skein_status (*keep)(void *file, const char *path, skein_error *error);
    void (*abandon)(void *file); /* NULL is allowed */
} io_recording_format;

extern const io_recording_format io_recording_csv, io_recording_hdf5;

/* The format of an exporter's name, or NULL. */
const io_recording_format *io_recording_named(const char *name);

#endif
