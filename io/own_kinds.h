/* Kinds that the command and the window know: the library's, and those of the shared objects that the environment's
 * SKEIN_KINDS names (skein/kinds.h). Scenes, lists and worlds all ask here.
 *
 * Invariant: loaded once, when the program begins and has one thread; constant from then on. */
#ifndef SKEIN_IO_OWN_KINDS_H
#define SKEIN_IO_OWN_KINDS_H

#include <skein/kinds.h>

/* Loads the shared objects of a list, separated by colons; NULL or "" is none. What was loaded stays. */
skein_status io_kinds_load(const char *paths, skein_error *error);
/* For worlds; NULL where nothing was loaded, as on machines that load no shared objects. */
#ifdef __wasi__
static inline const skein_kinds *io_kinds(void) {
    return NULL;
}
#else
const skein_kinds *io_kinds(void);
#endif

static inline const skein_kind *io_kind_at(skein_category category, size_t index) {
    return skein_kinds_at(io_kinds(), category, index);
}
static inline const skein_kind *io_kind_find(skein_category category, const char *name, skein_error *error) {
    return skein_kinds_find(io_kinds(), category, name, error);
}

#endif
