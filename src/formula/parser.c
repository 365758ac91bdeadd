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
#include "formula/parser.h"

static sk_value sign(parser *p);

/* ---- the grammar ---- */

/* Counts one more level of brackets or signs, which limits the recursion. */
static bool enter(parser *p) {
    if (++p->depth <= SKEIN_FORMULA_MOST_DEPTH) return true;
    return sk_text_fail(&p->text, p->text.now.begin, p->text.now.end, SKEIN_ERROR_LIMIT,
                        "nested too deep: %d brackets or signs in each other are the most; name parts with let",
                        SKEIN_FORMULA_MOST_DEPTH);
}

static sk_value primary(parser *p) {
    sk_token token = p->text.now;
    sk_value out = sk_nothing;
    if (!enter(p)) return sk_nothing;
    if (sk_text_take(&p->text, SK_TOKEN_NUMBER)) {
        out = sk_number(sk_constant(p->graph, token.number));
    } else if (sk_text_take(&p->text, SK_TOKEN_NAME)) {
        out = p->text.now.kind == '(' ? sk_parser_call(p, &token) : sk_parser_named(p, &token);
    } else if (sk_text_take(&p->text, '(')) {
        out = sk_parser_either(p);
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
        if (!sk_parser_need(p, begin, &value, SK_VECTOR3, "'.'")) return sk_nothing;
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
    if (!sk_parser_need(p, begin, &base, SK_NUMBER, "'^'")) return sk_nothing;
    size_t exponent_begin = p->text.now.begin;
    if (!enter(p)) return sk_nothing;
    sk_value exponent = sign(p);
    p->depth--;
    if (!sk_parser_need(p, exponent_begin, &exponent, SK_NUMBER, "'^'")) return sk_nothing;
    return sk_number(sk_power(p->graph, base.node[0], exponent.node[0]));
}

static sk_value sign(parser *p) {
    int kind = p->text.now.kind;
    if (kind != '-' && kind != '+' && kind != '!') return power(p);
    if (!enter(p)) return sk_nothing;
    sk_text_next(&p->text);
    size_t begin = p->text.now.begin;
    sk_value value = sign(p);
    p->depth--;
    if (kind == '!') {
        if (!sk_parser_need(p, begin, &value, SK_TRUTH, "'!'")) return sk_nothing;
        sk_node no = sk_minus(p->graph, sk_constant(p->graph, 1), value.node[0]);
        return (sk_value){.type = SK_TRUTH, .node = {no}};
    }
    if (value.type == SK_TRUTH)
        return sk_parser_need(p, begin, &value, SK_NUMBER, kind == '-' ? "'-'" : "'+'"), sk_nothing;
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
    if (!sk_parser_need(p, divisor_begin, &b, SK_NUMBER, "'/', on its right,")) return sk_nothing;
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
        if (left.type == SK_TRUTH) sk_parser_need(p, begin, &left, SK_NUMBER, kind == '*' ? "'*'" : "'/'");
        if (right.type == SK_TRUTH) sk_parser_need(p, right_begin, &right, SK_NUMBER, kind == '*' ? "'*'" : "'/'");
        if (p->text.failed) return sk_nothing;
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
        if (left.type == SK_TRUTH) sk_parser_need(p, begin, &left, SK_NUMBER, kind == '+' ? "'+'" : "'-'");
        if (right.type == SK_TRUTH) sk_parser_need(p, right_begin, &right, SK_NUMBER, kind == '+' ? "'+'" : "'-'");
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
    if (!sk_parser_need(p, begin, &left, SK_NUMBER, "a comparison") ||
        !sk_parser_need(p, right_begin, &right, SK_NUMBER, "a comparison"))
        return sk_nothing;
    if (is_comparison(p->text.now.kind)) {
        sk_text_fail(&p->text, p->text.now.begin, p->text.now.end, SKEIN_ERROR_SYNTAX,
                     "comparisons do not chain: write a < b && b < c");
        return sk_nothing;
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

/* Truth values are 1 and 0: "and" is their product, "or" the larger one. */
static sk_value both(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = comparison(p);
    while (!p->text.failed && sk_text_take(&p->text, SK_TOKEN_AND)) {
        size_t right_begin = p->text.now.begin;
        sk_value right = comparison(p);
        if (!sk_parser_need(p, begin, &left, SK_TRUTH, "'&&'") ||
            !sk_parser_need(p, right_begin, &right, SK_TRUTH, "'&&'"))
            return sk_nothing;
        sk_node node = sk_times(p->graph, left.node[0], right.node[0]);
        left = (sk_value){.type = SK_TRUTH, .node = {node}};
    }
    return left;
}

sk_value sk_parser_either(parser *p) {
    size_t begin = p->text.now.begin;
    sk_value left = both(p);
    while (!p->text.failed && sk_text_take(&p->text, SK_TOKEN_OR)) {
        size_t right_begin = p->text.now.begin;
        sk_value right = both(p);
        if (!sk_parser_need(p, begin, &left, SK_TRUTH, "'||'") ||
            !sk_parser_need(p, right_begin, &right, SK_TRUTH, "'||'"))
            return sk_nothing;
        sk_node a = left.node[0], b = right.node[0], node = sk_less(p->graph, a, b, b, a);
        left = (sk_value){.type = SK_TRUTH, .node = {node}};
    }
    return left;
}

/* ---- lines ---- */

static void read_let(parser *p) {
    skein_formula *f = p->formula;
    sk_token name = p->text.now;
    if (!sk_text_take(&p->text, SK_TOKEN_NAME)) {
        sk_text_expected(&p->text, "a name after let");
        return;
    }
    if (sk_parser_is_taken(name.name))
        FAIL(p, name.begin, NAME, "'%s' has a meaning already: choose another name", name.name);
    else if (sk_parser_let(p, name.name))
        FAIL(p, name.begin, NAME, "'%s' was defined before: names do not change", name.name);
    else if (sk_parser_parameter(p, name.name) >= 0) FAIL(p, name.begin, NAME, "'%s' is a parameter", name.name);
    else if (f->lets == SK_FORMULA_MOST_LETS)
        FAIL(p, name.begin, LIMIT, "too many names: %d lines of let are the most", SK_FORMULA_MOST_LETS);
    if (p->text.failed) return;
    if (p->text.now.kind != '=') {
        sk_text_expected(&p->text, "'='");
        return;
    }
    sk_text_next(&p->text);
    p->defining = name.name;
    let defined = {.value = sk_parser_either(p)};
    p->defining = NULL;
    if (!p->text.failed && p->text.now.kind != ';') sk_text_expected(&p->text, "';' at the end of the let");
    sk_text_take(&p->text, ';');
    if (p->text.failed) return;
    memcpy(f->let_name[f->lets], name.name, SK_NAME_SIZE);
    defined.name = f->let_name[f->lets];
    for (int i = 0; i < (defined.value.type == SK_VECTOR3 ? 3 : 1); i++)
        if (defined.value.node[i] < p->graph->count && p->graph->data[defined.value.node[i]].op > SK_NODE_PARAMETER)
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
    sk_value value = sk_parser_either(p);
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
        if (sk_parser_is_taken(*name))
            return sk_fail(error, SKEIN_ERROR_NAME, "", "'%s' cannot be a parameter: it has a meaning already", *name);
        if (sk_parser_parameter(p, *name) >= 0)
            return sk_fail(error, SKEIN_ERROR_NAME, "", "the parameter '%s' is given twice", *name);
        memcpy(f->parameter_name[f->parameters++], *name, strlen(*name) + 1);
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
