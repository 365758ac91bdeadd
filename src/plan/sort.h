/* The rows that sort particles into cells, for rules that look at neighbours (space/cells.h), in this order.
 *
 *   frame     ordered   the cells' frame, and memory for all of it; coefficient[0] is the radius
 *   find      free      each particle's cell
 *   rank      ordered   each particle's place: a counting sort
 *   scatter   free      records to their places: the only one that jumps about in memory
 *   spread    free      positions and directions of flight, sixteen at a time; its elements are places
 *
 * The elements of the others are the user's particles. */
#ifndef SK_PLAN_SORT_H
#define SK_PLAN_SORT_H

#include "plan/row.h"

enum { SK_SORT_ROWS = 5 };

typedef struct sk_sort_row {
    sk_kernels kernels;
    sk_order order;
    bool by_place;
    const char *label;
} sk_sort_row;

extern const sk_sort_row sk_sort_rows[SK_SORT_ROWS];

#endif
