/* Frames: rigid maps of space, x to turn x + shift, where the matrix `turn` is a rotation. In double. */
#ifndef SK_BASE_FRAME_H
#define SK_BASE_FRAME_H

#include <stdbool.h>
#include <stddef.h>

typedef struct sk_frame {
    double turn[9], shift[3]; /* the matrix by rows */
} sk_frame;

#define SK_NO_FRAME ((sk_frame){{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}})

void sk_frame_turn(const sk_frame *frame, const double v[3], double out[3]);
void sk_frame_place(const sk_frame *frame, const double x[3], double out[3]);
/* The map that applies `first`, then `second`; and the inverse of a map. */
sk_frame sk_frame_then(const sk_frame *first, const sk_frame *second);
sk_frame sk_frame_back(const sk_frame *frame);
/* A share of a map along its screw motion: 0 is the identity, 1 the map itself, and shares that add up to 1, applied
 * one after the other, are the map. Half a turn has two such motions; one of them is taken. */
sk_frame sk_frame_share(const sk_frame *frame, double share);
/* The angle of its rotation, rad, 0 to pi. */
double sk_frame_angle(const sk_frame *frame);
/* The frame that best maps `count` points `from` to the points `to`, in the sum of squares; of several, the one with
 * the least rotation. */
sk_frame sk_frame_fit(size_t count, const double (*from)[3], const double (*to)[3]);
/* Whether the matrix is a rotation, but for rounding. */
bool sk_is_turn(const double turn[9]);

#endif
