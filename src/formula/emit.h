/* Writing formulas as text: what the walk over the graph (emit.c) and the languages (emit_c.c, emit_glsl.c) share. */
#ifndef SK_FORMULA_EMIT_H
#define SK_FORMULA_EMIT_H

#include "base/printf.h"
#include "formula/formula.h"

typedef struct sk_writer sk_writer;

typedef struct sk_language {
    const char *call[SK_NODE_COUNT]; /* operations that are written as functions */
    const char *declaration;         /* of a temporary */
    void (*constant)(sk_writer *, double);
    void (*input)(sk_writer *, uint32_t);
    void (*parameter)(sk_writer *, uint32_t);
    void (*open)(sk_writer *);
    void (*result)(sk_writer *, int component);                             /* up to the value */
    void (*derivative)(sk_writer *, int component, int particle, int axis); /* the same */
    void (*second)(sk_writer *, int row, int column);                       /* the same; NULL: these are left out */
    const char *end_result;
    void (*close)(sk_writer *);
} sk_language;

struct sk_writer {
    const skein_formula *formula;
    const sk_language *language;
    void (*write)(void *user, const char *text);
    void *user;
    bool *live;
    uint32_t *uses;   /* by live nodes and outputs */
    uint32_t *number; /* of a temporary, from 1 on */
    uint8_t *height;  /* of an expression written in place; 0: it has a name */
    uint32_t *shared; /* of what was computed for all elements beforehand, from 1 on; else 0 */
    const char *head; /* of the function that sk_formula_put_glsl writes */
};

extern const sk_language sk_c_language, sk_glsl_language, sk_shader_language, sk_kernel_language;

/* Nodes of a formula as the beginning of a function in GLSL that `head` opens: what they need, the head, and `float
 * o[count]` filled with them. Positions are p0, p1 ..., velocities v0, v1 ..., time t, and parameter i is the
 * includer's macro parameter@(i). The helpers stand in guards, so that several may stand in one shader. False when
 * there is no memory. */
bool sk_formula_put_glsl(const skein_formula *formula, const char *head, const sk_node *outputs, size_t count,
                         void (*put)(void *user, const char *text), void *user);

/* A number's value and gradient for the library's own walks (emit_kernel.c). */
void sk_put_kernel(sk_writer *w);
/* The same as a file to be compiled and registered (emit_compiled.c). */
void sk_put_compiled(sk_writer *w, const char *name);
/* What the language opens with, and a line for each node that has a name. */
void sk_put_temporaries(sk_writer *w, const sk_node *outputs, size_t count);
/* A node's name or expression, in brackets if its precedence is below `least`: 1 sums, 2 products, 3 calls. */
void sk_put_operand(sk_writer *w, sk_node node, int least);

void sk_put(sk_writer *w, const char *format, ...) SK_PRINTF(2, 3);
/* A number with a point or an exponent, whatever the locale says. */
void sk_put_number(sk_writer *w, double value, int digits);
/* The formula's own text, made fit for a comment; and its parameters. Each line begins with `line_begin`. */
void sk_put_source(sk_writer *w, const char *line_begin);
void sk_put_parameters(sk_writer *w, const char *line_begin);
/* Writes those of `count` helpers whose operation the formula has, and those of SK_NODE_CONSTANT always. */
void sk_put_helpers(sk_writer *w, const char *(*text_of)(size_t), size_t count, int (*op_of)(size_t));

#endif
