/* The functions of the formula language, each made of nodes: vectors by components, truths by 0 and 1. */
#include "formula/value.h"

#include <string.h>

#include <skein/formula.h>

const char *sk_type_text(sk_value_type type) {
    static const char *const texts[] = {"a number", "a vector", "a comparison"};
    return texts[type];
}

sk_value sk_number(sk_node node) {
    return (sk_value){.type = SK_NUMBER, .node = {node}};
}

sk_value sk_vector3(sk_node x, sk_node y, sk_node z) {
    return (sk_value){.type = SK_VECTOR3, .node = {x, y, z}};
}

sk_value sk_compare(sk_graph *g, sk_comparison comparison, sk_node a, sk_node b) {
    sk_node one = sk_constant(g, 1), zero = sk_constant(g, 0), node;
    switch (comparison) {
    case SK_LESS: node = sk_less(g, a, b, one, zero); break;
    case SK_AT_MOST: node = sk_less(g, b, a, zero, one); break;
    case SK_EQUAL: node = sk_less(g, a, b, zero, sk_less(g, b, a, zero, one)); break;
    default: node = sk_less(g, a, b, one, sk_less(g, b, a, one, zero)); break;
    }
    return (sk_value){.type = SK_TRUTH, .node = {node}, .comparison = comparison, .side = {a, b}};
}

/* ---- vectors ---- */

static sk_node dot_of(sk_graph *g, const sk_value *u, const sk_value *v) {
    sk_node x = sk_times(g, u->node[0], v->node[0]), y = sk_times(g, u->node[1], v->node[1]);
    sk_node z = sk_times(g, u->node[2], v->node[2]), sum = sk_plus(g, x, y);
    return sk_plus(g, sum, z);
}

static sk_value cross_of(sk_graph *g, const sk_value *u, const sk_value *v) {
    sk_value out = {.type = SK_VECTOR3};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sk_node plus = sk_times(g, u->node[j], v->node[k]), minus = sk_times(g, u->node[k], v->node[j]);
        out.node[i] = sk_minus(g, plus, minus);
    }
    return out;
}

static sk_value minus_of(sk_graph *g, const sk_value *u, const sk_value *v) {
    sk_value out = {.type = SK_VECTOR3};
    for (int i = 0; i < 3; i++) out.node[i] = sk_minus(g, u->node[i], v->node[i]);
    return out;
}

static sk_node length_of(sk_graph *g, const sk_value *v) {
    return sk_of(g, SK_NODE_SQRT, dot_of(g, v, v));
}

static sk_value apply_dot(sk_graph *g, const sk_value *a) {
    sk_value out = sk_number(dot_of(g, &a[0], &a[1]));
    out.of_dot = true;
    return out;
}

static sk_value apply_cross(sk_graph *g, const sk_value *a) {
    return cross_of(g, &a[0], &a[1]);
}

static sk_value apply_length(sk_graph *g, const sk_value *a) {
    return sk_number(length_of(g, &a[0]));
}

static sk_value apply_normalize(sk_graph *g, const sk_value *a) {
    sk_node over = sk_of(g, SK_NODE_RECIPROCAL, length_of(g, &a[0]));
    sk_value out = {.type = SK_VECTOR3};
    for (int i = 0; i < 3; i++) out.node[i] = sk_times(g, a->node[i], over);
    return out;
}

static sk_value apply_distance(sk_graph *g, const sk_value *a) {
    sk_value between = minus_of(g, &a[0], &a[1]);
    return sk_number(length_of(g, &between));
}

static sk_value apply_vec3(sk_graph *g, const sk_value *a) {
    (void)g;
    return sk_vector3(a[0].node[0], a[1].node[0], a[2].node[0]);
}

/* ---- angles ---- */

/* By atan2: acos loses half the digits where the vectors are nearly parallel. */
static sk_value apply_angle(sk_graph *g, const sk_value *a) {
    sk_value across = cross_of(g, &a[0], &a[1]);
    sk_node sine = length_of(g, &across), cosine = dot_of(g, &a[0], &a[1]);
    return sk_number(sk_arctangent(g, sine, cosine));
}

