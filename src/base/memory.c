/* Allocating blocks with a hidden header; large ones ask for large pages. The default allocator is the C library's. */
#include "base/memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#ifdef __linux__
#include <sys/mman.h>
#endif

/* A block's header, before what its user sees, keeps the 64-byte alignment of what follows. */
enum { HEADER = 64 };
typedef struct block_header {
    size_t whole, shift, before; /* bytes: the block's, those before the header, and calloc's before the block */
} block_header;

/* Large blocks in large pages: a fault for each 4 KiB was a fifth of the time that a world of 10^6 particles takes. */
static void ask_for_large_pages(char *memory, size_t size) {
#ifdef MADV_HUGEPAGE
    enum { PAGE = 4096, LARGE = 4 << 20 };
    if (size < LARGE) return;
    size_t first = (PAGE - (uintptr_t)memory % PAGE) % PAGE;
    madvise(memory + first, (size - first) / PAGE * PAGE, MADV_HUGEPAGE); // it is a hint: if it fails, all is as before
#else
    (void)memory, (void)size;
#endif
}

/* Memory from calloc, which knows what is zero already. *before is how many bytes precede the returned address. */
static char *zeroed(size_t size, size_t *before) {
    char *memory = calloc(1, size + HEADER);
    if (!memory) return NULL;
    ask_for_large_pages(memory, size + HEADER);
    *before = (HEADER - (uintptr_t)memory % HEADER) % HEADER;
    return memory + *before;
}

static void *default_allocate(void *user, size_t size, size_t alignment) {
    (void)user;
#ifdef _WIN32 // free() takes no aligned memory there; sk_allocate() only compares with this function
    (void)alignment;
    return malloc(size);
#else
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
#endif
}

static void default_release(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

sk_allocator sk_default_allocator(void) {
    return (sk_allocator){default_allocate, default_release, NULL, 0};
}

void *sk_allocate_shifted(sk_allocator *allocator, size_t size, size_t shift) {
    if (size > SIZE_MAX - 2 * HEADER - shift) return NULL;
    size_t whole = (size + shift + HEADER + HEADER - 1) / HEADER * HEADER;
    size_t before = 0;
    bool own = allocator->allocate == default_allocate;
    char *block = own ? zeroed(whole, &before) : allocator->allocate(allocator->user, whole, HEADER);
    if (!block) return NULL;
    if (!own) memset(block, 0, whole);
    memcpy(block + shift, &(block_header){whole, shift, before}, sizeof(block_header));
    allocator->bytes += whole;
    return block + shift + HEADER;
}

void *sk_allocate(sk_allocator *allocator, size_t size) {
    return sk_allocate_shifted(allocator, size, 0);
}

void sk_release(sk_allocator *allocator, void *memory) {
    if (!memory) return;
    block_header header;
    memcpy(&header, (char *)memory - HEADER, sizeof header);
    allocator->bytes -= header.whole;
    allocator->release(allocator->user, (char *)memory - HEADER - header.shift - header.before, header.whole);
}

char *sk_copy_text(sk_allocator *allocator, const char *text) {
    size_t length = text ? strlen(text) : 0;
    char *copy = sk_allocate(allocator, length + 1);
    if (copy && text) memcpy(copy, text, length + 1);
    return copy;
}

bool sk_reserve(sk_allocator *allocator, void **data, size_t *capacity, size_t need, size_t element_size) {
    if (need <= *capacity) return true;
    size_t room = *capacity * 2 > need ? *capacity * 2 : need;
    if (room < 8) room = 8;
    if (room > SIZE_MAX / 2 / element_size) return false;
    void *grown = sk_allocate(allocator, room * element_size);
    if (!grown) return false;
    if (*data) memcpy(grown, *data, *capacity * element_size);
    sk_release(allocator, *data);
    *data = grown;
    *capacity = room;
    return true;
}
