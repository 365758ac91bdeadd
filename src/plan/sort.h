/* The ops that sort particles into cells, for rules that look at neighbours (space/cells.h), in this order.
 *
 *   frame     ordered   finds the cells' box and sizes, and reserves memory; coefficient[0] is the radius
 *   find      free      finds the cell of each slot's particle
 *   rank      ordered   gives each particle a place, by a counting sort over cells
 *   copy      free      puts members of a cell in the user's order; copies positions and directions of flight by place
 *
 * The elements of `copy` are places, those of the others the slots of the op's group. */
#ifndef SK_PLAN_SORT_H
#define SK_PLAN_SORT_H

#include "plan/op.h"

enum { SK_SORT_OPS = 4 };

typedef struct sk_sort_op {
    sk_kernels kernels;
    sk_order order;
    bool by_place;
    const char *label;
} sk_sort_op;

extern const sk_sort_op sk_sort_ops[SK_SORT_OPS];

#endif
