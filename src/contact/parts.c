/* Searches on several threads: each works on a part of its own, and nobody allocates but the caller in between. */
#include "base/tasks.h"
#include "contact/touch.h"

static void work_on(void *data, int index) {
    const sk_parts_job *job = data;
    if (index >= job->touch->part_count) return;
    sk_search_part *part = &job->touch->part[index];
    if (part->next < part->end) job->work(job, part);
}

bool sk_touch_work(const sk_parts_job *job, sk_allocator *allocator, size_t count, size_t least) {
    sk_touch *touch = job->touch;
    int threads = touch->tasks && count >= least ? sk_tasks_count(touch->tasks) : 1;
    size_t parts = (size_t)(touch->part_count = threads < SK_MOST_PARTS ? threads : SK_MOST_PARTS);
    for (size_t i = 0; i < parts; i++) {
        touch->part[i].next = count * i / parts;
        touch->part[i].end = count * (i + 1) / parts;
    }
    for (bool all = false; !all;) {
        if (parts > 1) sk_tasks_run(touch->tasks, work_on, (void *)(uintptr_t)job);
        else work_on((void *)(uintptr_t)job, 0);
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
