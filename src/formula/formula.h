/* A formula: its text, its graph, and the nodes of its value and derivatives. The entry to the rest of the folder:
 * parser.c makes one from text, formula.c derives and evaluates it; code that runs it on many elements makes tapes from
 * it (tape.h). Parameters are numbered in the order in which the caller names them; after those come the values of
 * rest(...), in the order of the text. It is not changed after it was made. */
#ifndef SK_FORMULA_FORMULA_H
#define SK_FORMULA_FORMULA_H

#include <skein/formula.h>

#include "formula/text.h"
#include "formula/value.h"

enum {
    SK_FORMULA_MOST_LETS = 128,
    SK_FORMULA_MOST_WARNINGS = 4,
    /* a vector's value, and its derivatives by positions, velocities and time */
    SK_FORMULA_MOST_OUTPUTS = 3 * (1 + SK_INPUT_COUNT)
};

typedef struct sk_formula_warning {
    skein_formula_mark mark;
    const char *text;
} sk_formula_warning;

struct skein_formula {
    sk_allocator *allocator, own; /* `own` is the allocator of those made by the public call */
    char *text;
    sk_graph graph;
    int particles, parameters, rests;
    char parameter_name[SKEIN_FORMULA_MOST_PARAMETERS][SK_NAME_SIZE];
    char (*let_name)[SK_NAME_SIZE]; /* what nodes are called by, SK_FORMULA_MOST_LETS */
    int lets;
    int size; /* of the value: 1 or 3 */
    bool at_least_zero;
    uint8_t uses; /* what the value depends on */
    sk_node value[3];
    sk_node rest[SKEIN_FORMULA_MOST_RESTS]; /* what parameter `parameters` + i is at the rest pose */
    sk_node by_position[3][SK_INPUT_VELOCITY], by_velocity[3][SK_INPUT_VELOCITY], by_time[3];
    sk_node *hessian; /* (3 particles)^2, or NULL */
    sk_formula_warning warning[SK_FORMULA_MOST_WARNINGS];
    int warnings;
    uint64_t hash; /* of what it computes (compiled.h) */
};

/* As skein_formula_create, with the caller's memory. */
skein_formula *sk_formula_create(const skein_formula_desc *desc, sk_allocator *allocator, skein_formula_mark *mark,
                                 skein_error *error);

/* Evaluates the value and its derivatives at the positions, with the values of rest(...) after the parameters. False
 * when there is no memory. */
bool sk_formula_value_at(const skein_formula *formula, const double *positions, const double *parameters, double time,
                         skein_formula_value *value);

/* Reads the text into the formula's value, rests and warnings. */
skein_status sk_formula_parse(skein_formula *formula, const skein_formula_desc *desc, skein_formula_mark *mark,
                              skein_error *error);

#endif
