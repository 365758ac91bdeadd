/* A formula as a graph of scalar operations: each node is made once and shared by all nodes that read it.
 *
 * Made by the parser, extended by derivatives (derivative.c), read by everything else: evaluate.c computes it number
 * by number, tape.c sixteen at a time, emit.c writes it as C or GLSL. Nodes come after the nodes that they read, so
 * every pass is a loop over an array; nothing here recurses.
 *
 * Operations are total: each gives a finite number for finite arguments, unless it overflows. Where it is not defined,
 * it gives 0 or the nearest value, and counts as *guarded*:
 *
 *     reciprocal   1/x, 0 at 0 (and where 1/x would overflow)        log    of x under the least normal number, of that
 *     sqrt         0 under 0                                         exp    of x over what the format holds, of that
 *     asin, acos   of x beyond -1 and 1, of those (not counted)      pow    0 for x <= 0, but 1 where y is 0
 *
 * With reciprocals guarded so, the derivative of a length at length 0 is 0, and that of acos at 1 as well. */
#ifndef SK_FORMULA_GRAPH_H
#define SK_FORMULA_GRAPH_H

#include "base/memory.h"

typedef uint32_t sk_node;

typedef enum sk_node_op {
    SK_NODE_CONSTANT,
    SK_NODE_INPUT,
    SK_NODE_PARAMETER,
    SK_NODE_ADD,
    SK_NODE_SUBTRACT,
    SK_NODE_MULTIPLY,
    SK_NODE_NEGATE,
    SK_NODE_RECIPROCAL,
    SK_NODE_SQRT,
    SK_NODE_ABS,
    SK_NODE_LESS, /* a < b ? c : d; all that is piecewise is made of these */
    SK_NODE_EXP,
    SK_NODE_LOG,
    SK_NODE_SIN,
    SK_NODE_COS,
    SK_NODE_TAN,
    SK_NODE_ASIN,
    SK_NODE_ACOS,
    SK_NODE_ATAN2, /* y, x */
    SK_NODE_POW,
    SK_NODE_COUNT
} sk_node_op;

extern const struct sk_node_op_info {
    const char *name;
    int arity;
} sk_node_op_info[SK_NODE_COUNT];

/* Inputs: coordinates of positions, then of velocities, then time. */
enum {
    SK_FORMULA_PARTICLES = 8,
    SK_INPUT_POSITION = 0, /* + 3 particle + axis */
    SK_INPUT_VELOCITY = 3 * SK_FORMULA_PARTICLES,
    SK_INPUT_TIME = 2 * SK_INPUT_VELOCITY,
    SK_INPUT_COUNT
};

/* What a node depends on. */
enum { SK_USES_POSITION = 1, SK_USES_VELOCITY = 2, SK_USES_TIME = 4, SK_USES_PARAMETER = 8 };

typedef struct sk_graph_node {
    uint8_t op, uses;
    sk_node arg[4];   /* an input's and a parameter's number is arg[0] */
    double value;     /* of a constant */
    const char *name; /* where it came from, for readers: "length", "" */
} sk_graph_node;

typedef struct sk_graph {
    sk_graph_node *data;
    size_t count, capacity;
    uint32_t *table; /* node + 1 by hash; a power of two, at most half full */
    size_t table_size;
    sk_allocator *allocator;
    const char *name; /* given to nodes made from now on */
    bool no_memory, too_large;
} sk_graph;

enum { SK_GRAPH_MOST_NODES = 1 << 18 };

void sk_graph_init(sk_graph *graph, sk_allocator *allocator);
void sk_graph_free(sk_graph *graph);

/* Each makes a node, or finds an existing one, or a simpler one of the same value. When there is no memory, or the
 * graph would be too large, they set the graph's flag and return node 0: checking once at the end is enough.
 * Never use two of these as arguments of one call: C leaves open which is evaluated first, and the order of nodes
 * decides the order of sums in derivatives, and so the bits. */
sk_node sk_constant(sk_graph *graph, double value);
sk_node sk_input(sk_graph *graph, uint32_t input);
sk_node sk_parameter(sk_graph *graph, uint32_t parameter);
sk_node sk_plus(sk_graph *graph, sk_node a, sk_node b);
sk_node sk_minus(sk_graph *graph, sk_node a, sk_node b);
sk_node sk_times(sk_graph *graph, sk_node a, sk_node b);
sk_node sk_over(sk_graph *graph, sk_node a, sk_node b); /* a (1/b) */
sk_node sk_negative_of(sk_graph *graph, sk_node a);
sk_node sk_of(sk_graph *graph, sk_node_op op, sk_node a); /* an operation on one argument */
sk_node sk_less(sk_graph *graph, sk_node a, sk_node b, sk_node yes, sk_node no);
sk_node sk_arctangent(sk_graph *graph, sk_node y, sk_node x);
sk_node sk_power(sk_graph *graph, sk_node x, sk_node y);
/* A sum or a product without the rules that move signs and constants out of it. */
sk_node sk_plain(sk_graph *graph, sk_node_op op, sk_node a, sk_node b);

bool sk_is_constant(const sk_graph *graph, sk_node node, double *value);

/* live[i] for each node below `count` that the outputs depend on. */
void sk_graph_mark(const sk_graph *graph, const sk_node *outputs, size_t output_count, bool *live);

/* The derivative of `output` by each of the inputs, by the chain rule backwards. False when there is no memory. */
bool sk_gradient(sk_graph *graph, sk_node output, const uint32_t *inputs, size_t count, sk_node *derivatives);
/* The same by nodes, as if these were inputs. */
bool sk_gradient_by(sk_graph *graph, sk_node output, const sk_node *by, size_t count, sk_node *derivatives);
/* The derivatives of all outputs by one input, by the chain rule forwards. */
bool sk_tangents(sk_graph *graph, const sk_node *outputs, size_t count, uint32_t input, sk_node *derivatives);
/* The second derivatives of `output` by the coordinates of positions, (3 particles)^2 of them; those that are mirrored
 * at the diagonal are one node (second.c). False when there is no memory. */
bool sk_second_derivatives(sk_graph *graph, sk_node output, size_t particles, sk_node *hessian);

#endif
