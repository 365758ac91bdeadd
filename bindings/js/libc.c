/* What a page does with less of the C library, which it waits for. There are no files but those that were given (files.c): wasi-libc's
 * own functions would bring folders' paths and all its messages along. And what has lanes copies by an instruction, too, where the
 * library has loops of a thousand bytes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

FILE *fopen(const char *path, const char *mode) {
    (void)path, (void)mode;
    return NULL;
}

/* Who calls access() calls this one (CMakeLists.txt): the library's is beside others that are needed. */
int __wrap_access(const char *path, int mode);
int __wrap_access(const char *path, int mode) {
    (void)path, (void)mode;
    return -1;
}

char *strerror(int fault) {
    (void)fault;
    return (char *)"there is no such file here";
}

void *memmove(void *to, const void *from, size_t size) {
    return __builtin_memmove(to, from, size);
}

void *memcpy(void *restrict to, const void *restrict from, size_t size) {
    return __builtin_memcpy(to, from, size);
}

void *memset(void *to, int byte, size_t size) {
    return __builtin_memset(to, byte, size);
}

static void swap(char *a, char *b, size_t size) {
    for (size_t i = 0; i < size; i++) {
        const char was = a[i];
        a[i] = b[i], b[i] = was;
    }
}

/* Heap sort: the library's smooth sort is two thousand bytes, and faster only of what is in order. */
void qsort(void *base, size_t count, size_t size, int (*compare)(const void *a, const void *b)) {
    char *x = base;
    for (size_t left = count / 2, end = count; end > 1;) {
        if (left) left--;
        else swap(x, x + --end * size, size);
        for (size_t at = left, next; (next = 2 * at + 1) < end; at = next) {
            if (next + 1 < end && compare(x + next * size, x + (next + 1) * size) < 0) next++;
            if (compare(x + at * size, x + next * size) >= 0) break;
            swap(x + at * size, x + next * size, size);
        }
    }
}
