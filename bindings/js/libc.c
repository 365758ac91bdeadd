/* What a page does with less of the C library, which it waits for. There are no files but those that were given (files.c): wasi-libc's
 * own functions would bring folders' paths and all its messages along. And what has lanes copies by an instruction, too, where the
 * library has loops of a thousand bytes. */
#include <stdio.h>
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
