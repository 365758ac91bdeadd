/* Second derivatives by hand, sixteen elements at a time, in the library's own arithmetic. By the edges e from the
 * first particle to the others; the rows and columns of the first are what is left of none, since moving all changes
 * nothing.
 *
 *   neo-Hookean   I = sum M_ik e_i.e_k with M = D D^T, J = det D e_0.(e_1 x e_2), and so with g_i = sum M_ik e_k and
 *                 m_i = dJ/de_i   H_ij = v (a M_ij + 2/(I+1)^2 g_i g_j^T + 3 m_i m_j^T + 3 (J - 1.25) dm_i/de_j)
 *   StVK          the energy's second derivatives by f and g, which are sums of edges */
#include "bench/by_hand.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/polynomial.h"

/* Loops over three axes and the like: what they fill stays in registers. */
#ifdef __clang__
#define UNROLLED _Pragma("unroll")
#else
#define UNROLLED _Pragma("GCC unroll 9")
#endif

#define SK_UNIT bench_by_hand_second
SK_KERNELS(by_hand_function, neo_hookean);
SK_KERNELS(by_hand_function, stvk);

#ifdef SK_ISA

#include "base/wide_elementary.h"
#include "bench/wide_vectors.h"

typedef struct wide_matrix {
    sk_wide at[3][3];
} wide_matrix;

SK_INLINE sk_wide3 place_of_corner(const by_hand_input *in, int particle, size_t e) {
    sk_wide4 p = sk_gather((const sk_vec4 *)(const void *)in->positions, in->slot[particle] + e);
    return (sk_wide3){p.x, p.y, p.z};
}
SK_INLINE sk_wide parameter_at(const by_hand_input *in, int k, size_t e) {
    sk_wide x;
    memcpy(&x, in->parameter[k] + e, sizeof x);
    return x;
}
SK_INLINE sk_wide component_of(sk_wide3 a, int i) {
    return i == 0 ? a.x : i == 1 ? a.y : a.z;
}
SK_INLINE void put_entry(const by_hand_input *in, size_t row, size_t column, size_t e, sk_wide x) {
    memcpy(in->output + (row * (row + 1) / 2 + column) * in->stride + e, &x, sizeof x);
}
/* The block of rows 3 i and columns 3 j on, as far as it is in the lower triangle. */
SK_INLINE void put_block(const by_hand_input *in, size_t i, size_t j, size_t e, const wide_matrix *h) {
    UNROLLED
    for (size_t r = 0; r < 3; r++) {
        UNROLLED
        for (size_t c = 0; c < 3; c++)
            if (i != j || c <= r) put_entry(in, 3 * i + r, 3 * j + c, e, h->at[r][c]);
    }
}
/* Gives blocks [i][j], i >= j, of the edges, whose diagonal ones are symmetric, and the first particle's. */
SK_INLINE void put_blocks(const by_hand_input *in, size_t e, wide_matrix (*h)[3], int edges) {
    wide_matrix corner;
    memset(&corner, 0, sizeof corner);
    UNROLLED
    for (int i = 0; i < edges; i++) {
        wide_matrix left;
        UNROLLED
        for (int k = 0; k < edges; k++) {
            if (k <= i) put_block(in, (size_t)i + 1, (size_t)k + 1, e, &h[i][k]);
            UNROLLED
            for (int rc = 0; rc < 9; rc++) {
                int r = rc / 3, c = rc % 3;
                sk_wide x = k <= i ? h[i][k].at[r][c] : h[k][i].at[c][r];
                left.at[r][c] = k ? left.at[r][c] - x : -x;
            }
        }
        put_block(in, (size_t)i + 1, 0, e, &left);
        UNROLLED
        for (int rc = 0; rc < 9; rc++) corner.at[rc / 3][rc % 3] -= left.at[rc / 3][rc % 3];
    }
    put_block(in, 0, 0, e, &corner);
}

