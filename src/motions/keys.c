/* Key frames: each gives a shift of the pins and a rotation about a centre at a time. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "base/rotation.h"
#include "base/status.h"
#include "motions/motion.h"

enum { SHORT_KEY = 4, KEY = 7 };

/* A parsed text of keys; rows of KEY numbers: the time, the shift, the rotation in degrees. */
typedef struct key_table {
    size_t count;
    double key[][KEY];
} key_table;

typedef struct keys_params {
    char *keys;
    double centre[3];
    bool smooth, repeat;
    key_table *table;
} keys_params;

static const skein_field fields[] = {
    SK_TEXT(keys_params, keys, "keys", "0 0 0 0",
            "one after the other: a time (s), by how much they are shifted then along x, y, z (m) and, as one likes, "
            "turned about x, then y, then z (deg): [[0, 0, 0, 0], [1.5, 0, 0.2, 0, 0, 90, 0]]; in programs, as text, "
            "0 0 0 0, 1.5 0 0.2 0 0 90 0"),
    SK_VEC3(keys_params, centre, "centre", "m", 0, 0, 0, "what they are turned about, before they are shifted"),
    SK_BOOL(keys_params, smooth, "smooth", 1, "true: they slow down towards each key; false: evenly from key to key"),
    SK_BOOL(keys_params, repeat, "repeat", 0, "true: from the last key it goes on with the first, again and again"),
};

/* Reads the numbers of one row; returns how many, or -1 if it holds anything else. */
static int read_row(const char *at, const char *end, double key[static KEY]) {
    int count = 0;
    for (;;) {
        while (at < end && isspace((unsigned char)*at)) at++;
        if (at == end) return count;
        double x = 0;
        size_t size = sk_number_read_signed(at, &x); // it stops at the comma that ends the row
        if (!size || count == KEY || !(fabs(x) <= SK_FAR)) return -1;
        key[count++] = x;
        at += size;
    }
}

/* Reads all rows, which are separated by commas. */
static skein_status read_table(const char *text, key_table *table, skein_error *error) {
    for (const char *at = text; at; table->count++) {
        const char *comma = strchr(at, ','), *end = comma ? comma : at + strlen(at);
        double *key = table->key[table->count];
        int count = read_row(at, end, key);
        if (count != SHORT_KEY && count != KEY)
            return sk_fail(
                error, SKEIN_ERROR_VALUE, "keys",
                "key %zu: expected a time and 3 numbers (a shift), or 6 (and a turn), as in 0 0 0 0, 1.5 0 0.2 0, not '%.*s'",
                table->count, (int)(end - at < 60 ? end - at : 60), at);
        if (table->count && !(key[0] > key[-KEY]))
            return sk_fail(error, SKEIN_ERROR_VALUE, "keys", "key %zu: its time, %g s, is not after the one before it",
                           table->count, key[0]);
        at = comma ? comma + 1 : NULL;
    }
    return SKEIN_OK;
}

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    keys_params *params = data;
    (void)kind;
    size_t rows = 1;
    for (const char *c = params->keys; *c; c++) rows += *c == ',';
    key_table *table = sk_allocate(allocator, sizeof *table + rows * sizeof table->key[0]);
    if (!table) return sk_fail_memory(error, "keys");
    memset(table, 0, sizeof *table + rows * sizeof table->key[0]);
    skein_status status = read_table(params->keys, table, error);
    if (status) {
        sk_release(allocator, table);
        return status;
    }
    sk_release(allocator, params->table);
    params->table = table;
    return SKEIN_OK;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_release(allocator, ((keys_params *)data)->table);
}

/* Interpolates the shift and the rotation at a time. */
static void find(const keys_params *params, double time, double shift[3], double degrees[3]) {
    const key_table *table = params->table;
    double first = table->key[0][0], period = table->key[table->count - 1][0] - first;
    if (params->repeat && period > 0 && time > first) time = first + fmod(time - first, period);
    size_t next = 0;
    while (next < table->count && table->key[next][0] <= time) next++;
    const double *a = table->key[next ? next - 1 : 0], *b = table->key[next < table->count ? next : next - 1];
    double s = a == b ? 0 : (time - a[0]) / (b[0] - a[0]);
    if (s < 0) s = 0;
    if (params->smooth) s = s * s * (3 - 2 * s);
    for (int k = 0; k < 3; k++) shift[k] = a[1 + k] + s * (b[1 + k] - a[1 + k]);
    for (int k = 0; k < 3; k++) degrees[k] = a[4 + k] + s * (b[4 + k] - a[4 + k]);
}

static void move(const sk_motion *motion, size_t i, double time, double place[3]) {
    const keys_params *params = motion->params;
    double shift[3], degrees[3], matrix[9], arm[3];
    (void)i;
    find(params, time, shift, degrees);
    sk_rotation_of_degrees(degrees, matrix);
    for (int k = 0; k < 3; k++) arm[k] = place[k] - params->centre[k];
    for (int k = 0; k < 3; k++)
        place[k] = params->centre[k] + shift[k] + matrix[3 * k] * arm[0] + matrix[3 * k + 1] * arm[1] +
                   matrix[3 * k + 2] * arm[2];
}

static const sk_making making = {.make = make, .unmake = unmake};
const sk_motion_type sk_keys = {
    .kind = {"keys", "leads pins from key to key: shifted, and turned about a centre", SKEIN_MOTION, fields,
             sizeof fields / sizeof *fields, sizeof(keys_params)},
    .move = move,
    .making = &making,
};
