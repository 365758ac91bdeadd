/* What forces do to adjoints; see adjoint.h.
 *
 * Elastic forces are minus the gradient of an energy, so that df/dX is symmetric, and its product with F- is how f changes as
 * X moves along F-: two sums of forces by the kernels that the plan has, at X + e F- and X - e F-, whatever
 * kinds they are of; half their sum is f itself, which times F- says what a stiffness does. The part in F- that moves
 * farthest goes by `span`, so small that the third derivative does not show, and so large that rounding does not. Where forces
 * are linear, one sum at F- is all of it, and X times that says what a stiffness does.
 * Damping, -c (g . v) g with g the gradient of C, is linear in v and symmetric there; in X it is not:
 *
 *   d/dX of -c (g . v)(g . F-)  =  -c ((g . F-) H v + (g . v) H F-),   H u = how g changes along u
 *
 * and is added up element by element. Uniform forces are m g + f - (linear + rate m) v. */
#include <math.h>
#include <string.h>

#include "constraints/sweep.h"
#include "world/adjoint.h"

/* ---- uniform forces ---- */

static void reverse_field(sk_adjoint *a, const sk_op *op, const sk_taped *at) {
    const sk_rules *rules = &a->world->rules;
    size_t number = 0;
    while (rules->forces.data[number] != op->rule) number++;
    sk_uniform_force u = a->forces[number];
    const real *bar = a->of[SK_F];
    real *v = a->of[SK_V], linear = (real)u.linear, rate = (real)u.rate;
    if (linear != 0 || rate != 0)
        for (size_t i = 0; i < a->reals; i++) v[i] -= (linear + rate * a->mass[i]) * bar[i];
    for (size_t e = 0; e < a->effect_count; e++) {
        if (!a->effects[e].on_forces) continue;
        const sk_uniform_force *d = &a->effects[e].force[number];
        double sum = 0;
        for (size_t p = 0; p < a->world->particles.count; p++) {
            size_t stride, place = sk_adjoint_place(a, p, &stride);
            double m = (double)a->mass[place];
            for (size_t k = 0; k < 3 && m > 0; k++, place += stride)
                sum += (double)bar[place] *
                       (m * d->acceleration[k] + d->force[k] - (d->linear + d->rate * m) * (double)at->v[place]);
        }
        a->by_effect[e] += sum;
    }
    if (op->sets) memset(a->of[SK_F], 0, a->reals * sizeof(real));
}

/* ---- constraints ---- */

static const sk_batch *batch_of(const sk_op *op) {
    return ((const sk_sweep *)op->rule)->batch;
}

/* Sixteen numbers at a time: each has a maximum or sum of its own, so that a compiler takes them together. */
static double largest(const sk_adjoint *a, const real *x) {
    real most[SK_LANES] = {0}, all = 0;
    for (size_t i = 0; i < a->reals; i += SK_LANES)
        for (size_t l = 0; l < SK_LANES; l++) {
            real size = x[i + l] < 0 ? -x[i + l] : x[i + l];
            most[l] = size > most[l] ? size : most[l];
        }
    for (size_t l = 0; l < SK_LANES; l++) all = most[l] > all ? most[l] : all;
    return (double)all;
}

/* X + e F- and X - e F-, once for all constraints that look at a state. */
static void make_sides(sk_adjoint *a, const sk_taped *at) {
    const real *bar = a->of[SK_F];
    if (a->step > 0) return;
    a->step = a->span / a->most;
    a->work = 0;
    for (int side = 0; side < 2; side++) memset(a->force[side], 0, a->reals * sizeof(real));
    real e = (real)a->step;
    for (size_t i = 0; i < a->reals; i++) {
        a->side[0][i] = at->x[i] + e * bar[i];
        a->side[1][i] = at->x[i] - e * bar[i];
    }
}

/* The elastic forces of some ops at x, without velocities, are added to f. */
static void sum_forces(sk_adjoint *a, const sk_op *ops, size_t count, real *x, real *f, double time) {
    sk_run run = sk_world_run_context(a->world);
    run.time = time;
    run.vector[SK_X] = (sk_vec4 *)(void *)x;
    run.vector[SK_V] = (sk_vec4 *)(void *)a->still;
    run.vector[SK_F] = (sk_vec4 *)(void *)f;
    sk_run_ops(&run, a->world->tasks, ops, count);
}

