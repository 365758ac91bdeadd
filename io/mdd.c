/* The exporter "mdd": Lightwave's point cache, which Blender, Maya and others read.
 *
 *   int32 samples, int32 points, samples x float seconds, samples x points x (float x, y, z), all big endian
 *
 * The times stand before the positions, so that their number has to be known first: room is made for the samples that
 * the run is going to have, and if it ends early those that there are move up, within the file.
 *
 * Owns: the file's layout. Invariant: a file under its final name holds exactly the samples that it counts.
 */
#include "io/bytes.h"
#include "io/clip.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BLOCK_POINTS = 4096, POINT_BYTES = 12, COUNTS_BYTES = 8 };

typedef struct mdd {
    io_output *output;
    char *path;
    uint32_t points, room, added; /* room: for so many samples */
    double seconds;               /* from one sample to the next */
    unsigned char block[BLOCK_POINTS * POINT_BYTES];
} mdd;

static void mdd_free(mdd *m) {
    if (!m) return;
    io_output_abandon(m->output);
    free(m->path);
    free(m);
}

/* The counts and the times of so many samples. */
static void write_head(const mdd *m, io_output *output, uint32_t samples) {
    unsigned char bytes[COUNTS_BYTES];
    io_put_u32_big(bytes, samples);
    io_put_u32_big(bytes + 4, m->points);
    io_output_write(output, bytes, sizeof bytes);
    for (uint32_t s = 0; s < samples; s++) {
        io_put_u32_big(bytes, io_float_bits((float)(s * m->seconds)));
        io_output_write(output, bytes, 4);
    }
}

static void *create(const io_clip *clip, const char *path, skein_error *error) {
    if (clip->mesh.vertex_count == 0 || clip->mesh.vertex_count > INT32_MAX || clip->samples > INT32_MAX) {
        io_error_set(error, SKEIN_ERROR_LIMIT, path,
                     "an MDD file holds 1 to 2147483647 points and samples, not %zu points and %lu samples",
                     clip->mesh.vertex_count, (unsigned long)clip->samples);
        return NULL;
    }
    mdd *m = calloc(1, sizeof *m);
    if (!m || !(m->path = strdup(path))) {
        free(m);
        io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory");
        return NULL;
    }
    m->points = (uint32_t)clip->mesh.vertex_count;
    m->room = clip->samples;
    m->seconds = clip->params->every / clip->fps;
    m->output = io_output_open(path, error);
    if (!m->output) {
        mdd_free(m);
        return NULL;
    }
    write_head(m, m->output, m->room);
    return m;
}

static skein_status add(void *file, const double *positions, skein_error *error) {
    mdd *m = file;
    if (m->added == m->room)
        return io_error_set(error, SKEIN_ERROR_VALUE, m->path, "there is room for %lu samples only",
                            (unsigned long)m->room);
    for (size_t left = m->points; left > 0;) {
        size_t count = left < BLOCK_POINTS ? left : BLOCK_POINTS;
        for (size_t i = 0; i < 3 * count; i++) io_put_u32_big(m->block + 4 * i, io_float_bits((float)positions[i]));
        io_output_write(m->output, m->block, count * POINT_BYTES);
        positions += 3 * count;
        left -= count;
    }
    io_output_flush(m->output);
    skein_status status = io_output_status(m->output, error);
    m->added += status == SKEIN_OK;
    return status;
}

/* Moves the samples that there are to where they stand behind as many times, within the file: a full disk has no room
 * for another one. Returns the file's size, or 0 where it cannot. */
static uint64_t shorten(mdd *m) {
    uint64_t from = COUNTS_BYTES + 4 * (uint64_t)m->room, to = COUNTS_BYTES + 4 * (uint64_t)m->added;
    uint64_t left = (uint64_t)m->added * m->points * POINT_BYTES, size = to + left;
    const char *part = io_output_part(m->output);
    int fd = part ? open(part, O_RDONLY | O_CLOEXEC | O_NOFOLLOW) : -1;
    io_output_flush(m->output);
    io_output_cut(m->output, from + left); // what there is of a sample that did not fit
    while (left > 0 && fd >= 0) {
        ssize_t got = pread(fd, m->block, left < sizeof m->block ? (size_t)left : sizeof m->block, (off_t)from);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        io_output_patch(m->output, to, m->block, (size_t)got);
        from += (uint64_t)got;
        to += (uint64_t)got;
        left -= (uint64_t)got;
    }
    if (fd >= 0) close(fd);
    unsigned char count[4];
    io_put_u32_big(count, m->added);
    io_output_patch(m->output, 0, count, sizeof count);
    return left > 0 || fd < 0 || io_output_status(m->output, NULL) ? 0 : size;
}

static skein_status commit(void *file, skein_error *error) {
    mdd *m = file;
    skein_status status = io_output_status(m->output, error);
    if (!status && m->added < m->room) {
        uint64_t size = shorten(m);
        if (size) io_output_cut(m->output, size);
        else
            status = io_error_set(error, SKEIN_ERROR_FILE, m->path,
                                  "cannot write: its times cannot be put right, now that there are %lu samples of %lu",
                                  (unsigned long)m->added, (unsigned long)m->room);
    }
    if (!status) {
        status = io_output_commit(m->output, error);
        m->output = NULL;
    }
    mdd_free(m);
    return status;
}

static skein_status keep(void *file, const char *path, skein_error *error) {
    mdd *m = file;
    uint64_t size = m->added ? shorten(m) : 0;
    skein_status status = SKEIN_OK;
    if (!size) status = io_error_set(error, SKEIN_ERROR_VALUE, path, IO_NOTHING_KEPT);
    else {
        status = io_output_keep(m->output, path, size, NULL, error);
        m->output = NULL;
    }
    mdd_free(m);
    return status;
}

static void abandon(void *file) {
    mdd_free(file);
}

static const skein_field fields[] = {
    IO_CLIP_FIELD_EVERY(1, 1, "one sample each so many frames"),
    IO_CLIP_FIELD_UP,
    IO_CLIP_FIELD_SCALE,
};

const io_clip_format io_clip_mdd = {
    .kind = {.name = "mdd",
             .help = "MDD point cache of the whole run, with the time of every frame; only where a scene asks for it.",
             .category = SKEIN_EXPORTER,
             .fields = fields,
             .field_count = sizeof fields / sizeof *fields,
             .params_size = sizeof(io_clip_params)},
    .ending = ".mdd",
    .create = create,
    .add = add,
    .commit = commit,
    .keep = keep,
    .abandon = abandon,
};
