/* Memory through the world's allocator: every block is zeroed, aligned to 64 bytes, and knows its
 * own size, so that releasing needs only the pointer. Used by every floor; a NULL means no memory. */
#ifndef SK_BASE_MEMORY_H
#define SK_BASE_MEMORY_H

#include <skein/skein.h>

typedef struct sk_allocator {
    void *(*allocate)(void *user, size_t size, size_t alignment);
    void (*release)(void *user, void *memory, size_t size);
    void *user;
    size_t bytes; /* held now, headers included */
} sk_allocator;

/* The C library's allocator. */
sk_allocator sk_default_allocator(void);

void *sk_allocate(sk_allocator *allocator, size_t size);
/* The same, `shift` bytes (a multiple of 64) further in: large blocks begin at pages, and where a kernel walks
 * several of them in step, a load would wait for a store at the same place of another page. */
void *sk_allocate_shifted(sk_allocator *allocator, size_t size, size_t shift);
void sk_release(sk_allocator *allocator, void *memory); /* NULL is allowed */
/* A copy of a text; NULL copies as "". */
char *sk_copy_text(sk_allocator *allocator, const char *text);

/* Makes room for `need` elements in a growing array; its capacity at least doubles. The new room is
 * zero. False when there is no memory: the array is then as it was. */
bool sk_reserve(sk_allocator *allocator, void **data, size_t *capacity, size_t need, size_t element_size);
#define SK_RESERVE(allocator, array, need) \
    sk_reserve((allocator), (void **)&(array)->data, &(array)->capacity, (need), sizeof *(array)->data)

#endif
