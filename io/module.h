/* Modules: parts of Skein that bring heavy libraries with them, loaded when they are first asked for, so that a command
 * that does without them begins at once.
 *
 * A module NAME is a shared object skein_NAME.so, in one of io_modules_folder()'s, with one symbol: skein_module.
 * Invariant: what is loaded stays loaded, and comes from the same version of Skein, of the same precision or one whose
 * content does not depend on it. */
#ifndef SKEIN_IO_MODULE_H
#define SKEIN_IO_MODULE_H

#include <skein/skein.h>

typedef struct io_module {
    const char *version;
    size_t real_size; /* bytes; 0: serves either precision */
    const void *content;
} io_module;

/* In one file of the module; its content is a constant that both sides know. */
#define IO_MODULE(content_) IO_MODULE_OF(content_, sizeof(skein_real))
#define IO_MODULE_OF_EITHER(content_) IO_MODULE_OF(content_, 0)
#define IO_MODULE_OF(content_, real_size_) \
    extern const io_module skein_module;   \
    __attribute__((visibility("default"))) const io_module skein_module = {SKEIN_VERSION, (real_size_), (content_)}

/* The content of a module, from any thread; NULL after an error that says what to do. Cheap once it is loaded. */
const void *io_module_load(const char *name, skein_error *error);

#endif
