/* Evaluating a graph for one element at a time, in float or in double, whatever `real` is: the reference for tapes,
 * also used to fold constants and for single evaluations. Guards are described in graph.h. */
#ifndef SK_FORMULA_EVALUATE_H
#define SK_FORMULA_EVALUATE_H

#include "formula/graph.h"

/* Computes one operation; sets `guarded` if a guard acted, and does not change it otherwise. */
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
