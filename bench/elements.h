/* Formulas to measure and the 100,000 elements that they are measured on, gathered from a mesh: for tapes, for C by
 * hand, and for classes of dual numbers alike. Values and gradients are left where a solver would take them up, in the
 * cache: by tapes in registers, by others in arrays of a block. */
#ifndef SKEIN_BENCH_ELEMENTS_H
#define SKEIN_BENCH_ELEMENTS_H

#include <skein/formula.h>

#include "bench/bench.h"
#include "bench/by_hand.h"
#include "bench/texts.h"
#include "formula/formula.h"
#include "formula/tape.h"

/* What else there is of bench_texts, in their order: value and gradient by hand, one at a time and sixteen; by the
 * emitter's C; by dual numbers and by ADOL-C (NULL: not in this build); and second derivatives by hand, sixteen at a
 * time (NULL: there are none). */
typedef struct bench_functions {
    by_hand_function *by_hand, *by_hand_wide, *emitted, *by_dual, *by_adolc, *second, *emitted_second;
} bench_functions;
extern const bench_functions bench_functions_of[BENCH_FORMULAS];

typedef struct bench_elements {
    size_t count;
    sk_vec4 *positions;
    size_t position_count;
    uint32_t *slot[4];
    real *parameter[BY_HAND_MOST_PARAMETERS];
    real *ours, *theirs; /* outputs, one after the other */
    sk_tape_input input;
} bench_elements;

/* A rumpled sheet, or a block of shaken points, with elements all over it, and room for so many outputs. */
void bench_elements_make(bench_elements *e, bool solid, int parameter_count, size_t outputs);
void bench_elements_free(bench_elements *e);

/* The tape of a formula's value and gradient, or of the lower triangle of its second derivatives. */
typedef struct bench_tape {
    const bench_elements *elements;
    sk_tape tape;
    sk_allocator allocator;
} bench_tape;
void bench_tape_make(bench_tape *tape, const bench_elements *e, const bench_text *m, bool second);
void bench_tape_free(bench_tape *tape);
void bench_tape_run(void *tape); /* timed */

/* A function of by_hand.h on blocks of so many elements, and its outputs into arrays of a block. */
typedef struct bench_by_hand {
    by_hand_function *run;
    by_hand_input all;
    size_t block;
} bench_by_hand;
bench_by_hand bench_by_hand_of(const bench_elements *e, by_hand_function *run, size_t block);
void bench_by_hand_run(void *by_hand); /* timed */

/* That a function by hand gives what the tape gives, for each output; else the program fails. */
void bench_check_by_hand(const bench_elements *e, const bench_tape *tape, const bench_by_hand *by_hand,
                         const char *name);

#endif