void SK_KERNEL(neo_hookean)(const by_hand_input *in) {
    const sk_wide one = sk_splat(1);
    for (size_t n = 0; n < in->count; n += SK_PART) {
        sk_wide3 p0 = place_of_corner(in, 0, n), e[3], g[3], m[3], d[3], gs[3], ms[3];
        sk_wide mm[3][3];
        wide_matrix h[3][3];
        UNROLLED
        for (int i = 0; i < 3; i++) {
            e[i] = minus(place_of_corner(in, i + 1, n), p0);
            d[i] =
                (sk_wide3){parameter_at(in, 3 * i, n), parameter_at(in, 3 * i + 1, n), parameter_at(in, 3 * i + 2, n)};
        }
        UNROLLED
        for (int i = 0; i < 3; i++) {
            UNROLLED
            for (int j = 0; j <= i; j++) mm[i][j] = mm[j][i] = sk_dot_wide(d[i], d[j]);
        }
        sk_wide det = sk_dot_wide(d[0], cross(d[1], d[2])), squares = (sk_wide){0};
        UNROLLED
        for (int i = 0; i < 3; i++) {
            g[i] = weighted_sum(one, weighted_sum(mm[i][0], e[0], mm[i][1], e[1]), mm[i][2], e[2]);
            m[i] = scale(det, cross(e[(i + 1) % 3], e[(i + 2) % 3]));
            squares += sk_dot_wide(g[i], e[i]);
        }
        sk_wide j = sk_dot_wide(e[0], m[0]) - sk_splat((real)1.25), v = parameter_at(in, 9, n);
        sk_wide over = 1 / (squares + 1), a = v * (1 - over), twist = 3 * v * j * det;
        UNROLLED
        for (int i = 0; i < 3; i++) gs[i] = scale(2 * v * over * over, g[i]), ms[i] = scale(3 * v, m[i]);
        UNROLLED
        for (int i = 0; i < 3; i++) {
            UNROLLED
            for (int k = 0; k <= i; k++) {
                UNROLLED
                for (int rc = 0; rc < 9; rc++) {
                    int r = rc / 3, c = rc % 3;
                    sk_wide x =
                        component_of(gs[i], r) * component_of(g[k], c) + component_of(ms[i], r) * component_of(m[k], c);
                    if (r == c) x += a * mm[i][k];
                    else if (i != k) { // the third edge, crossed
                        sk_wide third = twist * component_of(e[3 - i - k], 3 - r - c);
                        bool plus = ((c + 1) % 3 == r) == (i - k == 1);
                        x = plus ? x + third : x - third;
                    }
                    h[i][k].at[r][c] = x;
                }
            }
        }
        put_blocks(in, n, h, 3);
    }
}

void SK_KERNEL(stvk)(const by_hand_input *in) {
    const sk_wide half = sk_splat((real)0.5);
    for (size_t n = 0; n < in->count; n += SK_PART) {
        sk_wide3 p0 = place_of_corner(in, 0, n), a = minus(place_of_corner(in, 1, n), p0);
        sk_wide3 b = minus(place_of_corner(in, 2, n), p0);
        sk_wide by_f[2] = {parameter_at(in, 0, n), parameter_at(in, 2, n)};
        sk_wide by_g[2] = {parameter_at(in, 1, n), parameter_at(in, 3, n)};
        sk_wide3 f = weighted_sum(by_f[0], a, by_f[1], b), g = weighted_sum(by_g[0], a, by_g[1], b);
        sk_wide area = parameter_at(in, 4, n), x = half * (sk_dot_wide(f, f) - 1);
        sk_wide y = half * (sk_dot_wide(g, g) - 1), trace = x + y, z = area * sk_dot_wide(f, g);
        sk_wide of_f = area * (2 * x + 3 * trace), of_g = area * (2 * y + 3 * trace);
        wide_matrix h[3][3];
        UNROLLED
        for (int i = 0; i < 2; i++) {
            UNROLLED
            for (int k = 0; k <= i; k++) {
                sk_wide ff = by_f[i] * by_f[k], fg = by_f[i] * by_g[k], gf = by_g[i] * by_f[k], gg = by_g[i] * by_g[k];
                // what f and what g on the right are multiplied by
                sk_wide3 left = weighted_sum(area * (5 * ff + gg), f, area * (fg + 3 * gf), g);
                sk_wide3 right = weighted_sum(area * (3 * fg + gf), f, area * (ff + 5 * gg), g);
                sk_wide diagonal = of_f * ff + of_g * gg + z * (fg + gf);
                UNROLLED
                for (int rc = 0; rc < 9; rc++) {
                    int r = rc / 3, c = rc % 3;
                    sk_wide s =
                        component_of(left, r) * component_of(f, c) + component_of(right, r) * component_of(g, c);
                    h[i][k].at[r][c] = r == c ? s + diagonal : s;
                }
            }
        }
        put_blocks(in, n, h, 2);
    }
}

#else

#define KERNEL(name_)                                                   \
    void by_hand_second_##name_(const by_hand_input *in) {              \
        static by_hand_function *const versions[] = SK_EACH_ISA(name_); \
        versions[sk_isa_choose()](in);                                  \
    }
KERNEL(neo_hookean)
KERNEL(stvk)

#endif