/* p (q + r) */
static double sum_of_products(const sk_adjoint *a, const real *p, const real *q, const real *r) {
    real sum[SK_LANES] = {0};
    double all = 0;
    for (size_t i = 0; i < a->reals; i += SK_LANES)
        for (size_t l = 0; l < SK_LANES; l++) sum[l] += p[i + l] * (q[i + l] + r[i + l]);
    for (size_t l = 0; l < SK_LANES; l++) all += (double)sum[l];
    return all;
}

/* Adds a batch's forces to those of the others that look at this state; returns, if it is `asked`, the forces at X times F-. */
static double add_curved(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time, bool asked) {
    make_sides(a, at);
    for (int side = 0; side < 2; side++) sum_forces(a, ops, count, a->side[side], a->force[side], time);
    if (!asked) return 0;
    double before = a->work;
    a->work = 0.5 * sum_of_products(a, a->of[SK_F], a->force[0], a->force[1]);
    return a->work - before;
}

static double add_linear(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time, bool asked) {
    if (!a->unit_made) {
        memset(a->linear, 0, a->reals * sizeof(real));
        for (size_t i = 0; i < a->reals; i++) a->unit[i] = a->of[SK_F][i] / (real)a->most;
        a->linear_work = 0;
        a->unit_made = true;
    }
    sum_forces(a, ops, count, a->unit, a->linear, time);
    if (!asked) return 0;
    double before = a->linear_work;
    a->linear_work = a->most * sum_of_products(a, at->x, a->linear, a->still);
    return a->linear_work - before;
}

/* X- gets what all constraints of a state have. */
static void take_forces(sk_adjoint *a) {
    real *x = a->of[SK_X], half = a->step > 0 ? (real)(0.5 / a->step) : 0, most = (real)a->most;
    const real *ahead = a->force[0], *behind = a->force[1], *linear = a->linear;
    for (size_t i = 0; i < a->reals && a->step > 0; i++) x[i] += half * (ahead[i] - behind[i]);
    for (size_t i = 0; i < a->reals && a->unit_made; i++) x[i] += most * linear[i];
}

/* X + e `along` as it is outside of a step, which evaluating a constraint takes. */
static void plain(sk_adjoint *a, int which, const real *x, double e, const real *along) {
    sk_vec4 *to = (sk_vec4 *)(void *)a->plain[which];
    for (size_t p = 0; p < a->world->particles.count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride);
        real moved[3];
        for (size_t k = 0; k < 3; k++, at += stride) moved[k] = x[at] + (along ? (real)e * along[at] : 0);
        to[a->world->particles.slot_of[p]] = (sk_vec4){moved[0], moved[1], moved[2], 0};
    }
}

/* What an element's particles have of a vector. */
typedef double triples[SK_MOST_ARITY][3];

static void load(const sk_adjoint *a, const sk_batch *batch, size_t element, const real *x, triples out) {
    for (size_t i = 0; i < sk_batch_particle_count(batch); i++) {
        size_t stride, at = sk_adjoint_place(a, sk_batch_particle(batch, element, i), &stride);
        for (size_t k = 0; k < 3; k++, at += stride) out[i][k] = (double)x[at];
    }
}

static double along(size_t count, triples g, triples u) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) sum += g[i][k] * u[i][k];
    return sum;
}

/* How the gradient changes from one place to another. False without memory. */
static bool change(const sk_batch *batch, double time, size_t element, const sk_vec4 *from, const sk_vec4 *to,
                   double times, triples out) {
    sk_constraint_answer answer;
    triples one;
    size_t count = sk_batch_particle_count(batch);
    if (!batch->type->evaluate(batch, time, from, element, count, &answer, one) ||
        !batch->type->evaluate(batch, time, to, element, count, &answer, out))
        return false;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) out[i][k] = times * (out[i][k] - one[i][k]);
    return true;
}

/* The damping of one element: what X- and V- get of it. */
static bool reverse_damped(sk_adjoint *a, const sk_batch *batch, double time, size_t element, const double e[2],
                           double c, triples g, triples v, triples bar) {
    const sk_vec4 *x[5];
    triples along_bar = {{0}}, along_v = {{0}};
    size_t count = sk_batch_particle_count(batch);
    for (int i = 0; i < 5; i++) x[i] = (const sk_vec4 *)(const void *)a->plain[i];
    if (!change(batch, time, element, x[2], x[1], 0.5 / e[0], along_bar)) return false;
    if (e[1] > 0 && !change(batch, time, element, x[4], x[3], 0.5 / e[1], along_v)) return false;
    double gv = along(count, g, v), gbar = along(count, g, bar);
    for (size_t i = 0; i < count; i++) {
        size_t stride, place = sk_adjoint_place(a, sk_batch_particle(batch, element, i), &stride);
        for (size_t k = 0; k < 3; k++, place += stride) {
            a->of[SK_X][place] -= (real)(c * (gbar * along_v[i][k] + gv * along_bar[i][k]));
            a->of[SK_V][place] -= (real)(c * gbar * g[i][k]);
        }
    }
    return true;
}

