/* A formula as text: C, GLSL, or the list of its operations, by one walk over the graph; a language is a table of
 * spellings. The order of operations is the graph's, so C that is built without contraction gives the bits of
 * sk_evaluate_double or _float, if its elementary functions do. Expressions are written in place where they are read
 * once and are short; all others get names, from the functions and the lets that they come from. */
#include <float.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/status.h"
#include "formula/formula.h"

enum { NAMED = 0, MOST_HEIGHT = 3 };

typedef struct writer writer;

typedef struct language {
    const char *call[SK_OP_COUNT]; /* operations that are written as functions */
    const char *declaration;       /* of a temporary */
    void (*constant)(writer *, double);
    void (*input)(writer *, uint32_t);
    void (*parameter)(writer *, uint32_t);
    void (*open)(writer *);
    void (*result)(writer *, int component);                             /* up to the value */
    void (*derivative)(writer *, int component, int particle, int axis); /* the same */
    const char *end_result;
    void (*close)(writer *);
} language;

struct writer {
    const skein_formula *formula;
    const language *language;
    void (*write)(void *user, const char *text);
    void *user;
    bool *live;
    uint32_t *uses;   /* by live nodes and outputs */
    uint32_t *number; /* of a temporary, from 1 on */
    uint8_t *height;  /* of an expression written in place; NAMED: it has a name */
};

