/* The painter's thread; see painter.h. */
#include "viewer/painter.h"

#include <unistd.h>

static void *painter_thread(void *data) {
    viewer_painter *painter = data;
    // the window and the steps are to be served first; on Linux this is the thread's, and that of those it starts
    if (nice(5) == -1) viewer_event(painter->exchange->events, "the painter is no nicer than the window");
    pthread_mutex_lock(&painter->lock);
    for (;;) {
        while (!painter->work && !painter->ending) pthread_cond_wait(&painter->changed, &painter->lock);
        if (!painter->work) break;
        void (*work)(void *user) = painter->work;
        void *user = painter->user;
        pthread_mutex_unlock(&painter->lock);
        work(user);
        pthread_mutex_lock(&painter->lock);
        painter->work = NULL;
        pthread_cond_broadcast(&painter->changed);
        viewer_nudge(painter->exchange);
    }
    pthread_mutex_unlock(&painter->lock);
    return NULL;
}

bool viewer_painter_start(viewer_painter *painter, viewer_exchange *exchange) {
    *painter = (viewer_painter){.exchange = exchange};
    if (pthread_mutex_init(&painter->lock, NULL)) return false;
    if (!pthread_cond_init(&painter->changed, NULL)) {
        if (!pthread_create(&painter->thread, NULL, painter_thread, painter)) return true;
        pthread_cond_destroy(&painter->changed);
    }
    pthread_mutex_destroy(&painter->lock);
    return false;
}

void viewer_painter_stop(viewer_painter *painter) {
    pthread_mutex_lock(&painter->lock);
    painter->ending = true;
    pthread_cond_broadcast(&painter->changed);
    pthread_mutex_unlock(&painter->lock);
    pthread_join(painter->thread, NULL);
    pthread_cond_destroy(&painter->changed);
    pthread_mutex_destroy(&painter->lock);
}

bool viewer_painter_busy(viewer_painter *painter) {
    pthread_mutex_lock(&painter->lock);
    bool busy = painter->work != NULL;
    pthread_mutex_unlock(&painter->lock);
    return busy;
}

void viewer_painter_wait(viewer_painter *painter) {
    pthread_mutex_lock(&painter->lock);
    while (painter->work) pthread_cond_wait(&painter->changed, &painter->lock);
    pthread_mutex_unlock(&painter->lock);
}

void viewer_painter_begin(viewer_painter *painter, void (*work)(void *user), void *user) {
    pthread_mutex_lock(&painter->lock);
    while (painter->work) pthread_cond_wait(&painter->changed, &painter->lock);
    painter->work = work;
    painter->user = user;
    pthread_cond_broadcast(&painter->changed);
    pthread_mutex_unlock(&painter->lock);
}

void viewer_painter_do(viewer_painter *painter, void (*work)(void *user), void *user) {
    viewer_painter_begin(painter, work, user);
    viewer_painter_wait(painter);
}
