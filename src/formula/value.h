/* Values of expressions during parsing: a number, a vector or a truth value, each a few nodes of the graph; and the
 * functions of the language, which make such values from others. A truth value is 1 or 0. */
#ifndef SK_FORMULA_VALUE_H
#define SK_FORMULA_VALUE_H

#include "formula/graph.h"

typedef enum sk_value_type { SK_NUMBER, SK_VECTOR3, SK_TRUTH } sk_value_type;

typedef enum sk_comparison { SK_NO_COMPARISON, SK_LESS, SK_AT_MOST, SK_EQUAL, SK_UNEQUAL } sk_comparison;

typedef struct sk_value {
    sk_value_type type;
    sk_node node[3];
    bool of_dot;              /* a dot product, perhaps clamped: acos of it is a mistake */
    sk_comparison comparison; /* a truth that is side[0] < side[1], ... */
    bool swapped;             /* it was written as side[1] > side[0] */
    sk_node side[2];
} sk_value;

sk_value sk_number(sk_node node);
sk_value sk_vector3(sk_node x, sk_node y, sk_node z);
sk_value sk_compare(sk_graph *graph, sk_comparison comparison, sk_node a, sk_node b);
const char *sk_type_text(sk_value_type type); /* "a number", ... */

/* A function: its arguments' types as letters, n number, v vector, b truth, a either number or vector, all alike. */
typedef struct sk_function {
    const char *name, *arguments;
    sk_value (*apply)(sk_graph *graph, const sk_value *arguments);
    const char *usage, *help;
} sk_function;

enum { SK_MOST_ARGUMENTS = 4 };
extern const sk_function sk_functions[];
extern const size_t sk_function_count;

/* NULL if there is none. */
const sk_function *sk_function_find(const char *name);

#endif
