/* bench_emit [--second|--compiled] NAME FILE: one of the formulas of texts.c as the emitter writes it for the library's
 * kernels, or as a function with second derivatives; or a kind's, to be compiled and registered as a program does. The
 * build runs it, so that what is measured is what the emitter makes today. */
#include <stdio.h>
#include <string.h>

#include <skein/formula.h>

#include "bench/texts.h"

static void print(void *file, const char *text) {
    fputs(text, file);
}

int main(int argc, char **argv) {
    bool compiled = argc == 4 && !strcmp(argv[1], "--compiled"), second = argc == 4 && !strcmp(argv[1], "--second");
    const char *name = argc >= 3 ? argv[argc - 2] : "", *path = argv[argc - 1];
    skein_formula_desc desc = {.text = NULL};
    for (int i = 0; i < BENCH_FORMULAS && (argc == 3 || second); i++)
        if (!strcmp(name, bench_texts[i].identifier))
            desc = (skein_formula_desc){
                .text = bench_texts[i].text, .parameters = bench_texts[i].parameters, .second = second};
    for (int i = 0; i < BENCH_KINDS && compiled; i++)
        if (!strcmp(name, bench_kind_texts[i].kind)) desc.text = bench_kind_texts[i].text;
    if (!desc.text) {
        fprintf(stderr, "usage: bench_emit [--second|--compiled] NAME FILE, where NAME is an identifier or a kind in "
                        "texts.c\n");
        return 2;
    }
    skein_error error;
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    FILE *file = f ? fopen(path, "w") : NULL;
    if (f && !file) {
        perror(path);
        return 1;
    }
    char symbol[64];
    snprintf(symbol, sizeof symbol, "compiled_%s", name);
    if (!f || (compiled ? skein_formula_emit_compiled(f, symbol, print, file, &error)
                        : skein_formula_emit(f, second ? SKEIN_FORMULA_C : SKEIN_FORMULA_KERNEL, print, file, &error))) {
        fprintf(stderr, "bench_emit: %s: %s\n", error.where, error.message);
        return 1;
    }
    skein_formula_destroy(f);
    return fclose(file) ? 1 : 0;
}
