/* A constraint as C for the library's own walks (constraints/element_arithmetic.h): its rest values, its value and its
 * gradient, in macros that are independent of the data's layout.
 *
 *     // length(p0 - p1) - rest(length(p0 - p1))
 *     TEXT("length(p0 - p1) - rest(length(p0 - p1))")
 *     RESTS(rests) { ... REST(0, x); }
 *     FORMULA(formula) { ... GRADIENT(0, particle, axis, g); VALUE(0, c); }
 *
 * Two properties that make walks faster are found here. If the gradient is y/s for each particle, s being the length of
 * y, it is written as y and UNIT_DIVISOR(s): so a distance needs one division instead of two, and no square of its
 * gradient. If the second particle's gradient is minus the first's, OPPOSITE(1, 0) says so. */
#include <string.h>

#include "formula/emit.h"

/* A gradient's component: sign times node. */
typedef struct component {
    sk_node node;
    bool negative;
} component;

static bool is_zero(const sk_graph *g, sk_node node) {
    double value;
    return sk_is_constant(g, node, &value) && value == 0;
}

static component without_sign(const sk_graph *g, sk_node node) {
    bool negative = g->data[node].op == SK_NODE_NEGATE;
    return (component){negative ? g->data[node].arg[0] : node, negative};
}

/* The other factor of a product; false if the node is no product with that factor. */
static bool divide_by(const sk_graph *g, sk_node product, sk_node factor, sk_node *other) {
    const sk_graph_node *n = &g->data[product];
    if (n->op != SK_NODE_MULTIPLY || (n->arg[0] != factor && n->arg[1] != factor)) return false;
    *other = n->arg[n->arg[0] == factor];
    return true;
}

/* Whether a node is the sum of the three squares, in whatever order. */
static bool is_square_of(const sk_graph *g, sk_node node, const component y[3]) {
    sk_node todo[8] = {node};
    bool found[3] = {false, false, false};
    for (int count = 1; count > 0;) {
        const sk_graph_node *n = &g->data[todo[--count]];
        if (n->op == SK_NODE_ADD && count + 2 < 8) {
            todo[count++] = n->arg[0], todo[count++] = n->arg[1];
            continue;
        }
        int k = 0;
        while (k < 3 && (found[k] || n->op != SK_NODE_MULTIPLY || n->arg[0] != n->arg[1] || n->arg[0] != y[k].node))
            k++;
        if (k == 3) return false;
        found[k] = true;
    }
    return found[0] && found[1] && found[2];
}

/* Finds a node s whose reciprocal is a factor of all components and makes each particle's gradient a unit vector; if
 * there is one, removes that factor from the components. */
static bool find_divisor(const skein_formula *f, component *y, sk_node *divisor) {
    const sk_graph *g = &f->graph;
    int count = 3 * f->particles;
    for (int side = 0; side < 2; side++) {
        const sk_graph_node *first = &g->data[y[0].node];
        sk_node factor = first->arg[side], bare[SK_INPUT_VELOCITY] = {0};
        if (first->op != SK_NODE_MULTIPLY || g->data[factor].op != SK_NODE_RECIPROCAL) continue;
        *divisor = g->data[factor].arg[0];
        bool all = g->data[*divisor].op == SK_NODE_SQRT;
        for (int i = 0; i < count && all; i++) all = divide_by(g, y[i].node, factor, &bare[i]);
        for (int p = 0; p < f->particles && all; p++) {
            component of[3] = {{bare[3 * p], false}, {bare[3 * p + 1], false}, {bare[3 * p + 2], false}};
            all = is_square_of(g, g->data[*divisor].arg[0], of);
        }
        for (int i = 0; i < count && all; i++) y[i].node = bare[i];
        if (all) return true;
    }
    return false;
}

static bool is_opposite(const skein_formula *f, const component *y) {
    bool all = f->particles == 2;
    for (int i = 0; i < 3 && all; i++) all = y[i].node == y[3 + i].node && y[i].negative != y[3 + i].negative;
    return all;
}

/* The formula as a string, for the inspection of constraints of that kind. */
static void put_text(sk_writer *w) {
    sk_put(w, "TEXT(\"");
    for (const char *c = w->formula->text; *c; c++) {
        if (*c == '\n') sk_put(w, "\\n");
        else sk_put(w, *c == '"' || *c == '\\' ? "\\%c" : "%c", *c);
    }
    sk_put(w, "\")\n");
}

static void put_rests(sk_writer *w) {
    const skein_formula *f = w->formula;
    if (!f->rests) return;
    sk_put(w, "RESTS(rests) {\n");
    sk_put_temporaries(w, f->rest, (size_t)f->rests);
    for (int i = 0; i < f->rests; i++) {
        sk_put(w, "    REST(%d, ", f->parameters + i);
        sk_put_operand(w, f->rest[i], 0);
        sk_put(w, ");\n");
    }
    sk_put(w, "}\n\n");
}

void sk_put_kernel(sk_writer *w) {
    const skein_formula *f = w->formula;
    component y[SK_INPUT_VELOCITY];
    sk_node outputs[SK_INPUT_VELOCITY + 2], divisor;
    size_t count = 0, coordinates = 3 * (size_t)f->particles;
    for (size_t i = 0; i < coordinates; i++) y[i] = without_sign(&f->graph, f->by_position[0][i]);
    bool divided = coordinates && find_divisor(f, y, &divisor), opposite = is_opposite(f, y);
    outputs[count++] = f->value[0];
    if (divided) outputs[count++] = divisor;
    for (size_t i = 0; i < coordinates; i++) outputs[count++] = y[i].node;
    sk_put_source(w, "// ");
    sk_put_parameters(w, "// ");
    put_text(w);
    put_rests(w);
    sk_put(w, "FORMULA(formula) {\n");
    sk_put_temporaries(w, outputs, count);
    if (divided) {
        sk_put(w, "    UNIT_DIVISOR(");
        sk_put_operand(w, divisor, 0);
        sk_put(w, ");\n");
    }
    for (size_t i = 0; i < coordinates && !(opposite && i == 3); i++) {
        bool sign = y[i].negative && !is_zero(&f->graph, y[i].node);
        sk_put(w, "    GRADIENT(0, %zu, %zu, %s", i / 3, i % 3, sign ? "-" : "");
        sk_put_operand(w, y[i].node, sign ? 2 : 0);
        sk_put(w, ");\n");
    }
    if (opposite) sk_put(w, "    OPPOSITE(1, 0);\n");
    sk_put(w, "    VALUE(0, ");
    sk_put_operand(w, f->value[0], 0);
    sk_put(w, ");\n}\n");
}
