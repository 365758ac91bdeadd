/* What fuzzers share: the entry that libFuzzer calls, judging, and little memory.
 *
 * tests/fuzz_NAME.c feeds any bytes to one reader and judges what comes out; it aborts where that is wrong. It is
 * called by libFuzzer (tools/fuzz), or by fuzz/replay.c with the files of a corpus. */
#ifndef SKEIN_TESTS_FUZZ_H
#define SKEIN_TESTS_FUZZ_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <skein/skein.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static inline void require(bool fine) {
    if (!fine) abort();
}

/* ---- Bytes -------------------------------------------------------------------------------------- */

/* What stands before a NUL byte, or all; exactly as large as it is, so that a sanitizer sees the first byte too many.
 * To be freed. `data` and `size` become what stands behind the NUL: NULL and 0 if there is none. */
static inline char *fuzz_take_part(const uint8_t **data, size_t *size, size_t *length) {
    const uint8_t *end = *size ? memchr(*data, '\0', *size) : NULL;
    *length = end ? (size_t)(end - *data) : *size;
    char *part = malloc(*length + (*length == 0));
    require(part != NULL);
    if (*length) memcpy(part, *data, *length);
    *size = end ? *size - *length - 1 : 0;
    *data = end ? end + 1 : NULL;
    return part;
}

/* ---- Little memory: an allocator of a world; what a legal input may ask for is bounded by it ------ */

enum { FUZZ_MOST_MEMORY = 4 << 20 };

static inline void *fuzz_allocate(void *user, size_t size, size_t alignment) {
    size_t *used = user;
    if (size > FUZZ_MOST_MEMORY - *used) return NULL;
    void *memory = aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    *used += memory ? size : 0;
    return memory;
}

static inline void fuzz_release(void *user, void *memory, size_t size) {
    *(size_t *)user -= size;
    free(memory);
}

/* ---- Little time: a step of a hundred thousand substeps is legal, too; neighbours may be everyone - */

static inline double fuzz_number(const skein_world *world, const char *path) {
    skein_value value;
    return skein_get_path(world, path, &value) ? 1 : value.number[0];
}

/* Whether a step is worth at most so many looks at a particle or pair, or thereabouts. */
static inline bool fuzz_is_cheap(skein_world *world, double most) {
    skein_statistics s;
    if (skein_world_statistics(world, &s) != SKEIN_OK) return false;
    double substeps = fuzz_number(world, "method.substeps") * fuzz_number(world, "method.iterations");
    return substeps * ((double)s.particles * (double)s.particles + (double)s.constraints) < most;
}

#endif
