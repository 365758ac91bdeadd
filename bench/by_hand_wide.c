/* The same by hand, sixteen elements at a time, in the library's own arithmetic: what a tape could be at best. */
#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "bench/wide_vectors.h"

SK_INLINE sk_wide3 SK_ISA(at)(const by_hand_input *in, int particle, size_t e) {
    sk_wide4 p = SK_ISA(sk_gather)((const sk_vec4 *)(const void *)in->positions, in->slot[particle] + e);
    return (sk_wide3){p.x, p.y, p.z};
}
SK_INLINE sk_wide SK_ISA(parameter)(const by_hand_input *in, int k, size_t e) {
    sk_wide x;
    memcpy(&x, in->parameter[k] + e, sizeof x);
    return x;
}
SK_INLINE void SK_ISA(put)(const by_hand_input *in, int output, size_t e, sk_wide x) {
    memcpy(in->output + (size_t)output * in->stride + e, &x, sizeof x);
}
SK_INLINE void SK_ISA(give_all)(const by_hand_input *in, size_t e, const sk_wide3 *g, int others) {
    sk_wide3 first = {{0}, {0}, {0}};
    for (int k = 0; k <= others; k++) {
        sk_wide3 out = k < others ? g[k] : first;
        int at = k < others ? 1 + 3 * (k + 1) : 1;
        SK_ISA(put)(in, at, e, out.x);
        SK_ISA(put)(in, at + 1, e, out.y);
        SK_ISA(put)(in, at + 2, e, out.z);
        if (k < others) first = SK_ISA(minus)(first, g[k]);
    }
}
static void SK_ISA(distance)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_LANES) {
        sk_wide3 d = SK_ISA(minus)(SK_ISA(at)(in, 1, e), SK_ISA(at)(in, 0, e));
        sk_wide length = SK_ISA(sk_wide_sqrt)(SK_ISA(sk_dot_wide)(d, d));
        SK_ISA(put)(in, 0, e, length - SK_ISA(parameter)(in, 0, e));
        sk_wide3 g = SK_ISA(scale)(SK_ISA(over)(length), d);
        SK_ISA(give_all)(in, e, &g, 1);
    }
}

static void SK_ISA(dihedral)(const by_hand_input *in) {
    for (size_t i = 0; i < in->count; i += SK_LANES) {
        sk_wide3 p0 = SK_ISA(at)(in, 0, i), e = SK_ISA(minus)(SK_ISA(at)(in, 1, i), p0);
        sk_wide3 a = SK_ISA(minus)(SK_ISA(at)(in, 2, i), p0), b = SK_ISA(minus)(SK_ISA(at)(in, 3, i), p0);
        sk_wide3 left = SK_ISA(cross)(e, a), right = SK_ISA(cross)(b, e);
        sk_wide ee = SK_ISA(sk_dot_wide)(e, e), length = SK_ISA(sk_wide_sqrt)(ee), over = SK_ISA(over)(ee);
        sk_wide3 g2 = SK_ISA(scale)(length * SK_ISA(over)(SK_ISA(sk_dot_wide)(left, left)), left);
        sk_wide3 g3 = SK_ISA(scale)(length * SK_ISA(over)(SK_ISA(sk_dot_wide)(right, right)), right);
        sk_wide s2 = SK_ISA(sk_dot_wide)(a, e) * over, s3 = SK_ISA(sk_dot_wide)(b, e) * over;
        sk_wide angle = SK_ISA(sk_wide_atan2)(length * SK_ISA(sk_dot_wide)(left, b), SK_ISA(sk_dot_wide)(left, right));
        SK_ISA(put)(in, 0, i, angle - SK_ISA(parameter)(in, 0, i));
        const sk_wide3 g[3] = {SK_ISA(sum)(-s2, g2, -s3, g3), g2, g3};
        SK_ISA(give_all)(in, i, g, 3);
    }
}

static void SK_ISA(volume)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_LANES) {
        sk_wide3 p0 = SK_ISA(at)(in, 0, e), a = SK_ISA(minus)(SK_ISA(at)(in, 1, e), p0);
        sk_wide3 b = SK_ISA(minus)(SK_ISA(at)(in, 2, e), p0), c = SK_ISA(minus)(SK_ISA(at)(in, 3, e), p0);
        sk_wide sixth = SK_ISA(sk_splat)((real)(1.0 / 6));
        sk_wide3 ab = SK_ISA(cross)(a, b);
        SK_ISA(put)(in, 0, e, sixth * SK_ISA(sk_dot_wide)(ab, c) - SK_ISA(parameter)(in, 0, e));
        const sk_wide3 g[3] = {SK_ISA(scale)(sixth, SK_ISA(cross)(b, c)), SK_ISA(scale)(sixth, SK_ISA(cross)(c, a)),
                               SK_ISA(scale)(sixth, ab)};
        SK_ISA(give_all)(in, e, g, 3);
    }
}

