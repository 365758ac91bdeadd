/* Derivatives as nodes of the same graph: by reverse mode for gradients, and by forward mode over those for second
 * derivatives. It uses graph.h's operations only, so their guards apply here too. */
#include <string.h>

#include "formula/graph.h"

static const sk_node NONE = UINT32_MAX;

/* ---- the local derivatives ---- */

/* The derivative of an operation on one argument, as a factor. */
static sk_node factor_of(sk_graph *g, sk_node node) {
    const sk_graph_node n = g->data[node];
    const sk_node x = n.arg[0], one = sk_constant(g, 1), zero = sk_constant(g, 0), half = sk_constant(g, 0.5);
    switch (n.op) {
    case SK_NODE_NEGATE: return sk_constant(g, -1);
    case SK_NODE_RECIPROCAL: return sk_negative_of(g, sk_times(g, node, node));
    case SK_NODE_SQRT: return sk_times(g, half, sk_of(g, SK_NODE_RECIPROCAL, node));
    case SK_NODE_ABS: return sk_less(g, x, zero, sk_constant(g, -1), one);
    case SK_NODE_EXP: return node;
    case SK_NODE_LOG: return sk_less(g, zero, x, sk_of(g, SK_NODE_RECIPROCAL, x), zero);
    case SK_NODE_SIN: return sk_of(g, SK_NODE_COS, x);
    case SK_NODE_COS: return sk_negative_of(g, sk_of(g, SK_NODE_SIN, x));
    case SK_NODE_TAN: return sk_plus(g, one, sk_times(g, node, node));
    case SK_NODE_ASIN:
    case SK_NODE_ACOS: {
        sk_node below = sk_minus(g, one, x), above = sk_plus(g, one, x), square = sk_times(g, below, above);
        sk_node slope = sk_of(g, SK_NODE_RECIPROCAL, sk_of(g, SK_NODE_SQRT, square));
        return n.op == SK_NODE_ASIN ? slope : sk_negative_of(g, slope);
    }
    default: return zero;
    }
}

/* Partial derivatives. atan2(y, x): x/(x^2 + y^2) by y, -y/(x^2 + y^2) by x. x^y: y x^(y-1) by x, log(x) x^y by y. */
static sk_node partial(sk_graph *g, sk_node node, int which) {
    const sk_graph_node n = g->data[node];
    const sk_node a = n.arg[0], b = n.arg[1];
    if (n.op == SK_NODE_ATAN2) {
        sk_node xx = sk_times(g, b, b), yy = sk_times(g, a, a), square = sk_plus(g, xx, yy);
        sk_node over = sk_of(g, SK_NODE_RECIPROCAL, square);
        return which == 0 ? sk_times(g, b, over) : sk_negative_of(g, sk_times(g, a, over));
    }
    if (n.op == SK_NODE_POW) {
        if (which == 0) return sk_times(g, b, sk_power(g, a, sk_minus(g, b, sk_constant(g, 1))));
        return sk_times(g, sk_of(g, SK_NODE_LOG, a), node);
    }
    return factor_of(g, node);
}

/* ---- backwards ---- */

/* The derivative of the output by each node, as far as it has been found. */
typedef struct adjoints {
    sk_graph *graph;
    sk_node *of;
    const bool *wanted; /* depends on one of the inputs */
} adjoints;

static void accumulate(adjoints *a, sk_node node, sk_node contribution) {
    if (!a->wanted[node]) return;
    a->of[node] = a->of[node] == NONE ? contribution : sk_plus(a->graph, a->of[node], contribution);
}