/* Goes through a batch's elements where there is damping, or a field changes it; `by_damping` is the derivative by that. */
static skein_status reverse_elements(sk_adjoint *a, const sk_batch *batch, const sk_taped *at, double time,
                                     double *by_damping, skein_error *error) {
    const sk_material *material = batch->params;
    double fastest = largest(a, at->v), e[2] = {a->span / a->most, fastest > 0 ? a->span / fastest : 0};
    const real *bar = a->of[SK_F];
    plain(a, 0, at->x, 0, NULL);
    plain(a, 1, at->x, e[0], bar), plain(a, 2, at->x, -e[0], bar);
    plain(a, 3, at->x, e[1], at->v), plain(a, 4, at->x, -e[1], at->v);
    size_t count = sk_batch_particle_count(batch);
    if (batch->type->enclose || count > SK_MOST_ARITY)
        return sk_fail(error, SKEIN_ERROR_VALUE, batch->label, "its damping has no gradient yet: it encloses a volume");
    for (size_t element = 0; element < batch->count; element++) {
        sk_constraint_answer answer;
        triples g, v, f;
        if (!batch->type->evaluate(batch, time, (const sk_vec4 *)(const void *)a->plain[0], element, count, &answer, g))
            return sk_fail_memory(error, "a gradient");
        if (answer.is_energy || answer.by_time != 0)
            return sk_fail(error, SKEIN_ERROR_VALUE, batch->label,
                           "damping of an energy, or of a constraint that depends on time, has no gradient yet");
        if (answer.one_sided && answer.value >= 0) continue;
        load(a, batch, element, at->v, v), load(a, batch, element, bar, f);
        double scale = batch->scale ? (double)batch->scale[element] : 1;
        *by_damping -= scale * along(count, g, v) * along(count, g, f);
        if (material->damping > 0 && !reverse_damped(a, batch, time, element, e, material->damping * scale, g, v, f))
            return sk_fail_memory(error, "a gradient");
    }
    return SKEIN_OK;
}

/* Ops of one batch. */
static skein_status reverse_forces(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time,
                                   skein_error *error) {
    const sk_batch *batch = batch_of(ops);
    const sk_material *material = batch->params;
    if (a->most < 0) a->most = largest(a, a->of[SK_F]);
    if (!(a->most > 0)) return SKEIN_OK;
    size_t number = 0;
    const sk_rules *rules = &a->world->rules;
    while (rules->batches.data[number] != batch) number++;
    bool elements = material->damping > 0;
    for (size_t i = 0; i < a->effect_count; i++) elements |= a->effects[i].damping[number] != 0;
    double work = (batch->type->linear ? add_linear : add_curved)(a, ops, count, at, time, a->effect_count > 0);
    double by_stiffness = work / material->stiffness, by_damping = 0;
    skein_status status =
        elements ? reverse_elements(a, batch, at, time - ops->before_end, &by_damping, error) : SKEIN_OK;
    for (size_t i = 0; i < a->effect_count; i++)
        a->by_effect[i] += by_stiffness * a->effects[i].stiffness[number] + by_damping * a->effects[i].damping[number];
    return status;
}

/* ---- ops that look at one state ---- */

skein_status sk_adjoint_reverse_looks(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time,
                                      skein_error *error) {
    skein_status status = SKEIN_OK;
    a->step = 0, a->most = -1, a->unit_made = false;
    for (size_t k = count; k-- > 0 && !status;) {
        if (sk_op_type_of(&ops[k])->reverse == SK_REVERSE_FIELD) {
            reverse_field(a, &ops[k], at);
            continue;
        }
        size_t from = k;
        while (from > 0 && sk_op_type_of(&ops[from - 1])->reverse == SK_REVERSE_ELASTIC &&
               batch_of(&ops[from - 1]) == batch_of(&ops[k]))
            from--;
        status = reverse_forces(a, &ops[from], k - from + 1, at, time, error);
        k = from;
    }
    take_forces(a);
    return status;
}
