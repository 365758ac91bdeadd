/* XPBD's projections by hand, sixteen at a time, gather to scatter, in the library's own arithmetic (no fused
 * operations, no estimates, the same guards) and over its groups: what an emitted kernel could be at best. */
#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "bench/wide_vectors.h"

SK_INLINE sk_wide SK_ISA(lanes)(const real *from, size_t group) {
    return *(const sk_wide *)(const void *)(from + group * SK_LANES);
}
SK_INLINE sk_wide4 SK_ISA(take)(const by_hand_sweep *s, size_t arity, size_t group, size_t particle) {
    return SK_ISA(sk_gather)((const sk_vec4 *)(const void *)s->positions,
                             s->slots + (group * arity + particle) * SK_LANES);
}
SK_INLINE sk_wide3 SK_ISA(between)(sk_wide4 from, sk_wide4 to) {
    return (sk_wide3){to.x - from.x, to.y - from.y, to.z - from.z};
}
/* Adds k g to a particle and puts it back. */
SK_INLINE void SK_ISA(move)(const by_hand_sweep *s, size_t arity, size_t group, size_t particle, sk_wide4 p, sk_wide k,
                            sk_wide3 g) {
    p.x += k * g.x, p.y += k * g.y, p.z += k * g.z;
    SK_ISA(sk_scatter)
    ((sk_vec4 *)(void *)s->positions, s->slots + (group * arity + particle) * SK_LANES, p);
}
/* w |g|^2 */
SK_INLINE sk_wide SK_ISA(heft)(sk_wide4 p, sk_wide3 g) {
    return p.w * SK_ISA(sk_dot_wide)(g, g);
}
/* The multiplier: -C over the weights and the compliance. */
SK_INLINE sk_wide SK_ISA(multiplier)(const by_hand_sweep *s, size_t group, sk_wide value, sk_wide weight) {
    sk_wide below = weight + SK_ISA(lanes)(s->compliance, group) * s->per_step;
    return SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), -value / below);
}

static void SK_ISA(distance)(const by_hand_sweep *s) {
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = SK_ISA(take)(s, 2, i, 0), p1 = SK_ISA(take)(s, 2, i, 1);
        sk_wide3 d = SK_ISA(between)(p0, p1);
        sk_wide length = SK_ISA(sk_wide_sqrt)(SK_ISA(sk_dot_wide)(d, d)), value = length - SK_ISA(lanes)(s->rest, i);
        sk_wide below = length * (p0.w + p1.w + SK_ISA(lanes)(s->compliance, i) * s->per_step);
        sk_wide k = SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), value / below);
        SK_ISA(move)(s, 2, i, 0, p0, k * p0.w, d);
        SK_ISA(move)(s, 2, i, 1, p1, -k * p1.w, d);
    }
}

/* The angle over the edge p0 p1; the gradients of its ends are shares of those of the corners. */
static void SK_ISA(dihedral)(const by_hand_sweep *s) {
    const sk_wide pi = SK_ISA(sk_splat)((real)3.14159265358979324), turn = pi + pi;
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = SK_ISA(take)(s, 4, i, 0), p1 = SK_ISA(take)(s, 4, i, 1);
        sk_wide4 p2 = SK_ISA(take)(s, 4, i, 2), p3 = SK_ISA(take)(s, 4, i, 3);
        sk_wide3 e = SK_ISA(between)(p0, p1), a = SK_ISA(between)(p0, p2), b = SK_ISA(between)(p0, p3);
        sk_wide3 left = SK_ISA(cross)(e, a), right = SK_ISA(cross)(b, e);
        sk_wide ee = SK_ISA(sk_dot_wide)(e, e), length = SK_ISA(sk_wide_sqrt)(ee), over = SK_ISA(over)(ee);
        sk_wide3 g2 = SK_ISA(scale)(length * SK_ISA(over)(SK_ISA(sk_dot_wide)(left, left)), left);
        sk_wide3 g3 = SK_ISA(scale)(length * SK_ISA(over)(SK_ISA(sk_dot_wide)(right, right)), right);
        sk_wide s2 = SK_ISA(sk_dot_wide)(a, e) * over, s3 = SK_ISA(sk_dot_wide)(b, e) * over;
        sk_wide3 g1 = SK_ISA(sum)(-s2, g2, -s3, g3), g0 = SK_ISA(sum)(s2 - 1, g2, s3 - 1, g3);
        sk_wide value = SK_ISA(sk_wide_atan2)(length * SK_ISA(sk_dot_wide)(left, b), SK_ISA(sk_dot_wide)(left, right));
        value -= SK_ISA(lanes)(s->rest, i);
        value -= SK_ISA(sk_keep)(SK_ISA(sk_more)(value, pi), turn);
        value += SK_ISA(sk_keep)(SK_ISA(sk_more)(-pi, value), turn);
        sk_wide weight = SK_ISA(heft)(p0, g0) + SK_ISA(heft)(p1, g1) + SK_ISA(heft)(p2, g2) + SK_ISA(heft)(p3, g3);
        sk_wide k = SK_ISA(multiplier)(s, i, value, weight);
        SK_ISA(move)(s, 4, i, 0, p0, k * p0.w, g0);
        SK_ISA(move)(s, 4, i, 1, p1, k * p1.w, g1);
        SK_ISA(move)(s, 4, i, 2, p2, k * p2.w, g2);
        SK_ISA(move)(s, 4, i, 3, p3, k * p3.w, g3);
    }
}

