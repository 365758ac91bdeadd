/* Formulas as C. */
#include <float.h>

#include "formula/emit.h"

/* Macros that a program may redefine, for another layout or type, or for elementary functions of its own. */
static const struct {
    int op; /* where it is needed; SK_NODE_CONSTANT: everywhere */
    const char *text;
} c_macros[] = {
    {SK_NODE_CONSTANT, "#include <math.h>\n"
                       "#define REAL double\n"
                       "#define NUMBER(x) (x)\n"
                       "#define POSITION(particle, axis) position[3 * (particle) + (axis)]\n"
                       "#define VELOCITY(particle, axis) velocity[3 * (particle) + (axis)]\n"
                       "#define PARAMETER(index) parameter[index]\n"
                       "#define TIME time\n"
                       "#define VALUE(component, x) value[component] = (x)\n"
                       "#define GRADIENT(component, particle, axis, x) \\\n"
                       "    gradient[3 * (PARTICLES * (component) + (particle)) + (axis)] = (x)\n"},
    {SK_NODE_RECIPROCAL, "#define RECIPROCAL(x) (fabs(x) >= 2.2250738585072014e-308 ? 1 / (x) : 0)\n"},
    {SK_NODE_SQRT, "#define SQRT(x) sqrt((x) >= 0 ? (x) : 0)\n"},
    {SK_NODE_ABS, "#define ABS(x) fabs(x)\n"},
    {SK_NODE_LESS, "#define LESS(a, b, yes, no) ((a) < (b) ? (yes) : (no))\n"},
    {SK_NODE_EXP, "#define EXP(x) exp((x) <= 709 ? (x) : 709)\n"},
    {SK_NODE_LOG, "#define LOG(x) log((x) >= 2.2250738585072014e-308 ? (x) : 2.2250738585072014e-308)\n"},
    {SK_NODE_SIN, "#define SIN(x) sin(x)\n"},
    {SK_NODE_COS, "#define COS(x) cos(x)\n"},
    {SK_NODE_TAN, "#define TAN(x) tan(x)\n"},
    {SK_NODE_ASIN, "#define ASIN(x) asin((x) > 1 ? 1 : (x) < -1 ? -1 : (x))\n"},
    {SK_NODE_ACOS, "#define ACOS(x) acos((x) > 1 ? 1 : (x) < -1 ? -1 : (x))\n"},
    {SK_NODE_ATAN2, "#define ATAN2(y, x) atan2(y, x)\n"},
    {SK_NODE_POW, "#define POW(x, y) ((y) == 0 ? 1 : (x) > 0 ? pow(x, y) : 0)\n"},
};

static const char *c_text_of(size_t i) {
    return c_macros[i].text;
}
static int c_op_of(size_t i) {
    return c_macros[i].op;
}

static void c_open(sk_writer *w) {
    sk_put_source(w, "// ");
    sk_put(w, "//\n// Made by `skein formula --emit function`: the value, and its derivatives by the positions.\n");
    if (w->formula->hessian) sk_put(w, "// Second derivatives are row by row, up to the diagonal.\n");
    sk_put_parameters(w, "// ");
    sk_put(w, "#ifndef FORMULA\n#define PARTICLES %d\n", w->formula->particles);
    sk_put_helpers(w, c_text_of, sizeof c_macros / sizeof *c_macros, c_op_of);
    sk_put(w,
           "#define FORMULA(name) \\\n"
           "    static void name(const double *position, const double *velocity, const double *parameter, \\\n"
           "                     double time, double *value, double *gradient%s)\n",
           w->formula->hessian ? ", double *hessian" : "");
    if (w->formula->hessian)
        sk_put(w, "#define HESSIAN(row, column, x) hessian[(row) * ((row) + 1) / 2 + (column)] = (x)\n");
    sk_put(w, "#endif\n\nFORMULA(formula) {\n");
}

static void c_constant(sk_writer *w, double value) {
    sk_put(w, "NUMBER(");
    sk_put_number(w, value, DBL_DECIMAL_DIG);
    sk_put(w, ")");
}

static void c_input(sk_writer *w, uint32_t input) {
    if (input == SK_INPUT_TIME) sk_put(w, "TIME");
    else
        sk_put(w, "%s(%u, %u)", input >= SK_INPUT_VELOCITY ? "VELOCITY" : "POSITION", input % SK_INPUT_VELOCITY / 3,
               input % 3);
}

static void c_parameter(sk_writer *w, uint32_t parameter) {
    sk_put(w, "PARAMETER(%u)", parameter);
}

static void c_result(sk_writer *w, int component) {
    sk_put(w, "    VALUE(%d, ", component);
}

static void c_derivative(sk_writer *w, int component, int particle, int axis) {
    sk_put(w, "    GRADIENT(%d, %d, %d, ", component, particle, axis);
}

static void c_second(sk_writer *w, int row, int column) {
    sk_put(w, "    HESSIAN(%d, %d, ", row, column);
}

static void c_close(sk_writer *w) {
    sk_put(w, "}\n");
}

/* How C and kernels spell operations. */
#define SPELLING                                  \
    .call = {[SK_NODE_RECIPROCAL] = "RECIPROCAL", \
             [SK_NODE_SQRT] = "SQRT",             \
             [SK_NODE_ABS] = "ABS",               \
             [SK_NODE_LESS] = "LESS",             \
             [SK_NODE_EXP] = "EXP",               \
             [SK_NODE_LOG] = "LOG",               \
             [SK_NODE_SIN] = "SIN",               \
             [SK_NODE_COS] = "COS",               \
             [SK_NODE_TAN] = "TAN",               \
             [SK_NODE_ASIN] = "ASIN",             \
             [SK_NODE_ACOS] = "ACOS",             \
             [SK_NODE_ATAN2] = "ATAN2",           \
             [SK_NODE_POW] = "POW"},              \
    .declaration = "const REAL", .constant = c_constant, .input = c_input, .parameter = c_parameter

const sk_language sk_c_language = {
    SPELLING,           .open = c_open,       .result = c_result, .derivative = c_derivative,
    .second = c_second, .end_result = ");\n", .close = c_close,
};

static void nothing(sk_writer *w) {
    (void)w;
}

const sk_language sk_kernel_language = {SPELLING, .open = nothing};