/* Between the triangles (p0 p1 p2) and (p1 p0 p3): with e = p1 - p0, a = p2 - p0, b = p3 - p0 their normals are
 * e x a and b x e, whose cross product is -e (e x a . b): atan2 of its length along -e, and of their dot product. */
static sk_value apply_dihedral(sk_graph *g, const sk_value *p) {
    sk_value e = minus_of(g, &p[1], &p[0]), a = minus_of(g, &p[2], &p[0]), b = minus_of(g, &p[3], &p[0]);
    sk_value left = cross_of(g, &e, &a), right = cross_of(g, &b, &e);
    sk_node along = length_of(g, &e), volume = dot_of(g, &left, &b), sine = sk_times(g, along, volume);
    sk_node cosine = dot_of(g, &left, &right);
    return sk_number(sk_arctangent(g, sine, cosine));
}

/* ---- numbers ---- */

#define UNARY(name_, op_)                                           \
    static sk_value apply_##name_(sk_graph *g, const sk_value *a) { \
        return sk_number(sk_of(g, op_, a->node[0]));                \
    }
UNARY(sqrt, SK_NODE_SQRT)
UNARY(exp, SK_NODE_EXP)
UNARY(log, SK_NODE_LOG)
UNARY(sin, SK_NODE_SIN)
UNARY(cos, SK_NODE_COS)
UNARY(tan, SK_NODE_TAN)
UNARY(asin, SK_NODE_ASIN)
UNARY(acos, SK_NODE_ACOS)
UNARY(abs, SK_NODE_ABS)
#undef UNARY

static sk_value apply_atan2(sk_graph *g, const sk_value *a) {
    return sk_number(sk_arctangent(g, a[0].node[0], a[1].node[0]));
}

static sk_value apply_pow(sk_graph *g, const sk_value *a) {
    return sk_number(sk_power(g, a[0].node[0], a[1].node[0]));
}

static sk_node least(sk_graph *g, sk_node a, sk_node b) {
    return sk_less(g, a, b, a, b);
}

static sk_node most(sk_graph *g, sk_node a, sk_node b) {
    return sk_less(g, a, b, b, a);
}

static sk_value apply_min(sk_graph *g, const sk_value *a) {
    sk_value out = sk_number(least(g, a[0].node[0], a[1].node[0]));
    out.of_dot = a[0].of_dot || a[1].of_dot;
    return out;
}

static sk_value apply_max(sk_graph *g, const sk_value *a) {
    sk_value out = sk_number(most(g, a[0].node[0], a[1].node[0]));
    out.of_dot = a[0].of_dot || a[1].of_dot;
    return out;
}

static sk_value apply_clamp(sk_graph *g, const sk_value *a) {
    sk_value out = sk_number(least(g, most(g, a[0].node[0], a[1].node[0]), a[2].node[0]));
    out.of_dot = a[0].of_dot;
    return out;
}

/* s^2 (3 - 2 s) with s = (x - from)/(to - from), from 0 to 1. */
static sk_value apply_smoothstep(sk_graph *g, const sk_value *a) {
    sk_node from = a[0].node[0], to = a[1].node[0], x = a[2].node[0];
    sk_node gone = sk_minus(g, x, from), all = sk_minus(g, to, from), share = sk_over(g, gone, all);
    sk_node zero = sk_constant(g, 0), one = sk_constant(g, 1), two = sk_constant(g, 2), three = sk_constant(g, 3);
    sk_node s = least(g, most(g, share, zero), one), rest = sk_minus(g, three, sk_times(g, two, s));
    return sk_number(sk_times(g, sk_times(g, s, s), rest));
}

