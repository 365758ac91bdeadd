/* The formulas that are measured as values and gradients, as texts. Apart from what runs them, for emit.c. */
#ifndef SKEIN_BENCH_TEXTS_H
#define SKEIN_BENCH_TEXTS_H

#include <stdbool.h>

typedef struct bench_text {
    const char *name, *identifier; /* for people, and for C */
    const char *text;
    const char *const *parameters;
    int particles, parameter_count;
    bool solid; /* on tetrahedra of a block, else on triangles and hinges of a sheet */
} bench_text;

enum { BENCH_FORMULAS = 5 };
extern const bench_text bench_texts[BENCH_FORMULAS];

/* The texts of kinds that the library has kernels of, src/constraints/emitted/. */
typedef struct bench_kind_text {
    const char *kind, *text;
} bench_kind_text;

enum { BENCH_DISTANCE, BENCH_DIHEDRAL, BENCH_VOLUME, BENCH_AREA, BENCH_KINDS };
extern const bench_kind_text bench_kind_texts[BENCH_KINDS];

#endif
