/* A formula's text: its tokens, and errors with their places. Used by the parser alone; nothing is allocated. The first
 * error is kept, and after it there are no more tokens, so that the parser need not check after every step. */
#ifndef SK_FORMULA_TEXT_H
#define SK_FORMULA_TEXT_H

#include <skein/formula.h>

#include "base/printf.h"

/* Single characters stand for themselves. */
enum {
    SK_TOKEN_END = 256,
    SK_TOKEN_NUMBER,
    SK_TOKEN_NAME,
    SK_TOKEN_LE,
    SK_TOKEN_GE,
    SK_TOKEN_EQ,
    SK_TOKEN_NE,
    SK_TOKEN_AND,
    SK_TOKEN_OR
};

enum { SK_NAME_SIZE = 32 };

typedef struct sk_token {
    int kind;
    size_t begin, end; /* in the text */
    double number;
    char name[SK_NAME_SIZE];
} sk_token;

typedef struct sk_text {
    const char *text;
    size_t length, at;
    sk_token now, before; /* the present token, and the one before it */
    bool failed;
    skein_formula_mark *mark; /* where a fault is told; may be NULL, as may `error` */
    skein_error *error;
} sk_text;

void sk_text_init(sk_text *text, const char *chars, skein_formula_mark *mark, skein_error *error);
void sk_text_next(sk_text *text);
/* Takes the present token if it is of the kind. */
bool sk_text_take(sk_text *text, int kind);
/* Fails at [begin, end) of the text, unless something failed before. Returns false. */
bool sk_text_fail(sk_text *text, size_t begin, size_t end, skein_status status, const char *format, ...)
    SK_PRINTF(5, 6);
/* Fails at the present token: "expected ..., not 'that'". */
bool sk_text_expected(sk_text *text, const char *what);
skein_formula_mark sk_text_mark(const sk_text *text, size_t begin, size_t end);

/* Letters, digits and _, not a digit first, and short enough. */
bool sk_is_name(const char *name);

#endif
