/* Put before tests that are built for Windows: what its C library has by another name. */
#ifndef SKEIN_TESTS_WINDOWS_H
#define SKEIN_TESTS_WINDOWS_H

#include <stdlib.h>

static inline int setenv(const char *name, const char *value, int overwrite) {
    return !overwrite && getenv(name) ? 0 : _putenv_s(name, value);
}

static inline int unsetenv(const char *name) {
    return _putenv_s(name, "");
}

#endif
