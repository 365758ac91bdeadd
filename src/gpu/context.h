/* The OpenGL context that the device computes in: its own, without a window, or the one that is current.
 *
 * Called by device.c around all calls of OpenGL. A context of its own is current only between enter and leave, so that
 * a world may move between threads, and restores the one that was current before. A context that was taken over must be
 * current whenever the world is used, which is not checked. */
#ifndef SK_GPU_CONTEXT_H
#define SK_GPU_CONTEXT_H

#include <skein/skein.h>

typedef struct sk_gpu_context {
    void *display, *context; /* EGL's, of an own context */
    bool own;
    struct {
        void *display, *draw, *read, *context;
    } before;       /* what was current when it was entered */
    char name[256]; /* the renderer and the version */
    bool software;  /* it renders on the processor */
} sk_gpu_context;

/* Makes a context of its own: on the first graphics card, else on whatever OpenGL there is. Not entered. */
skein_status sk_gpu_context_create(sk_gpu_context *context, skein_error *error);
/* Takes over the current one. */
skein_status sk_gpu_context_adopt(sk_gpu_context *context, skein_error *error);
/* Frees an own one; not while it is entered. */
void sk_gpu_context_release(sk_gpu_context *context);

void sk_gpu_context_enter(sk_gpu_context *context);
void sk_gpu_context_leave(sk_gpu_context *context);

#endif
