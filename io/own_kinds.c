/* Loading kinds from shared objects; see own_kinds.h. */
#include "io/own_kinds.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "io/file.h"

static skein_kinds *loaded; // the program's one registry: filled before it has threads, and never changed again

const skein_kinds *io_kinds(void) {
    return loaded;
}

static skein_status load(const char *path, skein_error *error) {
    void *object = dlopen(path, RTLD_LAZY | RTLD_LOCAL); // a program's main() may be in it, too, with all that it calls
    if (!object) return io_error_set(error, SKEIN_ERROR_FILE, "SKEIN_KINDS", "%s", dlerror());
    const skein_kind *const *kinds = dlsym(object, "skein_module_kinds");
    if (!kinds)
        return io_error_set(error, SKEIN_ERROR_FILE, path, "has no list skein_module_kinds, as skein/kinds.h has it");
    for (; *kinds; kinds++) {
        skein_error words = {SKEIN_OK, "", ""};
        skein_status status = skein_kind_register(loaded, *kinds, &words);
        if (!status) continue;
        return io_error_set(error, status, path, "%.80s%s%.120s: %.280s", (*kinds)->name ? (*kinds)->name : "a kind",
                            words.where[0] ? ", " : "", words.where, words.message);
    }
    return SKEIN_OK;
}

skein_status io_kinds_load(const char *paths, skein_error *error) {
    skein_status status = SKEIN_OK;
    if (!paths || !paths[0]) return SKEIN_OK;
    if (!loaded) loaded = skein_kinds_create(error);
    if (!loaded) return SKEIN_ERROR_MEMORY;
    for (size_t length; *paths && !status; paths += length + (paths[length] == ':')) {
        char path[4096];
        length = strcspn(paths, ":");
        if (!length) continue;
        // a bare name is looked for in the system's folders by dlopen: a file here is meant
        bool bare = !memchr(paths, '/', length);
        snprintf(path, sizeof path, "%s%.*s", bare ? "./" : "", (int)length, paths);
        status = load(path, error);
    }
    return status;
}