static void put(writer *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void put(writer *w, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    w->write(w->user, text);
}

/* A number with a point or an exponent, whatever the locale says. */
static void put_number(writer *w, double value, int digits) {
    char text[40];
    snprintf(text, sizeof text, "%.*g", digits, value);
    for (char *c = text; *c; c++)
        if (*c == ',') *c = '.';
    put(w, "%s%s", text, strpbrk(text, ".en") ? "" : ".0");
}

/* The formula's own text, made fit for a comment. */
static void put_source(writer *w, const char *line_begin) {
    const char *text = w->formula->text;
    put(w, "%s", line_begin);
    for (; *text; text++) {
        bool ends_comment = text[0] == '/' && text > w->formula->text && text[-1] == '*';
        if (*text == '\n' && text[1]) put(w, "\n%s", line_begin);
        else if (*text != '\n') put(w, "%c", *text < ' ' || *text > '~' || *text == '\\' || ends_comment ? '?' : *text);
    }
    put(w, "\n");
}

/* ---- expressions ---- */

/* How tightly an expression holds together: 1 sums and signs, 2 products, 3 what needs no brackets. */
static int tightness(const writer *w, sk_node node) {
    uint8_t op = w->formula->graph.data[node].op;
    if (w->number[node] || op <= SK_OP_PARAMETER || w->language->call[op]) return 3;
    return op == SK_OP_MULTIPLY ? 2 : 1;
}

static void put_temporary(writer *w, sk_node node) {
    const char *name = w->formula->graph.data[node].name;
    size_t length = strlen(name);
    bool plain = length && name[0] != '_' && name[length - 1] != '_' && !strstr(name, "__");
    put(w, "%s_%u", plain ? name : "x", w->number[node]);
}

static void put_expression(writer *w, sk_node node);

static void put_operand(writer *w, sk_node node, int least) {
    bool name = w->number[node] != 0, brackets = tightness(w, node) < least;
    put(w, "%s", brackets ? "(" : "");
    if (name) put_temporary(w, node);
    else put_expression(w, node);
    put(w, "%s", brackets ? ")" : "");
}

/* Recurs as deep as expressions are high. */
static void put_expression(writer *w, sk_node node) {
    const sk_graph_node *n = &w->formula->graph.data[node];
    const char *call = w->language->call[n->op];
    if (n->op == SK_OP_CONSTANT) {
        w->language->constant(w, n->value);
    } else if (n->op == SK_OP_INPUT) {
        w->language->input(w, n->arg[0]);
    } else if (n->op == SK_OP_PARAMETER) {
        w->language->parameter(w, n->arg[0]);
    } else if (call) {
        put(w, "%s(", call);
        for (int k = 0; k < sk_op_info[n->op].arity; k++) {
            put(w, "%s", k ? ", " : "");
            put_operand(w, n->arg[k], 0);
        }
        put(w, ")");
    } else if (n->op == SK_OP_NEGATE) {
        put(w, "-");
        put_operand(w, n->arg[0], 2);
    } else {
        bool product = n->op == SK_OP_MULTIPLY;
        put_operand(w, n->arg[0], product ? 2 : 1);
        put(w, product ? " * " : n->op == SK_OP_ADD ? " + " : " - ");
        put_operand(w, n->arg[1], product ? 3 : 2);
    }
}

static void put_output(writer *w, sk_node node) {
    put_operand(w, node, 0);
    put(w, "%s", w->language->end_result);
}

/* ---- the walk ---- */

static size_t outputs_of(const skein_formula *f, sk_node outputs[SK_FORMULA_MOST_OUTPUTS]) {
    size_t count = 0;
    for (int k = 0; k < f->size; k++) {
        outputs[count++] = f->value[k];
        for (int i = 0; i < 3 * f->particles; i++) outputs[count++] = f->by_position[k][i];
    }
    return count;
}

/* Which nodes get names: those that are read more than once, or stand too high. */
static void find_names(writer *w) {
    const sk_graph *g = &w->formula->graph;
    uint32_t next = 0;
    for (size_t i = 0; i < g->count; i++) {
        const sk_graph_node *n = &g->data[i];
        int height = 1;
        if (!w->live[i] || n->op <= SK_OP_PARAMETER) continue;
        for (int k = 0; k < sk_op_info[n->op].arity; k++)
            if (w->height[n->arg[k]] >= height) height = w->height[n->arg[k]] + 1;
        bool named = w->uses[i] > 1 || height > MOST_HEIGHT || n->op == SK_OP_LESS;
        if (named) w->number[i] = ++next;
        else w->height[i] = (uint8_t)height;
    }
}

static void put_all(writer *w, const sk_node *outputs, size_t count) {
    const skein_formula *f = w->formula;
    const sk_graph *g = &f->graph;
    sk_graph_mark(g, outputs, count, w->live);
    for (size_t i = 0; i < count; i++) w->uses[outputs[i]]++;
    for (size_t i = 0; i < g->count; i++)
        for (int k = 0; w->live[i] && k < sk_op_info[g->data[i].op].arity; k++) w->uses[g->data[i].arg[k]]++;
    find_names(w);
    w->language->open(w);
    for (size_t i = 0; i < g->count; i++) {
        if (!w->number[i]) continue;
        put(w, "    %s ", w->language->declaration);
        put_temporary(w, (sk_node)i);
        put(w, " = ");
        put_expression(w, (sk_node)i);
        put(w, ";\n");
    }
    for (int k = 0; k < f->size; k++) {
        for (int p = 0; p < f->particles; p++)
            for (int axis = 0; axis < 3; axis++) {
                w->language->derivative(w, k, p, axis);
                put_output(w, f->by_position[k][3 * p + axis]);
            }
    }
    for (int k = 0; k < f->size; k++) {
        w->language->result(w, k);
        put_output(w, f->value[k]);
    }
    w->language->close(w);
}

/* ---- C ---- */

/* What a program may define otherwise, for another layout, another type, or elementary functions of its own. */
static const struct {
    int op; /* where it is needed; SK_OP_CONSTANT: everywhere */
    const char *text;
} c_macros[] = {
    {SK_OP_CONSTANT,
     "#include <math.h>\n"
     "#define FORMULA(name) \\\n"
     "    static void name(const double *position, const double *velocity, const double *parameter, \\\n"
     "                     double time, double *value, double *gradient)\n"
     "#define REAL double\n"
     "#define NUMBER(x) (x)\n"
     "#define POSITION(particle, axis) position[3 * (particle) + (axis)]\n"
     "#define VELOCITY(particle, axis) velocity[3 * (particle) + (axis)]\n"
     "#define PARAMETER(index) parameter[index]\n"
     "#define TIME time\n"
     "#define VALUE(component, x) value[component] = (x)\n"
     "#define GRADIENT(component, particle, axis, x) \\\n"
     "    gradient[3 * (PARTICLES * (component) + (particle)) + (axis)] = (x)\n"},
    {SK_OP_RECIPROCAL, "#define RECIPROCAL(x) (fabs(x) >= 2.2250738585072014e-308 ? 1 / (x) : 0)\n"},
    {SK_OP_SQRT, "#define SQRT(x) sqrt((x) >= 0 ? (x) : 0)\n"},
    {SK_OP_ABS, "#define ABS(x) fabs(x)\n"},
    {SK_OP_LESS, "#define LESS(a, b, yes, no) ((a) < (b) ? (yes) : (no))\n"},
    {SK_OP_EXP, "#define EXP(x) exp((x) <= 709 ? (x) : 709)\n"},
    {SK_OP_LOG, "#define LOG(x) log((x) >= 2.2250738585072014e-308 ? (x) : 2.2250738585072014e-308)\n"},
    {SK_OP_SIN, "#define SIN(x) sin(x)\n"},
    {SK_OP_COS, "#define COS(x) cos(x)\n"},
    {SK_OP_TAN, "#define TAN(x) tan(x)\n"},
    {SK_OP_ASIN, "#define ASIN(x) asin((x) > 1 ? 1 : (x) < -1 ? -1 : (x))\n"},
    {SK_OP_ACOS, "#define ACOS(x) acos((x) > 1 ? 1 : (x) < -1 ? -1 : (x))\n"},
    {SK_OP_ATAN2, "#define ATAN2(y, x) atan2(y, x)\n"},
    {SK_OP_POW, "#define POW(x, y) ((y) == 0 ? 1 : (x) > 0 ? pow(x, y) : 0)\n"},
};

static void put_helpers(writer *w, const char *(*text_of)(size_t), size_t count, int (*op_of)(size_t)) {
    bool used[SK_OP_COUNT] = {[SK_OP_CONSTANT] = true};
    const sk_graph *g = &w->formula->graph;
    for (size_t i = 0; i < g->count; i++)
        if (w->live[i]) used[g->data[i].op] = true;
    for (size_t i = 0; i < count; i++)
        if (used[op_of(i)]) w->write(w->user, text_of(i));
}

static const char *c_text_of(size_t i) {
    return c_macros[i].text;
}
static int c_op_of(size_t i) {
    return c_macros[i].op;
}

static void put_parameters(writer *w, const char *line_begin) {
    const skein_formula *f = w->formula;
    for (int i = 0; i < f->parameters + f->rests; i++) {
        if (i < f->parameters) put(w, "%sParameter %d is %s.\n", line_begin, i, f->parameter_name[i]);
        else put(w, "%sParameter %d is the value of rest(...) number %d.\n", line_begin, i, i - f->parameters + 1);
    }
}

static void c_open(writer *w) {
    put_source(w, "// ");
    put(w, "//\n// Made by `skein formula --emit c`: the value, and its derivatives by the positions.\n");
    put_parameters(w, "// ");
    put(w, "#ifndef FORMULA\n#define PARTICLES %d\n", w->formula->particles);
    put_helpers(w, c_text_of, sizeof c_macros / sizeof *c_macros, c_op_of);
    put(w, "#endif\n\nFORMULA(formula) {\n");
}

static void c_constant(writer *w, double value) {
    put(w, "NUMBER(");
    put_number(w, value, DBL_DECIMAL_DIG);
    put(w, ")");
}

static void c_input(writer *w, uint32_t input) {
    if (input == SK_INPUT_TIME) put(w, "TIME");
    else
        put(w, "%s(%u, %u)", input >= SK_INPUT_VELOCITY ? "VELOCITY" : "POSITION", input % SK_INPUT_VELOCITY / 3,
            input % 3);
}

static void c_parameter(writer *w, uint32_t parameter) {
    put(w, "PARAMETER(%u)", parameter);
}

static void c_result(writer *w, int component) {
    put(w, "    VALUE(%d, ", component);
}

static void c_derivative(writer *w, int component, int particle, int axis) {
    put(w, "    GRADIENT(%d, %d, %d, ", component, particle, axis);
}

static void c_close(writer *w) {
    put(w, "}\n");
}

static const language c_language = {.call = {[SK_OP_RECIPROCAL] = "RECIPROCAL",
                                             [SK_OP_SQRT] = "SQRT",
                                             [SK_OP_ABS] = "ABS",
                                             [SK_OP_LESS] = "LESS",
                                             [SK_OP_EXP] = "EXP",
                                             [SK_OP_LOG] = "LOG",
                                             [SK_OP_SIN] = "SIN",
                                             [SK_OP_COS] = "COS",
                                             [SK_OP_TAN] = "TAN",
                                             [SK_OP_ASIN] = "ASIN",
                                             [SK_OP_ACOS] = "ACOS",
                                             [SK_OP_ATAN2] = "ATAN2",
                                             [SK_OP_POW] = "POW"},
                                    .declaration = "const REAL",
                                    .constant = c_constant,
                                    .input = c_input,
                                    .parameter = c_parameter,
                                    .open = c_open,
                                    .result = c_result,
                                    .derivative = c_derivative,
                                    .end_result = ");\n",
                                    .close = c_close};

/* ---- GLSL ---- */

static const struct {
    int op;
    const char *text;
} glsl_helpers[] = {
    {SK_OP_RECIPROCAL,
     "float formula_reciprocal(float x) {\n    return abs(x) >= 1.17549435e-38 ? 1.0 / x : 0.0;\n}\n"},
    {SK_OP_SQRT, "float formula_sqrt(float x) {\n    return x >= 0.0 ? sqrt(x) : 0.0;\n}\n"},
    {SK_OP_LESS, "float formula_less(float a, float b, float yes, float no) {\n    return a < b ? yes : no;\n}\n"},
    {SK_OP_EXP, "float formula_exp(float x) {\n    return exp(min(x, 88.0));\n}\n"},
    {SK_OP_LOG, "float formula_log(float x) {\n    return log(max(x, 1.17549435e-38));\n}\n"},
    {SK_OP_ASIN, "float formula_asin(float x) {\n    return asin(clamp(x, -1.0, 1.0));\n}\n"},
    {SK_OP_ACOS, "float formula_acos(float x) {\n    return acos(clamp(x, -1.0, 1.0));\n}\n"},
    {SK_OP_POW, "float formula_pow(float x, float y) {\n    return y == 0.0 ? 1.0 : x > 0.0 ? pow(x, y) : 0.0;\n}\n"},
};

static const char *glsl_text_of(size_t i) {
    return glsl_helpers[i].text;
}
static int glsl_op_of(size_t i) {
    return glsl_helpers[i].op;
}

static void glsl_open(writer *w) {
    const skein_formula *f = w->formula;
    put_source(w, "// ");
    put(w, "//\n// Made by `skein formula --emit glsl`: the value, and its derivatives by the positions.\n");
    put_parameters(w, "// ");
    put_helpers(w, glsl_text_of, sizeof glsl_helpers / sizeof *glsl_helpers, glsl_op_of);
    put(w, "%s formula(", f->size == 3 ? "vec3" : "float");
    for (int p = 0; p < f->particles; p++) put(w, "vec3 p%d, ", p);
    for (int p = 0; p < f->particles && (f->uses & SK_USES_VELOCITY); p++) put(w, "vec3 v%d, ", p);
    for (int i = 0; i < f->parameters + f->rests; i++) put(w, "float q%d, ", i);
    put(w, "float t");
    for (int p = 0; p < f->particles; p++) put(w, ", out %s by_p%d", f->size == 3 ? "mat3" : "vec3", p);
    put(w, ") {\n");
    if (f->size == 3) put(w, "    vec3 value;\n");
}

static void glsl_constant(writer *w, double value) {
    double most = FLT_MAX;
    put(w, value < 0 ? "(" : "");
    put_number(w, value > most ? most : value < -most ? -most : value, FLT_DECIMAL_DIG);
    put(w, value < 0 ? ")" : "");
}

static void glsl_input(writer *w, uint32_t input) {
    if (input == SK_INPUT_TIME) put(w, "t");
    else put(w, "%c%u.%c", input >= SK_INPUT_VELOCITY ? 'v' : 'p', input % SK_INPUT_VELOCITY / 3, "xyz"[input % 3]);
}

static void glsl_parameter(writer *w, uint32_t parameter) {
    put(w, "q%u", parameter);
}

static void glsl_result(writer *w, int component) {
    if (w->formula->size == 3) put(w, "    value.%c = ", "xyz"[component]);
    else put(w, "    return ");
}

static void glsl_derivative(writer *w, int component, int particle, int axis) {
    if (w->formula->size == 3) put(w, "    by_p%d[%d][%d] = ", particle, axis, component);
    else put(w, "    by_p%d.%c = ", particle, "xyz"[axis]);
}

static void glsl_close(writer *w) {
    put(w, w->formula->size == 3 ? "    return value;\n}\n" : "}\n");
}

static const language glsl_language = {.call = {[SK_OP_RECIPROCAL] = "formula_reciprocal",
                                                [SK_OP_SQRT] = "formula_sqrt",
                                                [SK_OP_ABS] = "abs",
                                                [SK_OP_LESS] = "formula_less",
                                                [SK_OP_EXP] = "formula_exp",
                                                [SK_OP_LOG] = "formula_log",
                                                [SK_OP_SIN] = "sin",
                                                [SK_OP_COS] = "cos",
                                                [SK_OP_TAN] = "tan",
                                                [SK_OP_ASIN] = "formula_asin",
                                                [SK_OP_ACOS] = "formula_acos",
                                                [SK_OP_ATAN2] = "atan",
                                                [SK_OP_POW] = "formula_pow"},
                                       .declaration = "float",
                                       .constant = glsl_constant,
                                       .input = glsl_input,
                                       .parameter = glsl_parameter,
                                       .open = glsl_open,
                                       .result = glsl_result,
                                       .derivative = glsl_derivative,
                                       .end_result = ";\n",
                                       .close = glsl_close};

/* ---- the graph ---- */

static void put_leaf(writer *w, const sk_graph_node *n) {
    const skein_formula *f = w->formula;
    if (n->op == SK_OP_CONSTANT) {
        put_number(w, n->value, 10);
    } else if (n->op == SK_OP_INPUT) {
        glsl_input(w, n->arg[0]);
    } else if ((int)n->arg[0] < f->parameters) {
        put(w, "%s", f->parameter_name[n->arg[0]]);
    } else {
        put(w, "rest #%u", f->rest[n->arg[0] - (uint32_t)f->parameters]);
    }
}

static void put_graph(writer *w, const sk_node *outputs, size_t count) {
    const skein_formula *f = w->formula;
    const sk_graph *g = &f->graph;
    sk_node all[SK_FORMULA_MOST_OUTPUTS + SKEIN_FORMULA_MOST_RESTS];
    memcpy(all, outputs, count * sizeof *all);
    memcpy(all + count, f->rest, (size_t)f->rests * sizeof *all);
    sk_graph_mark(g, all, count + (size_t)f->rests, w->live);
    for (size_t i = 0; i < g->count; i++) {
        const sk_graph_node *n = &g->data[i];
        if (!w->live[i]) continue;
        put(w, "#%-4zu %-9s ", i, n->op <= SK_OP_PARAMETER ? "" : sk_op_info[n->op].name);
        if (n->op <= SK_OP_PARAMETER) put_leaf(w, n);
        for (int k = 0; k < sk_op_info[n->op].arity; k++) put(w, "%s#%u", k ? " " : "", n->arg[k]);
        put(w, "%s%s\n", n->name[0] ? "    // " : "", n->name);
    }
    for (int k = 0; k < f->size; k++) {
        put(w, "value%s%.1s = #%u\n", f->size == 3 ? "." : "", f->size == 3 ? &"xyz"[k] : "", f->value[k]);
        for (int i = 0; i < 3 * f->particles; i++)
            put(w, "d/dp%d.%c = #%u\n", i / 3, "xyz"[i % 3], f -> by_position[k][i]);
    }
}

skein_status skein_formula_emit(const skein_formula *f, skein_formula_language asked,
                                void (*write)(void *user, const char *text), void *user, skein_error *error) {
    sk_allocator allocator = sk_default_allocator();
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS];
    size_t nodes = f->graph.count, count = outputs_of(f, outputs);
    writer w = {.formula = f,
                .language = asked == SKEIN_FORMULA_C ? &c_language : &glsl_language,
                .write = write,
                .user = user,
                .live = sk_allocate(&allocator, nodes * sizeof *w.live),
                .uses = sk_allocate(&allocator, nodes * sizeof *w.uses),
                .number = sk_allocate(&allocator, nodes * sizeof *w.number),
                .height = sk_allocate(&allocator, nodes * sizeof *w.height)};
    bool good = w.live && w.uses && w.number && w.height;
    if (good && asked == SKEIN_FORMULA_GRAPH) put_graph(&w, outputs, count);
    else if (good) put_all(&w, outputs, count);
    sk_release(&allocator, w.live);
    sk_release(&allocator, w.uses);
    sk_release(&allocator, w.number);
    sk_release(&allocator, w.height);
    return good ? SKEIN_OK : sk_fail_memory(error, "a formula as text");
}
