/* Vectors and 4 x 4 matrices for drawing, in double until the moment they go to the card.
 *
 * Used by camera.c, light.c and draw.c. Matrices are stored by columns, as OpenGL reads them:
 * entry (row r, column c) is m[4 c + r], and a point is a column on the right. */
#ifndef SKEIN_RENDER_LINEAR_H
#define SKEIN_RENDER_LINEAR_H

#include <math.h>

static inline double render_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void render_cross(const double a[3], const double b[3], double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

/* Scales to length 1; a vector without a direction becomes y. */
static inline void render_normalise(double v[3]) {
    double length = sqrt(render_dot(v, v));
    if (length > 1e-300 && isfinite(length)) {
        v[0] /= length, v[1] /= length, v[2] /= length;
    } else {
        v[0] = 0, v[1] = 1, v[2] = 0;
    }
}

/* Two unit vectors across `axis` (of length 1), so that right x up = axis; up leans towards y. */
static inline void render_basis(const double axis[3], double right[3], double up[3]) {
    static const double y[3] = {0, 1, 0}, z[3] = {0, 0, -1};
    render_cross(fabs(axis[1]) < 0.999 ? y : z, axis, right);
    render_normalise(right);
    render_cross(axis, right, up);
}

/* A vector and one number more, as uniforms take them. */
static inline void render_store(const double v[3], double w, float out[4]) {
    for (int i = 0; i < 3; i++) out[i] = (float)v[i];
    out[3] = (float)w;
}

/* out = a b; out may be neither of them. */
static inline void render_multiply(const double a[16], const double b[16], double out[16]) {
    for (int c = 0; c < 4; c++) {
        for (int r = 0; r < 4; r++) {
            double sum = 0;
            for (int k = 0; k < 4; k++) sum += a[4 * k + r] * b[4 * c + k];
            out[4 * c + r] = sum;
        }
    }
}

/* The matrix that turns world points into coordinates along three unit axes about `origin`. */
static inline void render_look_along(const double right[3], const double up[3], const double back[3],
                                     const double origin[3], double out[16]) {
    const double *axis[3] = {right, up, back};
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++) out[4 * c + r] = axis[r][c];
        out[12 + r] = -render_dot(axis[r], origin);
    }
    out[3] = out[7] = out[11] = 0;
    out[15] = 1;
}

#endif
