/* Values, gradients and second derivatives as one would write them by hand in C. */
#include "bench/by_hand.h"

#include <math.h>

typedef skein_real real;
typedef struct vec {
    real x, y, z;
} vec;

#ifdef SKEIN_DOUBLE
#define SQRT sqrt
#define ATAN2 atan2
#define LOG log
#else
#define SQRT sqrtf
#define ATAN2 atan2f
#define LOG logf
#endif

static inline vec at(const by_hand_input *in, int particle, size_t e) {
    const real *p = in->positions + 4 * (size_t)in->slot[particle][e];
    return (vec){p[0], p[1], p[2]};
}
static inline vec minus(vec a, vec b) {
    return (vec){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline vec sum(real s, vec a, real t, vec b) {
    return (vec){s * a.x + t * b.x, s * a.y + t * b.y, s * a.z + t * b.z};
}
static inline real dot(vec a, vec b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline vec cross(vec a, vec b) {
    return (vec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline vec scale(real s, vec a) {
    return (vec){s * a.x, s * a.y, s * a.z};
}
static inline void give(const by_hand_input *in, int particle, size_t e, vec g) {
    real *out = in->output + (1 + 3 * (size_t)particle) * in->stride + e;
    out[0] = g.x, out[in->stride] = g.y, out[2 * in->stride] = g.z;
}

/* The first particle's is what is left of none, since moving all changes nothing. */
static inline void give_all(const by_hand_input *in, size_t e, const vec *g, int others) {
    vec first = {0, 0, 0};
    for (int k = 0; k < others; k++) {
        give(in, k + 1, e, g[k]);
        first = minus(first, g[k]);
    }
    give(in, 0, e, first);
}

void by_hand_distance(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e++) {
        vec d = minus(at(in, 1, e), at(in, 0, e));
        real length = SQRT(dot(d, d)), over = length > 0 ? 1 / length : 0;
        in->output[e] = length - in->parameter[0][e];
        vec g = scale(over, d);
        give_all(in, e, &g, 1);
    }
}

void by_hand_dihedral(const by_hand_input *in) {
    for (size_t i = 0; i < in->count; i++) {
        vec p0 = at(in, 0, i), e = minus(at(in, 1, i), p0), a = minus(at(in, 2, i), p0), b = minus(at(in, 3, i), p0);
        vec left = cross(e, a), right = cross(b, e);
        real ee = dot(e, e), length = SQRT(ee), ll = dot(left, left), rr = dot(right, right);
        vec g2 = scale(ll > 0 ? length / ll : 0, left), g3 = scale(rr > 0 ? length / rr : 0, right);
        real over = ee > 0 ? 1 / ee : 0, s2 = dot(a, e) * over, s3 = dot(b, e) * over;
        in->output[i] = ATAN2(length * dot(left, b), dot(left, right)) - in->parameter[0][i];
        const vec g[3] = {sum(-s2, g2, -s3, g3), g2, g3};
        give_all(in, i, g, 3);
    }
}

void by_hand_volume(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e++) {
        vec p0 = at(in, 0, e), a = minus(at(in, 1, e), p0), b = minus(at(in, 2, e), p0), c = minus(at(in, 3, e), p0);
        const real sixth = (real)(1.0 / 6);
        vec ab = cross(a, b);
        in->output[e] = sixth * dot(ab, c) - in->parameter[0][e];
        const vec g[3] = {scale(sixth, cross(b, c)), scale(sixth, cross(c, a)), scale(sixth, ab)};
        give_all(in, e, g, 3);
    }
}

/* F = edges D; P = dE/dF; the gradient by p(i+1) is the sum of P's columns times row i of D. */
void by_hand_neo_hookean(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e++) {
        vec p0 = at(in, 0, e), edge[3], f[3], p[3], g[3];
        real d[3][3];
        for (int i = 0; i < 9; i++) d[i / 3][i % 3] = in->parameter[i][e];
        for (int i = 0; i < 3; i++) edge[i] = minus(at(in, i + 1, e), p0);
        for (int j = 0; j < 3; j++) f[j] = sum(1, sum(d[0][j], edge[0], d[1][j], edge[1]), d[2][j], edge[2]);
        vec c[3] = {cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])};
        real squares = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]), j = dot(f[0], c[0]),
             v = in->parameter[9][e];
        const real rest = (real)1.25;
        in->output[e] =
            v * ((real)0.5 * (squares - 3) + (real)1.5 * (j - rest) * (j - rest) - (real)0.5 * LOG(squares + 1));
        for (int k = 0; k < 3; k++) p[k] = sum(v * (1 - 1 / (squares + 1)), f[k], 3 * v * (j - rest), c[k]);
        for (int i = 0; i < 3; i++) g[i] = sum(1, sum(d[i][0], p[0], d[i][1], p[1]), d[i][2], p[2]);
        give_all(in, e, g, 3);
    }
}

void by_hand_stvk(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e++) {
        vec p0 = at(in, 0, e), a = minus(at(in, 1, e), p0), b = minus(at(in, 2, e), p0);
        real d0 = in->parameter[0][e], d1 = in->parameter[1][e], d2 = in->parameter[2][e], d3 = in->parameter[3][e];
        real area = in->parameter[4][e];
        vec f = sum(d0, a, d2, b), g = sum(d1, a, d3, b);
        real x = (real)0.5 * (dot(f, f) - 1), y = (real)0.5 * (dot(g, g) - 1), z = (real)0.5 * dot(f, g), trace = x + y;
        in->output[e] = area * (x * x + y * y + 2 * z * z + (real)1.5 * trace * trace);
        vec pf = sum(area * (2 * x + 3 * trace), f, 2 * area * z, g),
            pg = sum(2 * area * z, f, area * (2 * y + 3 * trace), g);
        const vec grad[2] = {sum(d0, pf, d1, pg), sum(d2, pf, d3, pg)};
        give_all(in, e, grad, 2);
    }
}