/* A comparison's own two sides are compared again, so that no truth is made to be looked at. */
static sk_node choose(sk_graph *g, const sk_value *truth, sk_node yes, sk_node no) {
    if (truth->comparison == SK_LESS) return sk_less(g, truth->side[0], truth->side[1], yes, no);
    if (truth->comparison == SK_AT_MOST) return sk_less(g, truth->side[1], truth->side[0], no, yes);
    return sk_less(g, sk_constant(g, 0), truth->node[0], yes, no);
}

static sk_value apply_select(sk_graph *g, const sk_value *a) {
    sk_value out = {.type = a[1].type};
    for (int i = 0; i < (out.type == SK_VECTOR3 ? 3 : 1); i++)
        out.node[i] = choose(g, &a[0], a[1].node[i], a[2].node[i]);
    return out;
}

const sk_function sk_functions[] = {
    {"dot", "vv", apply_dot, "dot(u, v)", "the dot product of two vectors"},
    {"cross", "vv", apply_cross, "cross(u, v)", "the cross product of two vectors"},
    {"length", "v", apply_length, "length(v)", "the length of a vector"},
    {"normalize", "v", apply_normalize, "normalize(v)", "the vector at length 1; 0 where it has no length"},
    {"distance", "vv", apply_distance, "distance(p, q)", "length(p - q)"},
    {"vec3", "nnn", apply_vec3, "vec3(x, y, z)", "a vector from three numbers"},
    {"angle", "vv", apply_angle, "angle(u, v)", "between two vectors, 0 to pi; exact where acos(dot(..)) is not"},
    {"dihedral", "vvvv", apply_dihedral, "dihedral(p0, p1, p2, p3)",
     "between triangles p0 p1 p2 and p1 p0 p3: 0 when flat; > 0 where p3 lies on the side of cross(p1-p0, p2-p0)"},
    {"sqrt", "n", apply_sqrt, "sqrt(x)", "the square root; 0 under 0"},
    {"exp", "n", apply_exp, "exp(x)", "e to the x"},
    {"log", "n", apply_log, "log(x)", "the natural logarithm"},
    {"pow", "nn", apply_pow, "pow(x, y)", "x^y; a negative x needs a constant, whole y"},
    {"sin", "n", apply_sin, "sin(x)", "of an angle in radians"},
    {"cos", "n", apply_cos, "cos(x)", "the same"},
    {"tan", "n", apply_tan, "tan(x)", "the same"},
    {"asin", "n", apply_asin, "asin(x)", "-pi/2 to pi/2; x is taken into -1 to 1"},
    {"acos", "n", apply_acos, "acos(x)", "0 to pi; x is taken into -1 to 1"},
    {"atan2", "nn", apply_atan2, "atan2(y, x)", "the angle of the point (x, y), -pi to pi"},
    {"abs", "n", apply_abs, "abs(x)", "x without its sign"},
    {"min", "nn", apply_min, "min(x, y)", "the smaller one"},
    {"max", "nn", apply_max, "max(x, y)", "the larger one"},
    {"clamp", "nnn", apply_clamp, "clamp(x, low, high)", "x, taken into low to high"},
    {"smoothstep", "nnn", apply_smoothstep, "smoothstep(from, to, x)", "0 up to `from`, 1 from `to` on, smooth between"},
    {"select", "baa", apply_select, "select(x < y, yes, no)", "one of two numbers or vectors"},
    {"rest", "a", NULL, "rest(...)", "what an expression is at the rest pose: a number or vector for each element"},
};
const size_t sk_function_count = sizeof sk_functions / sizeof *sk_functions;

const sk_function *sk_function_find(const char *name) {
    for (size_t i = 0; i < sk_function_count; i++)
        if (!strcmp(name, sk_functions[i].name)) return &sk_functions[i];
    return NULL;
}

bool skein_formula_function(size_t index, const char **usage, const char **help) {
    if (index >= sk_function_count) return false;
    if (usage) *usage = sk_functions[index].usage;
    if (help) *help = sk_functions[index].help;
    return true;
}
