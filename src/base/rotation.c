#include "base/rotation.h"

#include <math.h>

#include "base/elementary.h"

void sk_sincos_degrees(double degrees, double *sine, double *cosine) {
    double turn = fmod(degrees, 360);
    if (turn < 0) turn += 360;
    static const double quarter_sine[] = {0, 1, 0, -1};
    for (int q = 0; q < 4; q++)
        if (turn == 90.0 * q) {
            *sine = quarter_sine[q];
            *cosine = quarter_sine[(q + 1) % 4];
            return;
        }
    sk_sincos(turn * 0.017453292519943295, sine, cosine);
}

void sk_rotation_of_degrees(const double degrees[3], double matrix[9]) {
    double s[3], c[3];
    for (int k = 0; k < 3; k++) sk_sincos_degrees(degrees[k], &s[k], &c[k]);
    matrix[0] = c[2] * c[1], matrix[1] = c[2] * s[1] * s[0] - s[2] * c[0], matrix[2] = c[2] * s[1] * c[0] + s[2] * s[0];
    matrix[3] = s[2] * c[1], matrix[4] = s[2] * s[1] * s[0] + c[2] * c[0], matrix[5] = s[2] * s[1] * c[0] - c[2] * s[0];
    matrix[6] = -s[1], matrix[7] = c[1] * s[0], matrix[8] = c[1] * c[0];
}
