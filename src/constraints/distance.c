/* Distance: C = |xa - xb| - rest. As a force it is the classical spring and damper pair. */
#include "constraints/constraint.h"

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

/* Particles in one place have no direction: they get no force, and no NaN. */
static inline real safe_inverse(real length) { return length > 0 ? 1 / length : 0; }

static void force(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    const sk_vec4 *x = run->vector[row->source[0]], *v = run->vector[row->source[1]];
    sk_vec4 *f = run->vector[row->dst];
    real damping_time = (real)sk_batch_damping_time(batch);
    for (size_t e = begin; e < end; e++) {
        uint32_t a = batch->slot[2 * e], b = batch->slot[2 * e + 1];
        sk_vec3 d = sk_sub(sk_xyz(x[a]), sk_xyz(x[b]));
        real length = sk_length(d);
        sk_vec3 n = sk_scale(safe_inverse(length), d);
        real rate = sk_dot(n, sk_sub(sk_xyz(v[a]), sk_xyz(v[b])));
        real pull = batch->stiffness[e] * ((length - batch->rest[e]) + damping_time * rate);
        sk_accumulate(&f[a], sk_scale(-pull, n));
        sk_accumulate(&f[b], sk_scale(pull, n));
    }
}

static void project(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    sk_vec4 *x = run->vector[row->dst];
    real per_step = (real)(1 / (row->dt * row->dt));
    for (size_t e = begin; e < end; e++) {
        uint32_t a = batch->slot[2 * e], b = batch->slot[2 * e + 1];
        sk_vec3 d = sk_sub(sk_xyz(x[a]), sk_xyz(x[b]));
        real length = sk_length(d);
        real weight = (x[a].w + x[b].w) + batch->compliance[e] * per_step;
        real below = length * weight;
        real s = below > 0 ? (batch->rest[e] - length) / below : 0;
        sk_accumulate(&x[a], sk_scale(s * x[a].w, d));
        sk_accumulate(&x[b], sk_scale(-s * x[b].w, d));
    }
}

static void project_damped(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    sk_vec4 *x = run->vector[row->dst];
    const sk_vec4 *x0 = run->vector[row->source[1]];
    real per_step = (real)(1 / (row->dt * row->dt));
    real gamma = (real)(sk_batch_damping_time(batch) / row->dt);
    for (size_t e = begin; e < end; e++) {
        uint32_t a = batch->slot[2 * e], b = batch->slot[2 * e + 1];
        sk_vec3 d = sk_sub(sk_xyz(x[a]), sk_xyz(x[b])), d0 = sk_sub(sk_xyz(x0[a]), sk_xyz(x0[b]));
        real length = sk_length(d);
        sk_vec3 n = sk_scale(safe_inverse(length), d);
        real moved = sk_dot(n, sk_sub(d, d0));
        real soft = batch->compliance[e] * per_step;
        real below = (1 + gamma) * (x[a].w + x[b].w) + soft;
        real above = (batch->rest[e] - length) - soft * batch->multiplier[e] - gamma * moved;
        real s = below > 0 ? above / below : 0;
        batch->multiplier[e] += s;
        sk_accumulate(&x[a], sk_scale(s * x[a].w, n));
        sk_accumulate(&x[b], sk_scale(-s * x[b].w, n));
    }
}

static void strain(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, real *out) {
    for (size_t e = begin; e < end; e++) {
        sk_vec3 d = sk_sub(sk_xyz(x[batch->slot[2 * e]]), sk_xyz(x[batch->slot[2 * e + 1]]));
        real rest = batch->rest[e];
        out[e - begin] = rest > 0 ? (sk_length(d) - rest) / rest : 0;
    }
}

const sk_constraint_type sk_distance = {
    .kind = {"distance", "keeps two particles at their rest distance (a spring and damper)", SKEIN_CONSTRAINT,
             fields, sizeof fields / sizeof *fields, sizeof(distance_params)},
    .arity = 2,
    .rest = rest_length,
    .force = force,
    .project = project,
    .project_damped = project_damped,
    .strain = strain,
};
