/* The painter: a thread that does one piece of work at a time for the stage, so that no step waits for a picture.
 *
 *     stage --begin--> work on the painter's thread --> stage is nudged (exchange.h)
 *
 * Invariant: while it is busy, what its work touches is the painter's: OpenGL, the frames, the pictures. The stage looks
 * at none of it before it is idle. Called by the stage's thread alone. */
#ifndef SKEIN_VIEWER_PAINTER_H
#define SKEIN_VIEWER_PAINTER_H

#include "viewer/exchange.h"

typedef struct viewer_painter {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    viewer_exchange *exchange; /* whose stage is nudged */
    void (*work)(void *user);  /* NULL: idle */
    void *user;
    bool ending;
} viewer_painter;

/* False where there is no thread. */
bool viewer_painter_start(viewer_painter *painter, viewer_exchange *exchange);
/* Waits for what it does, and ends it. */
void viewer_painter_stop(viewer_painter *painter);

bool viewer_painter_busy(viewer_painter *painter);
void viewer_painter_wait(viewer_painter *painter); /* until it is idle */
/* Begins a piece of work; waits for the one before. */
void viewer_painter_begin(viewer_painter *painter, void (*work)(void *user), void *user);
/* The same, and waits for its end. */
void viewer_painter_do(viewer_painter *painter, void (*work)(void *user), void *user);

#endif
