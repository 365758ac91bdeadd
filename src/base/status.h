/* Filling in a skein_error: the words of every failure. */
#ifndef SK_BASE_STATUS_H
#define SK_BASE_STATUS_H

#include <skein/skein.h>

/* Writes `status`, `where` and a formatted message into `error` (which may be NULL); returns `status`. */
skein_status sk_fail(skein_error *error, skein_status status, const char *where, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The failure of an allocation, said in one way everywhere. */
skein_status sk_fail_memory(skein_error *error, const char *what);

/* A pointer that must not be NULL is: SKEIN_ERROR_VALUE, for every public call that returns a status. */
skein_status sk_fail_null(skein_error *error, const char *argument);

/* Copies a name that somebody gave to where it will be printed: what would break a line or steer a terminal (control
 * characters, of UTF-8 too) becomes '?', and what is too long is cut between letters. */
void sk_label_copy(char *out, size_t size, const char *name);

/* Of `count` names, the one nearest to `name` by edit distance, or NULL if none is near. */
const char *sk_nearest_name(const char *name, const char *const *names, size_t count);

#endif
