/* PC2 point caches: the positions of a whole run in one file, as Blender, 3ds Max and Maya read them.
 *
 *   byte 0   "POINTCACHE2\0"        16  int32 points             24  float frames from sample to sample
 *       12   int32 version, 1       20  float first frame        28  int32 samples
 *       32   samples x points x (float x, y, z), all little endian
 *
 * Owns: the file's layout. Called by the exporters and by tests. Invariant: a file under its final name
 * holds exactly the samples that its header counts; while it grows, its part counts no sample that is
 * not there, and all but those of the last quarter of a second.
 */
#ifndef SKEIN_IO_PC2_H
#define SKEIN_IO_PC2_H

#include <skein/skein.h>

typedef struct io_pc2_header {
    uint32_t points; /* 1 to 2^31 - 1 */
    float start;     /* the frame of the first sample */
    float rate;      /* frames from one sample to the next, above 0 */
    uint32_t samples;
} io_pc2_header;

/* ---- Writing ------------------------------------------------------------------------------- */

typedef struct io_pc2_writer io_pc2_writer;

#define IO_PC2_UNKNOWN UINT32_MAX /* as many samples as are added; the file must not be a pipe then */

/* Begins a file; it appears under its name at the commit. NULL on failure. */
io_pc2_writer *io_pc2_create(const char *path, io_pc2_header header, skein_error *error);
/* Adds a sample, points x 3. Numbers that are no finite floats are kept as they are. Stops early on a
 * full disk; the writer must still be committed or abandoned. */
skein_status io_pc2_add(io_pc2_writer *writer, const double *positions, skein_error *error);
/* Completes the file and frees the writer in any case; a failure leaves no file. It is one, too, when
 * fewer or more samples were added than the header promised. */
skein_status io_pc2_commit(io_pc2_writer *writer, skein_error *error);
/* Keeps the whole samples that there are, under another path, and frees the writer; after a failure to
 * add one, too. Where there is none it fails, and nothing is left. Only for an unknown number of samples. */
skein_status io_pc2_keep(io_pc2_writer *writer, const char *path, skein_error *error);
void io_pc2_abandon(io_pc2_writer *writer); /* NULL is allowed */

/* ---- Reading ------------------------------------------------------------------------------- */

typedef struct io_pc2_reader io_pc2_reader;

/* Reads and checks the header and the file's size. What follows the samples that the header counts is
 * left alone: in the part of a run that was killed it is a sample in the making. NULL on failure. */
io_pc2_reader *io_pc2_open(const char *path, io_pc2_header *header, skein_error *error);
/* Reads a sample, 0 to samples - 1, into out[points x 3]. */
skein_status io_pc2_read(io_pc2_reader *reader, uint32_t sample, double *out, skein_error *error);
void io_pc2_close(io_pc2_reader *reader); /* NULL is allowed */

#endif
