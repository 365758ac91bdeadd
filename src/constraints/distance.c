/* Distance: C = |xa - xb| - rest. As a force it is the classical spring and damper pair. */
#ifdef SK_ISA

SK_INLINE sk_wide3 SK_ISA(along)(sk_wide s, sk_wide3 d) {
    return (sk_wide3){s * d.x, s * d.y, s * d.z};
}

/* Particles in one place have no direction: they get no force, and no NaN. */
SK_INLINE void SK_ISA(pair)(sk_pair *p, const sk_pair_constants *c, sk_pair_mode mode) {
    sk_wide3 d = {p->a.x - p->b.x, p->a.y - p->b.y, p->a.z - p->b.z};
    sk_wide square = SK_ISA(sk_dot_wide)(d, d);
    sk_wide length = SK_ISA(sk_wide_sqrt)(square);
    if (mode == SK_PAIR_FORCE) {
        sk_wide inverse = SK_ISA(sk_keep)(SK_ISA(sk_positive)(length), 1 / length);
        sk_wide3 u = {p->other_a.x - p->other_b.x, p->other_a.y - p->other_b.y, p->other_a.z - p->other_b.z};
        sk_wide rate = SK_ISA(sk_dot_wide)(d, u) * inverse;
        sk_wide push = (p->stiffness * ((p->rest - length) - c->damping_time * rate)) * inverse;
        p->da = p->db = SK_ISA(along)(push, d);
        return;
    }
    sk_wide weight = p->wa + p->wb, s;
    if (mode == SK_PAIR_PROJECT) {
        sk_wide below = length * (weight + p->soft);
        s = SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), (p->rest - length) / below);
    } else if (mode == SK_PAIR_PROJECT_DAMPED) {
        sk_wide3 moved = {d.x - (p->other_a.x - p->other_b.x), d.y - (p->other_a.y - p->other_b.y),
                          d.z - (p->other_a.z - p->other_b.z)};
        sk_wide inverse = SK_ISA(sk_keep)(SK_ISA(sk_positive)(length), 1 / length);
        sk_wide below = (1 + c->gamma) * weight + p->soft;
        // a multiplier of 0 against an infinite compliance is nothing
        sk_wide held = SK_ISA(sk_keep)(SK_ISA(sk_differ)(p->multiplier, (sk_wide){0}), p->soft * p->multiplier);
        sk_wide above = (p->rest - length) - held - c->gamma * (SK_ISA(sk_dot_wide)(d, moved) * inverse);
        sk_wide change = SK_ISA(sk_keep)(SK_ISA(sk_positive)(below), above / below);
        p->multiplier += change;
        s = change * inverse;
    } else {
        // lanes without an element have a rest length of 0: for them any length is right
        sk_wide most = c->most * p->rest, below = length * weight;
        sk_mask over = SK_ISA(sk_more)(length, most) & SK_ISA(sk_positive)(below) & SK_ISA(sk_positive)(p->rest);
        s = SK_ISA(sk_keep)(over, (most - length) / below);
        if (mode == SK_PAIR_LIMIT_MOVING) {
            sk_wide3 u = {p->other_a.x - p->other_b.x, p->other_a.y - p->other_b.y, p->other_a.z - p->other_b.z};
            sk_wide parting = SK_ISA(sk_dot_wide)(d, u);
            sk_wide stop = SK_ISA(sk_keep)(over & SK_ISA(sk_positive)(parting), -parting / (square * weight));
            p->dv_a = SK_ISA(along)(stop * p->wa, d);
            p->dv_b = SK_ISA(along)(stop * p->wb, d);
        }
    }
    p->da = SK_ISA(along)(s * p->wa, d);
    p->db = SK_ISA(along)(s * p->wb, d);
}

/* k along the spring; the tension over the length across it, where it is stretched (pressed, it would give way). */
SK_INLINE void SK_ISA(stiffness)(sk_wide k, sk_wide rest, sk_wide length, sk_wide inverse_length, sk_wide *along,
                                 sk_wide *across) {
    *along = k;
    *across = SK_ISA(sk_keep)(SK_ISA(sk_more)(length, rest), k * (length - rest) * inverse_length);
}

#include "constraints/pair_solve.h"
#include "constraints/pair_sweeps.h"

#else
#include "constraints/pair.h"

#define SK_KERNELS "constraints/distance.c"
#include "base/for_each_isa.h"

typedef struct distance_params {
    sk_material material;
} distance_params;

static const skein_field fields[] = {
    SK_REAL(distance_params, material.stiffness, "stiffness", "N/m", 1e4, 0, SK_UNBOUNDED,
            "force a metre of stretch; \"infinite\" is rigid (position methods only)"),
    SK_REAL(distance_params, material.damping, "damping", "N s/m", 0, 0, SK_FAR,
            "force a metre a second of stretching; it does not slow other motion"),
};

static double rest_length(const double (*x)[3]) {
    double d[3] = {x[0][0] - x[1][0], x[0][1] - x[1][1], x[0][2] - x[1][2]};
    return __builtin_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

static void strain(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, real *out) {
    for (size_t e = begin; e < end; e++) {
        sk_vec3 d = sk_sub(sk_xyz(x[batch->slot[2 * e]]), sk_xyz(x[batch->slot[2 * e + 1]]));
        real rest = batch->rest[e];
        out[e - begin] = rest > 0 ? (sk_length(d) - rest) / rest : 0;
    }
}

static void value(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, double *out) {
    for (size_t e = begin; e < end; e++) {
        const sk_vec4 *a = &x[batch->slot[2 * e]], *b = &x[batch->slot[2 * e + 1]];
        const double at[2][3] = {{(double)a->x, (double)a->y, (double)a->z},
                                 {(double)b->x, (double)b->y, (double)b->z}};
        out[e - begin] = rest_length(at) - (double)batch->rest[e];
    }
}

const sk_constraint_type sk_distance = {
    .kind = {"distance", "keeps two particles at their rest distance (a spring and damper)", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(distance_params)},
    .arity = 2,
    .rest = rest_length,
    .force = {{SK_EACH_ISA(force_strips)}, {SK_EACH_ISA(force_groups)}},
    .project = {{SK_EACH_ISA(project_strips)}, {SK_EACH_ISA(project_groups)}},
    .project_damped = {{SK_EACH_ISA(project_damped_strips)}, {SK_EACH_ISA(project_damped_groups)}},
    .limit = {{SK_EACH_ISA(limit_strips)}, {SK_EACH_ISA(limit_groups)}},
    .limit_moving = {{SK_EACH_ISA(limit_moving_strips)}, {SK_EACH_ISA(limit_moving_groups)}},
    .apply = {SK_EACH_ISA(apply)},
    .diagonal = {SK_EACH_ISA(diagonal)},
    .strain = strain,
    .value = value,
};
#endif