/* Six times the gradients are products of edges; the sixth comes in where they are put together. */
static void SK_ISA(volume)(const by_hand_sweep *s) {
    const sk_wide sixth = SK_ISA(sk_splat)((real)(1.0 / 6));
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = SK_ISA(take)(s, 4, i, 0), p1 = SK_ISA(take)(s, 4, i, 1);
        sk_wide4 p2 = SK_ISA(take)(s, 4, i, 2), p3 = SK_ISA(take)(s, 4, i, 3);
        sk_wide3 a = SK_ISA(between)(p0, p1), b = SK_ISA(between)(p0, p2), c = SK_ISA(between)(p0, p3);
        sk_wide3 g1 = SK_ISA(cross)(b, c), g2 = SK_ISA(cross)(c, a), g3 = SK_ISA(cross)(a, b);
        sk_wide3 g0 = {-g1.x - g2.x - g3.x, -g1.y - g2.y - g3.y, -g1.z - g2.z - g3.z};
        sk_wide value = sixth * SK_ISA(sk_dot_wide)(g3, c) - SK_ISA(lanes)(s->rest, i);
        sk_wide weight = SK_ISA(heft)(p0, g0) + SK_ISA(heft)(p1, g1) + SK_ISA(heft)(p2, g2) + SK_ISA(heft)(p3, g3);
        sk_wide k = sixth * SK_ISA(multiplier)(s, i, value, sixth * sixth * weight);
        SK_ISA(move)(s, 4, i, 0, p0, k * p0.w, g0);
        SK_ISA(move)(s, 4, i, 1, p1, k * p1.w, g1);
        SK_ISA(move)(s, 4, i, 2, p2, k * p2.w, g2);
        SK_ISA(move)(s, 4, i, 3, p3, k * p3.w, g3);
    }
}

static void SK_ISA(area)(const by_hand_sweep *s) {
    const sk_wide half = SK_ISA(sk_splat)((real)0.5);
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = SK_ISA(take)(s, 3, i, 0), p1 = SK_ISA(take)(s, 3, i, 1), p2 = SK_ISA(take)(s, 3, i, 2);
        sk_wide3 a = SK_ISA(between)(p0, p1), b = SK_ISA(between)(p0, p2), n = SK_ISA(cross)(a, b);
        sk_wide twice = SK_ISA(sk_wide_sqrt)(SK_ISA(sk_dot_wide)(n, n));
        sk_wide3 unit = SK_ISA(scale)(half * SK_ISA(over)(twice), n);
        sk_wide3 g1 = SK_ISA(cross)(b, unit), g2 = SK_ISA(cross)(unit, a);
        sk_wide3 g0 = {-g1.x - g2.x, -g1.y - g2.y, -g1.z - g2.z};
        sk_wide value = half * twice - SK_ISA(lanes)(s->rest, i);
        sk_wide weight = SK_ISA(heft)(p0, g0) + SK_ISA(heft)(p1, g1) + SK_ISA(heft)(p2, g2);
        sk_wide k = SK_ISA(multiplier)(s, i, value, weight);
        SK_ISA(move)(s, 3, i, 0, p0, k * p0.w, g0);
        SK_ISA(move)(s, 3, i, 1, p1, k * p1.w, g1);
        SK_ISA(move)(s, 3, i, 2, p2, k * p2.w, g2);
    }
}

#else

#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/polynomial.h"

#define SK_KERNELS "bench/by_hand_project.c"
#include "base/for_each_isa.h"

#define KERNEL(name_)                                                     \
    void by_hand_project_##name_(const by_hand_sweep *s) {                \
        static by_hand_projection *const versions[] = SK_EACH_ISA(name_); \
        versions[sk_isa_choose()](s);                                     \
    }
KERNEL(distance)
KERNEL(dihedral)
KERNEL(volume)
KERNEL(area)

#endif
