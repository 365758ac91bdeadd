/* What names stand for: particles, parameters, lets and functions. */
#include <stdio.h>
#include <string.h>

#include "base/status.h"
#include "formula/parser.h"

bool sk_parser_need(parser *p, size_t begin, const sk_value *value, sk_value_type type, const char *by) {
    if (p->text.failed || value->type == type) return !p->text.failed;
    const char *hint =
        value->type == SK_VECTOR3 && type == SK_NUMBER ? "; its length is length(v), a component v.x" : "";
    return sk_text_fail(&p->text, begin, p->text.before.end, SKEIN_ERROR_VALUE, "%s takes %s, and this is %s%s", by,
                        sk_type_text(type), sk_type_text(value->type), hint);
}

/* ---- names ---- */

static const char *const words[] = {"p", "v", "t", "pi", "let"};

let *sk_parser_let(parser *p, const char *name) {
    for (int i = 0; i < p->formula->lets; i++)
        if (!strcmp(p->lets[i].name, name)) return &p->lets[i];
    return NULL;
}

int sk_parser_parameter(const parser *p, const char *name) {
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

sk_value sk_parser_named(parser *p, const sk_token *token) {
    const char *name = token->name;
    const let *found = sk_parser_let(p, name);
    int parameter = sk_parser_parameter(p, name);
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
    if (strcmp(function->name, "acos") != 0 || !argument->of_dot || f->warnings == SK_FORMULA_MOST_WARNINGS) return;
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
    if (letter == 'n') return sk_parser_need(p, begin, value, SK_NUMBER, by);
    if (letter == 'v') return sk_parser_need(p, begin, value, SK_VECTOR3, by);
    if (letter == 'b') return sk_parser_need(p, begin, value, SK_TRUTH, by);
    if (at > 0 && function->arguments[at - 1] == 'a')
        return sk_parser_need(p, begin, value, arguments[at - 1].type, by);
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

sk_value sk_parser_call(parser *p, const sk_token *token) {
    const sk_function *function = sk_function_find(token->name);
    sk_value arguments[SK_MOST_ARGUMENTS] = {{0}};
    if (!function) {
        sk_parser_named(p, token); // an unknown name is said to be one
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
        sk_value value = sk_parser_either(p);
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
    if (p->text.failed) return sk_nothing;
    if (rest) return rest_of(p, &arguments[0], token->begin);
    warn_of_acos(p, function, &arguments[0], token->begin);
    p->graph->name = function->name;
    sk_value out = function->apply(p->graph, arguments);
    p->graph->name = "";
    return out;
}

bool sk_parser_is_taken(const char *name) {
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!strcmp(name, words[i])) return true;
    return particle_number(name) >= 0 || sk_function_find(name);
}
