/* The little of POSIX threads that the library's pool (src/base/tasks.c) asks for, where workers of JavaScript are the
 * threads: wasi-libc has none of it. threads.c has how. */
#ifndef SKEIN_JS_PTHREAD_H
#define SKEIN_JS_PTHREAD_H

#include <stddef.h>
#include <stdint.h>

typedef int pthread_t; /* a seat */
typedef struct pthread_mutex_t {
    _Atomic int32_t taken; /* 0: no, 1: yes, 2: yes, and somebody may wait */
} pthread_mutex_t;
typedef struct pthread_cond_t {
    _Atomic int32_t told; /* counts on */
} pthread_cond_t;

/* EAGAIN where no worker is free. Attributes are not looked at. */
int pthread_create(pthread_t *thread, const void *attributes, void *(*start)(void *), void *argument);
int pthread_join(pthread_t thread, void **result);
int pthread_mutex_init(pthread_mutex_t *mutex, const void *attributes);
int pthread_mutex_destroy(pthread_mutex_t *mutex);
int pthread_mutex_lock(pthread_mutex_t *mutex);
int pthread_mutex_unlock(pthread_mutex_t *mutex);
int pthread_cond_init(pthread_cond_t *condition, const void *attributes);
int pthread_cond_destroy(pthread_cond_t *condition);
int pthread_cond_wait(pthread_cond_t *condition, pthread_mutex_t *mutex);
int pthread_cond_broadcast(pthread_cond_t *condition);

#endif
