/* Where a scene comes from: a file, the name of one that comes with Skein, a mesh, or standard input.
 *
 *   flag.json, ./flag     a file
 *   birds                 SCENES/birds.json, of the folders that io/places.h names, where there is no such file
 *   shirt.obj             a scene about the mesh (io/mesh_scene.c)
 *   -                     standard input
 *
 * Called by the command and the window, with whatever a user typed or dropped. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "io/places.h"
#include "io/scene_settings.h"

static const char ending[] = ".json";

static bool is_file(const char *path) {
    struct stat info;
    return !stat(path, &info) && !S_ISDIR(info.st_mode);
}

/* A name has no folder, and of endings at most the scenes' own. */
static bool is_name(const char *word) {
    const char *dot = strrchr(word, '.');
    return word[0] && word[0] != '.' && !strchr(word, '/') && (!dot || !strcmp(dot, ending));
}

static bool in_folder(const char *folder, const char *word, char path[IO_PLACE_SIZE]) {
    bool has_ending = strrchr(word, '.') != NULL;
    int length = snprintf(path, IO_PLACE_SIZE, "%s/%s%s", folder, word, has_ending ? "" : ending);
    return length < IO_PLACE_SIZE && is_file(path);
}

bool io_scene_find(const char *word, char path[IO_PLACE_SIZE]) {
    char folder[IO_PLACE_SIZE];
    bool known = is_file(word) || !is_name(word);
    for (size_t i = 0; !known && io_scenes_folder(i, folder); i++)
        if (in_folder(folder, word, path)) return true;
    snprintf(path, IO_PLACE_SIZE, "%s", word);
    return known;
}

size_t io_scene_names(char (*names)[IO_SCENE_NAME_SIZE], size_t most) {
    char path[IO_PLACE_SIZE];
    size_t count = 0;
    for (size_t i = 0; io_scenes_folder(i, path); i++) {
        DIR *folder = opendir(path);
        for (struct dirent *entry; folder && (entry = readdir(folder)) != NULL;) {
            const char *dot = strrchr(entry->d_name, '.');
            size_t length = dot ? (size_t)(dot - entry->d_name) : 0;
            if (!length || strcmp(dot, ending) || length >= IO_SCENE_NAME_SIZE || count == most) continue;
            snprintf(names[count], IO_SCENE_NAME_SIZE, "%.*s", (int)length, entry->d_name);
            bool again = false;
            for (size_t n = 0; n < count; n++) again |= !strcmp(names[n], names[count]);
            count += !again;
        }
        if (folder) closedir(folder);
    }
    qsort(names, count, sizeof *names, (int (*)(const void *, const void *))strcmp);
    return count;
}

void io_scene_not_found(const char *word, io_faults *faults) {
    enum { MOST = 64 };
    char names[MOST][IO_SCENE_NAME_SIZE], hint[IO_HINT_SIZE];
    const char *list[MOST];
    size_t count = io_scene_names(names, MOST);
    for (size_t i = 0; i < count; i++) list[i] = names[i];
    io_fault((io_place){word, "", faults}, "", SKEIN_ERROR_FILE, "there is no such file, and no scene of that name%s",
             io_hint(word, list, count, hint));
}

skein_status io_stdin_read(size_t most, io_bytes *out, skein_error *error) {
    io_bytes bytes = {NULL, 0};
    size_t capacity = 0;
    for (;;) {
        if (!io_grow(&bytes.data, &capacity, bytes.size + 65536, 1)) {
            free(bytes.data);
            return io_error_set(error, SKEIN_ERROR_MEMORY, IO_STDIN_NAME, "out of memory");
        }
        ssize_t got = read(STDIN_FILENO, bytes.data + bytes.size, capacity - bytes.size);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0 || bytes.size > most) {
            free(bytes.data);
            return got < 0 ? io_error_set(error, SKEIN_ERROR_FILE, IO_STDIN_NAME, "cannot read: %s", strerror(errno))
                           : io_error_set(error, SKEIN_ERROR_LIMIT, IO_STDIN_NAME, "more than %zu MB", most >> 20);
        }
        if (!got) break;
        bytes.size += (size_t)got;
    }
    *out = bytes;
    return SKEIN_OK;
}
