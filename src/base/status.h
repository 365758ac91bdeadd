/* Filling in a skein_error: how every failure is reported. */
#ifndef SK_BASE_STATUS_H
#define SK_BASE_STATUS_H

#include <skein/skein.h>

#include "base/printf.h"

/* Writes `status`, `where` and a formatted message into `error` (which may be NULL); returns `status`. */
skein_status sk_fail(skein_error *error, skein_status status, const char *where, const char *format, ...)
    SK_PRINTF(4, 5);

/* The failure of an allocation, with the same message everywhere. Inline, so that a caller's reader sees its status. */
static inline skein_status sk_fail_memory(skein_error *error, const char *what) {
    sk_fail(error, SKEIN_ERROR_MEMORY, "", "no memory for %s", what);
    return SKEIN_ERROR_MEMORY;
}

/* The error of public calls for a pointer that is NULL and must not be. */
static inline skein_status sk_fail_null(skein_error *error, const char *argument) {
    sk_fail(error, SKEIN_ERROR_VALUE, argument, "%s is NULL", argument);
    return SKEIN_ERROR_VALUE;
}

/* Copies a user's name for printing: control characters (also those of UTF-8), which could break a line or control a
 * terminal, become '?', and too long a name is cut between characters. */
void sk_label_copy(char *out, size_t size, const char *name);

/* Of `count` names, the one nearest to `name` by edit distance, or NULL if none is near. */
const char *sk_nearest_name(const char *name, const char *const *names, size_t count);

#endif
