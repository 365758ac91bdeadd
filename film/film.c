/* A film's thread and queue; see film.h. */
#include "film/film.h"

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "film/maker.h"
#include "render/fail.h"

/* Pictures that may wait: enough to even out what drawing and encoding take by turns. */
enum { WAITING = 4 };

struct film {
    const film_maker *maker;
    void *state;
    film_options options;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    /* Under the lock. Picture i of the film lies in waiting[i % WAITING] from `added` > i until `made` > i. */
    render_image waiting[WAITING];
    size_t added, made;
    bool ending, complete;
    skein_status status;
    skein_error error; /* of the first failure */
};

/* ---- the film's thread ---- */

/* The next picture; NULL at the end. The lock is held. */
static const render_image *wait_for_picture(film *f) {
    while (f->made == f->added && !f->ending) pthread_cond_wait(&f->changed, &f->lock);
    return f->made < f->added ? &f->waiting[f->made % WAITING] : NULL;
}

static void *make(void *argument) {
    film *f = argument;
    const render_image *image;
    skein_error error = {SKEIN_OK, "", ""};
    skein_status status = SKEIN_OK;
    pthread_mutex_lock(&f->lock);
    while ((image = wait_for_picture(f)) != NULL) {
        pthread_mutex_unlock(&f->lock);
        if (status == SKEIN_OK) status = f->maker->add(f->state, image, &error);
        pthread_mutex_lock(&f->lock);
        if (status != SKEIN_OK && f->status == SKEIN_OK) f->status = status, f->error = error;
        f->made++;
        pthread_cond_signal(&f->changed);
    }
    bool complete = f->complete;
    pthread_mutex_unlock(&f->lock);
    skein_error last = {SKEIN_OK, "", ""};
    skein_status ended = f->maker->end(f->state, complete, &last);
    if (f->status == SKEIN_OK && ended != SKEIN_OK) f->status = ended, f->error = last;
    return NULL;
}

/* ---- the caller's side ---- */

/* NULL after an error. */
static const film_maker *maker_of(const film_format *format, skein_error *error) {
    if (!format->encoders) return &film_series;
    const film_libav *libav = film_find_libav(error);
    return !libav ? NULL : strcmp(format->ending, ".gif") ? libav->video : libav->gif;
}

/* Signals are for the caller's thread. */
static int start_thread(film *f) {
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before);
    int fault = pthread_create(&f->thread, NULL, make, f);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return fault;
}

film *film_create(const char *path, const film_options *options, double rate, skein_error *error) {
    const film_format *format = film_format_of(path, error);
    const char *encoder = NULL;
    if (!format) return NULL;
    if (format->encoders && !(encoder = film_choose_encoder(format, path, film_encoder_is_here, error))) return NULL;
    const film_maker *maker = maker_of(format, error);
    if (!maker) return NULL;
    film *f = calloc(1, sizeof *f);
    if (!f) {
        render_fail_memory(error, "the film");
        return NULL;
    }
    film_job job = {path, format, encoder, *options, rate / film_every(format, rate)};
    film_fit_size(format, job.options.size);
    f->options = job.options;
    f->maker = maker;
    f->state = f->maker->begin(&job, error);
    if (!f->state) {
        free(f);
        return NULL;
    }
    pthread_mutex_init(&f->lock, NULL);
    pthread_cond_init(&f->changed, NULL);
    if (!start_thread(f)) return f;
    f->maker->end(f->state, false, NULL);
    free(f);
    render_fail(error, SKEIN_ERROR_MEMORY, path, "no thread could be started for the film");
    return NULL;
}

static skein_status failure_of(const film *f, skein_error *error) {
    if (f->status != SKEIN_OK && error) *error = f->error;
    return f->status;
}

skein_status film_add(film *f, render_image *image, skein_error *error) {
    if (image->width != f->options.size[0] || image->height != f->options.size[1])
        return render_fail(error, SKEIN_ERROR_VALUE, "size", "a picture of %d x %d in a film of %d x %d", image->width,
                           image->height, f->options.size[0], f->options.size[1]);
    pthread_mutex_lock(&f->lock);
    while (f->added - f->made == WAITING) pthread_cond_wait(&f->changed, &f->lock);
    skein_status status = failure_of(f, error);
    if (status == SKEIN_OK) {
        render_image *place = &f->waiting[f->added % WAITING], other = *place;
        *place = *image;
        *image = other;
        f->added++;
        pthread_cond_signal(&f->changed);
    }
    pthread_mutex_unlock(&f->lock);
    return status;
}

static skein_status end(film *f, bool complete, skein_error *error) {
    pthread_mutex_lock(&f->lock);
    f->ending = true;
    f->complete = complete;
    if (!complete) f->made = f->added; // what waits is not wanted any more
    pthread_cond_signal(&f->changed);
    pthread_mutex_unlock(&f->lock);
    pthread_join(f->thread, NULL);
    skein_status status = failure_of(f, error);
    for (int i = 0; i < WAITING; i++) render_image_release(&f->waiting[i]);
    pthread_cond_destroy(&f->changed);
    pthread_mutex_destroy(&f->lock);
    free(f);
    return status;
}

skein_status film_finish(film *f, skein_error *error) {
    return end(f, true, error);
}

void film_abandon(film *f) {
    if (f) end(f, false, NULL);
}
