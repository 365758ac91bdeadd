/* The tokens of a formula, one at a time, and the place of the first fault. */
#include "formula/text.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/number.h"
#include "base/status.h"

/* ASCII whatever the locale. */
static bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}
static bool is_printable(char c) {
    return c >= ' ' && c <= '~';
}

bool sk_is_name(const char *name) {
    size_t length = strlen(name);
    if (!is_letter(name[0]) || length >= SK_NAME_SIZE) return false;
    for (size_t i = 1; i < length; i++)
        if (!is_letter(name[i]) && !is_digit(name[i])) return false;
    return true;
}

/* ---- faults ---- */

skein_formula_mark sk_text_mark(const sk_text *text, size_t begin, size_t end) {
    size_t line = 1, start = 0;
    for (size_t i = 0; i < begin; i++)
        if (text->text[i] == '\n') line++, start = i + 1;
    return (skein_formula_mark){line, begin - start + 1, end > begin ? end - begin : 1};
}

bool sk_text_fail(sk_text *text, size_t begin, size_t end, skein_status status, const char *format, ...) {
    if (text->failed) return false;
    text->failed = true;
    text->now.kind = SK_TOKEN_END;
    skein_formula_mark mark = sk_text_mark(text, begin, end);
    if (text->mark) *text->mark = mark;
    char where[64], message[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    snprintf(where, sizeof where, "line %zu, column %zu", mark.line, mark.column);
    sk_fail(text->error, status, where, "%s", message);
    return false;
}

bool sk_text_expected(sk_text *text, const char *what) {
    const sk_token *now = &text->now;
    char found[40];
    if (now->kind == SK_TOKEN_END) snprintf(found, sizeof found, "the end");
    else
        snprintf(found, sizeof found, "'%.*s'", (int)(now->end - now->begin > 32 ? 32 : now->end - now->begin),
                 text->text + now->begin);
    return sk_text_fail(text, now->begin, now->end, SKEIN_ERROR_SYNTAX, "expected %s, not %s", what, found);
}

size_t skein_formula_show(const char *text, const skein_formula_mark *mark, char *out, size_t size) {
    if (!out) size = 0;
    if (!text || !mark) return (size_t)snprintf(out, size, "%s", "");
    enum { MOST = 120 }; // of a line: what is longer is cut around the mark
    for (size_t line = 1; line < mark->line && *text; text++) line += *text == '\n';
    size_t length = strcspn(text, "\n"), at = mark->column - 1 < length ? mark->column - 1 : length;
    size_t first = at > MOST / 2 ? at - MOST / 2 : 0, shown = length - first < MOST ? length - first : MOST;
    size_t width = mark->width < 1 ? 1 : mark->width, room = shown > at - first ? shown - (at - first) : 1;
    char source[MOST + 1], under[MOST + 1];
    for (size_t i = 0; i < shown; i++) source[i] = is_printable(text[first + i]) ? text[first + i] : '?';
    source[shown] = '\0';
    if (width > room) width = room;
    memset(under, '^', width);
    under[width] = '\0';
    return (size_t)snprintf(out, size, "%s\n%*s%s\n", source, (int)(at - first), "", under);
}

/* ---- tokens ---- */

void sk_text_init(sk_text *text, const char *chars, skein_formula_mark *mark, skein_error *error) {
    *text = (sk_text){.text = chars, .length = strlen(chars), .mark = mark, .error = error};
    if (mark) *mark = (skein_formula_mark){1, 1, 1};
    if (text->length > SKEIN_FORMULA_MOST_TEXT) {
        sk_text_fail(text, 0, 1, SKEIN_ERROR_LIMIT, "the formula is too long: %zu bytes, where %d are the most",
                     text->length, SKEIN_FORMULA_MOST_TEXT);
        return;
    }
    sk_text_next(text);
}

static void skip_blanks(sk_text *text) {
    const char *c = text->text;
    for (;;) {
        while (c[text->at] == ' ' || c[text->at] == '\t' || c[text->at] == '\n' || c[text->at] == '\r') text->at++;
        if (c[text->at] != '/' || c[text->at + 1] != '/') return;
        text->at += strcspn(c + text->at, "\n"); // a comment
    }
}

static void read_number(sk_text *text) {
    text->at += sk_number_read(text->text + text->at, &text->now.number);
    const char *c = text->text + text->at;
    text->now.end = text->at;
    if (*c == '.')
        sk_text_fail(text, text->now.begin, text->at + 1, SKEIN_ERROR_SYNTAX, "a number has one point at the most");
    else if (is_letter(*c))
        sk_text_fail(text, text->now.begin, text->at + 1, SKEIN_ERROR_SYNTAX,
                     "a number ends with '%c': write 2*x, not 2x", *c);
    else if (!isfinite(text->now.number))
        sk_text_fail(text, text->now.begin, text->at, SKEIN_ERROR_LIMIT, "the number is too large");
}

static void read_name(sk_text *text) {
    const char *c = text->text + text->at;
    size_t length = 1;
    while (is_letter(c[length]) || is_digit(c[length])) length++;
    text->at += length;
    if (length >= SK_NAME_SIZE) {
        sk_text_fail(text, text->now.begin, text->at, SKEIN_ERROR_LIMIT,
                     "the name is too long: %zu letters, where %d are the most", length, SK_NAME_SIZE - 1);
        return;
    }
    memcpy(text->now.name, c, length);
    text->now.name[length] = '\0';
}

static int read_symbol(sk_text *text) {
    static const struct {
        char chars[3];
        int kind;
    } pairs[] = {{"<=", SK_TOKEN_LE}, {">=", SK_TOKEN_GE},  {"==", SK_TOKEN_EQ},
                 {"!=", SK_TOKEN_NE}, {"&&", SK_TOKEN_AND}, {"||", SK_TOKEN_OR}};
    const char *c = text->text + text->at;
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        if (c[0] == pairs[i].chars[0] && c[1] == pairs[i].chars[1]) {
            text->at += 2;
            return pairs[i].kind;
        }
    text->at++;
    return (unsigned char)*c;
}

void sk_text_next(sk_text *text) {
    if (text->failed) return;
    text->before = text->now;
    skip_blanks(text);
    text->now.begin = text->at;
    char c = text->text[text->at];
    if (!c) {
        text->now.kind = SK_TOKEN_END;
    } else if (is_digit(c) || (c == '.' && is_digit(text->text[text->at + 1]))) {
        text->now.kind = SK_TOKEN_NUMBER;
        read_number(text);
    } else if (is_letter(c)) {
        text->now.kind = SK_TOKEN_NAME;
        read_name(text);
    } else if (strchr("+-*/^()<>=!&|,.;", c)) {
        text->now.kind = read_symbol(text);
    } else if (c == '?') {
        sk_text_fail(text, text->at, text->at + 1, SKEIN_ERROR_SYNTAX,
                     "there is no '?' here: write select(condition, yes, no)");
    } else if (strchr("[]{}", c)) {
        sk_text_fail(text, text->at, text->at + 1, SKEIN_ERROR_SYNTAX,
                     "there is no '%c' here: brackets are round, and a vector is vec3(x, y, z)", c);
    } else {
        sk_text_fail(text, text->at, text->at + 1, SKEIN_ERROR_SYNTAX,
                     is_printable(c) ? "'%c' means nothing here" : "a byte that is no printable ASCII (0x%02x)",
                     is_printable(c) ? c : (int)(unsigned char)c);
    }
    text->now.end = text->at > text->now.begin ? text->at : text->now.begin;
    if (text->failed) text->now.kind = SK_TOKEN_END;
}

bool sk_text_take(sk_text *text, int kind) {
    if (text->now.kind != kind) return false;
    sk_text_next(text);
    return true;
}
