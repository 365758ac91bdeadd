/* Where compiled formulas are kept. A file there is loaded as code, so it must be the user's own, in a folder where
 * nobody else can write, below folders where nobody else can put another in its place; and it must be whole, for a
 * loader falls over one that is not: its last bytes are a checksum, which a loader does not look at. */
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "app/compile.h"

static const char mark[8] = "skeinsum";
enum { FOOTER = sizeof mark + sizeof(uint64_t), MOST_BYTES = 1 << 28 };

static bool is_private(const struct stat *s) {
    return s->st_uid == geteuid() && !(s->st_mode & (S_IWGRP | S_IWOTH));
}

/* ---- the folder ---- */

/* Makes a folder and those above it, as far as they are missing. */
static bool make_folders(char *path) {
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        bool good = !mkdir(path, 0700) || errno == EEXIST || errno == EROFS || errno == EACCES;
        *slash = '/';
        if (!good) return false;
    }
    return !mkdir(path, 0700) || errno == EEXIST;
}

/* Whether somebody else could rename what is in the folder: not where it is the user's or the system's own, and who
 * else may write there (as in /tmp) may only rename what is theirs. */
static bool is_firm(const struct stat *s) {
    struct stat root;
    bool owned = s->st_uid == 0 || s->st_uid == geteuid() || (!stat("/", &root) && s->st_uid == root.st_uid);
    return owned && (!(s->st_mode & (S_IWGRP | S_IWOTH)) || s->st_mode & S_ISVTX);
}

/* Looks at the folders above a real path; the first that is not firm is left in `path`. */
static bool are_firm_above(char *path) {
    struct stat s;
    for (char *slash; (slash = strrchr(path, '/')) && path[1];) {
        slash[slash == path] = '\0';
        if (stat(path, &s) || !is_firm(&s)) return false;
    }
    return true;
}

bool app_cache_folder(char *path, size_t size, char *words, size_t words_size) {
    const char *own = getenv("SKEIN_CACHE"), *xdg = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int length = 0;
    if (own && own[0]) length = snprintf(path, size, "%s", own);
    else if (xdg && xdg[0] == '/') length = snprintf(path, size, "%s/skein", xdg);
    else if (home && home[0] == '/') length = snprintf(path, size, "%s/.cache/skein", home);
    struct stat s;
    if (length <= 0 || (size_t)length >= size) {
        snprintf(words, words_size, "there is no home folder; SKEIN_CACHE may name another");
        return false;
    }
    if (!make_folders(path) || stat(path, &s) || !S_ISDIR(s.st_mode)) {
        snprintf(words, words_size, "the folder %.300s cannot be made: %s", path, strerror(errno));
        return false;
    }
    char *real = realpath(path, NULL); // what is looked at is what is used; and dlopen() wants a slash
    bool fits = real && strlen(real) < size;
    if (fits) snprintf(path, size, "%s", real);
    bool safe = fits && is_private(&s) && are_firm_above(real);
    if (!safe) snprintf(words, words_size, "others than you can write in %.300s", fits && is_private(&s) ? real : path);
    free(real);
    return safe;
}

/* ---- its files ---- */

static uint64_t checksum(const unsigned char *bytes, size_t count) {
    uint64_t hash = UINT64_C(0xcbf29ce484222325);
    for (size_t i = 0; i < count; i++) hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    return hash;
}

/* All bytes of a regular file, with room for FOOTER more; NULL where it is none, or `own` and not the user's own. */
static unsigned char *read_whole(const char *path, bool own, size_t *count) {
    struct stat s;
    int file = open(path, O_RDONLY | O_NOFOLLOW | O_CLOEXEC);
    if (file < 0) return NULL;
    unsigned char *bytes = NULL;
    if (!fstat(file, &s) && S_ISREG(s.st_mode) && (!own || is_private(&s)) && s.st_size > 0 && s.st_size < MOST_BYTES)
        bytes = malloc((size_t)s.st_size + FOOTER);
    for (*count = 0; bytes && *count < (size_t)s.st_size;) {
        ssize_t got = read(file, bytes + *count, (size_t)s.st_size - *count);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) {
            free(bytes);
            bytes = NULL;
            break;
        }
        *count += (size_t)got;
    }
    close(file);
    return bytes;
}

bool app_cache_check(const char *path) {
    size_t count = 0;
    unsigned char *bytes = read_whole(path, true, &count);
    bool good = bytes && count > FOOTER && !memcmp(bytes + count - FOOTER, mark, sizeof mark);
    if (good) {
        uint64_t sum;
        memcpy(&sum, bytes + count - sizeof sum, sizeof sum);
        good = sum == checksum(bytes, count - FOOTER);
    }
    free(bytes);
    return good;
}

static bool write_whole(int file, const unsigned char *bytes, size_t count) {
    while (count) {
        ssize_t put = write(file, bytes, count);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) return false;
        bytes += put;
        count -= (size_t)put;
    }
    return true;
}

bool app_cache_put(const char *from, const char *path) {
    char temporary[2200];
    size_t count;
    unsigned char *bytes = read_whole(from, false, &count);
    if (!bytes) return false;
    uint64_t sum = checksum(bytes, count);
    memcpy(bytes + count, mark, sizeof mark);
    memcpy(bytes + count + sizeof mark, &sum, sizeof sum);
    snprintf(temporary, sizeof temporary, "%s.XXXXXX", path);
    int file = mkstemp(temporary);
    bool good = file >= 0 && !fchmod(file, 0700) && write_whole(file, bytes, count + FOOTER);
    if (file >= 0) good = !close(file) && good;
    if (good) good = !rename(temporary, path); // whoever looks sees the old one or the new one, whole
    if (!good && file >= 0) unlink(temporary);
    free(bytes);
    return good;
}
