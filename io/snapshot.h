/* Snapshots of worlds as files, with a note behind them, and journals: files that only grow, entry by entry.
 *
 * Owns: the files' layouts. A snapshot's file is what skein_snapshot_write() gives, and then the note, a text: what
 * reads the file as a snapshot alone may. A journal is "skeinjrn", a word that is 1, and entries: three words (sort,
 * bytes, sum) and the bytes, in the order of the machine that wrote it. Called by the command. Invariant: a snapshot
 * stands under its name only when it is complete and on the disk; of a journal all entries that were given before a
 * program was killed can be read, whatever stands behind them. */
#ifndef SKEIN_IO_SNAPSHOT_H
#define SKEIN_IO_SNAPSHOT_H

#include "io/file.h"

skein_status io_snapshot_write(const skein_world *world, const char *note, const char *path, skein_error *error);

typedef struct io_snapshot {
    io_bytes bytes;   /* the snapshot, then the note */
    const char *note; /* within these */
    skein_snapshot_info info;
} io_snapshot;

/* Reads one that is whole. Fails as io_file_read() and skein_snapshot_look() do; then there is nothing to free. */
skein_status io_snapshot_read(const char *path, io_snapshot *out, skein_error *error);
void io_snapshot_free(io_snapshot *snapshot);

typedef struct io_journal io_journal;

/* Begins one, instead of what stands there; or goes on with one behind its first `size` bytes. NULL on failure. */
io_journal *io_journal_begin(const char *path, skein_error *error);
io_journal *io_journal_go_on(const char *path, uint64_t size, skein_error *error);
/* What is added can be read from then on, if the program is killed, too. */
skein_status io_journal_add(io_journal *journal, uint64_t sort, const void *bytes, size_t size, skein_error *error);
/* Brings it to the disk itself. */
skein_status io_journal_sync(io_journal *journal, skein_error *error);
uint64_t io_journal_size(const io_journal *journal);
void io_journal_end(io_journal *journal); /* NULL is allowed */

/* Shows the whole entries of a journal's first `size` bytes (UINT64_MAX: all of them), until `take` returns false.
 * `end` (or NULL) receives where the last whole one ends. Fails where it is none, or where `size` bytes are not there
 * whole; nothing larger than the file is allocated. */
typedef bool io_journal_take(void *user, uint64_t sort, const void *bytes, size_t size);
skein_status io_journal_read(const char *path, uint64_t size, io_journal_take *take, void *user, uint64_t *end,
                             skein_error *error);

#endif