static void pass_back(adjoints *a, sk_node node, sk_node d) {
    sk_graph *g = a->graph;
    const sk_graph_node n = g->data[node];
    switch (n.op) {
    case SK_NODE_ADD:
        accumulate(a, n.arg[0], d);
        accumulate(a, n.arg[1], d);
        break;
    case SK_NODE_SUBTRACT:
        accumulate(a, n.arg[0], d);
        if (a->wanted[n.arg[1]]) accumulate(a, n.arg[1], sk_negative_of(g, d));
        break;
    case SK_NODE_MULTIPLY:
        if (a->wanted[n.arg[0]]) accumulate(a, n.arg[0], sk_times(g, d, n.arg[1]));
        if (a->wanted[n.arg[1]]) accumulate(a, n.arg[1], sk_times(g, d, n.arg[0]));
        break;
    case SK_NODE_LESS: {
        sk_node zero = sk_constant(g, 0);
        if (a->wanted[n.arg[2]]) accumulate(a, n.arg[2], sk_less(g, n.arg[0], n.arg[1], d, zero));
        if (a->wanted[n.arg[3]]) accumulate(a, n.arg[3], sk_less(g, n.arg[0], n.arg[1], zero, d));
        break;
    }
    case SK_NODE_RECIPROCAL: // -(d r) r: in this order intermediate values stay in range
        if (a->wanted[n.arg[0]]) accumulate(a, n.arg[0], sk_negative_of(g, sk_times(g, sk_times(g, d, node), node)));
        break;
    default:
        for (int k = 0; k < sk_node_op_info[n.op].arity; k++)
            if (a->wanted[n.arg[k]]) accumulate(a, n.arg[k], sk_times(g, d, partial(g, node, k)));
    }
}

/* wanted[i]: whether node i depends on an input of the list. */
static void find_wanted(const sk_graph *graph, const uint32_t *inputs, size_t count, bool *wanted) {
    bool listed[SK_INPUT_COUNT] = {0};
    for (size_t i = 0; i < count; i++) listed[inputs[i]] = true;
    for (size_t i = 0; i < graph->count; i++) {
        const sk_graph_node *n = &graph->data[i];
        wanted[i] = n->op == SK_NODE_INPUT && listed[n->arg[0]];
        for (int k = 0; k < sk_node_op_info[n->op].arity; k++) wanted[i] |= wanted[n->arg[k]];
    }
}

/* Finds the derivative of the output by each wanted node, down to those in `seed` (NULL: to the inputs). */
static void go_back(adjoints *a, sk_node output, size_t count, const bool *seed) {
    for (size_t i = 0; i < count; i++) a->of[i] = NONE;
    a->of[output] = sk_constant(a->graph, 1);
    for (size_t i = (size_t)output + 1; i-- > 0;)
        if (a->of[i] != NONE && a->wanted[i] && !(seed && seed[i])) pass_back(a, (sk_node)i, a->of[i]);
}

bool sk_gradient(sk_graph *graph, sk_node output, const uint32_t *inputs, size_t count, sk_node *derivatives) {
    if (graph->no_memory || graph->too_large) return false;
    size_t before = graph->count; // nodes made below are not differentiated
    sk_node *of = sk_allocate(graph->allocator, before * sizeof *of);
    bool *wanted = sk_allocate(graph->allocator, before * sizeof *wanted);
    if (!of || !wanted) graph->no_memory = true;
    graph->name = "d";
    if (of && wanted) {
        adjoints a = {graph, of, wanted};
        find_wanted(graph, inputs, count, wanted);
        go_back(&a, output, before, NULL);
        for (size_t k = 0; k < count; k++) {
            sk_node input = sk_input(graph, inputs[k]);
            derivatives[k] = input < before && of[input] != NONE ? of[input] : sk_constant(graph, 0);
        }
    }
    graph->name = "";
    sk_release(graph->allocator, of);
    sk_release(graph->allocator, wanted);
    return !graph->no_memory && !graph->too_large;
}

