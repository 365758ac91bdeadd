/* HDF5 files that can be read at any time, also while they grow and after the program was killed.
 *
 * Owns: the bytes of the file format, of which this writes the oldest and simplest forms: version 0 of the superblock,
 * one group, attributes that are texts, contiguous sets, and sets that grow along their first axis in chunks found by a
 * version 1 B-tree. Every HDF5 library reads them. Called by recording_hdf5.c.
 *
 * Why not the HDF5 library: it writes the tables of a growing file in place and in no order that a stop would respect;
 * its mode for readers beside a writer leaves marks that plain readers refuse after a stop; it follows links, hides why
 * a write failed, and aborts at exit after a full disk.
 *
 *   byte 0      superblock, object headers of the sets that grow      one block under 4 KiB, written in one go
 *               the group, its names, other headers, contiguous sets  written once
 *               chunks and nodes of the B-trees, as they come
 *
 * A reader beside the writer takes several looks (the first block, nodes, chunks). If the file grew between them, it may
 * get an error, about 1 in 10,000 times, and then opens the file anew; once the writer ended or was killed, never.
 *
 * Invariant: what the first block says is in the file. Whatever it does not yet speak of is written elsewhere, then the
 * block in one write, which a kill does not cut. Nodes that change go to places that the tree in the file does not use;
 * those are reserved ahead, so that a full disk does not keep the last whole sample from being found. */
#ifndef SKEIN_IO_HDF5_H
#define SKEIN_IO_HDF5_H

#include "io/file.h"

typedef struct io_hdf5 io_hdf5;

typedef enum io_hdf5_type {
    IO_HDF5_REAL, /* skein_real */
    IO_HDF5_DOUBLE,
    IO_HDF5_UINT32,
    IO_HDF5_TEXT /* UTF-8; `size` bytes each */
} io_hdf5_type;

enum { IO_HDF5_MOST_SETS = 127, IO_HDF5_MOST_RANK = 3, IO_HDF5_MOST_NOTES = 4 };

/* A text that is attached to a set or to the whole file: "unit", "m". At most 60,000 bytes. */
typedef struct io_hdf5_note {
    const char *name, *text; /* NULL ends a list of less than all */
} io_hdf5_note;

/* A set of numbers. All pointers must live until io_hdf5_begin() has returned. */
typedef struct io_hdf5_set {
    const char *name;
    io_hdf5_type type;
    uint32_t size;                    /* of a text */
    int rank;                         /* 0: one element. One that grows counts its growing axis */
    uint64_t dims[IO_HDF5_MOST_RANK]; /* the first one of a set that grows is left out of account */
    const void *data;                 /* NULL: it grows, from no sample */
    size_t chunk;                     /* samples of one that grows that lie together; 0: as many as fit into 16 KiB */
    io_hdf5_note notes[IO_HDF5_MOST_NOTES];
} io_hdf5_set;

/* Begins a file with these sets, in the order of their names; it appears under `path` at the commit. At most three of
 * them may grow, and a sample of each is less than 4 GB. NULL on failure. */
io_hdf5 *io_hdf5_begin(const char *path, const io_hdf5_set *sets, size_t count,
                       const io_hdf5_note notes[IO_HDF5_MOST_NOTES], skein_error *error);
/* Adds a sample: `data` has one for each set that grows, in their order. Now and then makes all samples so far
 * readable. After a failure nothing more is written. */
skein_status io_hdf5_add(io_hdf5 *file, const void *const *data, skein_error *error);
/* Makes all samples so far readable now. */
void io_hdf5_publish(io_hdf5 *file);
/* Samples that a reader finds in the file as it is now. */
uint64_t io_hdf5_readable(const io_hdf5 *file);
/* After a failure: makes all whole samples readable, returns their number. Then nothing but io_hdf5_keep() or
 * io_hdf5_abandon() is allowed. */
uint64_t io_hdf5_round_off(io_hdf5 *file);
/* Frees in any case; else as io_output_commit(), io_output_keep() and io_output_abandon(). */
skein_status io_hdf5_commit(io_hdf5 *file, skein_error *error);
skein_status io_hdf5_keep(io_hdf5 *file, const char *path, skein_error *error);
void io_hdf5_abandon(io_hdf5 *file);

#endif
