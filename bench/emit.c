/* bench_emit NAME FILE [second]: one of the formulas of texts.c as the emitter writes it for the library's kernels, or
 * as C with second derivatives. The build runs it, so that what is measured is what the emitter makes today. */
#include <stdio.h>
#include <string.h>

#include <skein/formula.h>

#include "bench/texts.h"

static void print(void *file, const char *text) {
    fputs(text, file);
}

int main(int argc, char **argv) {
    const bench_text *found = NULL;
    for (int i = 0; i < BENCH_FORMULAS; i++)
        if (argc >= 3 && !strcmp(argv[1], bench_texts[i].identifier)) found = &bench_texts[i];
    if (!found) {
        fprintf(stderr, "usage: bench_emit NAME FILE [second], where NAME is an identifier in texts.c\n");
        return 2;
    }
    skein_error error;
    skein_formula_desc desc = {.text = found->text, .parameters = found->parameters, .second = argc == 4};
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    FILE *file = f ? fopen(argv[2], "w") : NULL;
    if (f && !file) {
        perror(argv[2]);
        return 1;
    }
    if (!f || skein_formula_emit(f, argc == 4 ? SKEIN_FORMULA_C : SKEIN_FORMULA_KERNEL, print, file, &error)) {
        fprintf(stderr, "bench_emit: %s: %s\n", error.where, error.message);
        return 1;
    }
    skein_formula_destroy(f);
    return fclose(file) ? 1 : 0;
}
