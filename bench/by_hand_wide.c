/* The same by hand, sixteen elements at a time, in the library's own arithmetic: what a tape could be at best. */
#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/polynomial.h"

#define SK_UNIT bench_by_hand_wide
SK_KERNELS(by_hand_function, distance);
SK_KERNELS(by_hand_function, dihedral);
SK_KERNELS(by_hand_function, volume);
SK_KERNELS(by_hand_function, neo_hookean);
SK_KERNELS(by_hand_function, stvk);

#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "bench/wide_vectors.h"

SK_INLINE sk_wide3 at(const by_hand_input *in, int particle, size_t e) {
    sk_wide4 p = sk_gather((const sk_vec4 *)(const void *)in->positions, in->slot[particle] + e);
    return (sk_wide3){p.x, p.y, p.z};
}
SK_INLINE sk_wide parameter_at(const by_hand_input *in, int k, size_t e) {
    sk_wide x;
    memcpy(&x, in->parameter[k] + e, sizeof x);
    return x;
}
SK_INLINE void put_entry(const by_hand_input *in, int output, size_t e, sk_wide x) {
    memcpy(in->output + (size_t)output * in->stride + e, &x, sizeof x);
}
SK_INLINE void give_all(const by_hand_input *in, size_t e, const sk_wide3 *g, int others) {
    sk_wide3 first = {{0}, {0}, {0}};
    for (int k = 0; k <= others; k++) {
        sk_wide3 out = k < others ? g[k] : first;
        int at = k < others ? 1 + 3 * (k + 1) : 1;
        put_entry(in, at, e, out.x);
        put_entry(in, at + 1, e, out.y);
        put_entry(in, at + 2, e, out.z);
        if (k < others) first = minus(first, g[k]);
    }
}
void SK_KERNEL(distance)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_PART) {
        sk_wide3 d = minus(at(in, 1, e), at(in, 0, e));
        sk_wide length = sk_wide_sqrt(sk_dot_wide(d, d));
        put_entry(in, 0, e, length - parameter_at(in, 0, e));
        sk_wide3 g = scale(inverse_of(length), d);
        give_all(in, e, &g, 1);
    }
}

void SK_KERNEL(dihedral)(const by_hand_input *in) {
    for (size_t i = 0; i < in->count; i += SK_PART) {
        sk_wide3 p0 = at(in, 0, i), e = minus(at(in, 1, i), p0);
        sk_wide3 a = minus(at(in, 2, i), p0), b = minus(at(in, 3, i), p0);
        sk_wide3 left = cross(e, a), right = cross(b, e);
        sk_wide ee = sk_dot_wide(e, e), length = sk_wide_sqrt(ee), over = inverse_of(ee);
        sk_wide3 g2 = scale(length * inverse_of(sk_dot_wide(left, left)), left);
        sk_wide3 g3 = scale(length * inverse_of(sk_dot_wide(right, right)), right);
        sk_wide s2 = sk_dot_wide(a, e) * over, s3 = sk_dot_wide(b, e) * over;
        sk_wide angle = sk_wide_atan2(length * sk_dot_wide(left, b), sk_dot_wide(left, right));
        put_entry(in, 0, i, angle - parameter_at(in, 0, i));
        const sk_wide3 g[3] = {weighted_sum(-s2, g2, -s3, g3), g2, g3};
        give_all(in, i, g, 3);
    }
}

void SK_KERNEL(volume)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_PART) {
        sk_wide3 p0 = at(in, 0, e), a = minus(at(in, 1, e), p0);
        sk_wide3 b = minus(at(in, 2, e), p0), c = minus(at(in, 3, e), p0);
        sk_wide sixth = sk_splat((real)(1.0 / 6));
        sk_wide3 ab = cross(a, b);
        put_entry(in, 0, e, sixth * sk_dot_wide(ab, c) - parameter_at(in, 0, e));
        const sk_wide3 g[3] = {scale(sixth, cross(b, c)), scale(sixth, cross(c, a)), scale(sixth, ab)};
        give_all(in, e, g, 3);
    }
}

void SK_KERNEL(neo_hookean)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_PART) {
        sk_wide3 p0 = at(in, 0, e), edge[3], f[3], p[3], g[3];
        sk_wide d[3][3], one = sk_splat(1), half = sk_splat((real)0.5);
        for (int i = 0; i < 9; i++) d[i / 3][i % 3] = parameter_at(in, i, e);
        for (int i = 0; i < 3; i++) edge[i] = minus(at(in, i + 1, e), p0);
        for (int j = 0; j < 3; j++)
            f[j] = weighted_sum(one, weighted_sum(d[0][j], edge[0], d[1][j], edge[1]), d[2][j], edge[2]);
        sk_wide3 c[3] = {cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])};
        sk_wide squares = sk_dot_wide(f[0], f[0]) + sk_dot_wide(f[1], f[1]) + sk_dot_wide(f[2], f[2]);
        sk_wide j = sk_dot_wide(f[0], c[0]) - sk_splat((real)1.25), v = parameter_at(in, 9, e);
        sk_wide energy = half * (squares - 3 * one) + 3 * half * j * j - half * sk_wide_log(squares + one);
        put_entry(in, 0, e, v * energy);
        for (int k = 0; k < 3; k++) p[k] = weighted_sum(v * (one - inverse_of(squares + one)), f[k], 3 * v * j, c[k]);
        for (int i = 0; i < 3; i++) g[i] = weighted_sum(one, weighted_sum(d[i][0], p[0], d[i][1], p[1]), d[i][2], p[2]);
        give_all(in, e, g, 3);
    }
}

void SK_KERNEL(stvk)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_PART) {
        sk_wide3 p0 = at(in, 0, e), a = minus(at(in, 1, e), p0);
        sk_wide3 b = minus(at(in, 2, e), p0);
        sk_wide d0 = parameter_at(in, 0, e), d1 = parameter_at(in, 1, e), d2 = parameter_at(in, 2, e);
        sk_wide d3 = parameter_at(in, 3, e), area = parameter_at(in, 4, e), one = sk_splat(1);
        sk_wide3 f = weighted_sum(d0, a, d2, b), g = weighted_sum(d1, a, d3, b);
        sk_wide half = sk_splat((real)0.5), x = half * (sk_dot_wide(f, f) - one);
        sk_wide y = half * (sk_dot_wide(g, g) - one), z = half * sk_dot_wide(f, g), trace = x + y;
        put_entry(in, 0, e, area * (x * x + y * y + 2 * z * z + 3 * half * trace * trace));
        sk_wide mixed = 2 * area * z;
        sk_wide3 pf = weighted_sum(area * (2 * x + 3 * trace), f, mixed, g);
        sk_wide3 pg = weighted_sum(mixed, f, area * (2 * y + 3 * trace), g);
        const sk_wide3 grad[2] = {weighted_sum(d0, pf, d1, pg), weighted_sum(d2, pf, d3, pg)};
        give_all(in, e, grad, 2);
    }
}

#else

/* The one for the instruction set that runs. */
#define KERNEL(name_)                                                   \
    void by_hand_wide_##name_(const by_hand_input *in) {                \
        static by_hand_function *const versions[] = SK_EACH_ISA(name_); \
        versions[sk_isa_choose()](in);                                  \
    }
KERNEL(distance)
KERNEL(dihedral)
KERNEL(volume)
KERNEL(neo_hookean)
KERNEL(stvk)

#endif
