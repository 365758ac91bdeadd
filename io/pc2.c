/* PC2 point caches: see pc2.h for the layout and the contract.
 *
 * Points go through one block of bytes, so that a sample of any size needs no memory of its own.
 */
#include "io/pc2.h"

#include "io/bytes.h"
#include "io/file.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER_BYTES = 32, POINT_BYTES = 12, SAMPLES_OFFSET = 28, BLOCK_POINTS = 4096 };

static const char magic[12] = "POINTCACHE2";

/* ---- Writing ------------------------------------------------------------------------------- */

struct io_pc2_writer {
    io_output *output;
    char *path; /* for messages */
    io_pc2_header header;
    uint32_t added;
    unsigned char block[BLOCK_POINTS * POINT_BYTES];
};

io_pc2_writer *io_pc2_create(const char *path, io_pc2_header header, skein_error *error) {
    if (header.points == 0 || header.points > INT32_MAX ||
        (header.samples > INT32_MAX && header.samples != IO_PC2_UNKNOWN)) {
        io_error_set(error, SKEIN_ERROR_LIMIT, path,
                     "a PC2 file holds 1 to 2147483647 points and samples, not %lu points",
                     (unsigned long)header.points);
        return NULL;
    }
    if (!isfinite(header.start) || !(header.rate > 0) || !isfinite(header.rate)) {
        io_error_set(error, SKEIN_ERROR_VALUE, path, "a PC2 file needs a finite first frame and a rate above 0");
        return NULL;
    }
    io_pc2_writer *writer = malloc(sizeof *writer);
    char *name = strdup(path);
    if (!writer || !name) {
        free(writer);
        free(name);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    writer->output = io_output_open(path, error);
    writer->path = name;
    writer->header = header;
    writer->added = 0;
    if (!writer->output) {
        io_pc2_abandon(writer);
        return NULL;
    }
    unsigned char bytes[HEADER_BYTES];
    memcpy(bytes, magic, sizeof magic);
    io_put_u32(bytes + 12, 1);
    io_put_u32(bytes + 16, header.points);
    io_put_float(bytes + 20, header.start);
    io_put_float(bytes + 24, header.rate);
    io_put_u32(bytes + SAMPLES_OFFSET, header.samples == IO_PC2_UNKNOWN ? 0 : header.samples);
    io_output_write(writer->output, bytes, sizeof bytes);
    return writer;
}

static void count_samples(io_pc2_writer *writer, uint32_t samples) {
    unsigned char bytes[4];
    io_put_u32(bytes, samples);
    io_output_patch(writer->output, SAMPLES_OFFSET, bytes, sizeof bytes);
}

skein_status io_pc2_add(io_pc2_writer *writer, const double *positions, skein_error *error) {
    if (writer->added == INT32_MAX)
        return io_error_set(error, SKEIN_ERROR_LIMIT, writer->path, "a PC2 file holds at most 2147483647 samples");
    size_t left = writer->header.points;
    while (left > 0) {
        size_t count = left < BLOCK_POINTS ? left : BLOCK_POINTS;
        for (size_t i = 0; i < 3 * count; i++) io_put_float(writer->block + 4 * i, (float)positions[i]);
        io_output_write(writer->output, writer->block, count * POINT_BYTES);
        positions += 3 * count;
        left -= count;
    }
    writer->added++;
    // samples first, then their number: a reader never finds it too large
    if (writer->header.samples == IO_PC2_UNKNOWN) {
        io_output_flush(writer->output);
        if (io_output_is_due(writer->output)) count_samples(writer, writer->added);
    }
    return io_output_status(writer->output, error);
}

skein_status io_pc2_commit(io_pc2_writer *writer, skein_error *error) {
    skein_status status;
    if (writer->header.samples == IO_PC2_UNKNOWN) count_samples(writer, writer->added);
    if (writer->header.samples != IO_PC2_UNKNOWN && writer->header.samples != writer->added)
        status = io_error_set(error, SKEIN_ERROR_VALUE, writer->path, "%lu samples were promised, %lu were added",
                              (unsigned long)writer->header.samples, (unsigned long)writer->added);
    else {
        status = io_output_commit(writer->output, error);
        writer->output = NULL;
    }
    io_pc2_abandon(writer);
    return status;
}

skein_status io_pc2_keep(io_pc2_writer *writer, const char *path, skein_error *error) {
    assert(writer->header.samples == IO_PC2_UNKNOWN);
    io_output_flush(writer->output);
    uint64_t sample_bytes = (uint64_t)writer->header.points * POINT_BYTES, written = io_output_written(writer->output);
    uint32_t whole = written > HEADER_BYTES ? (uint32_t)((written - HEADER_BYTES) / sample_bytes) : 0;
    if (!whole) {
        io_pc2_abandon(writer);
        return io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    }
    unsigned char bytes[4];
    io_put_u32(bytes, whole < writer->added ? whole : writer->added);
    uint64_t size = HEADER_BYTES + io_get_u32(bytes) * sample_bytes;
    skein_status status =
        io_output_keep(writer->output, path, size, &(io_output_change){SAMPLES_OFFSET, bytes, 4}, error);
    writer->output = NULL;
    io_pc2_abandon(writer);
    return status;
}

void io_pc2_abandon(io_pc2_writer *writer) {
    if (!writer) return;
    io_output_abandon(writer->output);
    free(writer->path);
    free(writer);
}

/* ---- Reading ------------------------------------------------------------------------------- */

struct io_pc2_reader {
    FILE *file;
    char *path;
    io_pc2_header header;
    unsigned char block[BLOCK_POINTS * POINT_BYTES];
};

/* Checks the first bytes and the size against each other. */
static skein_status read_header(io_pc2_reader *reader, skein_error *error) {
    unsigned char bytes[HEADER_BYTES];
    if (fread(bytes, 1, sizeof bytes, reader->file) != sizeof bytes || memcmp(bytes, magic, sizeof magic) != 0)
        return io_error_set(error, SKEIN_ERROR_SYNTAX, reader->path, "not a PC2 file: expected POINTCACHE2");
    if (io_get_u32(bytes + 12) != 1)
        return io_error_set(error, SKEIN_ERROR_SYNTAX, reader->path, "PC2 version %lu: expected 1",
                            (unsigned long)io_get_u32(bytes + 12));
    reader->header = (io_pc2_header){.points = io_get_u32(bytes + 16),
                                     .start = io_get_float(bytes + 20),
                                     .rate = io_get_float(bytes + 24),
                                     .samples = io_get_u32(bytes + SAMPLES_OFFSET)};
    uint64_t points = reader->header.points, samples = reader->header.samples;
    if (points == 0 || points > INT32_MAX || samples > INT32_MAX)
        return io_error_set(error, SKEIN_ERROR_SYNTAX, reader->path,
                            "%llu points and %llu samples: expected 1 to 2147483647", (unsigned long long)points,
                            (unsigned long long)samples);
    // 2^31 x 2^31 x 12 passes 64 bits, so the file's size is divided instead.
    off_t size = fseeko(reader->file, 0, SEEK_END) == 0 ? ftello(reader->file) : -1;
    if (size < 0) return io_error_set(error, SKEIN_ERROR_FILE, reader->path, "cannot read: %s", strerror(errno));
    uint64_t sample_bytes = points * POINT_BYTES, body = (uint64_t)size - HEADER_BYTES;
    if (body / sample_bytes < samples)
        return io_error_set(error, SKEIN_ERROR_SYNTAX, reader->path,
                            "the header counts %llu samples, the file holds %llu%s", (unsigned long long)samples,
                            (unsigned long long)(body / sample_bytes),
                            body % sample_bytes != 0 ? " and a part of one: it is cut off" : "");
    return SKEIN_OK;
}

io_pc2_reader *io_pc2_open(const char *path, io_pc2_header *header, skein_error *error) {
    io_pc2_reader *reader = malloc(sizeof *reader);
    char *name = strdup(path);
    if (!reader || !name) {
        free(reader);
        free(name);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    reader->path = name;
    reader->file = fopen(path, "rb");
    skein_status status = SKEIN_OK;
    if (!reader->file) status = io_error_set(error, SKEIN_ERROR_FILE, path, "cannot read: %s", strerror(errno));
    if (status == SKEIN_OK) status = read_header(reader, error);
    if (status != SKEIN_OK) {
        io_pc2_close(reader);
        return NULL;
    }
    *header = reader->header;
    return reader;
}

skein_status io_pc2_read(io_pc2_reader *reader, uint32_t sample, double *out, skein_error *error) {
    if (sample >= reader->header.samples)
        return io_error_set(error, SKEIN_ERROR_VALUE, reader->path, "sample %lu of %lu, counted from 0",
                            (unsigned long)sample, (unsigned long)reader->header.samples);
    uint64_t offset = HEADER_BYTES + (uint64_t)sample * reader->header.points * POINT_BYTES;
    size_t left = reader->header.points;
    bool fine = fseeko(reader->file, (off_t)offset, SEEK_SET) == 0;
    while (fine && left > 0) {
        size_t count = left < BLOCK_POINTS ? left : BLOCK_POINTS;
        fine = fread(reader->block, POINT_BYTES, count, reader->file) == count;
        for (size_t i = 0; fine && i < 3 * count; i++) out[i] = (double)io_get_float(reader->block + 4 * i);
        out += 3 * count;
        left -= count;
    }
    if (fine) return SKEIN_OK;
    return io_error_set(error, SKEIN_ERROR_FILE, reader->path, "cannot read sample %lu", (unsigned long)sample);
}

void io_pc2_close(io_pc2_reader *reader) {
    if (!reader) return;
    if (reader->file) fclose(reader->file);
    free(reader->path);
    free(reader);
}
