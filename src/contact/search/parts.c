/* Searches on several threads: each works on a part of its own, and nobody allocates but the caller in between. */
#include <stdatomic.h>

#include "base/float_mode.h"
#include "base/tasks.h"
#include "contact/search/search.h"

typedef struct working {
    const sk_parts_job *job;
    size_t count;
    _Atomic size_t next; /* of what nobody has taken yet */
} working;

/* Whether a part has more to do, or gets more. */
static bool has_more(working *w, sk_search_part *part) {
    if (part->next < part->end) return true;
    const size_t at_once = w->job->at_once;
    if (!at_once) return false;
    size_t next = atomic_fetch_add_explicit(&w->next, at_once, memory_order_relaxed);
    if (next >= w->count) return false;
    part->next = next, part->end = w->count - next < at_once ? w->count : next + at_once;
    return true;
}

static void work_on(void *data, int index) {
    working *w = data;
    if (index >= w->job->touch->part_count) return;
    sk_search_part *part = &w->job->touch->part[index];
    uint64_t mode = sk_float_mode_enter();
    while (has_more(w, part)) {
        w->job->work(w->job, part);
        if (part->next < part->end) break; // it needs room
    }
    sk_float_mode_leave(mode);
}

bool sk_touch_work(const sk_parts_job *job, sk_allocator *allocator, size_t count, size_t least) {
    sk_touch *touch = job->touch;
    int threads = touch->tasks && count >= least ? sk_tasks_count(touch->tasks) : 1;
    size_t parts = (size_t)(touch->part_count = threads < SK_MOST_PARTS ? threads : SK_MOST_PARTS);
    working w = {.job = job, .count = count};
    atomic_init(&w.next, 0);
    for (size_t i = 0; i < parts; i++) {
        touch->part[i].next = job->at_once ? 0 : count * i / parts;
        touch->part[i].end = job->at_once ? 0 : count * (i + 1) / parts;
    }
    for (bool all = false; !all;) {
        if (parts > 1) sk_tasks_run(touch->tasks, work_on, &w);
        else work_on(&w, 0);
        all = true;
        for (size_t i = 0; i < parts; i++) {
            if (touch->part[i].next >= touch->part[i].end) continue;
            all = false;
            if (!job->grow(&touch->part[i], allocator)) return false;
        }
    }
    return true;
}

void sk_touch_release_parts(sk_touch *touch, sk_allocator *allocator) {
    for (int i = 0; i < SK_MOST_PARTS; i++) {
        sk_search_part *part = &touch->part[i];
        sk_release(allocator, part->block);
        sk_release(allocator, part->ring);
        sk_release(allocator, part->start);
        sk_release(allocator, part->first.data);
        sk_release(allocator, part->second.data);
        sk_pairs_release(&part->batch, allocator);
        sk_pairs_release(&part->fresh, allocator);
        *part = (sk_search_part){.block = NULL};
    }
}
