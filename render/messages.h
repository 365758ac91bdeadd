/* What the OpenGL driver has to say (KHR_debug), counted.
 *
 * Attached by context.c offscreen, and by a window to its own context. Invariant: a driver that is
 * content leaves every counter at 0; tests check that. */
#ifndef SKEIN_RENDER_MESSAGES_H
#define SKEIN_RENDER_MESSAGES_H

#include <stddef.h>

typedef struct render_messages {
    size_t errors;   /* errors, undefined behaviour, and whatever has high severity */
    size_t warnings; /* the rest, but for notifications and hints on speed */
    char last[512];  /* the last one counted; "" while there was none */
} render_messages;

/* Counts the messages of the current context into `messages`, which must live as long as that does. */
void render_messages_attach(render_messages *messages);

#endif
