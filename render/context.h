/* An OpenGL 4.5 core context without a window or a display, through EGL.
 *
 * Made by picture.c (and whatever else draws offscreen); the window makes its own. Invariant: a
 * context that was created is current on the thread that created it, until it is destroyed. */
#ifndef SKEIN_RENDER_CONTEXT_H
#define SKEIN_RENDER_CONTEXT_H

#include "render/messages.h"
#include "skein/skein.h"

typedef struct render_context render_context;

/* Tries Mesa's surfaceless platform, then each graphics device, then the default display. NULL where
 * none has OpenGL 4.5: `error` says what each of them answered and what to install. */
render_context *render_context_create(skein_error *error);
void render_context_destroy(render_context *context); /* NULL is allowed */

/* The driver's messages so far. */
const render_messages *render_context_messages(const render_context *context);
/* "surfaceless: llvmpipe (LLVM 15.0.6, 256 bits), 4.5 (Core Profile) Mesa 22.3.6" */
const char *render_context_name(const render_context *context);

#endif
