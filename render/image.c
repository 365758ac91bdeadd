/* Pictures in memory and as PNG files; see image.h. */
#include "render/image.h"

#include "render/fail.h"
#include "render/stb.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

skein_status render_image_resize(render_image *image, int width, int height, skein_error *error) {
    if (image->pixels && image->width == width && image->height == height) return SKEIN_OK;
    uint8_t *pixels = realloc(image->pixels, (size_t)width * (size_t)height * 3);
    if (!pixels) return render_fail_memory(error, "the picture");
    *image = (render_image){width, height, pixels};
    return SKEIN_OK;
}

void render_image_release(render_image *image) {
    free(image->pixels);
    *image = (render_image){0, 0, NULL};
}

const uint8_t *render_image_pixel(const render_image *image, int x, int y) {
    return &image->pixels[3 * ((size_t)y * (size_t)image->width + (size_t)x)];
}

/* ---- Writing -------------------------------------------------------------------------------- */

static skein_status fail_file(skein_error *error, const char *path, const char *what, int reason) {
    const char *advice = reason == ENOENT   ? "; make the directory first"
                         : reason == ENOSPC ? "; make room or write elsewhere"
                         : reason == EISDIR ? "; name a file in it"
                                            : "";
    return render_fail(error, SKEIN_ERROR_FILE, path, "cannot %s: %s%s", what, strerror(reason), advice);
}

/* All bytes into an open file, and on to the disk; returns 0 or an errno. */
static int write_all(int file, const uint8_t *bytes, size_t length, bool to_disk) {
    while (length > 0) {
        ssize_t written = write(file, bytes, length);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written < 0 ? errno : EIO;
        bytes += written, length -= (size_t)written;
    }
    return to_disk && fsync(file) != 0 && errno != EINVAL ? errno : 0;
}

/* Straight into what `path` names: for devices and pipes, which cannot be replaced. */
static skein_status write_straight(const char *path, const uint8_t *bytes, size_t length, skein_error *error) {
    int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0) return fail_file(error, path, "open the file", errno);
    int reason = write_all(file, bytes, length, false);
    if (close(file) != 0 && reason == 0) reason = errno;
    return reason ? fail_file(error, path, "write the file", reason) : SKEIN_OK;
}

/* Into a new file beside `path`, which takes its name when all is well and is gone otherwise. */
static skein_status write_beside(const char *path, const uint8_t *bytes, size_t length, skein_error *error) {
    size_t room = strlen(path) + 40;
    char *beside = malloc(room);
    if (!beside) return render_fail_memory(error, "a file name");

    // a name that nobody else has; a left-over of an earlier process with our number is passed by
    int file = -1, reason = EEXIST;
    for (int attempt = 0; attempt < 100 && file < 0 && reason == EEXIST; attempt++) {
        snprintf(beside, room, "%s.part-%ld-%d", path, (long)getpid(), attempt);
        file = open(beside, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        reason = file < 0 ? errno : 0;
    }
    if (file < 0) {
        free(beside);
        return fail_file(error, path, "create the file", reason);
    }

    reason = write_all(file, bytes, length, true);
    if (close(file) != 0 && reason == 0) reason = errno;
    if (reason == 0 && rename(beside, path) != 0) reason = errno;
    if (reason != 0) unlink(beside);
    free(beside);
    return reason ? fail_file(error, path, "write the file", reason) : SKEIN_OK;
}

skein_status render_image_write_png(const render_image *image, const char *path, skein_error *error) {
    struct stat there;
    bool exists = stat(path, &there) == 0;
    if (exists && S_ISDIR(there.st_mode)) return fail_file(error, path, "write the file", EISDIR);

    int length = 0;
    uint8_t *bytes = render_stb_encode_png(image->pixels, image->width, image->height, &length);
    if (!bytes) return render_fail_memory(error, "the PNG");
    skein_status status = exists && !S_ISREG(there.st_mode) ? write_straight(path, bytes, (size_t)length, error)
                                                            : write_beside(path, bytes, (size_t)length, error);
    free(bytes);
    return status;
}

/* ---- Reading -------------------------------------------------------------------------------- */

/* A pipe would be waited for, perhaps for ever; not blocking makes no difference to a file. */
static FILE *open_to_read(const char *path, skein_error *error) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat info;
    if (fd >= 0 && !fstat(fd, &info) && !S_ISREG(info.st_mode)) {
        close(fd);
        render_fail(error, SKEIN_ERROR_FILE, path, "cannot read: it is a %s, expected a PNG or JPEG",
                    S_ISDIR(info.st_mode)    ? "directory"
                    : S_ISFIFO(info.st_mode) ? "pipe"
                                             : "device");
        return NULL;
    }
    FILE *file = fd < 0 ? NULL : fdopen(fd, "rb");
    if (!file)
        render_fail(error, SKEIN_ERROR_FILE, path, "cannot read: %s; give the path of a PNG or JPEG", strerror(errno));
    if (!file && fd >= 0) close(fd);
    return file;
}

skein_status render_image_read(render_image *image, const char *path, skein_error *error) {
    FILE *file = open_to_read(path, error);
    if (!file) return SKEIN_ERROR_FILE;
    int width = 0, height = 0;
    const char *problem = "";
    uint8_t *pixels = NULL;
    bool measured = render_stb_measure(file, &width, &height, &problem);
    bool small = measured && (int64_t)width * height <= RENDER_IMAGE_MOST_PIXELS;
    if (small) pixels = render_stb_decode(file, &width, &height, &problem);
    fclose(file);
    if (measured && !small)
        return render_fail(error, SKEIN_ERROR_LIMIT, path,
                           "the picture has %d x %d pixels, and at most %d are read, 8192 x 4096, say: make it smaller",
                           width, height, RENDER_IMAGE_MOST_PIXELS);
    if (!pixels)
        return render_fail(error, SKEIN_ERROR_SYNTAX, path, "not a PNG or JPEG that can be read (%s)", problem);
    render_image_release(image);
    *image = (render_image){width, height, pixels};
    return SKEIN_OK;
}
