/* What the formats of clips share: see clip.h for the contract. */
#include "io/clip.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* A new format is its own file and a row here. */
static const io_clip_format *const formats[] = {&io_clip_obj,  &io_clip_pc2, &io_clip_mdd, &io_clip_glb,
                                                &io_clip_usda, &io_clip_ply, &io_clip_stl};

const io_clip_format *io_clip_format_at(size_t index) {
    return index < sizeof formats / sizeof *formats ? formats[index] : NULL;
}

const io_clip_format *io_clip_format_named(const char *name) {
    const io_clip_format *format;
    for (size_t i = 0; (format = io_clip_format_at(i)); i++)
        if (!strcmp(format->kind.name, name)) return format;
    return NULL;
}

const io_clip_format *io_clip_format_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *ending = strrchr(name, '.');
    const io_clip_format *format;
    for (size_t i = 0; ending && ending > name && (format = io_clip_format_at(i)); i++)
        if (!strcasecmp(format->ending, ending)) return format;
    return NULL;
}

void io_clip_place(const io_clip_params *params, double *positions, size_t count) {
    if (params->up == IO_UP_Y && params->scale == 1) return;
    for (double *p = positions; p < positions + 3 * count; p += 3) {
        double y = p[1], z = p[2];
        p[0] *= params->scale;
        p[1] = params->scale * (params->up == IO_UP_Z ? -z : y);
        p[2] = params->scale * (params->up == IO_UP_Z ? y : z);
    }
}

skein_status io_clip_check_positions(const char *path, const double *positions, size_t count, skein_error *error) {
    for (size_t i = 0; i < 3 * count; i++) {
        if (isfinite((float)positions[i])) continue;
        const double *p = positions + i / 3 * 3;
        return io_error_set(error, SKEIN_ERROR_VALUE, path,
                            "not written: vertex %zu is at (%g, %g, %g), which is not finite as a float "
                            "(has the motion blown up?)",
                            i / 3, p[0], p[1], p[2]);
    }
    return SKEIN_OK;
}

void io_clip_append_part(io_output *output, const char *part, uint64_t offset, uint64_t size) {
    char block[1 << 15];
    int fd = open(part, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    ssize_t got = fd < 0 ? -1 : 1;
    for (; size > 0 && got > 0; size -= (uint64_t)got, offset += (uint64_t)got) {
        got = pread(fd, block, size < sizeof block ? (size_t)size : sizeof block, (off_t)offset);
        if (got < 0 && errno == EINTR)
            got = pread(fd, block, size < sizeof block ? (size_t)size : sizeof block, (off_t)offset);
        if (got <= 0) break;
        io_output_write(output, block, (size_t)got);
    }
    if (fd >= 0) close(fd);
    if (size > 0) io_output_fail(output, got < 0 && errno ? errno : EIO);
}