static void SK_ISA(neo_hookean)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_LANES) {
        sk_wide3 p0 = SK_ISA(at)(in, 0, e), edge[3], f[3], p[3], g[3];
        sk_wide d[3][3], one = SK_ISA(sk_splat)(1), half = SK_ISA(sk_splat)((real)0.5);
        for (int i = 0; i < 9; i++) d[i / 3][i % 3] = SK_ISA(parameter)(in, i, e);
        for (int i = 0; i < 3; i++) edge[i] = SK_ISA(minus)(SK_ISA(at)(in, i + 1, e), p0);
        for (int j = 0; j < 3; j++)
            f[j] = SK_ISA(sum)(one, SK_ISA(sum)(d[0][j], edge[0], d[1][j], edge[1]), d[2][j], edge[2]);
        sk_wide3 c[3] = {SK_ISA(cross)(f[1], f[2]), SK_ISA(cross)(f[2], f[0]), SK_ISA(cross)(f[0], f[1])};
        sk_wide squares =
            SK_ISA(sk_dot_wide)(f[0], f[0]) + SK_ISA(sk_dot_wide)(f[1], f[1]) + SK_ISA(sk_dot_wide)(f[2], f[2]);
        sk_wide j = SK_ISA(sk_dot_wide)(f[0], c[0]) - SK_ISA(sk_splat)((real)1.25), v = SK_ISA(parameter)(in, 9, e);
        sk_wide energy = half * (squares - 3 * one) + 3 * half * j * j - half * SK_ISA(sk_wide_log)(squares + one);
        SK_ISA(put)(in, 0, e, v * energy);
        for (int k = 0; k < 3; k++) p[k] = SK_ISA(sum)(v * (one - SK_ISA(over)(squares + one)), f[k], 3 * v * j, c[k]);
        for (int i = 0; i < 3; i++) g[i] = SK_ISA(sum)(one, SK_ISA(sum)(d[i][0], p[0], d[i][1], p[1]), d[i][2], p[2]);
        SK_ISA(give_all)(in, e, g, 3);
    }
}

static void SK_ISA(stvk)(const by_hand_input *in) {
    for (size_t e = 0; e < in->count; e += SK_LANES) {
        sk_wide3 p0 = SK_ISA(at)(in, 0, e), a = SK_ISA(minus)(SK_ISA(at)(in, 1, e), p0);
        sk_wide3 b = SK_ISA(minus)(SK_ISA(at)(in, 2, e), p0);
        sk_wide d0 = SK_ISA(parameter)(in, 0, e), d1 = SK_ISA(parameter)(in, 1, e), d2 = SK_ISA(parameter)(in, 2, e);
        sk_wide d3 = SK_ISA(parameter)(in, 3, e), area = SK_ISA(parameter)(in, 4, e), one = SK_ISA(sk_splat)(1);
        sk_wide3 f = SK_ISA(sum)(d0, a, d2, b), g = SK_ISA(sum)(d1, a, d3, b);
        sk_wide half = SK_ISA(sk_splat)((real)0.5), x = half * (SK_ISA(sk_dot_wide)(f, f) - one);
        sk_wide y = half * (SK_ISA(sk_dot_wide)(g, g) - one), z = half * SK_ISA(sk_dot_wide)(f, g), trace = x + y;
        SK_ISA(put)(in, 0, e, area * (x * x + y * y + 2 * z * z + 3 * half * trace * trace));
        sk_wide mixed = 2 * area * z;
        sk_wide3 pf = SK_ISA(sum)(area * (2 * x + 3 * trace), f, mixed, g);
        sk_wide3 pg = SK_ISA(sum)(mixed, f, area * (2 * y + 3 * trace), g);
        const sk_wide3 grad[2] = {SK_ISA(sum)(d0, pf, d1, pg), SK_ISA(sum)(d2, pf, d3, pg)};
        SK_ISA(give_all)(in, e, grad, 2);
    }
}

#else

#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_KERNELS "bench/by_hand_wide.c"
#include "base/for_each_isa.h"

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
