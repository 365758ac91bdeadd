/* The list of recent scenes: one path a line; see recent.h. */
#include "viewer/recent.h"

#include <errno.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/file.h"

/* The list's path; false where there is no home. With `make`, its folders are made. */
static bool find_list(char path[VIEWER_TEXT], bool make) {
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    // as the XDG base directory specification has it: what is not absolute does not count
    if (state && state[0] == '/') snprintf(path, VIEWER_TEXT, "%.900s/skein/recent", state);
    else if (home && home[0] == '/') snprintf(path, VIEWER_TEXT, "%.900s/.local/state/skein/recent", home);
    else return false;
    for (char *slash = path; make && (slash = strchr(slash + 1, '/')) != NULL;) {
        *slash = 0;
        bool good = !mkdir(path, 0700) || errno == EEXIST;
        *slash = '/';
        if (!good) return false;
    }
    return true;
}

void viewer_recent_read(viewer_recent *recent) {
    char path[VIEWER_TEXT];
    io_bytes bytes;
    recent->count = 0;
    if (!find_list(path, false) || io_file_read(path, (size_t)1 << 20, &bytes, NULL)) return;
    for (char *line = bytes.data, *next; line && *line && recent->count < VIEWER_RECENTS; line = next) {
        next = strchr(line, '\n');
        if (next) *next++ = 0;
        if (line[0] != '/' || strlen(line) >= VIEWER_TEXT || access(line, R_OK)) continue;
        snprintf(recent->path[recent->count++], VIEWER_TEXT, "%s", line);
    }
    io_bytes_free(&bytes);
}

static bool write_list(const viewer_recent *recent, skein_error *error) {
    char path[VIEWER_TEXT];
    if (!find_list(path, true)) {
        io_error_set(error, SKEIN_ERROR_FILE, "recent scenes", "there is no folder to keep them in: %s",
                     strerror(errno));
        return false;
    }
    io_output *output = io_output_open(path, error);
    for (size_t i = 0; output && i < recent->count; i++) {
        io_output_write(output, recent->path[i], strlen(recent->path[i]));
        io_output_write(output, "\n", 1);
    }
    return output && !io_output_commit(output, error);
}

bool viewer_recent_add(viewer_recent *recent, const char *path, skein_error *error) {
    char *whole = realpath(path, NULL);
    // a path that breaks lines has no place in a list of lines
    if (!whole || strlen(whole) >= VIEWER_TEXT || strchr(whole, '\n')) {
        free(whole);
        return true;
    }
    size_t at = 0;
    while (at < recent->count && strcmp(recent->path[at], whole) != 0) at++;
    if (at == recent->count) {
        if (recent->count < VIEWER_RECENTS) recent->count++;
        at = recent->count - 1;
    }
    memmove(recent->path[1], recent->path[0], at * sizeof recent->path[0]);
    snprintf(recent->path[0], VIEWER_TEXT, "%s", whole);
    free(whole);
    return write_list(recent, error);
}
