/* The guard between the program and a terminal: streams that let through what is text and steer nothing. */
#define _GNU_SOURCE // fopencookie()
#include "app/terminal.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "io/printable.h"

void app_terminal_draw(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vdprintf(STDERR_FILENO, format, arguments);
    va_end(arguments);
}

#ifdef __GLIBC__

/* A stream and the beginning of a letter whose end comes with the next write. */
typedef struct guard {
    int fd;
    char begun[4];
    size_t begun_count;
} guard;

static bool write_all(int fd, const char *bytes, size_t size) {
    while (size > 0) {
        ssize_t done = write(fd, bytes, size);
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return false;
        bytes += done;
        size -= (size_t)done;
    }
    return true;
}

static ssize_t write_clean(void *data, const char *bytes, size_t size) {
    guard *g = data;
    char clean[4096];
    size_t used = 0, taken = 0;
    while (taken < size || g->begun_count > 0) {
        // a letter at a time, its first bytes perhaps from the last write
        char letter[4];
        size_t from_before = g->begun_count, count = from_before;
        memcpy(letter, g->begun, from_before);
        while (count < sizeof letter && taken + count - from_before < size) {
            letter[count] = bytes[taken + count - from_before];
            count++;
        }
        bool fine;
        size_t length = io_printable_letter(letter, count, &fine);
        if (length == 0) { // the end is still to come
            memcpy(g->begun, letter, count);
            g->begun_count = count;
            break;
        }
        if (used + length > sizeof clean) {
            if (!write_all(g->fd, clean, used)) return 0;
            used = 0;
        }
        memcpy(clean + used, fine ? letter : "?", fine ? length : 1);
        used += fine ? length : 1;
        // of the bytes from before those that are left; of the others those that were used
        size_t old = length < from_before ? length : from_before;
        memmove(g->begun, g->begun + old, from_before - old);
        g->begun_count = from_before - old;
        taken += length - old;
    }
    return write_all(g->fd, clean, used) ? (ssize_t)size : 0;
}

static FILE *guarded(guard *g, int mode) {
    FILE *stream = fopencookie(g, "w", (cookie_io_functions_t){.write = write_clean});
    if (stream) setvbuf(stream, NULL, mode, BUFSIZ);
    return stream;
}

void app_terminal_guard(void) {
    static guard out = {.fd = STDOUT_FILENO}, err = {.fd = STDERR_FILENO};
    FILE *to_out = guarded(&out, isatty(STDOUT_FILENO) ? _IOLBF : _IOFBF), *to_err = guarded(&err, _IONBF);
    if (to_out) stdout = to_out;
    if (to_err) stderr = to_err;
}

#else
void app_terminal_guard(void) {}
#endif
