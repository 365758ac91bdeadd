/* Failures in words: one function fills a skein_error for everything under render/.
 *
 * Called by every file here that can fail. Invariant: a NULL error is allowed everywhere, and an
 * error that was filled holds the place (`where`) and what can be done about it (`message`). */
#ifndef SKEIN_RENDER_FAIL_H
#define SKEIN_RENDER_FAIL_H

#include "skein/skein.h"

/* Fills `error` and returns `status`, so that a caller can write `return render_fail(...)`. */
__attribute__((format(printf, 4, 5))) skein_status render_fail(skein_error *error, skein_status status,
                                                               const char *where, const char *format, ...);

/* The same for memory that was not to be had; `what` names what it was for. */
skein_status render_fail_memory(skein_error *error, const char *what);

#endif
