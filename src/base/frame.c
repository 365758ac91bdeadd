/* Rigid maps of space: composed, inverted, interpolated, and fitted to points. */
#include "base/frame.h"

#include <math.h>
#include <string.h>

#include "base/elementary.h"
#include "base/rotation.h"

void sk_frame_turn(const sk_frame *frame, const double v[3], double out[3]) {
    const double *r = frame->turn, x = v[0], y = v[1], z = v[2];
    for (int k = 0; k < 3; k++) out[k] = r[3 * k] * x + r[3 * k + 1] * y + r[3 * k + 2] * z;
}

void sk_frame_place(const sk_frame *frame, const double x[3], double out[3]) {
    sk_frame_turn(frame, x, out);
    for (int k = 0; k < 3; k++) out[k] += frame->shift[k];
}

sk_frame sk_frame_then(const sk_frame *first, const sk_frame *second) {
    const double *a = second->turn, *b = first->turn;
    sk_frame both;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            both.turn[3 * r + c] = a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c];
    sk_frame_place(second, first->shift, both.shift);
    return both;
}

sk_frame sk_frame_back(const sk_frame *frame) {
    sk_frame back;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) back.turn[3 * r + c] = frame->turn[3 * c + r];
    sk_frame_turn(&back, frame->shift, back.shift);
    for (int k = 0; k < 3; k++) back.shift[k] = -back.shift[k];
    return back;
}

double sk_frame_angle(const sk_frame *frame) {
    const sk_frame none = SK_NO_FRAME;
    double unit[3];
    return sk_rotation_from_to(frame->turn, none.turn, unit);
}

/* sin(x)/x */
static double sinc(double x) {
    double s, c;
    if (fabs(x) < 1e-4) return 1 - x * x / 6;
    sk_sincos(x, &s, &c);
    return s / x;
}

/* A screw motion about the axis u by the angle a moves along u by that part of the shift. In the plane across u, with
 * complex numbers, the shift is an integral over turns: w a sinc(a/2) exp(i a/2), where w is the same for all shares.
 * So the shift of a share s is s sinc(s a/2)/sinc(a/2) exp(i (s - 1) a/2) times the whole one, also if a is 0. */
sk_frame sk_frame_share(const sk_frame *frame, double share) {
    const sk_frame none = SK_NO_FRAME;
    if (!(share > 0)) return none;
    if (share >= 1) return *frame;
    sk_frame part;
    double u[3], angle = sk_rotation_from_to(frame->turn, none.turn, u);
    sk_rotation_about(u, share * angle, part.turn);
    const double *t = frame->shift;
    double along = u[0] * t[0] + u[1] * t[1] + u[2] * t[2], s, c;
    double across[3] = {t[0] - along * u[0], t[1] - along * u[1], t[2] - along * u[2]};
    double aside[3] = {u[1] * across[2] - u[2] * across[1], u[2] * across[0] - u[0] * across[2],
                       u[0] * across[1] - u[1] * across[0]};
    sk_sincos(0.5 * (share - 1) * angle, &s, &c);
    double scale = share * sinc(0.5 * share * angle) / sinc(0.5 * angle);
    for (int k = 0; k < 3; k++) part.shift[k] = share * along * u[k] + scale * (c * across[k] + s * aside[k]);
    return part;
}

/* ---- fitting a frame to points ---- */

/* A Jacobi rotation of a symmetric matrix, after which a[p][q] is 0, and of the eigenvectors. */
static void clear(double a[4][4], double v[4][4], int p, int q) {
    if (!(fabs(a[p][q]) > 0)) return;
    double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
    double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 4; k++) {
        double x = a[k][p], y = a[k][q];
        a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
    }
    for (int k = 0; k < 4; k++) {
        double x = a[p][k], y = a[q][k];
        a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
    }
    for (int k = 0; k < 4; k++) {
        double x = v[k][p], y = v[k][q];
        v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
    }
}

/* The quaternion of the best rotation. Of several equally good ones (all points on a line, or in one place) it is the
 * one with the least angle: the projection of the quaternion 1 onto their eigenvectors. */
static void best_quaternion(double a[4][4], double q[4]) {
    enum { ROUNDS = 12 };
    double v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, most, size = 0, length = 0;
    for (int round = 0; round < ROUNDS; round++)
        for (int p = 0; p < 4; p++)
            for (int r = p + 1; r < 4; r++) clear(a, v, p, r);
    most = a[0][0];
    for (int i = 0; i < 4; i++) most = fmax(most, a[i][i]), size = fmax(size, fabs(a[i][i]));
    memset(q, 0, 4 * sizeof *q);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4 && a[i][i] >= most - 1e-9 * size; k++) q[k] += v[0][i] * v[k][i];
    for (int k = 0; k < 4; k++) length += q[k] * q[k];
    for (int i = 0; i < 4 && !(length > 1e-12); i++) { // half a turn: all are at right angles to 1
        if (a[i][i] < most) continue;
        for (int k = 0; k < 4; k++) q[k] = v[k][i];
        length = 1;
    }
    for (int k = 0; k < 4; k++) q[k] /= sqrt(length);
}

/* Horn 1987: the quaternion is the eigenvector to the largest eigenvalue of a matrix of the sums of products. */
sk_frame sk_frame_fit(size_t count, const double (*from)[3], const double (*to)[3]) {
    sk_frame frame = SK_NO_FRAME;
    double a[3] = {0, 0, 0}, b[3] = {0, 0, 0}, m[3][3] = {{0}}, q[4];
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) a[k] += from[i][k] / (double)count, b[k] += to[i][k] / (double)count;
    for (size_t i = 0; i < count; i++)
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++) m[r][c] += (from[i][r] - a[r]) * (to[i][c] - b[c]);
    double n[4][4] = {{m[0][0] + m[1][1] + m[2][2], m[1][2] - m[2][1], m[2][0] - m[0][2], m[0][1] - m[1][0]},
                      {m[1][2] - m[2][1], m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[2][0] + m[0][2]},
                      {m[2][0] - m[0][2], m[0][1] + m[1][0], m[1][1] - m[0][0] - m[2][2], m[1][2] + m[2][1]},
                      {m[0][1] - m[1][0], m[2][0] + m[0][2], m[1][2] + m[2][1], m[2][2] - m[0][0] - m[1][1]}};
    best_quaternion(n, q);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double turn[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                            2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                            2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
    memcpy(frame.turn, turn, sizeof turn);
    sk_frame_turn(&frame, a, frame.shift);
    for (int k = 0; k < 3; k++) frame.shift[k] = b[k] - frame.shift[k];
    return frame;
}

bool sk_is_turn(const double turn[9]) {
    double worst = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
            double dot = 0;
            for (int k = 0; k < 3; k++) dot += turn[3 * r + k] * turn[3 * c + k];
            worst = fmax(worst, fabs(dot - (r == c)));
        }
    const double *t = turn;
    double volume =
        t[0] * (t[4] * t[8] - t[5] * t[7]) - t[1] * (t[3] * t[8] - t[5] * t[6]) + t[2] * (t[3] * t[7] - t[4] * t[6]);
    return worst < 1e-6 && volume > 0;
}
