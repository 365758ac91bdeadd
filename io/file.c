/* Files in and out: see file.h for the contract.
 *
 * Output is not synced to the disk before the rename: a series of frames would wait for the disk at
 * each one, and what is guarded against is a program that stops or a full disk, not a power cut. A writer that wants
 * more asks for it (io_output_sync).
 */
#include "io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static const char *fault_text(int fault) {
    switch (fault) {
    case ENOENT: return "no such file or directory";
    case ENOTDIR: return "a part of the path is not a directory";
    case EACCES:
    case EPERM: return "no permission";
    case EISDIR: return "it is a directory";
    case ENOSPC: return "the disk is full";
    case EDQUOT: return "the disk quota is used up";
    case EFBIG: return "it grew over the limit for a file's size";
    case EROFS: return "the disk is read-only";
    case ESPIPE: return "it is a pipe, and this format needs a file";
    default: return strerror(fault);
    }
}

/* ---- Reading ------------------------------------------------------------------------------- */

/* Opens a file for reading, and nothing else: a pipe would be waited for, perhaps for ever, and a device has no end.
 * Not blocking makes no difference to a file. */
static int open_to_read(const char *path, struct stat *info, skein_error *error) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0 || fstat(fd, info) != 0) {
        int fault = errno;
        if (fd >= 0) close(fd);
        io_error_set(error, SKEIN_ERROR_FILE, path, "cannot read: %s", fault_text(fault));
        return -1;
    }
    if (S_ISREG(info->st_mode)) return fd;
    close(fd);
    io_error_set(error, SKEIN_ERROR_FILE, path, "cannot read: it is a %s, expected a file",
                 S_ISDIR(info->st_mode)    ? "directory"
                 : S_ISFIFO(info->st_mode) ? "pipe"
                                           : "device");
    return -1;
}

skein_status io_file_read(const char *path, size_t most, io_bytes *out, skein_error *error) {
    *out = (io_bytes){NULL, 0};
    struct stat info;
    int fd = open_to_read(path, &info, error);
    if (fd < 0) return SKEIN_ERROR_FILE;

    // The size is a guess only: files of /proc have none, and a file may grow while it is read.
    size_t capacity = 0;
    bool too_large = (uintmax_t)info.st_size > most;
    size_t guess = !too_large && info.st_size > 0 ? (size_t)info.st_size + 2 : 1u << 16;
    bool memory = io_grow(&out->data, &capacity, guess, 1);
    ssize_t got = 0;
    while (memory && !too_large) {
        size_t room = capacity - 1 - out->size;
        got = read(fd, out->data + out->size, room < 1u << 30 ? room : 1u << 30);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        out->size += (size_t)got;
        too_large = out->size > most;
        memory = io_grow(&out->data, &capacity, out->size + 2, 1);
    }
    int fault = errno;
    close(fd);
    if (memory && !too_large && got == 0) {
        out->data[out->size] = '\0';
        return SKEIN_OK;
    }
    io_bytes_free(out);
    if (!memory) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory while reading the file");
    if (too_large)
        return io_error_set(error, SKEIN_ERROR_LIMIT, path, "the file is larger than the %zu bytes allowed here", most);
    return io_error_set(error, SKEIN_ERROR_FILE, path, "cannot read: %s", fault_text(fault));
}

/* Whether `real`, without links, lies in the folder of `path`. */
static bool lies_in_folder_of(const char *real, const char *path) {
    const char *slash = strrchr(path, '/');
    char *name = slash ? strndup(path, (size_t)(slash + 1 - path)) : strdup("."),
         *whole = name ? realpath(name, NULL) : NULL;
    size_t length = whole ? strlen(whole) : 0;
    bool inside = whole && !strncmp(real, whole, length) && (length == 1 || real[length] == '/');
    free(name), free(whole);
    return inside;
}

skein_status io_file_read_beside(const char *first, const char *path, size_t most, io_bytes *out, skein_error *error) {
    *out = (io_bytes){NULL, 0};
    char *real = realpath(path, NULL), *origin = realpath(first, NULL);
    bool away = real && !lies_in_folder_of(real, path) && !(origin && lies_in_folder_of(real, origin));
    skein_status status = SKEIN_OK;
    if (away)
        status = io_error_set(error, SKEIN_ERROR_FILE, path,
                              "is a link out of its folder, to %s: put the file itself there", real);
    free(real), free(origin);
    return status ? status : io_file_read(path, most, out, error);
}

void io_bytes_free(io_bytes *bytes) {
    free(bytes->data);
    *bytes = (io_bytes){NULL, 0};
}

