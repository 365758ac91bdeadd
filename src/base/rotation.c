/* Rotations as degrees, matrices, and angle and axis, and conversions between them; right angles are exact. */
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

void sk_rotation_about(const double u[3], double angle, double matrix[9]) {
    double s, c;
    sk_sincos(angle, &s, &c); // Rodrigues
    double d = 1 - c;
    matrix[0] = c + u[0] * u[0] * d, matrix[1] = u[0] * u[1] * d - u[2] * s, matrix[2] = u[0] * u[2] * d + u[1] * s;
    matrix[3] = u[1] * u[0] * d + u[2] * s, matrix[4] = c + u[1] * u[1] * d, matrix[5] = u[1] * u[2] * d - u[0] * s;
    matrix[6] = u[2] * u[0] * d - u[1] * s, matrix[7] = u[2] * u[1] * d + u[0] * s, matrix[8] = c + u[2] * u[2] * d;
}

/* Makes a direction of `v`, or takes y where it has no length. */
static double normalise(const double v[3], double unit[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; k++) unit[k] = length > 0 ? v[k] / length : k == 1;
    return length;
}

double sk_rotation_from_to(const double from[9], const double to[9], double unit[3]) {
    double r[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            r[3 * i + j] = from[3 * i] * to[3 * j] + from[3 * i + 1] * to[3 * j + 1] + from[3 * i + 2] * to[3 * j + 2];
    double twice[3] = {r[7] - r[5], r[2] - r[6], r[3] - r[1]}, cosine = 0.5 * (r[0] + r[4] + r[8] - 1);
    double sine = 0.5 * normalise(twice, unit);
    if (sine < 1e-6 && cosine < 0) { // half a turn: R = 2 u u^T - 1
        int k = r[0] > r[4] ? r[0] > r[8] ? 0 : 2 : r[4] > r[8] ? 1 : 2;
        double column[3] = {r[k], r[3 + k], r[6 + k]};
        column[k] += 1;
        normalise(column, unit);
    }
    return sk_atan2(sine, cosine);
}

double sk_rotation_of_directions(const double from[3], const double to[3], double unit[3]) {
    double cross[3] = {to[1] * from[2] - to[2] * from[1], to[2] * from[0] - to[0] * from[2],
                       to[0] * from[1] - to[1] * from[0]};
    double cosine = from[0] * to[0] + from[1] * to[1] + from[2] * to[2], sine = normalise(cross, unit);
    if (sine < 1e-6 && cosine < 0) { // opposite directions: any axis across them
        int k = fabs(to[0]) < 0.6 ? 0 : 1;
        double across[3] = {-to[k] * to[0], -to[k] * to[1], -to[k] * to[2]};
        across[k] += 1;
        normalise(across, unit);
    }
    return sk_atan2(sine, cosine);
}
