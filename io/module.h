/* Modules: parts of Skein that bring heavy libraries with them, loaded when they are first asked for, so that a command
 * that does without them begins at once.
 *
 * A module NAME is a shared object skein_NAME.so, in one of io_modules_folder()'s, with one symbol: skein_module.
 * Invariant: what is loaded stays loaded, and comes from the same version of Skein, of the same precision. */
#ifndef SKEIN_IO_MODULE_H
#define SKEIN_IO_MODULE_H

#include <skein/skein.h>

typedef struct io_module {
    const char *version;
    size_t real_size; /* bytes */
    const void *content;
} io_module;

/* In one file of the module; its content is a constant that both sides know. */
#define IO_MODULE(content_)                \
    extern const io_module skein_module;   \
    __attribute__((visibility("default"))) \
    const io_module skein_module = {SKEIN_VERSION, sizeof(skein_real), (content_)}

/* The content of a module, from any thread; NULL after an error that says what to do. Cheap once it is loaded. */
const void *io_module_load(const char *name, skein_error *error);

#endif
