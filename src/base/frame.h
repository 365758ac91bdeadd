/* Frames: rigid maps of space, x to turn x + shift, with a turn of determinant 1. In double. */
#ifndef SK_BASE_FRAME_H
#define SK_BASE_FRAME_H

#include <stdbool.h>
#include <stddef.h>

typedef struct sk_frame {
    double turn[9], shift[3]; /* rows */
} sk_frame;

#define SK_NO_FRAME ((sk_frame){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}})

void sk_frame_turn(const sk_frame *frame, const double v[3], double out[3]);
void sk_frame_place(const sk_frame *frame, const double x[3], double out[3]);
/* The map that is `first`, then `second`. */
sk_frame sk_frame_then(const sk_frame *first, const sk_frame *second);
sk_frame sk_frame_back(const sk_frame *frame);
/* A share of a map, along the one screw that makes it: 0 leaves all where it is, 1 is the map itself, and shares that add up
 * to 1, one after the other, are the map. Half a turn has two such ways; one of them is taken. */
sk_frame sk_frame_share(const sk_frame *frame, double share);
/* How far it turns, rad, 0 to pi. */
double sk_frame_angle(const sk_frame *frame);
/* The frame that comes nearest to taking each of `count` places `from` to the one `to`, in the sum of squares; the least turn
 * where several do. */
sk_frame sk_frame_fit(size_t count, const double (*from)[3], const double (*to)[3]);
/* Whether the rows are those of a turn, but for rounding. */
bool sk_is_turn(const double turn[9]);

#endif
