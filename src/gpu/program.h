/* Compute programs: the texts of src/, which the build turns into C (render/embed.cmake), put together and compiled.
 *
 * Called by compose.c, which writes the texts, and by whoever dispatches. A program is made once for each text: a plan
 * that is written anew with other numbers finds its programs again. The device's context is entered. */
#ifndef SK_GPU_PROGRAM_H
#define SK_GPU_PROGRAM_H

#include "base/memory.h"
#include "base/printf.h"

/* What the build writes: every file by its path without ".glsl", ending with a NULL name. */
typedef struct sk_gpu_file {
    const char *name, *text;
} sk_gpu_file;
extern const sk_gpu_file sk_gpu_files[];

/* A text that grows. Once memory has failed nothing more is added. */
typedef struct sk_gpu_text {
    sk_allocator *allocator;
    char *data;
    size_t count, capacity; /* without the 0 at the end */
    bool no_memory;
} sk_gpu_text;

void sk_gpu_put(sk_gpu_text *text, const char *format, ...) SK_PRINTF(2, 3);
/* Adds a text, with `number` for every '@' in it. */
void sk_gpu_put_text(sk_gpu_text *text, const char *from, size_t number);
/* Adds a file, with `number` for every '@' in it. The file must be one that the build has embedded. */
void sk_gpu_put_file(sk_gpu_text *text, const char *name, size_t number);

typedef struct sk_gpu_programs {
    struct sk_gpu_program {
        char *text;
        unsigned name;
    } * data;
    size_t count, capacity;
} sk_gpu_programs;

/* Compiles the text, or finds the program that was made of the same; `what` names it in the driver's complaints. */
skein_status sk_gpu_program(sk_gpu_programs *programs, sk_allocator *allocator, sk_gpu_text *text, const char *what,
                            unsigned *name, skein_error *error);
void sk_gpu_programs_release(sk_gpu_programs *programs, sk_allocator *allocator);

#endif
