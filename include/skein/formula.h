/* Formulas: a line of text, differentiated by the library.
 *
 *     skein_formula_desc desc = {.text = "length(p0 - p1) - L", .parameters = (const char *[]){"L", NULL}};
 *     skein_formula *f = skein_formula_create(&desc, NULL, &error);
 *     skein_formula_evaluate(f, &(skein_formula_point){.positions = p, .parameters = &l}, &value);
 *     // value.number[0], value.by_position[0][3 * particle + axis]
 *     skein_formula_destroy(f);
 *
 * The language, with every function, is described in docs/formula.md and by `skein formula --functions`. Numbers and
 * 3-vectors; particles p0 to p7 (p is p0); velocities v0 to v7 where they are allowed; t, the time; parameters by the
 * names that the caller gives; lines `let name = ...;` before the result; rest(...), what an expression is at the rest
 * pose.
 *
 * Values are finite wherever they do not overflow: at places where a derivative has no value (a length at 0) it is 0,
 * and `guarded` says so. A formula is not changed by evaluating it: threads may share one.
 *
 * Errors and pointers are as in skein.h: a `skein_error` may be NULL; so may what is said to be, and nothing else.
 */
#ifndef SKEIN_FORMULA_H
#define SKEIN_FORMULA_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default) /* what a shared library shows of itself, and nothing else */
#endif

enum {
    SKEIN_FORMULA_MOST_PARTICLES = 8,
    SKEIN_FORMULA_MOST_PARAMETERS = 32,
    SKEIN_FORMULA_MOST_RESTS = 32,
    SKEIN_FORMULA_MOST_TEXT = 65536, /* bytes */
    SKEIN_FORMULA_MOST_DEPTH = 100   /* of brackets in brackets */
};

typedef enum skein_formula_result {
    SKEIN_FORMULA_ANY,
    SKEIN_FORMULA_NUMBER, /* a constraint, an energy, a surface */
    SKEIN_FORMULA_VECTOR  /* a force */
} skein_formula_result;

/* What a formula is made from. All zero but the text is a good start. */
typedef struct skein_formula_desc {
    const char *text;
    const char *const *parameters; /* names, ended by NULL; NULL: none */
    int particles;                 /* how many it is on; 0: as many as it names */
    bool velocities;               /* v0 ... v7 are allowed */
    bool comparison;               /* the result may be `a >= b`, which stands for a - b >= 0, or `a == b` */
    bool second;                   /* second derivatives are wanted, too */
    skein_formula_result result;
} skein_formula_desc;

/* A place in a formula's text: line and column count from 1. */
typedef struct skein_formula_mark {
    size_t line, column, width;
} skein_formula_mark;

typedef struct skein_formula skein_formula;

/* NULL on failure: the place is then in `mark` and, in words, in error->where. Both may be NULL. Fails with
 * SKEIN_ERROR_SYNTAX, SKEIN_ERROR_NAME, SKEIN_ERROR_LIMIT and SKEIN_ERROR_MEMORY. The caller destroys it. */
skein_formula *skein_formula_create(const skein_formula_desc *desc, skein_formula_mark *mark, skein_error *error);
void skein_formula_destroy(skein_formula *formula); /* NULL is allowed */
/* The marked line of a text, and a second line with carets under the marked place. Returns the length that it needs,
 * as snprintf does. Bytes that are no printable ASCII are shown as '?'. `out` may be NULL. */
size_t skein_formula_show(const char *text, const skein_formula_mark *mark, char *out, size_t size);

/* What is right but unwise, by index from 0; NULL past the end. `mark` may be NULL. The text lives as long as the
 * formula. */
const char *skein_formula_warning(const skein_formula *formula, size_t index, skein_formula_mark *mark);

typedef struct skein_formula_info {
    int particles, parameters, rests;
    int size;                         /* of the result: 1 or 3 */
    bool at_least_zero;               /* it was written as `a >= b` or `a <= b` */
    bool positions, velocities, time; /* what the result depends on */
    size_t operations;                /* for the value and the gradient together */
} skein_formula_info;

