/* Filling in a skein_error: the words of every failure. */
#ifndef SK_BASE_STATUS_H
#define SK_BASE_STATUS_H

#include <skein/skein.h>

#include "base/printf.h"

/* Writes `status`, `where` and a formatted message into `error` (which may be NULL); returns `status`. */
skein_status sk_fail(skein_error *error, skein_status status, const char *where, const char *format, ...)
    SK_PRINTF(4, 5);

/* The failure of an allocation, said in one way everywhere. Here, so that who reads the code knows that it is one. */
static inline skein_status sk_fail_memory(skein_error *error, const char *what) {
    sk_fail(error, SKEIN_ERROR_MEMORY, "", "no memory for %s", what);
    return SKEIN_ERROR_MEMORY;
}

/* A pointer that must not be NULL is, for every public call that returns a status. */
static inline skein_status sk_fail_null(skein_error *error, const char *argument) {
    sk_fail(error, SKEIN_ERROR_VALUE, argument, "%s is NULL", argument);
    return SKEIN_ERROR_VALUE;
}

/* Copies a name that somebody gave to where it will be printed: what would break a line or steer a terminal (control
 * characters, of UTF-8 too) becomes '?', and what is too long is cut between letters. */
void sk_label_copy(char *out, size_t size, const char *name);

/* Of `count` names, the one nearest to `name` by edit distance, or NULL if none is near. */
const char *sk_nearest_name(const char *name, const char *const *names, size_t count);

#endif
