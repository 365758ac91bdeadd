/* The public headers that a compiled formula includes, as text: they need not be installed where skein runs. Embedded
 * by CMakeLists.txt. */
#ifndef SKEIN_APP_HEADERS_H
#define SKEIN_APP_HEADERS_H

typedef struct app_header {
    const char *name; /* "skein/compiled.h" */
    const char *text;
} app_header;

extern const app_header app_headers[]; /* ended by a NULL name */

#endif
