/* Messages of errors, labels made safe to print, and the known name nearest to an unknown one. */
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
    static const char *const names[SKEIN_CATEGORY_COUNT] = {"body",   "constraint", "force",    "collider", "motion",
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

void sk_label_copy(char *out, size_t size, const char *name) {
    const unsigned char *from = (const unsigned char *)name;
    size_t at = 0;
    while (*from) {
        size_t length = 1; // of a UTF-8 character with its continuation bytes
        while ((from[length] & 0xc0) == 0x80) length++;
        if (at + length >= size) break;
        bool control = from[0] < 0x20 || from[0] == 0x7f || (from[0] == 0xc2 && from[1] >= 0x80 && from[1] < 0xa0);
        if (control) out[at++] = '?';
        else memcpy(out + at, from, length), at += length;
        from += length;
    }
    out[at] = 0;
}

/* The least number of letters to change, add, leave out or swap with the next one (optimal string alignment); the table
 * keeps rows for two letters back. Names longer than MOST count as farthest apart. */
static size_t edit_distance(const char *a, const char *b) {
    enum { MOST = 64 };
    size_t rows[3][MOST + 1], length = strlen(b), height = strlen(a);
    if (length > MOST || height > MOST) return MOST;
    for (size_t j = 0; j <= length; j++) rows[0][j] = j;
    for (size_t i = 1; i <= height; i++) {
        size_t *row = rows[i % 3];
        const size_t *above = rows[(i + 2) % 3], *swapped = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            size_t best = above[j - 1] + (a[i - 1] != b[j - 1]);
            if (above[j] + 1 < best) best = above[j] + 1;
            if (row[j - 1] + 1 < best) best = row[j - 1] + 1;
            bool swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
            if (swap && swapped[j - 2] + 1 < best) best = swapped[j - 2] + 1;
            row[j] = best;
        }
    }
    return rows[height % 3][length];
}

/* Whether `name` is one of the parts that dots and underscores divide `whole` into, or several in a row. */
static bool is_part(const char *name, const char *whole) {
    size_t length = strlen(name);
    for (const char *at = whole; length && (at = strstr(at, name)) != NULL; at++)
        if ((at == whole || strchr("._", at[-1])) && (!at[length] || strchr("._", at[length]))) return true;
    return false;
}

/* Whether one begins with the other: "out" and "output". */
static bool begin_alike(const char *a, const char *b) {
    size_t shorter = strlen(a) < strlen(b) ? strlen(a) : strlen(b);
    return shorter >= 3 && !strncmp(a, b, shorter);
}

const char *sk_nearest_name(const char *name, const char *const *names, size_t count) {
    const char *nearest = NULL;
    size_t length = strlen(name), least = (length < 3 ? 1 : (length + 1) / 3) + 1; // a name farther away is no help
    for (size_t i = 0; i < count; i++) {
        size_t distance = edit_distance(name, names[i]);
        if (distance < least && distance < strlen(names[i])) {
            least = distance;
            nearest = names[i];
        }
    }
    for (size_t i = 0; i < count && !nearest; i++)
        if (is_part(name, names[i]) || begin_alike(name, names[i])) nearest = names[i];
    return nearest;
}
