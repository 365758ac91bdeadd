/* Files in and out.
 *
 * Owns: whole files in memory, output that appears under its name only when it is complete, and the
 * way io/ reports errors and warnings. Called by every reader and writer of io/ and by the command.
 * Invariant: nothing half written ever stands under the final name.
 *
 * SIGXFSZ (a file size limit) and SIGPIPE end a process that neither ignores nor handles them; a
 * program that wants the error instead ignores both signals.
 */
#ifndef SKEIN_IO_FILE_H
#define SKEIN_IO_FILE_H

#include <skein/skein.h>

#if defined(__GNUC__)
#define IO_PRINTF(format_, first_) __attribute__((format(printf, format_, first_)))
#else
#define IO_PRINTF(format_, first_)
#endif

/* ---- Errors -------------------------------------------------------------------------------- */

/* Fills `error` (NULL is allowed) and returns `status`. A `where` that is too long loses its front. */
skein_status io_error_set(skein_error *error, skein_status status, const char *where, const char *format, ...)
    IO_PRINTF(4, 5);
/* The same with the place "path:line". */
skein_status io_error_at(skein_error *error, skein_status status, const char *path, size_t line, const char *format,
                         ...) IO_PRINTF(5, 6);

/* Text of a file for a message: in single quotes, printable, cut short. Returns `out`. */
#define IO_QUOTE_SIZE 40
const char *io_quote(const char *begin, const char *end, char out[IO_QUOTE_SIZE]);

/* Where warnings go, one line each without a newline. `write` NULL keeps quiet. */
typedef struct io_warnings {
    void (*write)(void *user, const char *line);
    void *user;
} io_warnings;

void io_warn(io_warnings warnings, const char *format, ...) IO_PRINTF(2, 3);

/* ---- Memory -------------------------------------------------------------------------------- */

/* Makes room for `need` items of `item_size` bytes, at least doubling. False: no memory, all as before. */
bool io_grow(void *array_pointer, size_t *capacity, size_t need, size_t item_size);

/* ---- Reading ------------------------------------------------------------------------------- */

typedef struct io_bytes {
    char *data; /* data[size] is '\0', so that an empty file is a text, too */
    size_t size;
} io_bytes;

/* Reads a whole file, not a pipe or device, of at most `most` bytes. `out` is overwritten; {NULL, 0} on failure. */
skein_status io_file_read(const char *path, size_t most, io_bytes *out, skein_error *error);
/* The same for a file that goes with another one, `first`, and lies in its folder: a link that leads to neither that folder
 * nor the one where `first` really is, is not followed, for whoever made `first` may have laid it. */
skein_status io_file_read_beside(const char *first, const char *path, size_t most, io_bytes *out, skein_error *error);
void io_bytes_free(io_bytes *bytes);

/* ---- Writing ------------------------------------------------------------------------------- */

/* A file in the making. It grows as "NAME.PID.part" beside its final name NAME and is renamed at the
 * commit; a device or pipe is written directly. The first failure is kept and the rest ignored, so
 * a writer may write on and look at the commit only. A target's mode is kept; a link is followed,
 * but never one under the name that the file has while it grows. */
typedef struct io_output io_output;

io_output *io_output_open(const char *path, skein_error *error); /* NULL on failure */
void io_output_write(io_output *output, const void *bytes, size_t size);
void io_output_printf(io_output *output, const char *format, ...)
    IO_PRINTF(2, 3);                                     /* numbers have a point, in any locale */
void io_output_count(io_output *output, uint64_t value); /* in decimal */
/* Overwrites bytes already written; fails on a pipe. */
void io_output_patch(io_output *output, uint64_t offset, const void *bytes, size_t size);
/* The path of the file while it grows; NULL where a device or pipe is written directly. */
const char *io_output_part(const io_output *output);
/* Bytes written so far, one after the other: where the next one goes. */
uint64_t io_output_place(const io_output *output);
/* For files that grow for long, so that what is there can be read if the program is killed: whether a
 * quarter of a second has gone by since it last said so; and writes all that was given so far. */
bool io_output_is_due(io_output *output);
void io_output_flush(io_output *output);
/* Brings all that was given so far to the disk itself, and the commit its name, so that a power cut does not take it:
 * for what a run is to go on from. Costs some milliseconds, or many. */
void io_output_sync(io_output *output);
/* Notes that the writer had no memory for what should be written; or another failure, an errno. */
void io_output_fail_memory(io_output *output);
void io_output_fail(io_output *output, int fault);
/* The first failure so far (or SKEIN_OK), for a writer that wants to stop early. */
skein_status io_output_status(const io_output *output, skein_error *error);
/* Writes the rest, checks every error, gives the file its name. Frees `output` in any case; on
 * failure nothing is left and what stood under the name before still stands. */
skein_status io_output_commit(io_output *output, skein_error *error);
/* Takes back what was written after the first `size` bytes, and forgets a failure: for a writer that can
 * round off what is there by io_output_patch() before it keeps it. */
void io_output_cut(io_output *output, uint64_t size);
/* Gives what was written another name, for the good part of a file that cannot be completed: its first
 * `size` bytes, or all (UINT64_MAX), with bytes at one place changed (NULL: none). What stands under that
 * name is replaced; a failure of writing before does not matter. Frees `output` in any case. */
#define IO_NOTHING_KEPT "not one sample was written: nothing of it is kept"
typedef struct io_output_change {
    uint64_t offset;
    const void *bytes;
    size_t size;
} io_output_change;
skein_status io_output_keep(io_output *output, const char *path, uint64_t size, const io_output_change *change,
                            skein_error *error);
/* Of the bytes given so far, how many surely are in the file. */
uint64_t io_output_written(const io_output *output);
/* Removes what was written; NULL is allowed. */
void io_output_abandon(io_output *output);

#endif
