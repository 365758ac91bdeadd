/* Failures in words; see fail.h. */
#include "render/fail.h"

#include <stdarg.h>
#include <stdio.h>

skein_status render_fail(skein_error *error, skein_status status, const char *where, const char *format, ...) {
    if (error) {
        va_list arguments;
        error->status = status;
        snprintf(error->where, sizeof error->where, "%s", where);
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

skein_status render_fail_memory(skein_error *error, const char *what) {
    return render_fail(error, SKEIN_ERROR_MEMORY, "", "not enough memory for %s", what);
}
