/* The option --compile: constraints' formulas, compiled while the program runs, and kept for the next time. */
#ifndef SKEIN_APP_COMPILE_H
#define SKEIN_APP_COMPILE_H

#include "app/command.h"

/* Has every constraint's formula of the scene compiled, or takes it from the cache, and registers it with the world.
 * Says on the terminal what it did, unless it is to be quiet; what cannot be compiled stays on its tape, with a
 * warning. Returns how many warnings there were. */
size_t app_compile(skein_world *world, bool quiet);

/* ---- between its own files ---- */

/* Runs the C compiler ($CC, cc, gcc or clang) on a file. False, with words, when there is none or it fails. */
typedef struct app_compiler {
    const char *arguments[64]; /* its own, ended by NULL */
    char text[1024];
} app_compiler;
bool app_compiler_find(app_compiler *compiler);
/* The flags, for a cache's key. */
const char *app_compiler_flags(void);
/* From `folder`/formula.c to `folder`/formula.so. `words` gets what the compiler said first. */
bool app_compiler_run(const app_compiler *compiler, const char *folder, char *words, size_t size);

/* Where compiled formulas are kept: $SKEIN_CACHE, $XDG_CACHE_HOME/skein or ~/.cache/skein, made if missing. Only files
 * of the user's own count, which nobody else may write, and whose last bytes are the checksum of the others. False,
 * with words, when there is no such folder. */
bool app_cache_folder(char *path, size_t size, char *words, size_t words_size);
/* Whether the cache's file is whole. */
bool app_cache_check(const char *path);
/* Puts a file into the cache, checksum and all, in one step. */
bool app_cache_put(const char *from, const char *path);

#endif
