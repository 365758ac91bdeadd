/* Turns given in degrees, as fields give them: about x, then y, then z. */
#ifndef SK_BASE_ROTATION_H
#define SK_BASE_ROTATION_H

/* Sine and cosine of an angle in degrees, exact at the quarter turns that scenes ask for most. */
void sk_sincos_degrees(double degrees, double *sine, double *cosine);
/* Rows of the matrix of the three turns. */
void sk_rotation_of_degrees(const double degrees[3], double matrix[9]);

#endif
