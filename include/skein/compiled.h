/* Compiled formulas: what `skein formula --emit c` writes, and how it speaks with the library.
 *
 *     $ skein formula 'length(p0 - p1) - L' --param L=1 --emit c --name spring > spring.c
 *     $ cc -std=gnu17 -O3 -march=native -ffp-contract=off -fno-math-errno -c spring.c
 *
 *     extern const skein_compiled spring;      // in the program that links spring.o
 *     skein_formula_register(world, &spring);  // formula.h
 *
 * From then on every constraint of that formula in the world runs this code in place of the tape, with the tape's bits.
 * Here are the plain structs between both sides. An emitted file is the formula alone, in macros (FORMULA, POSITION,
 * GRADIENT ...), and compiled_formula.h says what they mean; the walk and what is made of value and
 * gradient are the library's own (inside/). */
#ifndef SKEIN_COMPILED_H
#define SKEIN_COMPILED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef SKEIN_DOUBLE // as in skein.h
typedef double skein_real;
#else
typedef float skein_real;
#endif

#define SKEIN_COMPILED_ABI 2
#define SKEIN_GROUP 16 /* elements a group, which share no particle */

/* What the code was compiled for: the library takes it only where the processor has that. */
typedef enum skein_instructions {
    SKEIN_INSTRUCTIONS_PLAIN,
    SKEIN_INSTRUCTIONS_AVX2,
    SKEIN_INSTRUCTIONS_AVX512 /* with DQ, BW and VL */
} skein_instructions;

/* The library's own elementary functions, which have the same bits on every machine: of `count` numbers, a multiple of
 * the code's lanes. Results may be in an argument's place. */
typedef void skein_function(const skein_real *x, skein_real *out, size_t count);
typedef void skein_function_of_two(const skein_real *x, const skein_real *y, skein_real *out, size_t count);
typedef struct skein_elementary {
    skein_function *exp, *log, *sin, *cos, *tan, *asin, *acos;
    skein_function_of_two *atan2 /* of y, x */, *pow;
} skein_elementary;

typedef struct skein_compiled skein_compiled;

/* Groups of elements, for a walk. State vectors have four numbers a slot, x y z and in `positions` the inverse mass, as
 * quads; slots under `packed` lie in blocks of sixteen, x16 y16 z16 w16. Values have SKEIN_GROUP lanes a group. */
typedef struct skein_groups {
    size_t count;
    const uint32_t *slots; /* of each group SKEIN_GROUP first particles, as many second ones ... */
    const uint8_t *ahead;  /* of each group: how many from it on, itself among them, share no particle */
    size_t packed;
    skein_real *positions;
    skein_real *other;      /* of forces the velocities, or NULL without damping; of damped projection X at the start */
    skein_real *sums;       /* of forces: added to */
    const skein_real *rest; /* rest value r of lane l: rest[r * rest_stride + l] */
    size_t rest_stride;
    const skein_real *stiffness, *compliance;
    skein_real *multiplier;       /* of damped projection */
    const skein_real *parameters; /* in the formula's order */
    skein_real time, step;        /* s; the substep */
    skein_real damping_time;      /* c/k, s */
    skein_real per_step;          /* 1/h^2, times the projections that share the stiffness */
    skein_real gamma;             /* c/(k h) */
    const skein_elementary *elementary;
} skein_groups;

/* Elements for implicit solves, in numbers and out: of each number `count` in a row, a multiple of SKEIN_GROUP, 64-byte aligned. Outputs may be
 * in an input's place: each SKEIN_GROUP is read before it is written, or what is written there is what was read. */
typedef struct skein_element_values {
    size_t count;
    const skein_real *const *positions; /* of each particle its x; y and z are `stride` further, and twice that */
    size_t stride;
    const skein_real *const *rest;
    const skein_real *parameters; /* in the formula's order; the same for all, as is time */
    skein_real time;              /* s */
    const skein_elementary *elementary;
    skein_real *const *outputs; /* the value, its gradient by particle and axis, and its derivative by t; or the lower
                                   triangle of the second derivatives, row by row */
} skein_element_values;

/* What an emitted file defines; all that it points to lasts as long. */
struct skein_compiled {
    uint32_t abi;       /* SKEIN_COMPILED_ABI */
    uint32_t real_size; /* sizeof(skein_real) */
    uint32_t lanes;     /* elements at once, 4, 8 or 16 */
    skein_instructions needs;
    uint64_t hash;                 /* of the formula's canonical form: skein_formula_hash() */
    const char *const *text;       /* the formula, in pieces; ended by NULL */
    const char *const *parameters; /* their names, ended by NULL */
    bool energy;                   /* for constraints of kind `energy`, else for `formula` */
    void (*project)(const skein_groups *groups);
    void (*project_damped)(const skein_groups *groups); /* and wherever multipliers are kept */
    void (*force)(const skein_groups *groups);
    void (*evaluate)(const skein_element_values *elements);
    void (*second)(const skein_element_values *elements); /* of an energy, else NULL */
};

#ifdef __cplusplus
}
#endif

#endif
