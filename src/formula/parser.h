/* What the two halves of the parser share: parser.c, the grammar, and parser_names.c, what names stand for. */
#ifndef SK_FORMULA_PARSER_H
#define SK_FORMULA_PARSER_H

#include "formula/formula.h"

typedef struct let {
    const char *name;
    sk_value value;
} let;

typedef struct parser {
    sk_text text;
    sk_graph *graph;
    skein_formula *formula;
    const skein_formula_desc *desc;
    let lets[SK_FORMULA_MOST_LETS];
    const char *defining; /* the name of the `let` that is being read */
    int depth;
    bool in_rest;
} parser;

/* What a rule returns after a fault. */
static const sk_value sk_nothing = {.type = SK_NUMBER};

/* A fault from the place `begin` to the last token read. */
#define FAIL(p_, begin_, status_, ...) \
    (sk_text_fail(&(p_)->text, (begin_), (p_)->text.before.end, SKEIN_ERROR_##status_, __VA_ARGS__), sk_nothing)

/* Is the value, which began at `begin`, of the type that `by` takes? Fails if not. */
bool sk_parser_need(parser *p, size_t begin, const sk_value *value, sk_value_type type, const char *by);

let *sk_parser_let(parser *p, const char *name);            /* NULL if there is none */
int sk_parser_parameter(const parser *p, const char *name); /* -1 if there is none */
bool sk_parser_is_taken(const char *name);                  /* by the language itself */
sk_value sk_parser_named(parser *p, const sk_token *token); /* a name alone */
sk_value sk_parser_call(parser *p, const sk_token *token);  /* a name before the present token, a bracket */
sk_value sk_parser_either(parser *p);                       /* an expression */

#endif
