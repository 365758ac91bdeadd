/* Files that a scene names, from memory: a page has no file system. JavaScript gives them by their paths as the scene
 * has them before it opens it; see exports.c. Here is the half of io/file.h that reads. */
#include "bindings/js/files.h"

#include <stdlib.h>
#include <string.h>

#include "io/file.h"

static const js_files *given;

const js_files *js_files_use(const js_files *files) {
    const js_files *before = given;
    given = files;
    return before;
}

skein_status io_file_read(const char *path, size_t most, io_bytes *out, skein_error *error) {
    *out = (io_bytes){NULL, 0};
    const js_file *file = NULL;
    for (size_t i = 0; given && i < given->count; i++)
        if (!strcmp(given->data[i].path, path)) file = &given->data[i];
    if (!file)
        return io_error_set(error, SKEIN_ERROR_FILE, path,
                            "cannot read: there is no such file among those that were given");
    if (file->size > most)
        return io_error_set(error, SKEIN_ERROR_LIMIT, path, "the file is larger than the %zu bytes allowed here", most);
    char *data = malloc(file->size + 1);
    if (!data) return io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory while reading the file");
    memcpy(data, file->bytes, file->size);
    data[file->size] = '\0';
    *out = (io_bytes){data, file->size};
    return SKEIN_OK;
}

void io_bytes_free(io_bytes *bytes) {
    free(bytes->data);
    *bytes = (io_bytes){NULL, 0};
}
