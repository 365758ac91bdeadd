/* Requests and what is shown; see exchange.h. */
#include "viewer/exchange.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

bool viewer_exchange_open(viewer_exchange *exchange, const viewer_events *events) {
    memset(exchange, 0, sizeof *exchange);
    exchange->events = events;
    exchange->shown.newest = exchange->shown.in_use = -1;
    pthread_condattr_t steady;
    bool good = !pthread_condattr_init(&steady);
    if (good) {
        pthread_condattr_setclock(&steady, CLOCK_MONOTONIC);
        good = !pthread_mutex_init(&exchange->lock, NULL) && !pthread_mutex_init(&exchange->queue_lock, NULL) &&
               !pthread_cond_init(&exchange->asked, &steady);
        pthread_condattr_destroy(&steady);
    }
    return good;
}

void viewer_exchange_close(viewer_exchange *exchange) {
    for (int s = 0; s < VIEWER_SIDES; s++) {
        free(exchange->shown.sides[s].objects);
        free(exchange->shown.sides[s].entries);
        for (viewer_own_field *own = exchange->shown.sides[s].own_fields, *next; own; own = next) {
            next = own->next;
            free(own);
        }
    }
    viewer_lesson_release(&exchange->shown.lesson);
    free(exchange->shown.cards);
    free(exchange->queue);
    free(exchange->taken);
    pthread_cond_destroy(&exchange->asked);
    pthread_mutex_destroy(&exchange->queue_lock);
    pthread_mutex_destroy(&exchange->lock);
}

/* Whether only the later of two requests matters: of the pointer's places, and of a slider's values. */
static bool replaces(const viewer_request *later, const viewer_request *last) {
    if (later->kind != last->kind) return false;
    return later->kind == VIEWER_MOVE ||
           (later->kind == VIEWER_SET && later->field == last->field && later->category == last->category &&
            later->index == last->index && later->side == last->side);
}

void viewer_ask(viewer_exchange *exchange, const viewer_request *request) {
    pthread_mutex_lock(&exchange->queue_lock);
    size_t count = exchange->queue_count;
    viewer_request *last = count ? &exchange->queue[count - 1] : NULL;
    if (last && replaces(request, last)) {
        *last = *request;
    } else {
        if (count == exchange->queue_room) {
            size_t room = 2 * count + 16;
            viewer_request *grown = realloc(exchange->queue, room * sizeof *grown);
            if (grown) exchange->queue = grown, exchange->queue_room = room;
            else viewer_event(exchange->events, "dropped a request: out of memory");
        }
        if (count < exchange->queue_room) exchange->queue[exchange->queue_count++] = *request;
    }
    pthread_cond_signal(&exchange->asked);
    pthread_mutex_unlock(&exchange->queue_lock);
}

void viewer_nudge(viewer_exchange *exchange) {
    pthread_mutex_lock(&exchange->queue_lock);
    exchange->nudged = true;
    pthread_cond_signal(&exchange->asked);
    pthread_mutex_unlock(&exchange->queue_lock);
}

const viewer_request *viewer_take(viewer_exchange *exchange, double seconds, size_t *count) {
    struct timespec until;
    clock_gettime(CLOCK_MONOTONIC, &until);
    double whole = (double)until.tv_nsec * 1e-9 + (seconds > 0 ? seconds : 0);
    until.tv_sec += (time_t)whole;
    until.tv_nsec = (long)((whole - (double)(time_t)whole) * 1e9);
    pthread_mutex_lock(&exchange->queue_lock);
    int status = 0;
    while (!exchange->queue_count && !exchange->nudged && !status && seconds > 0)
        status = pthread_cond_timedwait(&exchange->asked, &exchange->queue_lock, &until);
    exchange->nudged = false;
    viewer_request *queue = exchange->queue;
    size_t room = exchange->queue_room;
    *count = exchange->queue_count;
    exchange->queue = exchange->taken, exchange->queue_room = exchange->taken_room;
    exchange->taken = queue, exchange->taken_room = room;
    exchange->queue_count = 0;
    pthread_mutex_unlock(&exchange->queue_lock);
    return queue;
}