bool sk_gradient_by(sk_graph *graph, sk_node output, const sk_node *by, size_t count, sk_node *derivatives) {
    if (graph->no_memory || graph->too_large) return false;
    size_t before = graph->count;
    sk_node *of = sk_allocate(graph->allocator, before * sizeof *of);
    bool *wanted = sk_allocate(graph->allocator, 2 * before * sizeof *wanted);
    if (!of || !wanted) graph->no_memory = true;
    graph->name = "d";
    if (of && wanted) {
        adjoints a = {graph, of, wanted};
        bool *seed = wanted + before;
        memset(seed, 0, before * sizeof *seed);
        for (size_t k = 0; k < count; k++) seed[by[k]] = true;
        for (size_t i = 0; i < before; i++) {
            const sk_graph_node *n = &graph->data[i];
            wanted[i] = seed[i];
            for (int k = 0; k < sk_node_op_info[n->op].arity; k++) wanted[i] |= wanted[n->arg[k]];
        }
        go_back(&a, output, before, seed);
        for (size_t k = 0; k < count; k++) derivatives[k] = of[by[k]] != NONE ? of[by[k]] : sk_constant(graph, 0);
    }
    graph->name = "";
    sk_release(graph->allocator, of);
    sk_release(graph->allocator, wanted);
    return !graph->no_memory && !graph->too_large;
}

/* ---- forwards ---- */

/* The tangent of a node from those of its arguments, each NONE where it does not change. */
static sk_node tangent_of(sk_graph *g, sk_node node, const sk_node *of) {
    const sk_graph_node n = g->data[node];
    sk_node t[4] = {NONE, NONE, NONE, NONE}, sum = NONE;
    bool moves = false;
    for (int k = 0; k < sk_node_op_info[n.op].arity; k++) moves |= (t[k] = of[n.arg[k]]) != NONE;
    if (!moves) return NONE;
    if (n.op == SK_NODE_LESS) {
        const sk_node zero = sk_constant(g, 0);
        return sk_less(g, n.arg[0], n.arg[1], t[2] == NONE ? zero : t[2], t[3] == NONE ? zero : t[3]);
    }
    for (int k = 0; k < sk_node_op_info[n.op].arity; k++) {
        if (t[k] == NONE) continue;
        sk_node term = n.op == SK_NODE_ADD || (n.op == SK_NODE_SUBTRACT && k == 0) ? t[k]
                       : n.op == SK_NODE_SUBTRACT                                  ? sk_negative_of(g, t[k])
                       : n.op == SK_NODE_MULTIPLY                                  ? sk_times(g, t[k], n.arg[1 - k])
                                                  : sk_times(g, t[k], partial(g, node, k));
        sum = sum == NONE ? term : sk_plus(g, sum, term);
    }
    return sum;
}

bool sk_tangents(sk_graph *graph, const sk_node *outputs, size_t count, uint32_t input, sk_node *derivatives) {
    if (graph->no_memory || graph->too_large) return false;
    size_t before = 0; // nodes that outputs may depend on
    for (size_t k = 0; k < count; k++)
        if (outputs[k] >= before) before = outputs[k] + 1;
    sk_node *of = sk_allocate(graph->allocator, before * sizeof *of);
    bool *live = sk_allocate(graph->allocator, graph->count * sizeof *live);
    if (!of || !live) graph->no_memory = true;
    graph->name = "dd";
    if (of && live) {
        sk_graph_mark(graph, outputs, count, live);
        for (size_t i = 0; i < before; i++) {
            const sk_graph_node *n = &graph->data[i];
            bool leaf = n->op <= SK_NODE_PARAMETER, self = n->op == SK_NODE_INPUT && n->arg[0] == input;
            of[i] = !live[i] ? NONE : self ? sk_constant(graph, 1) : leaf ? NONE : tangent_of(graph, (sk_node)i, of);
        }
        for (size_t k = 0; k < count; k++)
            derivatives[k] = of[outputs[k]] == NONE ? sk_constant(graph, 0) : of[outputs[k]];
    }
    graph->name = "";
    sk_release(graph->allocator, of);
    sk_release(graph->allocator, live);
    return !graph->no_memory && !graph->too_large;
}
