/* One element of a graph at a time, in float or in double, whatever `real` is. The truth that tapes are held against,
 * and what folds constants and answers single questions. Guards are described in graph.h. */
#ifndef SK_FORMULA_EVALUATE_H
#define SK_FORMULA_EVALUATE_H

#include "formula/graph.h"

/* One operation; `guarded` is set where a guard acted, and else left alone. */
double sk_apply_double(sk_node_op op, const double *arguments, bool *guarded);
float sk_apply_float(sk_node_op op, const float *arguments, bool *guarded);

/* Every live node into values[node]. Returns whether a guard acted. `inputs` are SK_INPUT_COUNT numbers. */
bool sk_evaluate_double(const sk_graph *graph, const bool *live, const double *inputs, const double *parameters,
                        double *values);
bool sk_evaluate_float(const sk_graph *graph, const bool *live, const float *inputs, const float *parameters,
                       float *values);

/* Beyond these the guards act. */
#define SK_LEAST_FLOAT 1.17549435e-38f /* a reciprocal's and a logarithm's argument */
#define SK_LEAST_DOUBLE 2.2250738585072014e-308
#define SK_MOST_EXP_FLOAT 88.0f
#define SK_MOST_EXP_DOUBLE 709.0

#endif
