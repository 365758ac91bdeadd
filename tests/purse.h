/* For tests in which memory is wanting. */
#ifndef SKEIN_TESTS_PURSE_H
#define SKEIN_TESTS_PURSE_H

#include "helpers.h"

/* An allocator that counts, and fails at the n-th call: once, or from then on. */
typedef struct purse {
    size_t calls, fail_at, in_use, blocks;
    bool forever;
} purse;

static inline void *purse_take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    size_t call = p->calls++;
    if (p->forever ? call >= p->fail_at : call == p->fail_at) return NULL;
    assert_true(alignment && (alignment & (alignment - 1)) == 0 && size % alignment == 0);
    p->in_use += size;
    p->blocks++;
    void *memory = aligned_alloc(alignment, size);
    assert_non_null(memory);
    memset(memory, 0xa5, size); // whoever counts on zeros must ask for them
    return memory;
}

static inline void purse_give_back(void *user, void *memory, size_t size) {
    purse *p = user;
    assert_true(memory && p->in_use >= size && p->blocks);
    p->in_use -= size; // back to 0 only if the sizes are those that were asked for
    p->blocks--;
    free(memory);
}

/* The description of a world that takes its memory from a purse, on two threads. */
static inline skein_world_desc purse_world(purse *p) {
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = purse_take, desc.release = purse_give_back, desc.memory_user = p;
    desc.thread_count = 2;
    return desc;
}

#endif
