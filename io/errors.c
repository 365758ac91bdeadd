/* How io/ reports errors and warnings, and makes room: the part of file.h that needs no file system, as in a browser. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/file.h"

/* ---- Errors -------------------------------------------------------------------------------- */

static void where_set(skein_error *error, const char *where) {
    size_t length = strlen(where), room = sizeof error->where - 1;
    if (length <= room) {
        memcpy(error->where, where, length + 1);
        return;
    }
    // The end of a path says more than its front.
    memcpy(error->where, "...", 3);
    memcpy(error->where + 3, where + length - (room - 3), room - 3 + 1);
}

skein_status io_error_set(skein_error *error, skein_status status, const char *where, const char *format, ...) {
    if (!error) return status;
    error->status = status;
    where_set(error, where);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return status;
}

skein_status io_error_at(skein_error *error, skein_status status, const char *path, size_t line, const char *format,
                         ...) {
    if (!error) return status;
    error->status = status;
    // The line stays whole, the path gives way.
    char place[sizeof error->where];
    size_t length = strlen(path), room = sizeof place - 24;
    const char *tail = length > room ? path + length - room : path;
    snprintf(place, sizeof place, "%s%s:%zu", length > room ? "..." : "", tail, line);
    where_set(error, place);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return status;
}

const char *io_quote(const char *begin, const char *end, char out[IO_QUOTE_SIZE]) {
    size_t length = (size_t)(end - begin), room = IO_QUOTE_SIZE - 6, at = 0;
    out[at++] = '\'';
    for (size_t i = 0; i < length && i < room; i++) out[at++] = begin[i] >= ' ' && begin[i] <= '~' ? begin[i] : '?';
    memcpy(out + at, length > room ? "...'" : "'", length > room ? 5 : 2);
    return out;
}

void io_warn(io_warnings warnings, const char *format, ...) {
    if (!warnings.write) return;
    char line[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    warnings.write(warnings.user, line);
}

/* ---- Memory -------------------------------------------------------------------------------- */

bool io_grow(void *array_pointer, size_t *capacity, size_t need, size_t item_size) {
    if (need <= *capacity) return true;
    size_t more = *capacity < 32 ? 64 : *capacity + *capacity / 2;
    if (more < need) more = need;
    if (more > PTRDIFF_MAX / item_size) return false;
    // The pointer's own type is the caller's; its bytes are copied, not reinterpreted.
    void *array;
    memcpy(&array, array_pointer, sizeof array);
    array = realloc(array, more * item_size);
    if (!array) return false;
    memcpy(array_pointer, &array, sizeof array);
    *capacity = more;
    return true;
}
