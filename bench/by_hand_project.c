/* XPBD's projections by hand, sixteen at a time, gather to scatter, in the library's own arithmetic (no fused
 * operations, no estimates, the same guards) and over its groups: what an emitted kernel could be at best. */
#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/polynomial.h"

#define SK_UNIT bench_by_hand_project
SK_KERNELS(by_hand_projection, distance);
SK_KERNELS(by_hand_projection, dihedral);
SK_KERNELS(by_hand_projection, volume);
SK_KERNELS(by_hand_projection, area);

#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "bench/wide_vectors.h"

SK_INLINE sk_wide lanes(const real *from, size_t group) {
    return *(const sk_wide *)(const void *)(from + group * SK_LANES);
}
SK_INLINE sk_wide4 corner_at(const by_hand_sweep *s, size_t arity, size_t group, size_t particle) {
    return sk_gather((const sk_vec4 *)(const void *)s->positions, s->slots + (group * arity + particle) * SK_LANES);
}
SK_INLINE sk_wide3 between(sk_wide4 from, sk_wide4 to) {
    return (sk_wide3){to.x - from.x, to.y - from.y, to.z - from.z};
}
/* Adds k g to a particle and puts it back. */
SK_INLINE void move_corner(const by_hand_sweep *s, size_t arity, size_t group, size_t particle, sk_wide4 p, sk_wide k,
                           sk_wide3 g) {
    p.x += k * g.x, p.y += k * g.y, p.z += k * g.z;
    sk_scatter((sk_vec4 *)(void *)s->positions, s->slots + (group * arity + particle) * SK_LANES, p);
}
/* w |g|^2 */
SK_INLINE sk_wide heft(sk_wide4 p, sk_wide3 g) {
    return p.w * sk_dot_wide(g, g);
}
/* The multiplier: -C over the weights and the compliance. */
SK_INLINE sk_wide multiplier(const by_hand_sweep *s, size_t group, sk_wide value, sk_wide weight) {
    sk_wide below = weight + lanes(s->compliance, group) * s->per_step;
    return sk_keep(sk_positive(below), -value / below);
}

void SK_KERNEL(distance)(const by_hand_sweep *s) {
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = corner_at(s, 2, i, 0), p1 = corner_at(s, 2, i, 1);
        sk_wide3 d = between(p0, p1);
        sk_wide length = sk_wide_sqrt(sk_dot_wide(d, d)), value = length - lanes(s->rest, i);
        sk_wide below = length * (p0.w + p1.w + lanes(s->compliance, i) * s->per_step);
        sk_wide k = sk_keep(sk_positive(below), value / below);
        move_corner(s, 2, i, 0, p0, k * p0.w, d);
        move_corner(s, 2, i, 1, p1, -k * p1.w, d);
    }
}

/* The angle over the edge p0 p1; the gradients of its ends are shares of those of the corners. */
void SK_KERNEL(dihedral)(const by_hand_sweep *s) {
    const sk_wide pi = sk_splat((real)3.14159265358979324), turn = pi + pi;
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = corner_at(s, 4, i, 0), p1 = corner_at(s, 4, i, 1);
        sk_wide4 p2 = corner_at(s, 4, i, 2), p3 = corner_at(s, 4, i, 3);
        sk_wide3 e = between(p0, p1), a = between(p0, p2), b = between(p0, p3);
        sk_wide3 left = cross(e, a), right = cross(b, e);
        sk_wide ee = sk_dot_wide(e, e), length = sk_wide_sqrt(ee), over = inverse_of(ee);
        sk_wide3 g2 = scale(length * inverse_of(sk_dot_wide(left, left)), left);
        sk_wide3 g3 = scale(length * inverse_of(sk_dot_wide(right, right)), right);
        sk_wide s2 = sk_dot_wide(a, e) * over, s3 = sk_dot_wide(b, e) * over;
        sk_wide3 g1 = weighted_sum(-s2, g2, -s3, g3), g0 = weighted_sum(s2 - 1, g2, s3 - 1, g3);
        sk_wide value = sk_wide_atan2(length * sk_dot_wide(left, b), sk_dot_wide(left, right));
        value -= lanes(s->rest, i);
        value -= sk_keep(sk_more(value, pi), turn);
        value += sk_keep(sk_more(-pi, value), turn);
        sk_wide weight = heft(p0, g0) + heft(p1, g1) + heft(p2, g2) + heft(p3, g3);
        sk_wide k = multiplier(s, i, value, weight);
        move_corner(s, 4, i, 0, p0, k * p0.w, g0);
        move_corner(s, 4, i, 1, p1, k * p1.w, g1);
        move_corner(s, 4, i, 2, p2, k * p2.w, g2);
        move_corner(s, 4, i, 3, p3, k * p3.w, g3);
    }
}

/* Six times the gradients are products of edges; the sixth comes in where they are put together. */
void SK_KERNEL(volume)(const by_hand_sweep *s) {
    const sk_wide sixth = sk_splat((real)(1.0 / 6));
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = corner_at(s, 4, i, 0), p1 = corner_at(s, 4, i, 1);
        sk_wide4 p2 = corner_at(s, 4, i, 2), p3 = corner_at(s, 4, i, 3);
        sk_wide3 a = between(p0, p1), b = between(p0, p2), c = between(p0, p3);
        sk_wide3 g1 = cross(b, c), g2 = cross(c, a), g3 = cross(a, b);
        sk_wide3 g0 = {-g1.x - g2.x - g3.x, -g1.y - g2.y - g3.y, -g1.z - g2.z - g3.z};
        sk_wide value = sixth * sk_dot_wide(g3, c) - lanes(s->rest, i);
        sk_wide weight = heft(p0, g0) + heft(p1, g1) + heft(p2, g2) + heft(p3, g3);
        sk_wide k = sixth * multiplier(s, i, value, sixth * sixth * weight);
        move_corner(s, 4, i, 0, p0, k * p0.w, g0);
        move_corner(s, 4, i, 1, p1, k * p1.w, g1);
        move_corner(s, 4, i, 2, p2, k * p2.w, g2);
        move_corner(s, 4, i, 3, p3, k * p3.w, g3);
    }
}

void SK_KERNEL(area)(const by_hand_sweep *s) {
    const sk_wide half = sk_splat((real)0.5);
    for (size_t i = 0; i < s->group_count; i++) {
        sk_wide4 p0 = corner_at(s, 3, i, 0), p1 = corner_at(s, 3, i, 1), p2 = corner_at(s, 3, i, 2);
        sk_wide3 a = between(p0, p1), b = between(p0, p2), n = cross(a, b);
        sk_wide twice = sk_wide_sqrt(sk_dot_wide(n, n));
        sk_wide3 unit = scale(half * inverse_of(twice), n);
        sk_wide3 g1 = cross(b, unit), g2 = cross(unit, a);
        sk_wide3 g0 = {-g1.x - g2.x, -g1.y - g2.y, -g1.z - g2.z};
        sk_wide value = half * twice - lanes(s->rest, i);
        sk_wide weight = heft(p0, g0) + heft(p1, g1) + heft(p2, g2);
        sk_wide k = multiplier(s, i, value, weight);
        move_corner(s, 3, i, 0, p0, k * p0.w, g0);
        move_corner(s, 3, i, 1, p1, k * p1.w, g1);
        move_corner(s, 3, i, 2, p2, k * p2.w, g2);
    }
}

#else

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
