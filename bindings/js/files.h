/* Files that a scene names, from memory; see files.c. */
#ifndef SKEIN_JS_FILES_H
#define SKEIN_JS_FILES_H

#include <stddef.h>

typedef struct js_file {
    char *path;        /* as the reader asks for it: relative to the scene's own path */
    const char *bytes; /* of the caller */
    size_t size;
} js_file;

typedef struct js_files {
    js_file *data;
    size_t count, capacity;
} js_files;

/* From now on these are the files that there are (NULL: none); returns those before. (A reader is called with a path and
 * nothing else, so that they must stand outside; a module of WebAssembly has one thread.) */
const js_files *js_files_use(const js_files *files);

/* What was committed last, which is the caller's to free from now on; {0}: nothing since the last call. */
js_file js_file_take_written(void);

#endif
