/* Formulas as GLSL. */
#include <float.h>

#include "formula/emit.h"

static const struct {
    int op;
    const char *text;
} glsl_helpers[] = {
    {SK_NODE_RECIPROCAL,
     "float formula_reciprocal(float x) {\n    return abs(x) >= 1.17549435e-38 ? 1.0 / x : 0.0;\n}\n"},
    {SK_NODE_SQRT, "float formula_sqrt(float x) {\n    return x >= 0.0 ? sqrt(x) : 0.0;\n}\n"},
    {SK_NODE_LESS, "float formula_less(float a, float b, float yes, float no) {\n    return a < b ? yes : no;\n}\n"},
    {SK_NODE_EXP, "float formula_exp(float x) {\n    return exp(min(x, 88.0));\n}\n"},
    {SK_NODE_LOG, "float formula_log(float x) {\n    return log(max(x, 1.17549435e-38));\n}\n"},
    {SK_NODE_ASIN, "float formula_asin(float x) {\n    return asin(clamp(x, -1.0, 1.0));\n}\n"},
    {SK_NODE_ACOS, "float formula_acos(float x) {\n    return acos(clamp(x, -1.0, 1.0));\n}\n"},
    {SK_NODE_POW, "float formula_pow(float x, float y) {\n    return y == 0.0 ? 1.0 : x > 0.0 ? pow(x, y) : 0.0;\n}\n"},
};

static const char *glsl_text_of(size_t i) {
    return glsl_helpers[i].text;
}
static int glsl_op_of(size_t i) {
    return glsl_helpers[i].op;
}

static void glsl_open(sk_writer *w) {
    const skein_formula *f = w->formula;
    sk_put_source(w, "// ");
    sk_put(w, "//\n// Made by `skein formula --emit glsl`: the value, and its derivatives by the positions.\n");
    sk_put_parameters(w, "// ");
    sk_put_helpers(w, glsl_text_of, sizeof glsl_helpers / sizeof *glsl_helpers, glsl_op_of);
    sk_put(w, "%s formula(", f->size == 3 ? "vec3" : "float");
    for (int p = 0; p < f->particles; p++) sk_put(w, "vec3 p%d, ", p);
    for (int p = 0; p < f->particles && (f->uses & SK_USES_VELOCITY); p++) sk_put(w, "vec3 v%d, ", p);
    for (int i = 0; i < f->parameters + f->rests; i++) sk_put(w, "float q%d, ", i);
    sk_put(w, "float t");
    for (int p = 0; p < f->particles; p++) sk_put(w, ", out %s by_p%d", f->size == 3 ? "mat3" : "vec3", p);
    sk_put(w, ") {\n");
    if (f->size == 3) sk_put(w, "    vec3 value;\n");
}

static void glsl_constant(sk_writer *w, double value) {
    double most = FLT_MAX;
    sk_put(w, value < 0 ? "(" : "");
    sk_put_number(w, value > most ? most : value < -most ? -most : value, FLT_DECIMAL_DIG);
    sk_put(w, value < 0 ? ")" : "");
}

static void glsl_input(sk_writer *w, uint32_t input) {
    if (input == SK_INPUT_TIME) sk_put(w, "t");
    else sk_put(w, "%c%u.%c", input >= SK_INPUT_VELOCITY ? 'v' : 'p', input % SK_INPUT_VELOCITY / 3, "xyz"[input % 3]);
}

static void glsl_parameter(sk_writer *w, uint32_t parameter) {
    sk_put(w, "q%u", parameter);
}

static void glsl_result(sk_writer *w, int component) {
    if (w->formula->size == 3) sk_put(w, "    value.%c = ", "xyz"[component]);
    else sk_put(w, "    return ");
}

static void glsl_derivative(sk_writer *w, int component, int particle, int axis) {
    if (w->formula->size == 3) sk_put(w, "    by_p%d[%d][%d] = ", particle, axis, component);
    else sk_put(w, "    by_p%d.%c = ", particle, "xyz"[axis]);
}

static void glsl_close(sk_writer *w) {
    sk_put(w, w->formula->size == 3 ? "    return value;\n}\n" : "}\n");
}

/* The opening within a shader: helpers, which may be there already, and the caller's head. */
static void shader_open(sk_writer *w) {
    const sk_graph *g = &w->formula->graph;
    for (size_t h = 0; h < sizeof glsl_helpers / sizeof *glsl_helpers; h++) {
        size_t i = 0;
        while (i < g->count && !(w->live[i] && g->data[i].op == glsl_helpers[h].op)) i++;
        if (i == g->count) continue;
        sk_put(w, "#ifndef FORMULA_%zu\n#define FORMULA_%zu\n", h, h);
        w->write(w->user, glsl_helpers[h].text);
        sk_put(w, "#endif\n");
    }
    w->write(w->user, w->head);
}

static void shader_parameter(sk_writer *w, uint32_t parameter) {
    sk_put(w, "parameter@(%u)", parameter);
}

/* How operations that are functions are written. */
#define GLSL_CALLS                                                                                            \
    {                                                                                                         \
        [SK_NODE_RECIPROCAL] = "formula_reciprocal", [SK_NODE_SQRT] = "formula_sqrt", [SK_NODE_ABS] = "abs",  \
        [SK_NODE_LESS] = "formula_less", [SK_NODE_EXP] = "formula_exp", [SK_NODE_LOG] = "formula_log",        \
        [SK_NODE_SIN] = "sin", [SK_NODE_COS] = "cos", [SK_NODE_TAN] = "tan", [SK_NODE_ASIN] = "formula_asin", \
        [SK_NODE_ACOS] = "formula_acos", [SK_NODE_ATAN2] = "atan", [SK_NODE_POW] = "formula_pow"              \
    }

const sk_language sk_glsl_language = {.call = GLSL_CALLS,
                                      .declaration = "float",
                                      .constant = glsl_constant,
                                      .input = glsl_input,
                                      .parameter = glsl_parameter,
                                      .open = glsl_open,
                                      .result = glsl_result,
                                      .derivative = glsl_derivative,
                                      .end_result = ";\n",
                                      .close = glsl_close};

/* Only what sk_formula_put_glsl() needs. */
const sk_language sk_shader_language = {.call = GLSL_CALLS,
                                        .declaration = "float",
                                        .constant = glsl_constant,
                                        .input = glsl_input,
                                        .parameter = shader_parameter,
                                        .open = shader_open,
                                        .end_result = ";\n"};
