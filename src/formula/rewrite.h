/* Nodes as numbers times nodes: what second derivatives are put together from (second.c), and how they share what is
 * the same (rewrite.c). */
#ifndef SK_FORMULA_REWRITE_H
#define SK_FORMULA_REWRITE_H

#include "formula/graph.h"

/* factor times node; a factor of 0: nothing at all */
typedef struct sk_term {
    double factor;
    sk_node node;
} sk_term;

#define SK_NO_TERM ((sk_term){0, 0})

sk_node sk_term_node(sk_graph *graph, sk_term t);
/* The term's size as a node of its own, of which the sign stays outside. */
sk_term sk_term_whole(sk_graph *graph, sk_term t);
sk_term sk_term_product(sk_graph *graph, sk_term a, sk_term b);
sk_term sk_term_sum(sk_graph *graph, sk_term a, sk_term b);

/* Nodes, rewritten with all that they are computed from. False when there is no memory. */
bool sk_rewrite(sk_graph *graph, const sk_node *nodes, size_t count, sk_term *terms);

#endif
