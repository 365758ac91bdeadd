#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *skein_status_text(skein_status status) {
    switch (status) {
    case SKEIN_OK: return "ok";
    case SKEIN_ERROR_MEMORY: return "out of memory";
    case SKEIN_ERROR_VALUE: return "bad value";
    case SKEIN_ERROR_NAME: return "unknown name";
    case SKEIN_ERROR_HANDLE: return "stale handle";
    case SKEIN_ERROR_MESH: return "bad mesh";
    case SKEIN_ERROR_FILE: return "file error";
    case SKEIN_ERROR_SYNTAX: return "syntax error";
    case SKEIN_ERROR_LIMIT: return "limit exceeded";
    }
    return "unknown status";
}

const char *skein_category_text(skein_category category) {
    static const char *const names[SKEIN_CATEGORY_COUNT] = {"body",   "constraint", "force",    "collider",
                                                            "method", "scene",      "exporter", "view"};
    return category < SKEIN_CATEGORY_COUNT ? names[category] : "unknown";
}

skein_status sk_fail(skein_error *error, skein_status status, const char *where, const char *format, ...) {
    if (!error) return status;
    error->status = status;
    snprintf(error->where, sizeof error->where, "%s", where ? where : "");
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof error->message, format, arguments);
    va_end(arguments);
    return status;
}

skein_status sk_fail_memory(skein_error *error, const char *what) {
    return sk_fail(error, SKEIN_ERROR_MEMORY, "", "no memory for %s", what);
}

/* Levenshtein distance of two short texts, one row of the table at a time. */
static size_t edit_distance(const char *a, const char *b) {
    size_t row[64], length = strlen(b);
    if (length > 63 || strlen(a) > 63) return 64;
    for (size_t j = 0; j <= length; j++) row[j] = j;
    for (size_t i = 0; a[i]; i++) {
        size_t corner = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length; j++) {
            size_t best = corner + (a[i] != b[j]);
            if (row[j] + 1 < best) best = row[j] + 1;
            if (row[j + 1] + 1 < best) best = row[j + 1] + 1;
            corner = row[j + 1];
            row[j + 1] = best;
        }
    }
    return row[length];
}

const char *sk_nearest_name(const char *name, const char *const *names, size_t count) {
    const char *nearest = NULL;
    size_t least = strlen(name) / 2 + 2; /* farther than this is no help */
    for (size_t i = 0; i < count; i++) {
        size_t distance = edit_distance(name, names[i]);
        if (distance < least) {
            least = distance;
            nearest = names[i];
        }
    }
    return nearest;
}
