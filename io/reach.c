/* See reach.h. What is looked at is where a path really leads; somebody who changes links between the look and the reading has
 * the user's rights already. */
#include "io/reach.h"

#include <stdlib.h>
#include <string.h>

/* Whether `real`, without links, is `folder` or in it. */
static bool lies_in(const char *real, const char *folder) {
    char *whole = realpath(folder, NULL);
    size_t length = whole ? strlen(whole) : 0;
    bool root = length == 1; // whoever starts a program there, as services do, has not put everything into it
    bool inside = whole && !root && !strncmp(real, whole, length) && (!real[length] || real[length] == '/');
    free(whole);
    return inside;
}

static bool lies_beside(const char *real, const char *scene, const char *file) {
    char *folder = io_path_beside(scene, file);
    bool inside = folder && lies_in(real, folder);
    free(folder);
    return inside;
}

static bool is_named(const char *const *sets, const char *file) {
    for (; sets && *sets; sets++)
        if (strstr(*sets, file)) return true;
    return false;
}

bool io_reach_check(io_place place, const char *member, const char *file, const char *path) {
    const io_reach *reach = place.faults->reach;
    char *real = reach && file[0] ? realpath(path, NULL) : NULL;
    bool may = !real || is_named(reach->sets, file) || lies_beside(real, place.file, ".") ||
               lies_beside(real, place.file, "../meshes") || lies_in(real, ".");
    for (const char *const *allowed = may ? NULL : reach->allowed; allowed && *allowed && !may; allowed++)
        may = lies_in(real, *allowed);
    if (!may) {
        const char *slash = strrchr(real, '/');
        io_fault(place, member, SKEIN_ERROR_FILE,
                 "%s is not read: a scene reads what lies in its own folder, in ../meshes and in the current folder; "
                 "if you trust it: --allow-path %.*s",
                 real, slash > real ? (int)(slash - real) : 1, real);
    }
    free(real);
    return may;
}
