/* Folders around the program; see places.h. CMake says how they lie to each other once installed. */
#include "io/places.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* The folder of the running program; false where the system does not tell. */
static bool find_program(char path[IO_PLACE_SIZE]) {
    ssize_t length = readlink("/proc/self/exe", path, IO_PLACE_SIZE - 1);
    if (length <= 0) return false;
    path[length] = 0;
    char *slash = strrchr(path, '/');
    if (slash) *slash = 0;
    return slash != NULL;
}

/* `relative` to the program's folder; absolute, as the system sees it, where it is there. */
static bool from_program(const char *relative, char path[IO_PLACE_SIZE]) {
    char program[IO_PLACE_SIZE], joined[2 * IO_PLACE_SIZE];
    if (!find_program(program)) return false;
    snprintf(joined, sizeof joined, "%s/%s", program, relative);
    char *real = realpath(joined, NULL);
    int length = snprintf(path, IO_PLACE_SIZE, "%s", real ? real : joined);
    free(real);
    return length < IO_PLACE_SIZE;
}

/* The place that a variable of the environment names. */
static bool from_environment(const char *name, char path[IO_PLACE_SIZE]) {
    const char *given = getenv(name);
    return given && given[0] && snprintf(path, IO_PLACE_SIZE, "%s", given) < IO_PLACE_SIZE;
}

/* ---- scenes ---- */

/* Many a project has a folder "scenes" with something else in it. */
static bool holds_scenes(const char *path) {
    DIR *folder = opendir(path);
    bool found = false;
    for (struct dirent *entry; folder && !found && (entry = readdir(folder)) != NULL;) {
        const char *dot = strrchr(entry->d_name, '.');
        found = dot && !strcmp(dot, ".json");
    }
    if (folder) closedir(folder);
    return found;
}

/* The places in turn, whether there is anything or not. */
static bool scenes_place(size_t place, char path[IO_PLACE_SIZE]) {
    switch (place) {
    case 0: return snprintf(path, IO_PLACE_SIZE, "scenes") > 0;
    case 1: return from_program("scenes", path);
    case 2: return from_program(SKEIN_SCENES_FROM_PROGRAM, path);
    default: return snprintf(path, IO_PLACE_SIZE, "%s", SKEIN_SCENES_INSTALLED) < IO_PLACE_SIZE;
    }
}

bool io_scenes_folder(size_t index, char path[IO_PLACE_SIZE]) {
    enum { PLACES = 4 };
    struct stat info, seen[PLACES];
    size_t count = 0;
    if (from_environment("SKEIN_SCENES", path)) return index == 0;
    for (size_t place = 0; place < PLACES; place++) {
        if (!scenes_place(place, path) || stat(path, &info) || !S_ISDIR(info.st_mode)) continue;
        bool again = false;
        for (size_t s = 0; s < count; s++) again |= seen[s].st_ino == info.st_ino && seen[s].st_dev == info.st_dev;
        if (again || !holds_scenes(path)) continue;
        if (count == index) return true;
        seen[count++] = info;
    }
    return false;
}

/* ---- modules ---- */

bool io_modules_folder(size_t index, char path[IO_PLACE_SIZE]) {
    if (from_environment("SKEIN_MODULES", path)) return index == 0;
    switch (index) {
    case 0: return from_program(".", path);
    case 1: return from_program(SKEIN_MODULES_FROM_PROGRAM, path);
    case 2: return snprintf(path, IO_PLACE_SIZE, "%s", SKEIN_MODULES_INSTALLED) < IO_PLACE_SIZE;
    default: return false;
    }
}
