/* From text to the graph, in one pass by recursive descent: every rule of the grammar is a function that returns what
 * it has read as a value. A fault is kept by sk_text_fail, which also ends the text, so that every rule then returns.
 *
 *     formula    = { "let" name "=" either ";" } either [ ";" ]
 *     either     = both { "||" both }            both  = comparison { "&&" comparison }
 *     comparison = sum [ ("<" | "<=" | ">" | ">=" | "==" | "!=") sum ]
 *     sum        = product { ("+" | "-") product }
 *     product    = sign { ("*" | "/") sign }
 *     sign       = ("-" | "+" | "!") sign | power
 *     power      = swizzled [ "^" sign ]
 *     swizzled   = primary { "." letters }
 *     primary    = number | name | name "(" either { "," either } ")" | "(" either ")" */
#include <stdio.h>
#include <string.h>

#include "base/status.h"
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

static sk_value either(parser *p);
static sk_value sign(parser *p);

static const sk_value nothing = {.type = SK_NUMBER};

/* A fault from the place `begin` to the last token read. */
#define FAIL(p_, begin_, status_, ...) \
    (sk_text_fail(&(p_)->text, (begin_), (p_)->text.before.end, SKEIN_ERROR_##status_, __VA_ARGS__), nothing)

static bool need(parser *p, size_t begin, const sk_value *value, sk_value_type type, const char *by) {
    if (p->text.failed || value->type == type) return !p->text.failed;
    const char *hint =
        value->type == SK_VECTOR3 && type == SK_NUMBER ? "; its length is length(v), a component v.x" : "";
    return sk_text_fail(&p->text, begin, p->text.before.end, SKEIN_ERROR_VALUE, "%s takes %s, and this is %s%s", by,
                        sk_type_text(type), sk_type_text(value->type), hint);
}

/* ---- names ---- */

static const char *const words[] = {"p", "v", "t", "pi", "let"};

static let *find_let(parser *p, const char *name) {
    for (int i = 0; i < p->formula->lets; i++)
        if (!strcmp(p->lets[i].name, name)) return &p->lets[i];
    return NULL;
}

static int find_parameter(const parser *p, const char *name) {
    for (int i = 0; i < p->formula->parameters; i++)
        if (!strcmp(p->formula->parameter_name[i], name)) return i;
    return -1;
}

static sk_value unknown_name(parser *p, const sk_token *token) {
    enum { MOST = 256 };
    const char *names[MOST];
    static const char *const points[] = {"p0", "p1", "p2", "p3", "p4", "p5", "p6", "p7"};
    size_t count = 0;
    for (int i = 0; i < p->formula->parameters; i++) names[count++] = p->formula->parameter_name[i];
    for (int i = 0; i < p->formula->lets; i++) names[count++] = p->lets[i].name;
    for (size_t i = 0; i < sk_function_count; i++) names[count++] = sk_functions[i].name;
    for (int i = 0; i < (p->desc->particles ? p->desc->particles : 8); i++) names[count++] = points[i];
    names[count++] = "pi", names[count++] = "let";
    // of a name of one or two letters, nearly every other is near
    const char *near = token->name[1] && token->name[2] ? sk_nearest_name(token->name, names, count) : NULL;
    if (near) return FAIL(p, token->begin, NAME, "there is no name '%s'; did you mean '%s'?", token->name, near);
    return FAIL(p, token->begin, NAME,
                "there is no name '%s': parameters are named by whoever uses the formula, other "
                "names by let",
                token->name);
}

/* p, v, or one of them with digits: the particle's number; -1 for any other name. */
static long particle_number(const char *name) {
    long number = 0;
    if (name[0] != 'p' && name[0] != 'v') return -1;
    for (const char *c = name + 1; *c; c++) {
        if (*c < '0' || *c > '9') return -1;
        number = number < 1000 ? number * 10 + (*c - '0') : number;
    }
    return name[1] == '0' && name[2] ? -1 : number;
}

static sk_value particle(parser *p, const sk_token *token, long number) {
    const int given = p->desc->particles;
    if (number >= SKEIN_FORMULA_MOST_PARTICLES)
        return FAIL(p, token->begin, LIMIT, "too many particles: a formula has %d at the most, p0 to p%d",
                    SKEIN_FORMULA_MOST_PARTICLES, SKEIN_FORMULA_MOST_PARTICLES - 1);
    if (given && number >= given)
        return FAIL(p, token->begin, LIMIT,
                    given == 1 ? "this formula is on one particle: there is only p"
                               : "too many particles: this formula is on %d, p0 to p%d",
                    given, given - 1);
    bool velocity = token->name[0] == 'v';
    if (velocity && !p->desc->velocities)
        return FAIL(p, token->begin, NAME,
                    "'%s' is a velocity, and those are for force fields: a constraint, an "
                    "energy or a surface depends on positions and t",
                    token->name);
    if (velocity && p->in_rest)
        return FAIL(p, token->begin, VALUE, "nothing moves at the rest pose: there is no '%s' in rest(...)",
                    token->name);
    if (number >= p->formula->particles) p->formula->particles = (int)number + 1;
    uint32_t first = (uint32_t)((velocity ? SK_INPUT_VELOCITY : SK_INPUT_POSITION) + 3 * number);
    sk_value out = {.type = SK_VECTOR3};
    for (uint32_t axis = 0; axis < 3; axis++) out.node[axis] = sk_input(p->graph, first + axis);
    return out;
}

static sk_value named(parser *p, const sk_token *token) {
    const char *name = token->name;
    const let *found = find_let(p, name);
    int parameter = find_parameter(p, name);
    long number = particle_number(name);
    if (found) return found->value;
    if (parameter >= 0) return sk_number(sk_parameter(p->graph, (uint32_t)parameter));
    if (number >= 0) return particle(p, token, number);
    if (!strcmp(name, "pi")) return sk_number(sk_constant(p->graph, 3.14159265358979323846));
    if (!strcmp(name, "t") && p->in_rest)
        return FAIL(p, token->begin, VALUE, "there is no time at the rest pose: no 't' in rest(...)");
    if (!strcmp(name, "t")) return sk_number(sk_input(p->graph, SK_INPUT_TIME));
    if (p->defining && !strcmp(name, p->defining))
        return FAIL(p, token->begin, NAME, "'%s' is used in its own definition: formulas do not recur", name);
    if (!strcmp(name, "let"))
        return FAIL(p, token->begin, SYNTAX, "'let' begins a line, as in: let a = p1 - p0; length(a)");
    const sk_function *function = sk_function_find(name);
    if (function) return FAIL(p, token->begin, SYNTAX, "'%s' is a function: %s", name, function->usage);
    return unknown_name(p, token);
}

/* ---- functions ---- */

static void warn_of_acos(parser *p, const sk_function *function, const sk_value *argument, size_t begin) {
    skein_formula *f = p->formula;
    if (strcmp(function->name, "acos") || !argument->of_dot || f->warnings == SK_FORMULA_MOST_WARNINGS) return;
    f->warning[f->warnings++] = (sk_formula_warning){
        sk_text_mark(&p->text, begin, p->text.before.end),
        "acos of a dot product is inexact near 0 and 180 degrees, and its gradient is worse: use angle(u, v), or "
        "dihedral(p0, p1, p2, p3)"};
}

/* Does an argument fit its letter? 'a' is number or vector, and as the one before it. */
static bool fits(parser *p, const sk_function *function, const sk_value *arguments, int at, size_t begin) {
    const sk_value *value = &arguments[at];
    char letter = function->arguments[at], by[80];
    if (p->text.failed) return false;
    snprintf(by, sizeof by, "%s, as argument %d,", function->usage, at + 1);
    if (letter == 'n') return need(p, begin, value, SK_NUMBER, by);
    if (letter == 'v') return need(p, begin, value, SK_VECTOR3, by);
    if (letter == 'b') return need(p, begin, value, SK_TRUTH, by);
    if (at > 0 && function->arguments[at - 1] == 'a') return need(p, begin, value, arguments[at - 1].type, by);
    if (value->type != SK_TRUTH) return true;
    return sk_text_fail(&p->text, begin, p->text.before.end, SKEIN_ERROR_VALUE,
                        "%s takes a number or a vector, and this is a comparison", by);
}

/* Becomes parameters, one for each component, whose values at the rest pose are the argument. */
static sk_value rest_of(parser *p, const sk_value *argument, size_t begin) {
    skein_formula *f = p->formula;
    sk_value out = *argument;
    for (int i = 0; i < (out.type == SK_VECTOR3 ? 3 : 1) && !p->text.failed; i++) {
        int which = 0;
        while (which < f->rests && f->rest[which] != argument->node[i]) which++;
        if (which == SKEIN_FORMULA_MOST_RESTS)
            return FAIL(p, begin, LIMIT, "too many rest values: %d numbers are the most", SKEIN_FORMULA_MOST_RESTS);
        if (which == f->rests) f->rest[f->rests++] = argument->node[i];
        out.node[i] = sk_parameter(p->graph, (uint32_t)(f->parameters + which));
    }
    out.of_dot = false;
    return out;
}

static sk_value call(parser *p, const sk_token *token) {
    const sk_function *function = sk_function_find(token->name);
    sk_value arguments[SK_MOST_ARGUMENTS];
    if (!function) {
        named(p, token); // an unknown name is said to be one
        return FAIL(p, token->begin, SYNTAX, "'%s' is no function; to multiply, write %s*(...)", token->name,
                    token->name);
    }
    bool rest = !strcmp(function->name, "rest");
    if (rest && p->in_rest) return FAIL(p, token->begin, SYNTAX, "rest(...) in rest(...): the outer one is enough");
    p->in_rest |= rest;
    sk_text_next(&p->text); // the bracket
    int count = 0, wanted = (int)strlen(function->arguments);
    bool more = p->text.now.kind != ')';
    while (more && !p->text.failed) {
        size_t begin = p->text.now.begin;
        sk_value value = either(p);
        if (count < wanted) {
            arguments[count] = value;
            fits(p, function, arguments, count, begin);
        }
        count++;
        more = sk_text_take(&p->text, ',');
    }
    if (rest) p->in_rest = false;
    if (!p->text.failed && p->text.now.kind != ')') sk_text_expected(&p->text, "',' or ')'");
    sk_text_take(&p->text, ')');
    if (!p->text.failed && count != wanted)
        return FAIL(p, token->begin, VALUE, "%s takes %d argument%s, not %d", function->usage, wanted,
                    wanted == 1 ? "" : "s", count);
    if (p->text.failed) return nothing;
    if (rest) return rest_of(p, &arguments[0], token->begin);
    warn_of_acos(p, function, &arguments[0], token->begin);
    p->graph->name = function->name;
    sk_value out = function->apply(p->graph, arguments);
    p->graph->name = "";
    return out;
}

/* ---- the grammar ---- */

/* One bracket or sign deeper: what recurs, counts. */
static bool enter(parser *p) {
    if (++p->depth <= SKEIN_FORMULA_MOST_DEPTH) return true;
    return sk_text_fail(&p->text, p->text.now.begin, p->text.now.end, SKEIN_ERROR_LIMIT,
                        "nested too deep: %d brackets or signs in each other are the most; name parts with let",
                        SKEIN_FORMULA_MOST_DEPTH);
}

static sk_value primary(parser *p) {
    sk_token token = p->text.now;
    sk_value out = nothing;
    if (!enter(p)) return nothing;
    if (sk_text_take(&p->text, SK_TOKEN_NUMBER)) {
        out = sk_number(sk_constant(p->graph, token.number));
    } else if (sk_text_take(&p->text, SK_TOKEN_NAME)) {
        out = p->text.now.kind == '(' ? call(p, &token) : named(p, &token);
    } else if (sk_text_take(&p->text, '(')) {
        out = either(p);
        if (!p->text.failed && p->text.now.kind != ')') {
            skein_formula_mark open = sk_text_mark(&p->text, token.begin, token.end);
            char what[64];
            snprintf(what, sizeof what, "')' for the bracket at line %zu, column %zu", open.line, open.column);
            sk_text_expected(&p->text, what);
        }
        sk_text_take(&p->text, ')');
    } else if (!p->text.failed) {
        sk_text_expected(&p->text, "a number, a name or '('");
    }
    p->depth--;
    return out;
}

static sk_value swizzled(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value value = primary(p);
    while (!p->text.failed && sk_text_take(&p->text, '.')) {
        sk_token letters = p->text.now;
        size_t count = letters.kind == SK_TOKEN_NAME ? strlen(letters.name) : 0;
        if (!count) sk_text_expected(&p->text, "x, y or z after '.'");
        if (!need(p, begin, &value, SK_VECTOR3, "'.'")) return nothing;
        sk_text_next(&p->text);
        if (strspn(letters.name, "xyz") != count || (count != 1 && count != 3))
            return FAIL(p, letters.begin, NAME, "'.%s': one or three of the letters x, y and z stand after '.'",
                        letters.name);
        sk_value out = {.type = count == 3 ? SK_VECTOR3 : SK_NUMBER};
        for (size_t i = 0; i < count; i++) out.node[i] = value.node[letters.name[i] - 'x'];
        value = out;
    }
    return value;
}

static sk_value power(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value base = swizzled(p);
    if (p->text.failed || !sk_text_take(&p->text, '^')) return base;
    if (!need(p, begin, &base, SK_NUMBER, "'^'")) return nothing;
    size_t exponent_begin = p->text.now.begin;
    if (!enter(p)) return nothing;
    sk_value exponent = sign(p);
    p->depth--;
    if (!need(p, exponent_begin, &exponent, SK_NUMBER, "'^'")) return nothing;
    return sk_number(sk_power(p->graph, base.node[0], exponent.node[0]));
}

static sk_value sign(parser *p) {
    int kind = p->text.now.kind;
    if (kind != '-' && kind != '+' && kind != '!') return power(p);
    if (!enter(p)) return nothing;
    sk_text_next(&p->text);
    size_t begin = p->text.now.begin;
    sk_value value = sign(p);
    p->depth--;
    if (kind == '!') {
        if (!need(p, begin, &value, SK_TRUTH, "'!'")) return nothing;
        sk_node no = sk_minus(p->graph, sk_constant(p->graph, 1), value.node[0]);
        return (sk_value){.type = SK_TRUTH, .node = {no}};
    }
    if (value.type == SK_TRUTH) return need(p, begin, &value, SK_NUMBER, kind == '-' ? "'-'" : "'+'"), nothing;
    for (int i = 0; kind == '-' && i < (value.type == SK_VECTOR3 ? 3 : 1); i++)
        value.node[i] = sk_negative_of(p->graph, value.node[i]);
    value.of_dot &= kind == '+';
    return value;
}

static sk_value multiply(parser *p, size_t begin, sk_value a, sk_value b) {
    if (a.type == SK_VECTOR3 && b.type == SK_VECTOR3)
        return FAIL(p, begin, VALUE, "two vectors have two products: dot(u, v) and cross(u, v)");
    if (a.type == SK_NUMBER && b.type == SK_VECTOR3) return multiply(p, begin, b, a);
    sk_value out = {.type = a.type};
    for (int i = 0; i < (a.type == SK_VECTOR3 ? 3 : 1); i++) out.node[i] = sk_times(p->graph, a.node[i], b.node[0]);
    return out;
}

static sk_value divide(parser *p, size_t begin, size_t divisor_begin, sk_value a, sk_value b) {
    double value;
    (void)begin;
    if (!need(p, divisor_begin, &b, SK_NUMBER, "'/', on its right,")) return nothing;
    if (sk_is_constant(p->graph, b.node[0], &value) && value == 0)
        return FAIL(p, divisor_begin, VALUE, "division by zero");
    sk_value out = {.type = a.type};
    for (int i = 0; i < (a.type == SK_VECTOR3 ? 3 : 1); i++) out.node[i] = sk_over(p->graph, a.node[i], b.node[0]);
    return out;
}

static sk_value product(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = sign(p);
    while (!p->text.failed && (p->text.now.kind == '*' || p->text.now.kind == '/')) {
        int kind = p->text.now.kind;
        sk_text_next(&p->text);
        size_t right_begin = p->text.now.begin;
        sk_value right = sign(p);
        if (left.type == SK_TRUTH) need(p, begin, &left, SK_NUMBER, kind == '*' ? "'*'" : "'/'");
        if (right.type == SK_TRUTH) need(p, right_begin, &right, SK_NUMBER, kind == '*' ? "'*'" : "'/'");
        if (p->text.failed) return nothing;
        left = kind == '*' ? multiply(p, begin, left, right) : divide(p, begin, right_begin, left, right);
    }
    return left;
}

static sk_value sum(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = product(p);
    while (!p->text.failed && (p->text.now.kind == '+' || p->text.now.kind == '-')) {
        int kind = p->text.now.kind;
        sk_text_next(&p->text);
        size_t right_begin = p->text.now.begin;
        sk_value right = product(p), out = {.type = left.type};
        if (left.type == SK_TRUTH) need(p, begin, &left, SK_NUMBER, kind == '+' ? "'+'" : "'-'");
        if (right.type == SK_TRUTH) need(p, right_begin, &right, SK_NUMBER, kind == '+' ? "'+'" : "'-'");
        if (!p->text.failed && left.type != right.type)
            return FAIL(p, begin, VALUE, "'%c' takes two numbers or two vectors, and these are %s and %s", kind,
                        sk_type_text(left.type), sk_type_text(right.type));
        for (int i = 0; !p->text.failed && i < (left.type == SK_VECTOR3 ? 3 : 1); i++)
            out.node[i] = (kind == '+' ? sk_plus : sk_minus)(p->graph, left.node[i], right.node[i]);
        left = out;
    }
    return left;
}

static bool is_comparison(int kind) {
    return kind == '<' || kind == '>' || (kind >= SK_TOKEN_LE && kind <= SK_TOKEN_NE);
}

static sk_value comparison(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = sum(p);
    int kind = p->text.now.kind;
    if (kind == '=' && !p->text.failed)
        sk_text_fail(&p->text, p->text.now.begin, p->text.now.end, SKEIN_ERROR_SYNTAX,
                     "'=' gives a name to something behind let; to compare, write '=='");
    if (p->text.failed || !is_comparison(kind)) return left;
    sk_text_next(&p->text);
    size_t right_begin = p->text.now.begin;
    sk_value right = sum(p);
    if (!need(p, begin, &left, SK_NUMBER, "a comparison") || !need(p, right_begin, &right, SK_NUMBER, "a comparison"))
        return nothing;
    if (is_comparison(p->text.now.kind)) {
        sk_text_fail(&p->text, p->text.now.begin, p->text.now.end, SKEIN_ERROR_SYNTAX,
                     "comparisons do not chain: write a < b && b < c");
        return nothing;
    }
    bool swapped = kind == '>' || kind == SK_TOKEN_GE;
    sk_comparison meaning = kind == '<' || kind == '>'                   ? SK_LESS
                            : kind == SK_TOKEN_LE || kind == SK_TOKEN_GE ? SK_AT_MOST
                            : kind == SK_TOKEN_EQ                        ? SK_EQUAL
                                                                         : SK_UNEQUAL;
    sk_node a = left.node[0], b = right.node[0];
    sk_value out = sk_compare(p->graph, meaning, swapped ? b : a, swapped ? a : b);
    out.swapped = swapped;
    return out;
}

/* Truths are 1 and 0: both is their product, either is their larger one. */
static sk_value both(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = comparison(p);
    while (!p->text.failed && sk_text_take(&p->text, SK_TOKEN_AND)) {
        size_t right_begin = p->text.now.begin;
        sk_value right = comparison(p);
        if (!need(p, begin, &left, SK_TRUTH, "'&&'") || !need(p, right_begin, &right, SK_TRUTH, "'&&'")) return nothing;
        sk_node node = sk_times(p->graph, left.node[0], right.node[0]);
        left = (sk_value){.type = SK_TRUTH, .node = {node}};
    }
    return left;
}

static sk_value either(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = both(p);
    while (!p->text.failed && sk_text_take(&p->text, SK_TOKEN_OR)) {
        size_t right_begin = p->text.now.begin;
        sk_value right = both(p);
        if (!need(p, begin, &left, SK_TRUTH, "'||'") || !need(p, right_begin, &right, SK_TRUTH, "'||'")) return nothing;
        sk_node a = left.node[0], b = right.node[0], node = sk_less(p->graph, a, b, b, a);
        left = (sk_value){.type = SK_TRUTH, .node = {node}};
    }
    return left;
}

/* ---- lines ---- */

static bool is_taken(const char *name) {
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!strcmp(name, words[i])) return true;
    return particle_number(name) >= 0 || sk_function_find(name);
}

static void read_let(parser *p) {
    skein_formula *f = p->formula;
    sk_token name = p->text.now;
    if (!sk_text_take(&p->text, SK_TOKEN_NAME)) {
        sk_text_expected(&p->text, "a name after let");
        return;
    }
    if (is_taken(name.name)) FAIL(p, name.begin, NAME, "'%s' has a meaning already: choose another name", name.name);
    else if (find_let(p, name.name))
        FAIL(p, name.begin, NAME, "'%s' was defined before: names do not change", name.name);
    else if (find_parameter(p, name.name) >= 0) FAIL(p, name.begin, NAME, "'%s' is a parameter", name.name);
    else if (f->lets == SK_FORMULA_MOST_LETS)
        FAIL(p, name.begin, LIMIT, "too many names: %d lines of let are the most", SK_FORMULA_MOST_LETS);
    if (p->text.failed) return;
    if (p->text.now.kind != '=') {
        sk_text_expected(&p->text, "'='");
        return;
    }
    sk_text_next(&p->text);
    p->defining = name.name;
    let defined = {.value = either(p)};
    p->defining = NULL;
    if (!p->text.failed && p->text.now.kind != ';') sk_text_expected(&p->text, "';' at the end of the let");
    sk_text_take(&p->text, ';');
    if (p->text.failed) return;
    memcpy(f->let_name[f->lets], name.name, SK_NAME_SIZE);
    defined.name = f->let_name[f->lets];
    for (int i = 0; i < (defined.value.type == SK_VECTOR3 ? 3 : 1); i++)
        if (defined.value.node[i] < p->graph->count && p->graph->data[defined.value.node[i]].op > SK_OP_PARAMETER)
            p->graph->data[defined.value.node[i]].name = defined.name;
    p->lets[f->lets++] = defined;
}

/* `a >= b` and `a <= b` stand for a difference that is at least 0, `a == b` for one that is 0. */
static sk_value difference(parser *p, sk_value value, size_t begin) {
    if (!p->desc->comparison)
        return FAIL(p, begin, VALUE, "the result is a comparison; expected %s",
                    p->desc->result == SKEIN_FORMULA_VECTOR ? "a vector" : "a number");
    sk_node first = value.side[value.swapped], second = value.side[!value.swapped];
    switch (value.comparison) {
    case SK_AT_MOST:
        p->formula->at_least_zero = true;
        return sk_number(sk_minus(p->graph, value.side[1], value.side[0]));
    case SK_EQUAL: return sk_number(sk_minus(p->graph, first, second));
    case SK_LESS: return FAIL(p, begin, VALUE, "a constraint holds with its bound: write <= or >= instead of < or >");
    default: return FAIL(p, begin, VALUE, "a constraint is one comparison, with >=, <= or ==");
    }
}

static void read_result(parser *p) {
    size_t begin = p->text.now.begin;
    if (p->text.now.kind == SK_TOKEN_END && !p->text.failed)
        sk_text_fail(&p->text, begin, begin, SKEIN_ERROR_SYNTAX,
                     p->formula->lets ? "the result is missing behind the last let" : "the formula is empty");
    sk_value value = either(p);
    if (!p->text.failed && value.type == SK_TRUTH) value = difference(p, value, begin);
    size_t end = p->text.before.end;
    sk_text_take(&p->text, ';');
    if (!p->text.failed && p->text.now.kind != SK_TOKEN_END) sk_text_expected(&p->text, "an operator or the end");
    if (p->text.failed) return;
    if (p->desc->result == SKEIN_FORMULA_NUMBER && value.type != SK_NUMBER)
        sk_text_fail(&p->text, begin, end, SKEIN_ERROR_VALUE,
                     "the result is a vector; expected a number, such as its length(v) or a component v.x");
    if (p->desc->result == SKEIN_FORMULA_VECTOR && value.type != SK_VECTOR3)
        sk_text_fail(&p->text, begin, end, SKEIN_ERROR_VALUE,
                     "the result is a number; expected a vector: vec3(x, y, z)");
    p->formula->size = value.type == SK_VECTOR3 ? 3 : 1;
    memcpy(p->formula->value, value.node, sizeof value.node);
}

/* The names that the caller gives. */
static skein_status read_parameters(parser *p, skein_error *error) {
    skein_formula *f = p->formula;
    for (const char *const *name = p->desc->parameters; name && *name; name++) {
        if (f->parameters == SKEIN_FORMULA_MOST_PARAMETERS)
            return sk_fail(error, SKEIN_ERROR_LIMIT, "", "too many parameters: %d are the most",
                           SKEIN_FORMULA_MOST_PARAMETERS);
        if (!sk_is_name(*name))
            return sk_fail(error, SKEIN_ERROR_NAME, "",
                           "'%.40s' cannot be a parameter's name: that is up to %d letters, digits and _, and no digit "
                           "first",
                           *name, SK_NAME_SIZE - 1);
        if (is_taken(*name))
            return sk_fail(error, SKEIN_ERROR_NAME, "", "'%s' cannot be a parameter: it has a meaning already", *name);
        if (find_parameter(p, *name) >= 0)
            return sk_fail(error, SKEIN_ERROR_NAME, "", "the parameter '%s' is given twice", *name);
        strcpy(f->parameter_name[f->parameters++], *name);
    }
    return SKEIN_OK;
}

static skein_status read_all(parser *p, skein_formula_mark *mark, skein_error *error) {
    skein_formula *f = p->formula;
    if (mark) *mark = (skein_formula_mark){1, 1, 1};
    skein_status status = read_parameters(p, error);
    if (status) return status;
    skein_error ignored;
    sk_text_init(&p->text, f->text, mark, error ? error : &ignored);
    while (!p->text.failed && p->text.now.kind == SK_TOKEN_NAME && !strcmp(p->text.now.name, "let")) {
        sk_text_next(&p->text);
        read_let(p);
    }
    if (!p->text.failed) read_result(p);
    if (p->graph->no_memory) return sk_fail_memory(error, "a formula");
    if (p->text.failed) return p->text.error->status;
    if (p->graph->too_large)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "the formula is too large: more than %d operations",
                       SK_GRAPH_MOST_NODES);
    if (f->particles < p->desc->particles) f->particles = p->desc->particles;
    return SKEIN_OK;
}

skein_status sk_formula_parse(skein_formula *formula, const skein_formula_desc *desc, skein_formula_mark *mark,
                              skein_error *error) {
    parser *p = sk_allocate(formula->allocator, sizeof *p);
    formula->let_name = sk_allocate(formula->allocator, SK_FORMULA_MOST_LETS * sizeof *formula->let_name);
    if (!p || !formula->let_name) {
        sk_release(formula->allocator, p);
        return sk_fail_memory(error, "a formula");
    }
    p->graph = &formula->graph, p->formula = formula, p->desc = desc;
    skein_status status = read_all(p, mark, error);
    sk_release(formula->allocator, p);
    return status;
}
