/* Tasks: dividing ranges of elements among threads. The world owns a pool; the runner calls it. */
#ifndef SK_BASE_TASKS_H
#define SK_BASE_TASKS_H

#include "base/memory.h"

typedef struct sk_tasks sk_tasks;

/* Starts the pool of the description (or takes its callback). NULL when there is no memory or no thread. */
sk_tasks *sk_tasks_create(sk_allocator *allocator, const skein_world_desc *desc);
void sk_tasks_destroy(sk_tasks *tasks); /* NULL is allowed */
int sk_tasks_count(const sk_tasks *tasks);
/* How many threads there may be: as many as were asked for, or as the machine has processors. */
int sk_tasks_most(const sk_tasks *tasks);
/* From now on `count` threads share the work: at most sk_tasks_most(), and fewer if the system starts no more. A pool
 * given by the description keeps its number. */
void sk_tasks_use(sk_tasks *tasks, int count);

/* Runs task(data, 0) ... task(data, sk_tasks_count - 1) at once and returns when all are done. */
void sk_tasks_run(sk_tasks *tasks, void (*task)(void *data, int index), void *data);

/* Whether all tasks of sk_tasks_run run at the same time, so that one may wait for another. */
bool sk_tasks_together(const sk_tasks *tasks);
/* Waits until *progress is at least `wanted`: spins a while, then gives the processor away. */
void sk_wait_for(const _Atomic uint32_t *progress, uint32_t wanted);

/* Runs body over [begin, end) in one piece for each thread. Short ranges run on the caller, for handing them over would
 * take longer. Pieces begin at multiples of 16 elements from `begin`. */
typedef void sk_range_body(void *data, size_t begin, size_t end);
void sk_parallel_for(sk_tasks *tasks, size_t begin, size_t end, sk_range_body *body, void *data);

/* The same where some elements take much longer than others: in pieces of `grain` elements, and who has
 * done one takes the next. `thread` is less than sk_tasks_count, and no two that run at once have the same; where there are
 * no tasks, or no more than one piece, it is 0. */
typedef void sk_piece_body(void *data, int thread, size_t begin, size_t end);
#ifdef SK_ONE_THREAD // a page without workers: what is called in one place only becomes a part of it (1.6 KB, packed)
static inline void sk_parallel_pieces(sk_tasks *tasks, size_t begin, size_t end, size_t grain, sk_piece_body *body,
                                      void *data) {
    (void)tasks, (void)grain;
    if (begin < end) body(data, 0, begin, end);
}
#else
void sk_parallel_pieces(sk_tasks *tasks, size_t begin, size_t end, size_t grain, sk_piece_body *body, void *data);
#endif

#endif