skein_formula_info skein_formula_about(const skein_formula *formula);

/* Where to evaluate. Whatever the formula does not name may be NULL. */
typedef struct skein_formula_point {
    const double *positions;      /* 3 a particle */
    const double *velocities;     /* 3 a particle */
    const double *rest_positions; /* 3 a particle, for rest(...); NULL: the positions are the rest pose */
    const double *parameters;
    double time;
} skein_formula_point;

/* A value and its derivatives; a number has them at [0]. */
typedef struct skein_formula_value {
    double number[3];
    double by_position[3][3 * SKEIN_FORMULA_MOST_PARTICLES];
    double by_velocity[3][3 * SKEIN_FORMULA_MOST_PARTICLES];
    double by_time[3];
    bool guarded; /* something had no value here, and 0 or the nearest was taken */
} skein_formula_value;

/* In double, whatever the library computes in. Fails with SKEIN_ERROR_VALUE where what the formula names is not given,
 * and with SKEIN_ERROR_MEMORY. */
skein_status skein_formula_evaluate(const skein_formula *formula, const skein_formula_point *point,
                                    skein_formula_value *value, skein_error *error);
/* The second derivatives of a number by all coordinates of the positions: (3 particles)^2, row by row. Fails in the same
 * way, and with SKEIN_ERROR_VALUE for a formula that was made without `second`. */
skein_status skein_formula_hessian(const skein_formula *formula, const skein_formula_point *point, double *hessian,
                                   skein_error *error);

typedef enum skein_formula_language {
    SKEIN_FORMULA_C,
    SKEIN_FORMULA_GLSL,
    SKEIN_FORMULA_KERNEL, /* C for a constraint that is compiled into the library (docs/formula.md) */
    SKEIN_FORMULA_GRAPH   /* the operations, a line each */
} skein_formula_language;

/* Writes the value and its gradient as text, in pieces; in C also the second derivatives, if they were asked for. Fails
 * with SKEIN_ERROR_VALUE for a formula that the language cannot have, and with SKEIN_ERROR_MEMORY. */
skein_status skein_formula_emit(const skein_formula *formula, skein_formula_language language,
                                void (*write)(void *user, const char *text), void *user, skein_error *error);

/* ---- at compiled speed: compiled.h ---- */

typedef struct skein_compiled skein_compiled;

/* Writes a file of C that a compiler makes into a skein_compiled of that name, a C identifier (NULL:
 * skein_compiled_formula). The formula is a constraint's: a number, without velocities; with second derivatives it is for
 * constraints of kind `energy`. Fails in the same way, and with SKEIN_ERROR_NAME for what is no identifier. */
skein_status skein_formula_emit_compiled(const skein_formula *formula, const char *name,
                                         void (*write)(void *user, const char *text), void *user, skein_error *error);
/* A hash of what a formula computes, independent of its names and blanks: formulas with the same hash are run by the
 * same compiled code. */
uint64_t skein_formula_hash(const skein_formula *formula);
/* From its next step on the world runs this in place of the tape for every constraint (`formula` or `energy`) with that
 * formula, also for those added later. It must exist until the world is destroyed. Fails with
 * SKEIN_ERROR_VALUE for code of another ABI, precision or processor, and for what another version of Skein emitted, whose
 * operations may differ; and with SKEIN_ERROR_MEMORY. Of two with the same hash the later one runs. */
skein_status skein_formula_register(skein_world *world, const skein_compiled *compiled);
/* A constraint's formula, until its text is changed or it is removed; NULL where it has none. */
const skein_formula *skein_formula_of(const skein_world *world, skein_handle constraint);
/* Whether something compiled runs for it. */
bool skein_formula_is_compiled(const skein_world *world, skein_handle constraint);

/* A function of the language, by index from 0; false past the end. Either may be NULL. */
bool skein_formula_function(size_t index, const char **usage, const char **help);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