/* ---- Writing ------------------------------------------------------------------------------- */

struct io_output {
    int fd;
    int fault;        /* errno of the first failure, or 0 */
    char *path;       /* as the caller named it, for messages */
    char *final_path; /* where the file will stand, links followed */
    char *part_path;  /* where it stands until then; NULL where a device or pipe is written directly */
    uint64_t written; /* bytes that went through, without those in the buffer */
    double looked;    /* seconds: when io_output_is_due() last said yes */
    locale_t locale;  /* the plain one, in which numbers are written whatever the program's is; or 0 */
    size_t used;
    char buffer[1 << 16];
};

enum { MOST_PART_NAME = 200 }; /* of the final name in the part's: the whole must be a name, too */

static void output_free(io_output *output) {
    if (output->fd >= 0) close(output->fd);
    if (output->part_path) unlink(output->part_path);
    free(output->part_path);
    free(output->final_path);
    free(output->path);
    if (output->locale) freelocale(output->locale);
    free(output);
}

/* Creates the part file beside the final name. Returns 0 or an errno. */
static int part_open(io_output *output) {
    const char *slash = strrchr(output->final_path, '/');
    size_t folder = slash ? (size_t)(slash + 1 - output->final_path) : 0, size = folder + MOST_PART_NAME + 64;
    char *part = malloc(size);
    if (!part) return ENOMEM;
    memcpy(part, output->final_path, folder);
    // O_EXCL picks a name nobody has and follows no link; 0666 leaves the mode to the user's umask.
    for (int n = 0; n < 1000; n++) {
        int length = snprintf(part + folder, size - folder, "%.*s.%ld", (int)MOST_PART_NAME,
                              output->final_path + folder, (long)getpid());
        snprintf(part + folder + length, size - folder - (size_t)length, n ? "-%d.part" : ".part", n);
        output->fd = open(part, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
        if (output->fd >= 0) {
            output->part_path = part;
            return 0;
        }
        if (errno != EEXIST) break;
    }
    int fault = errno;
    free(part);
    return fault;
}

/* Opens the output by what stands under its name now. Returns 0 or an errno. */
static int output_start(io_output *output) {
    struct stat info;
    bool exists = stat(output->path, &info) == 0;
    if (!exists && errno != ENOENT) return errno;
    // A device or pipe must never be replaced by a file.
    if (exists && !S_ISREG(info.st_mode)) {
        output->fd = open(output->path, O_WRONLY | O_CLOEXEC);
        return output->fd < 0 ? errno : 0;
    }
    if (exists && access(output->path, W_OK) != 0) return errno;
    output->final_path = exists ? realpath(output->path, NULL) : strdup(output->path);
    if (!output->final_path) return errno;
    size_t length = strlen(output->path);
    if (length == 0 || output->path[length - 1] == '/') return length == 0 ? ENOENT : EISDIR;
    int fault = part_open(output);
    // Some file systems have no modes: then the file is as they make it.
    if (fault == 0 && exists) (void)fchmod(output->fd, info.st_mode & 0777);
    return fault;
}

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

io_output *io_output_open(const char *path, skein_error *error) {
    io_output *output = malloc(sizeof *output);
    if (output) {
        output->fd = -1;
        output->fault = 0;
        output->used = 0;
        output->written = 0;
        output->looked = seconds_now();
        output->locale = newlocale(LC_NUMERIC_MASK, "C", (locale_t)0);
        output->path = strdup(path);
        output->final_path = output->part_path = NULL;
    }
    int fault = output && output->path && output->locale ? output_start(output) : ENOMEM;
    if (fault == 0) return output;
    if (output) output_free(output);
    io_error_set(error, fault == ENOMEM ? SKEIN_ERROR_MEMORY : SKEIN_ERROR_FILE, path, "cannot write: %s",
                 fault == ENOENT ? "its directory does not exist, create it first" : fault_text(fault));
    return NULL;
}

/* Writes all bytes through to the file; `offset` -1 appends. */
static void write_through(io_output *output, const char *bytes, size_t size, off_t offset) {
    while (size > 0 && output->fault == 0) {
        ssize_t done = offset < 0 ? write(output->fd, bytes, size) : pwrite(output->fd, bytes, size, offset);
        if (done < 0) {
            if (errno != EINTR) output->fault = errno;
            continue;
        }
        bytes += done;
        size -= (size_t)done;
        output->written += offset < 0 ? (uint64_t)done : 0;
        offset = offset < 0 ? offset : offset + done;
    }
}

void io_output_flush(io_output *output) {
    write_through(output, output->buffer, output->used, -1);
    output->used = 0;
}

void io_output_write(io_output *output, const void *bytes, size_t size) {
    if (size > sizeof output->buffer - output->used) io_output_flush(output);
    if (size > sizeof output->buffer) {
        write_through(output, bytes, size, -1);
        return;
    }
    memcpy(output->buffer + output->used, bytes, size);
    output->used += size;
}

void io_output_printf(io_output *output, const char *format, ...) {
    char line[1024], *text = line;
    va_list arguments;
    locale_t before = uselocale(output->locale); // of this thread alone
    va_start(arguments, format);
    int length = vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    if (length >= (int)sizeof line && (text = malloc((size_t)length + 1)) != NULL) {
        va_start(arguments, format);
        vsnprintf(text, (size_t)length + 1, format, arguments);
        va_end(arguments);
    }
    uselocale(before);
    if (length >= 0 && text) io_output_write(output, text, (size_t)length);
    else if (output->fault == 0) output->fault = length < 0 ? EINVAL : ENOMEM;
    if (text != line) free(text);
}

void io_output_count(io_output *output, uint64_t value) {
    char text[20], *at = text + sizeof text;
    do *--at = (char)('0' + value % 10);
    while ((value /= 10) != 0);
    io_output_write(output, at, (size_t)(text + sizeof text - at));
}

void io_output_patch(io_output *output, uint64_t offset, const void *bytes, size_t size) {
    io_output_flush(output);
    write_through(output, bytes, size, (off_t)offset);
}

const char *io_output_part(const io_output *output) {
    return output->part_path;
}

uint64_t io_output_place(const io_output *output) {
    return output->written + output->used;
}

uint64_t io_output_written(const io_output *output) {
    return output->written;
}

bool io_output_is_due(io_output *output) {
    double now = seconds_now();
    if (now - output->looked < 0.25) return false;
    output->looked = now;
    return true;
}

void io_output_sync(io_output *output) {
    io_output_flush(output);
    // a pipe, or a file system without it: there is no disk to wait for
    if (output->fault == 0 && output->part_path && fsync(output->fd) != 0 && errno != EINVAL && errno != ENOTSUP)
        output->fault = errno;
}

void io_output_fail(io_output *output, int fault) {
    if (output->fault == 0) output->fault = fault;
}

void io_output_fail_memory(io_output *output) {
    io_output_fail(output, ENOMEM);
}

skein_status io_output_status(const io_output *output, skein_error *error) {
    if (output->fault == 0) return SKEIN_OK;
    return io_error_set(error, SKEIN_ERROR_FILE, output->path, "cannot write: %s", fault_text(output->fault));
}

skein_status io_output_commit(io_output *output, skein_error *error) {
    io_output_flush(output);
    // Some file systems report a full disk only here.
    int closed = close(output->fd), fault = errno;
    output->fd = -1;
    if (output->fault == 0 && closed != 0) output->fault = fault;
    if (output->fault == 0 && output->part_path && rename(output->part_path, output->final_path) != 0)
        output->fault = errno;
    skein_status status = io_output_status(output, error);
    if (status == SKEIN_OK) {
        // The part file has become the file: nothing is left to remove.
        free(output->part_path);
        output->part_path = NULL;
    }
    output_free(output);
    return status;
}

void io_output_cut(io_output *output, uint64_t size) {
    output->used = 0;
    output->fault = 0;
    if (ftruncate(output->fd, (off_t)size) != 0 || lseek(output->fd, (off_t)size, SEEK_SET) < 0) output->fault = errno;
    else output->written = size;
}

skein_status io_output_keep(io_output *output, const char *path, uint64_t size, const io_output_change *change,
                            skein_error *error) {
    io_output_flush(output);
    if (!output->part_path) { // a device has what it has
        output_free(output);
        return SKEIN_OK;
    }
    // After a full disk, places that were written before can still be changed.
    output->fault = 0;
    if (size < output->written && ftruncate(output->fd, (off_t)size) != 0) output->fault = errno;
    if (change) write_through(output, change->bytes, change->size, (off_t)change->offset);
    if (output->fault == 0 && rename(output->part_path, path) != 0) output->fault = errno;
    skein_status status = SKEIN_OK;
    if (output->fault != 0)
        status = io_error_set(error, SKEIN_ERROR_FILE, path, "cannot write: %s", fault_text(output->fault));
    else {
        free(output->part_path);
        output->part_path = NULL;
    }
    output_free(output);
    return status;
}

void io_output_abandon(io_output *output) {
    if (output) output_free(output);
}
