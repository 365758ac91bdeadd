/* Files in memory: a page has no file system. JavaScript gives those that a scene names by their paths as the scene has
 * them before it opens it, and takes what an exporter wrote; see exports.c. Here is the half of io/file.h that reads, and
 * of the other half what writes a file in one go. */
#include "bindings/js/files.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
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

skein_status io_file_read_beside(const char *first, const char *path, size_t most, io_bytes *out, skein_error *error) {
    (void)first;
    return io_file_read(path, most, out, error); // there are no links
}

void io_bytes_free(io_bytes *bytes) {
    free(bytes->data);
    *bytes = (io_bytes){NULL, 0};
}

/* ---- writing: into memory ---- */

struct io_output {
    char *data;
    size_t size, capacity;
    skein_status status;
};

static js_file written;

js_file js_file_take_written(void) {
    js_file file = written;
    written = (js_file){0};
    return file;
}

io_output *io_output_open(const char *path, skein_error *error) {
    io_output *output = calloc(1, sizeof *output);
    if (!output) io_error_set(error, SKEIN_ERROR_MEMORY, path, "out of memory while writing");
    return output;
}

void io_output_write(io_output *output, const void *bytes, size_t size) {
    if (output->status || !size) return;
    if (!io_grow(&output->data, &output->capacity, output->size + size, 1)) {
        output->status = SKEIN_ERROR_MEMORY;
        return;
    }
    memcpy(output->data + output->size, bytes, size);
    output->size += size;
}

void io_output_printf(io_output *output, const char *format, ...) {
    char text[512];
    va_list rest;
    va_start(rest, format);
    int size = vsnprintf(text, sizeof text, format, rest);
    va_end(rest);
    if (size < 0 || (size_t)size >= sizeof text) output->status = SKEIN_ERROR_LIMIT;
    else io_output_write(output, text, (size_t)size);
}

void io_output_count(io_output *output, uint64_t value) {
    io_output_printf(output, "%" PRIu64, value);
}

void io_output_fail_memory(io_output *output) {
    output->status = SKEIN_ERROR_MEMORY;
}

void io_output_abandon(io_output *output) {
    if (output) free(output->data);
    free(output);
}

skein_status io_output_commit(io_output *output, skein_error *error) {
    skein_status status = output->status;
    if (status) {
        io_error_set(error, status, "",
                     status == SKEIN_ERROR_MEMORY ? "out of memory while writing" : "a line is too long");
        io_output_abandon(output);
        return status;
    }
    free((void *)(uintptr_t)written.bytes);
    written = (js_file){NULL, output->data, output->size};
    free(output);
    return SKEIN_OK;
}
