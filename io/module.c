/* Finding and loading modules; see module.h. */
#include "io/module.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "io/file.h"
#include "io/places.h"

/* Of the first folder that has the file; false where none has, with all of them in `looked`. */
static bool find_file(const char *file, char path[IO_PLACE_SIZE + 64], char *looked, size_t size) {
    char folder[IO_PLACE_SIZE];
    size_t length = 0;
    looked[0] = 0;
    for (size_t i = 0; io_modules_folder(i, folder); i++) {
        snprintf(path, IO_PLACE_SIZE + 64, "%s/%s", folder, file);
        if (!access(path, R_OK)) return true;
        int added = snprintf(looked + length, size - length, "%s%s", length ? ", " : "", folder);
        length += (size_t)added < size - length ? (size_t)added : 0;
    }
    return false;
}

const void *io_module_load(const char *name, skein_error *error) {
    char file[64], path[IO_PLACE_SIZE + 64], looked[300];
    snprintf(file, sizeof file, "skein_%.40s.so", name);
    if (!find_file(file, path, looked, sizeof looked)) {
        io_error_set(error, SKEIN_ERROR_FILE, file,
                     "this part of skein is missing, it was looked for in %s: install skein anew, or name the folder "
                     "where it lies in the environment's SKEIN_MODULES",
                     looked);
        return NULL;
    }
    void *object = dlopen(path, RTLD_NOW | RTLD_LOCAL); // only counts where it is loaded already
    if (!object) {
        io_error_set(error, SKEIN_ERROR_FILE, file, "this part of skein cannot be loaded, install what is missing: %s",
                     dlerror());
        return NULL;
    }
    const io_module *module = dlsym(object, "skein_module");
    if (module && !strcmp(module->version, SKEIN_VERSION) &&
        (!module->real_size || module->real_size == sizeof(skein_real)))
        return module->content;
    io_error_set(error, SKEIN_ERROR_FILE, path, "is not of this skein, " SKEIN_VERSION "%s: install skein anew",
                 sizeof(skein_real) == sizeof(double) ? " in double precision" : "");
    return NULL;
}
