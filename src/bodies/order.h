/* The order in which a cloth's springs are swept, and its particles lie in memory.
 *
 * Part of the answer, and of the speed. A mesh whose vertices are numbered row by row is a grid, whatever
 * file it came from, and so is one of quads that lie like a grid's (quads.h): its springs go direction by direction and
 * its particles lie in strips. Any other mesh goes outward from its pins: first the springs that lead outward, then those
 * that go round, each by distance; what was pulled last holds best; and so do its hinges. A mesh without pins has no
 * outward: a broad one goes along its longest axis instead, so that what is swept together lies together in memory and
 * threads can follow each other; the particles of any other stay as they are in its file, and its springs and hinges are
 * scattered.
 *
 * Springs are scattered because in files each shares a particle with the one before it. Only sixteen that share none
 * can be computed at once, and errors would be passed from each to the next (docs/design.md, "Hinges"). */
#ifndef SK_BODIES_ORDER_H
#define SK_BODIES_ORDER_H

#include "bodies/sheet.h"
#include "bodies/springs.h"

/* Rows and columns of a mesh that is numbered as a grid (a last row may be short); 0 and 0 if it is not. False
 * when there is no memory. */
bool sk_order_find_grid(const sk_sheet *sheet, const sk_springs *springs, uint32_t *rows, uint32_t *columns);
/* Sorts the springs of a grid by direction; place[particle] is its place in the grid, NULL: its own number. False
 * when there is no memory. */
bool sk_order_by_direction(sk_springs *springs, const uint32_t *place);
/* Whether a layer across the longest axis, as thick as an edge is long, has particles enough for groups to be full. */
bool sk_order_is_broad(const sk_springs *springs, const sk_sheet *sheet);
/* Sorts the springs outward from the pinned particles, or along the longest axis where there are none, twice, half of them each
 * time, and fills rank[particle] with its place. False when there is no memory. */
bool sk_order_outward(sk_springs *springs, const sk_sheet *sheet, const bool *pinned, uint32_t *rank);
/* Fills numbers[count] with an order of 0 to count - 1 in which neighbours are far apart, within windows of thousands. */
void sk_order_scatter(uint32_t *numbers, size_t count);
/* Puts the springs in an order in which neighbours share no particle. False when there is no memory. */
bool sk_order_scattered(sk_springs *springs);
/* Puts hinges in the order of their particles' ranks, or scatters them where `rank` is NULL; the array may become
 * another one. False when there is no memory. */
bool sk_order_hinges(sk_allocator *allocator, uint32_t (**corners)[4], size_t count, const uint32_t *rank);

#endif
