/* Fits for Python: what skein/_fits.py asks of the library before a fit's module (fit/fit.h) is called: point caches, read
 * by the command's own code, and how the module's structs are laid out.
 *
 * Owns nothing: a reader is the caller's until py_cache_close(). */
#include "fit/fit.h"

#include <string.h>

#include "io/module.h"
#include "io/pc2.h"

#define EXPORT __attribute__((visibility("default")))

EXPORT void *py_cache_open(const char *path, uint32_t count[2], double timing[2], skein_error *error);
EXPORT int py_cache_read(void *reader, uint32_t sample, double *places, skein_error *error);
EXPORT void py_cache_close(void *reader);
EXPORT size_t py_fit_struct_size(const char *name);
EXPORT const char *py_version(void);

/* Opens a PC2 file: how many points and samples, the frame of the first sample and the frames from one to the next. NULL
 * after an error. */
void *py_cache_open(const char *path, uint32_t count[2], double timing[2], skein_error *error) {
    io_pc2_header header;
    io_pc2_reader *reader = io_pc2_open(path, &header, error);
    if (!reader) return NULL;
    count[0] = header.points, count[1] = header.samples;
    timing[0] = (double)header.start, timing[1] = (double)header.rate;
    return reader;
}

/* A sample, three numbers a point; a status. */
int py_cache_read(void *reader, uint32_t sample, double *places, skein_error *error) {
    return (int)io_pc2_read(reader, sample, places, error);
}

void py_cache_close(void *reader) {
    io_pc2_close(reader);
}

/* Of a struct that passes between Python and the module; 0 for one that is not known here. */
size_t py_fit_struct_size(const char *name) {
    static const struct {
        const char *name;
        size_t size;
    } sizes[] = {{"module", sizeof(io_module)},   {"content", sizeof(fit_content)}, {"field", sizeof(fit_field)},
                 {"number", sizeof(fit_number)},  {"state", sizeof(fit_state)},     {"request", sizeof(fit_request)},
                 {"outcome", sizeof(fit_outcome)}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (!strcmp(sizes[i].name, name)) return sizes[i].size;
    return 0;
}

/* That of the library, which a module has to be of. */
const char *py_version(void) {
    return SKEIN_VERSION;
}
