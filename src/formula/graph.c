/* Making nodes: finding existing ones, folding constants, and the few simplifications that derivatives need. Only rules
 * that lose nothing are used: besides reordering constant factors, each gives the same bits as what it replaces (but
 * for the sign of a zero). */
#include "formula/graph.h"

#include <string.h>

#include "base/hash.h"
#include "formula/evaluate.h"

const struct sk_node_op_info sk_node_op_info[SK_NODE_COUNT] = {
    [SK_NODE_CONSTANT] = {"constant", 0}, [SK_NODE_INPUT] = {"input", 0},    [SK_NODE_PARAMETER] = {"parameter", 0},
    [SK_NODE_ADD] = {"add", 2},           [SK_NODE_SUBTRACT] = {"sub", 2},   [SK_NODE_MULTIPLY] = {"mul", 2},
    [SK_NODE_NEGATE] = {"neg", 1},        [SK_NODE_RECIPROCAL] = {"rcp", 1}, [SK_NODE_SQRT] = {"sqrt", 1},
    [SK_NODE_ABS] = {"abs", 1},           [SK_NODE_LESS] = {"less", 4},      [SK_NODE_EXP] = {"exp", 1},
    [SK_NODE_LOG] = {"log", 1},           [SK_NODE_SIN] = {"sin", 1},        [SK_NODE_COS] = {"cos", 1},
    [SK_NODE_TAN] = {"tan", 1},           [SK_NODE_ASIN] = {"asin", 1},      [SK_NODE_ACOS] = {"acos", 1},
    [SK_NODE_ATAN2] = {"atan2", 2},       [SK_NODE_POW] = {"pow", 2},
};

void sk_graph_init(sk_graph *graph, sk_allocator *allocator) {
    *graph = (sk_graph){.allocator = allocator, .name = ""};
}

void sk_graph_free(sk_graph *graph) {
    sk_release(graph->allocator, graph->data);
    sk_release(graph->allocator, graph->table);
    sk_graph_init(graph, graph->allocator);
}

/* ---- finding and adding ---- */

