/* Rotations: by degrees about x, then y, then z, as in fields; and by an angle about an axis. */
#ifndef SK_BASE_ROTATION_H
#define SK_BASE_ROTATION_H

/* Sine and cosine of an angle in degrees, exact at quarter turns. */
void sk_sincos_degrees(double degrees, double *sine, double *cosine);
/* Rows of the matrix of the three turns. */
void sk_rotation_of_degrees(const double degrees[3], double matrix[9]);
/* Rows of the matrix of a turn by `angle` (radians) about a unit axis. */
void sk_rotation_about(const double unit[3], double angle, double matrix[9]);
/* The angle (0 to pi) and the unit axis of the rotation that, applied after `to`, gives `from`. If the angle is 0 the
 * axis is y. */
double sk_rotation_from_to(const double from[9], const double to[9], double unit[3]);
/* The same for the least turn that takes the unit direction `to` to `from`. */
double sk_rotation_of_directions(const double from[3], const double to[3], double unit[3]);

#endif