static uint64_t bits_of(double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

static size_t hash_of(const sk_graph_node *node) {
    uint64_t hash = sk_hash_word(SK_HASH_START, node->op);
    for (int i = 0; i < 4; i++) hash = sk_hash_word(hash, node->arg[i]);
    return (size_t)sk_hash_mix(sk_hash_word(hash, bits_of(node->value)));
}

static bool same(const sk_graph_node *a, const sk_graph_node *b) {
    return a->op == b->op && !memcmp(a->arg, b->arg, sizeof a->arg) && bits_of(a->value) == bits_of(b->value);
}

/* The place of a node in the table, or the free one where it belongs. */
static size_t place_of(const sk_graph *graph, const sk_graph_node *node) {
    size_t at = hash_of(node) & (graph->table_size - 1);
    while (graph->table[at] && !same(&graph->data[graph->table[at] - 1], node)) at = (at + 1) & (graph->table_size - 1);
    return at;
}

static bool grow_table(sk_graph *graph) {
    if (2 * (graph->count + 1) <= graph->table_size) return true;
    size_t size = graph->table_size ? 2 * graph->table_size : 256;
    uint32_t *table = sk_allocate(graph->allocator, size * sizeof *table);
    if (!table) return false;
    sk_release(graph->allocator, graph->table);
    graph->table = table, graph->table_size = size;
    for (size_t i = 0; i < graph->count; i++) table[place_of(graph, &graph->data[i])] = (uint32_t)i + 1;
    return true;
}

static uint8_t uses_of(const sk_graph *graph, const sk_graph_node *node) {
    if (node->op == SK_NODE_INPUT)
        return node->arg[0] == SK_INPUT_TIME       ? SK_USES_TIME
               : node->arg[0] >= SK_INPUT_VELOCITY ? SK_USES_VELOCITY
                                                   : SK_USES_POSITION;
    if (node->op == SK_NODE_PARAMETER) return SK_USES_PARAMETER;
    uint8_t uses = 0;
    for (int i = 0; i < sk_node_op_info[node->op].arity; i++) uses |= graph->data[node->arg[i]].uses;
    return uses;
}

static sk_node find_or_add(sk_graph *graph, sk_graph_node node) {
    if (graph->no_memory || graph->too_large) return 0;
    if (!grow_table(graph)) {
        graph->no_memory = true;
        return 0;
    }
    size_t at = place_of(graph, &node);
    if (graph->table[at]) return graph->table[at] - 1;
    graph->too_large = graph->count >= SK_GRAPH_MOST_NODES;
    graph->no_memory = !graph->too_large && !SK_RESERVE(graph->allocator, graph, graph->count + 1);
    if (graph->no_memory || graph->too_large) return 0;
    node.uses = uses_of(graph, &node);
    node.name = graph->name;
    graph->data[graph->count] = node;
    graph->table[at] = (uint32_t)++graph->count;
    return (sk_node)graph->count - 1;
}

/* ---- leaves ---- */

bool sk_is_constant(const sk_graph *graph, sk_node node, double *value) {
    if (node >= graph->count || graph->data[node].op != SK_NODE_CONSTANT) return false;
    *value = graph->data[node].value;
    return true;
}

sk_node sk_constant(sk_graph *graph, double value) {
    return find_or_add(graph, (sk_graph_node){.op = SK_NODE_CONSTANT, .value = value == 0 ? 0 : value});
}

sk_node sk_input(sk_graph *graph, uint32_t input) {
    return find_or_add(graph, (sk_graph_node){.op = SK_NODE_INPUT, .arg = {input}});
}

sk_node sk_parameter(sk_graph *graph, uint32_t parameter) {
    return find_or_add(graph, (sk_graph_node){.op = SK_NODE_PARAMETER, .arg = {parameter}});
}

/* ---- operations ---- */

/* An operation whose arguments are all constant becomes one. */
static sk_node make(sk_graph *graph, sk_node_op op, sk_node a, sk_node b, sk_node c, sk_node d) {
    const sk_node arg[4] = {a, b, c, d};
    double x[4] = {0};
    int arity = sk_node_op_info[op].arity, constants = 0;
    while (constants < arity && sk_is_constant(graph, arg[constants], &x[constants])) constants++;
    bool guarded = false;
    if (constants == arity) return sk_constant(graph, sk_apply_double(op, x, &guarded));
    return find_or_add(graph, (sk_graph_node){.op = (uint8_t)op, .arg = {a, b, c, d}});
}

static bool is(const sk_graph *graph, sk_node node, sk_node_op op) {
    return node < graph->count && graph->data[node].op == op;
}

static sk_node argument(const sk_graph *graph, sk_node node, int which) {
    return graph->data[node].arg[which];
}

static bool is_value(const sk_graph *graph, sk_node node, double value) {
    double x;
    return sk_is_constant(graph, node, &x) && x == value;
}

static void sort(sk_node *a, sk_node *b) {
    if (*a <= *b) return;
    sk_node larger = *a;
    *a = *b, *b = larger;
}

sk_node sk_plus(sk_graph *graph, sk_node a, sk_node b) {
    if (is_value(graph, a, 0)) return b;
    if (is_value(graph, b, 0)) return a;
    if (is(graph, b, SK_NODE_NEGATE)) return sk_minus(graph, a, argument(graph, b, 0));
    if (is(graph, a, SK_NODE_NEGATE)) return sk_minus(graph, b, argument(graph, a, 0));
    if (a == b) return sk_times(graph, sk_constant(graph, 2), a);
    sort(&a, &b);
    return make(graph, SK_NODE_ADD, a, b, 0, 0);
}

sk_node sk_minus(sk_graph *graph, sk_node a, sk_node b) {
    if (is_value(graph, a, 0)) return sk_negative_of(graph, b);
    if (is_value(graph, b, 0)) return a;
    if (a == b) return sk_constant(graph, 0);
    if (is(graph, b, SK_NODE_NEGATE)) return sk_plus(graph, a, argument(graph, b, 0));
    if (is(graph, a, SK_NODE_NEGATE)) return sk_negative_of(graph, sk_plus(graph, argument(graph, a, 0), b));
    return make(graph, SK_NODE_SUBTRACT, a, b, 0, 0);
}

sk_node sk_negative_of(sk_graph *graph, sk_node a) {
    double x;
    if (is(graph, a, SK_NODE_NEGATE)) return argument(graph, a, 0);
    if (is(graph, a, SK_NODE_SUBTRACT)) return sk_minus(graph, argument(graph, a, 1), argument(graph, a, 0));
    if (is(graph, a, SK_NODE_MULTIPLY) && sk_is_constant(graph, argument(graph, a, 0), &x))
        return sk_times(graph, sk_constant(graph, -x), argument(graph, a, 1));
    return make(graph, SK_NODE_NEGATE, a, 0, 0, 0);
}

/* Constants come first and are moved out of products, where they are combined: 0.5 (2 x) is x. */
static sk_node scaled(sk_graph *graph, sk_node constant, sk_node b) {
    double x = 1, y;
    sk_is_constant(graph, constant, &x);
    if (x == 0) return sk_constant(graph, 0);
    if (x == 1) return b;
    if (x == -1) return sk_negative_of(graph, b);
    if (is(graph, b, SK_NODE_NEGATE)) return sk_times(graph, sk_constant(graph, -x), argument(graph, b, 0));
    if (is(graph, b, SK_NODE_MULTIPLY) && sk_is_constant(graph, argument(graph, b, 0), &y))
        return sk_times(graph, sk_constant(graph, x * y), argument(graph, b, 1));
    return make(graph, SK_NODE_MULTIPLY, constant, b, 0, 0);
}

sk_node sk_times(sk_graph *graph, sk_node a, sk_node b) {
    double x;
    if (sk_is_constant(graph, a, &x)) return scaled(graph, a, b);
    if (sk_is_constant(graph, b, &x)) return scaled(graph, b, a);
    if (is(graph, a, SK_NODE_NEGATE)) return sk_negative_of(graph, sk_times(graph, argument(graph, a, 0), b));
    if (is(graph, b, SK_NODE_NEGATE)) return sk_negative_of(graph, sk_times(graph, a, argument(graph, b, 0)));
    for (int turn = 0; turn < 2; turn++) {
        sk_node first = turn ? b : a, other = turn ? a : b;
        if (is(graph, first, SK_NODE_MULTIPLY) && sk_is_constant(graph, argument(graph, first, 0), &x))
            return scaled(graph, argument(graph, first, 0), sk_times(graph, argument(graph, first, 1), other));
    }
    sort(&a, &b);
    return make(graph, SK_NODE_MULTIPLY, a, b, 0, 0);
}

sk_node sk_over(sk_graph *graph, sk_node a, sk_node b) {
    double x, y;
    if (sk_is_constant(graph, a, &x) && sk_is_constant(graph, b, &y) && y != 0) return sk_constant(graph, x / y);
    return sk_times(graph, a, sk_of(graph, SK_NODE_RECIPROCAL, b));
}

sk_node sk_of(sk_graph *graph, sk_node_op op, sk_node a) {
    if (op == SK_NODE_ABS && is(graph, a, SK_NODE_NEGATE)) a = argument(graph, a, 0);
    if (op == SK_NODE_ABS && (is(graph, a, SK_NODE_SQRT) || is(graph, a, SK_NODE_ABS))) return a;
    return make(graph, op, a, 0, 0, 0);
}

sk_node sk_less(sk_graph *graph, sk_node a, sk_node b, sk_node yes, sk_node no) {
    double x, y;
    if (yes == no) return yes;
    if (sk_is_constant(graph, a, &x) && sk_is_constant(graph, b, &y)) return x < y ? yes : no;
    if (a == b) return no;
    return make(graph, SK_NODE_LESS, a, b, yes, no);
}

sk_node sk_arctangent(sk_graph *graph, sk_node y, sk_node x) {
    return make(graph, SK_NODE_ATAN2, y, x, 0, 0);
}

/* Whole powers by repeated squaring, so that they exist for negative bases too. */
static sk_node whole_power(sk_graph *graph, sk_node x, unsigned power) {
    sk_node result = sk_constant(graph, 1);
    for (; power; power >>= 1) {
        if (power & 1) result = sk_times(graph, result, x);
        if (power > 1) x = sk_times(graph, x, x);
    }
    return result;
}

sk_node sk_power(sk_graph *graph, sk_node x, sk_node y) {
    enum { MOST = 64 };
    double power;
    if (!sk_is_constant(graph, y, &power)) return make(graph, SK_NODE_POW, x, y, 0, 0);
    if (power == 0.5) return sk_of(graph, SK_NODE_SQRT, x);
    double size = power < 0 ? -power : power;
    if (!(size <= MOST) || size != (double)(unsigned)size) return make(graph, SK_NODE_POW, x, y, 0, 0);
    sk_node result = whole_power(graph, x, (unsigned)size);
    return power < 0 ? sk_of(graph, SK_NODE_RECIPROCAL, result) : result;
}

sk_node sk_plain(sk_graph *graph, sk_node_op op, sk_node a, sk_node b) {
    if (op != SK_NODE_SUBTRACT) sort(&a, &b);
    return make(graph, op, a, b, 0, 0);
}

void sk_graph_mark(const sk_graph *graph, const sk_node *outputs, size_t output_count, bool *live) {
    memset(live, 0, graph->count * sizeof *live);
    size_t end = 0;
    for (size_t i = 0; i < output_count; i++) {
        live[outputs[i]] = true;
        if (outputs[i] >= end) end = outputs[i] + 1;
    }
    for (size_t i = end; i-- > 0;)
        for (int a = 0; live[i] && a < sk_node_op_info[graph->data[i].op].arity; a++)
            live[graph->data[i].arg[a]] = true;
}
