/* Projections of PBD and XPBD in reverse; see adjoint.h.
 *
 * One after another they move their particles, so each needs these where it found them: from the positions that the prediction
 * left, all of a substep are done again here, element by element in the order of the plan, and what each found is kept. With g
 * the gradient of C, W the inverse masses, S = g W g, a = 1/(k h^2), c the damping over k h and d = x - x0, one is
 *
 *   dl = (-C - a l - c g d) / D,   D = (1 + c) S + a,   x += W g dl,   l += dl
 *
 * and in reverse, with a bar over adjoints, u = W X- and p = g u + l-,
 *
 *   X- += H (dl u - (p/D) (c d + 2 (1 + c) dl W g)) - (p/D) (1 + c) g,    X0- += (p/D) c g,    l- -= (p/D) a
 *   a- = -(p/D) (l + dl),    c- = -(p/D) (g d + dl S)
 *
 * one product with the matrix of second derivatives H. Where a kind's largest change m ended it, dl is m/S or -m/S, and
 * X- += H dl (u - 2 (p/S) W g). Where C = |L| - R is the length of a linear function L = sum of q x, as of a distance and of most
 * bending, g = q n with n = L/|L|, and with T = sum of q u and F = sum of q d all of it is
 *
 *   X- += q (dl/|L| (T - n n T) - (p/D) (c/|L| (F - n n F) + (1 + c) n))
 *
 * for H W g is 0. For all others H z is how the gradient changes along z, from a little to either side. C = |L| has a kink at L = 0,
 * which has no part in a move without a multiplier, -W q L/D. */
#include <math.h>
#include <string.h>

#include "constraints/sweep.h"
#include "world/adjoint.h"

typedef enum sort_of_kind { BY_LENGTH, BY_DIFFERENCES } sort_of_kind;

/* How a projection ended: its particles stayed, or went to C = 0 as far as it is soft, or as far as the kind goes at once, or a
 * one-sided one let go. */
typedef enum outcome { STAYED, MOVED, BOUNDED, LET_GO } outcome;

/* What a projection of C = |L| - R found. */
typedef struct found_length {
    double n[3], length, multiplier, change, below; // 0 below: nothing moved
} found_length;

/* What any other found. */
typedef struct found {
    outcome outcome;
    uint32_t element;
    double value, multiplier, change, weight, below;
    double x[SK_MOST_ARITY][3], gradient[SK_MOST_ARITY][3]; // the batch's number of particles
} found;

/* A batch's lanes and elements. */
typedef struct projected {
    const sk_batch *batch;
    sort_of_kind sort;
    uint32_t *element;        /* of each lane; or NOBODY */
    double *multiplier, *bar; /* of each lane, and the adjoints */
    double *share;            /* q of each element's particles, but for a distance's, which are 1 and -1 */
} projected;

struct sk_projections {
    projected *data; /* of each batch; those that no op projects have no elements */
    size_t count;
    sk_vec4 *x, *start, *bar, *bar_start; /* of each slot, as they lie outside of a step; w: the inverse mass */
    sk_vec4 *side[2];                     /* where a gradient is looked at; the slots of one element at a time */
    char *records;
    size_t used, capacity;
};

/* An op's numbers, which are those of all its elements. */
typedef struct pass {
    sk_adjoint *a;
    const sk_op *op;
    const sk_sweep *sweep;
    projected *p;
    double time, per_step, gamma;
    bool keeps, looks_back;       /* at X0: it is damped, or that is asked for */
    size_t arity, bytes;          /* of a record */
    double by_softness, by_gamma; /* sums of a times a-, and of c- */
    skein_error *error;
} pass;

#define NOBODY UINT32_MAX /* wider than an enumerator may be */

/* ---- what there is to go through ---- */

/* Of two particles; only lengths have a strain. */
static bool is_distance(const sk_batch *batch) {
    return batch->type->strain && batch->arity == 2;
}

static sort_of_kind sort_of(const sk_batch *batch) {
    return is_distance(batch) || batch->type->linear ? BY_LENGTH : BY_DIFFERENCES;
}

/* q of a linear kind: L is it times a metre where one particle is there and all others are at the origin. */
static bool find_shares(sk_adjoint *a, projected *p) {
    const sk_batch *batch = p->batch;
    size_t arity = batch->arity;
    sk_vec4 *x = a->projections->side[0];
    for (size_t e = 0; e < batch->count; e++) {
        double *q = p->share + arity * e, size = 0;
        for (size_t i = 0; i < arity && !(size > 0); i++) {
            sk_constraint_answer answer;
            double g[SK_MOST_ARITY][3];
            for (size_t k = 0; k < arity; k++) x[batch->slot[arity * e + k]] = (sk_vec4){k == i, 0, 0, 0};
            if (!batch->type->evaluate(batch, 0, x, e, arity, &answer, g)) return false;
            for (size_t k = 0; k < arity; k++) q[k] = g[k][0], size += g[k][0] * g[k][0];
        }
    }
    return true;
}

static bool find_projected(sk_adjoint *a, const sk_batch *batch) {
    sk_projections *all = a->projections;
    sk_allocator *allocator = &a->world->allocator;
    size_t number = 0;
    while (a->world->rules.batches.data[number] != batch) number++;
    projected *p = &all->data[number];
    if (p->element) return true; // by another sweep of its
    *p = (projected){.batch = batch, .sort = sort_of(batch)};
    p->element = sk_allocate(allocator, batch->lane_count * sizeof *p->element);
    p->multiplier = sk_allocate(allocator, batch->lane_count * sizeof *p->multiplier);
    p->bar = sk_allocate(allocator, batch->lane_count * sizeof *p->bar);
    bool shares = p->sort == BY_LENGTH && !is_distance(batch);
    if (shares) p->share = sk_allocate(allocator, batch->arity * batch->count * sizeof *p->share);
    if (!p->element || !p->multiplier || !p->bar || (shares && !p->share)) return false;
    for (size_t l = 0; l < batch->lane_count; l++) p->element[l] = NOBODY;
    for (size_t e = 0; e < batch->count; e++) p->element[batch->lane[e]] = (uint32_t)e;
    return !shares || find_shares(a, p);
}

/* Whether an op sets multipliers to 0. */
static bool clears(const sk_op *op) {
    return op->kernel == sk_sweep_clear_multipliers;
}

bool sk_adjoint_projects(const sk_op *op) {
    return clears(op) || (sk_op_type_of(op)->reverse == SK_REVERSE_ELASTIC && op->dst == SK_X);
}

bool sk_adjoint_begin_projections(sk_adjoint *a) {
    const skein_world *world = a->world;
    sk_allocator *allocator = &a->world->allocator;
    size_t bytes = world->particles.slot_capacity * sizeof(sk_vec4);
    bool any = false;
    for (size_t r = 0; r < world->plan.count; r++) any |= sk_adjoint_projects(&world->plan.data[r]);
    if (!any) return true;
    sk_projections *all = a->projections = sk_allocate(allocator, sizeof *all);
    if (!all) return false;
    all->count = world->rules.batches.count;
    all->data = sk_allocate(allocator, (all->count + 1) * sizeof *all->data);
    sk_vec4 **const vectors[] = {&all->x, &all->start, &all->bar, &all->bar_start, &all->side[0], &all->side[1]};
    bool good = all->data != NULL;
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
        good &= (*vectors[i] = sk_allocate(allocator, bytes)) != NULL;
    for (size_t r = 0; r < world->plan.count && good; r++) {
        const sk_op *op = &world->plan.data[r];
        if (sk_adjoint_projects(op)) good = find_projected(a, ((const sk_sweep *)op->rule)->batch);
    }
    return good;
}

void sk_adjoint_end_projections(sk_adjoint *a) {
    sk_projections *all = a->projections;
    sk_allocator *allocator = &a->world->allocator;
    if (!all) return;
    for (size_t i = 0; all->data && i < all->count; i++) {
        sk_release(allocator, all->data[i].element);
        sk_release(allocator, all->data[i].multiplier);
        sk_release(allocator, all->data[i].bar);
        sk_release(allocator, all->data[i].share);
    }
    sk_vec4 *const vectors[] = {all->x, all->start, all->bar, all->bar_start, all->side[0], all->side[1]};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) sk_release(allocator, vectors[i]);
    sk_release(allocator, all->records);
    sk_release(allocator, all->data);
    sk_release(allocator, all);
}

/* ---- elements ---- */

static double dot(const double p[3], const double q[3]) {
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
}

static void take(const sk_vec4 *vector, const uint32_t *slot, size_t count, double (*out)[3]) {
    for (size_t i = 0; i < count; i++) {
        sk_vec4 x = vector[slot[i]];
        out[i][0] = (double)x.x, out[i][1] = (double)x.y, out[i][2] = (double)x.z;
    }
}

static void put(sk_vec4 *vector, uint32_t slot, const double x[3]) {
    vector[slot].x = (real)x[0], vector[slot].y = (real)x[1], vector[slot].z = (real)x[2];
}

static const uint32_t *slots_of(const pass *s, uint32_t element) {
    return s->p->batch->slot + s->arity * element;
}

/* 1/(k h^2), times the ops that share the stiffness; a rigid one has 0. */
static double softness_of(const pass *s, size_t lane) {
    return (double)s->p->batch->lane_compliance[lane] * s->per_step;
}

static bool fail_at_kink(const pass *s, uint32_t element) {
    return !sk_fail(s->error, SKEIN_ERROR_VALUE, s->p->batch->label,
                    "element %u has a kink where it is at %.6g s, and no derivative: a length that is 0, say",
                    (unsigned)element, s->time);
}

/* C, g and S, as a projection finds them. */
static bool look(const pass *s, found *f, bool *one_sided, double *by_time) {
    const sk_batch *batch = s->p->batch;
    const uint32_t *slot = slots_of(s, f->element);
    const sk_vec4 *x = s->a->projections->x;
    *one_sided = false, *by_time = 0, f->weight = 0;
    take(x, slot, s->arity, f->x);
    sk_constraint_answer answer;
    if (!batch->type->evaluate(batch, s->time, x, f->element, s->arity, &answer, f->gradient))
        return !sk_fail_memory(s->error, "a gradient");
    if (answer.is_energy)
        return !sk_fail(s->error, SKEIN_ERROR_VALUE, batch->label, "an energy has no gradient under projections yet");
    if (answer.guarded) return fail_at_kink(s, f->element);
    *one_sided = answer.one_sided, *by_time = answer.by_time, f->value = answer.value;
    for (size_t i = 0; i < s->arity; i++) f->weight += (double)x[slot[i]].w * dot(f->gradient[i], f->gradient[i]);
    if (!isfinite(f->weight + f->value)) f->weight = 0, f->value = 0; // what is not finite is left alone
    return true;
}

/* g d, with d = x - x0. */
static double change_since_start(const pass *s, const found *f) {
    const uint32_t *slot = slots_of(s, f->element);
    double x0[SK_MOST_ARITY][3], sum = 0;
    take(s->a->projections->start, slot, s->arity, x0);
    for (size_t i = 0; i < s->arity; i++)
        for (int k = 0; k < 3; k++) sum += f->gradient[i][k] * (f->x[i][k] - x0[i][k]);
    return sum;
}

/* One projection, as the plan's kernels do it. */
static bool project(pass *s, size_t lane, found *f) {
    bool one_sided;
    double by_time, soft = softness_of(s, lane);
    const uint32_t *slot = slots_of(s, f->element);
    f->outcome = STAYED, f->multiplier = s->keeps ? s->p->multiplier[lane] : 0, f->change = 0;
    if (!isfinite(soft)) return true;
    if (!look(s, f, &one_sided, &by_time)) return false;
    if (by_time != 0 && s->gamma > 0)
        return !sk_fail(s->error, SKEIN_ERROR_VALUE, s->p->batch->label,
                        "damping of a constraint that depends on time has no gradient yet");
    f->below = (1 + s->gamma) * f->weight + soft;
    if (!(f->below > 0) || !(f->weight > 0) || (one_sided && f->value >= 0 && !(f->multiplier > 0))) return true;
    f->outcome = MOVED;
    f->change =
        (-f->value - soft * f->multiplier - (s->gamma > 0 ? s->gamma * change_since_start(s, f) : 0)) / f->below;
    double most = s->p->batch->type->most_change;
    if (most > 0 && fabs(f->change) * f->weight > most)
        f->outcome = BOUNDED, f->below = f->weight, f->change = copysign(most, f->change) / f->weight;
    if (one_sided && s->keeps && f->multiplier + f->change < 0) f->outcome = LET_GO, f->change = -f->multiplier;
    for (size_t i = 0; i < s->arity; i++) {
        double w = (double)s->a->projections->x[slot[i]].w, to[3];
        for (int k = 0; k < 3; k++) to[k] = f->x[i][k] + w * f->change * f->gradient[i][k];
        put(s->a->projections->x, slot[i], to);
    }
    if (s->keeps) s->p->multiplier[lane] += f->change;
    return true;
}

/* ---- products with second derivatives ---- */

/* The gradient at `span` to either side along z, whose largest number is `most`, and from that how it changes along z. How far their
 * mean is from the gradient between them, as a share of it, says how much of third derivatives is in it; below 0: no memory. */
static double differ_by(const pass *s, const found *f, double (*z)[3], double most, double span, double (*out)[3]) {
    const sk_batch *batch = s->p->batch;
    const uint32_t *slot = slots_of(s, f->element);
    double g[2][SK_MOST_ARITY][3], size = 0, off = 0;
    for (int side = 0; side < 2; side++) {
        sk_constraint_answer answer;
        sk_vec4 *x = s->a->projections->side[side];
        double e = (side ? -1 : 1) * span / most;
        for (size_t i = 0; i < s->arity; i++) {
            double to[3];
            for (int k = 0; k < 3; k++) to[k] = f->x[i][k] + e * z[i][k];
            put(x, slot[i], to);
        }
        if (!batch->type->evaluate(batch, s->time, x, f->element, s->arity, &answer, g[side])) return -1;
    }
    for (size_t i = 0; i < s->arity; i++)
        for (int k = 0; k < 3; k++) {
            out[i][k] = 0.5 * most / span * (g[0][i][k] - g[1][i][k]);
            size = fmax(size, fabs(f->gradient[i][k]));
            off = fmax(off, fabs(0.5 * (g[0][i][k] + g[1][i][k]) - f->gradient[i][k]));
        }
    return off / size;
}

/* out = H z, by as wide a step as third derivatives let it. None is narrow enough beside a kink. */
static bool differ(const pass *s, const found *f, double (*z)[3], double (*out)[3]) {
    double most = 0, span = s->a->span, off = 1;
    for (size_t i = 0; i < s->arity; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(z[i][k])), out[i][k] = 0;
    if (!(most > 0)) return true;
    for (int narrower = 0; narrower < 3; narrower++, span /= 32) {
        off = differ_by(s, f, z, most, span, out);
        if (off < 0) return !sk_fail_memory(s->error, "a gradient");
        if (off <= 1e-5) return true;
    }
    return fail_at_kink(s, f->element);
}

/* ---- one projection in reverse ---- */

static bool reverse_moved(pass *s, size_t lane, const found *f, double (*u)[3], double (*bar)[3], double along) {
    sk_projections *all = s->a->projections;
    const uint32_t *slot = slots_of(s, f->element);
    bool by_value = f->outcome != BOUNDED;
    double soft = by_value ? softness_of(s, lane) : 0, gamma = by_value ? s->gamma : 0, stiff = 1 + gamma,
           share = along / f->below;
    double z[SK_MOST_ARITY][3], turned[SK_MOST_ARITY][3], x0[SK_MOST_ARITY][3], since = change_since_start(s, f);
    if (f->outcome == LET_GO) share = 0;
    take(all->start, slot, s->arity, x0);
    for (size_t i = 0; i < s->arity; i++)
        for (int k = 0; k < 3; k++)
            z[i][k] =
                f->change * u[i][k] - share * (gamma * (f->x[i][k] - x0[i][k]) +
                                               2 * stiff * f->change * (double)all->x[slot[i]].w * f->gradient[i][k]);
    if (!differ(s, f, z, turned)) return false;
    for (size_t i = 0; i < s->arity; i++) {
        sk_vec4 *start = &all->bar_start[slot[i]];
        double by_start = share * gamma;
        for (int k = 0; k < 3; k++) bar[i][k] += turned[i][k] - (by_value ? share * stiff * f->gradient[i][k] : 0);
        start->x += (real)(by_start * f->gradient[i][0]);
        start->y += (real)(by_start * f->gradient[i][1]);
        start->z += (real)(by_start * f->gradient[i][2]);
    }
    if (s->keeps) s->p->bar[lane] -= f->outcome == LET_GO ? along : share * soft;
    if (!by_value) return true;
    s->by_softness -= share * soft * (f->multiplier + f->change);
    s->by_gamma -= share * (since + f->change * f->weight);
    return true;
}

static bool reverse(pass *s, size_t lane, const found *f) {
    sk_projections *all = s->a->projections;
    const uint32_t *slot = slots_of(s, f->element);
    double bar[SK_MOST_ARITY][3], u[SK_MOST_ARITY][3], along = s->keeps ? s->p->bar[lane] : 0;
    if (f->outcome == STAYED) return true;
    take(all->bar, slot, s->arity, bar);
    for (size_t i = 0; i < s->arity; i++)
        for (int k = 0; k < 3; k++) {
            u[i][k] = (double)all->x[slot[i]].w * bar[i][k];
            along += f->gradient[i][k] * u[i][k];
        }
    if (!reverse_moved(s, lane, f, u, bar, along)) return false;
    for (size_t i = 0; i < s->arity; i++) put(all->bar, slot[i], bar[i]);
    return true;
}

/* ---- constraints of a length, which are most: with `arity` a constant where this is inlined ---- */

/* q of an element's particles. */
static inline const double *shares_of(const pass *s, uint32_t element, size_t arity) {
    static const double of_distance[2] = {1, -1};
    return s->p->share ? s->p->share + arity * element : of_distance;
}

static inline void sum_of(const sk_vec4 *vector, const uint32_t *slot, const double *q, size_t arity, double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (size_t i = 0; i < arity; i++) {
        const sk_vec4 *x = &vector[slot[i]];
        sum[0] += q[i] * (double)x->x, sum[1] += q[i] * (double)x->y, sum[2] += q[i] * (double)x->z;
    }
}

/* F: how far L has come since the substep's start. */
static inline void way_of(const pass *s, const uint32_t *slot, const double *q, size_t arity, const found_length *f,
                          double way[3]) {
    sum_of(s->a->projections->start, slot, q, arity, way);
    for (int k = 0; k < 3; k++) way[k] = f->length * f->n[k] - way[k];
}

/* Whether the multiplier from before pulls along an L that is 0 but for rounding: no derivative has that. */
static bool has_kink(const pass *s, const uint32_t *slot, const double *q, const found_length *f) {
    double size = 0;
    if (f->multiplier == 0 || !s->p->share) return false;
    for (size_t i = 0; i < s->arity; i++) {
        sk_vec4 x = s->a->projections->x[slot[i]];
        size += fabs(q[i]) * (fabs((double)x.x) + fabs((double)x.y) + fabs((double)x.z));
    }
    return f->length <= 1e-13 * size;
}

static inline bool project_length(pass *s, size_t lane, uint32_t element, size_t arity, found_length *f) {
    const sk_batch *batch = s->p->batch;
    const uint32_t *slot = batch->slot + arity * element;
    const double *q = shares_of(s, element, arity), rest = s->p->share ? 0 : (double)batch->rest[element];
    sk_vec4 *x = s->a->projections->x;
    double soft = softness_of(s, lane), weight = 0, sum[3], since = 0;
    sum_of(x, slot, q, arity, sum);
    for (size_t i = 0; i < arity; i++) weight += (double)x[slot[i]].w * q[i] * q[i];
    f->length = sqrt(dot(sum, sum));
    double inverse = f->length > 0 ? 1 / f->length : 0;
    for (int k = 0; k < 3; k++) f->n[k] = sum[k] * inverse;
    f->multiplier = s->keeps ? s->p->multiplier[lane] : 0;
    f->change = 0;
    f->below = weight > 0 && (s->p->share || f->length > 0) && soft < SK_UNBOUNDED ? (1 + s->gamma) * weight + soft : 0;
    if (!(f->below > 0)) return true;
    if (has_kink(s, slot, q, f))
        return !sk_fail(s->error, SKEIN_ERROR_VALUE, batch->label,
                        "element %u is straight to the last digit at %.6g s, where its multiplier has no derivative: "
                        "begin a little bent, or let the method have 1 iteration",
                        (unsigned)element, s->time);
    if (s->gamma > 0) {
        double way[3];
        way_of(s, slot, q, arity, f, way);
        since = dot(f->n, way);
    }
    f->change = (rest - f->length - soft * f->multiplier - s->gamma * since) / f->below;
    for (size_t i = 0; i < arity; i++) {
        sk_vec4 *to = &x[slot[i]];
        double by = (double)to->w * q[i] * f->change;
        to->x += (real)(by * f->n[0]), to->y += (real)(by * f->n[1]), to->z += (real)(by * f->n[2]);
    }
    if (s->keeps) s->p->multiplier[lane] += f->change;
    return true;
}

static inline void reverse_length(pass *s, size_t lane, uint32_t element, size_t arity, const found_length *f) {
    sk_projections *all = s->a->projections;
    const uint32_t *slot = s->p->batch->slot + arity * element;
    const double *q = shares_of(s, element, arity);
    double t[3] = {0}, by[3], way[3], soft = softness_of(s, lane), weight = 0;
    if (!(f->below > 0)) return;
    for (size_t i = 0; i < arity; i++) {
        const sk_vec4 *bar = &all->bar[slot[i]];
        double w = (double)all->x[slot[i]].w * q[i];
        t[0] += w * (double)bar->x, t[1] += w * (double)bar->y, t[2] += w * (double)bar->z;
        weight += w * q[i];
    }
    double nt = dot(f->n, t), share = (nt + (s->keeps ? s->p->bar[lane] : 0)) / f->below, stiff = 1 + s->gamma;
    double turn = f->length > 0 ? f->change / f->length : -1 / f->below; // there n is 0
    for (int k = 0; k < 3; k++) by[k] = turn * (t[k] - nt * f->n[k]) - share * stiff * f->n[k];
    if (s->looks_back) {
        way_of(s, slot, q, arity, f, way);
        double since = dot(f->n, way), back = f->length > 0 ? share * s->gamma / f->length : 0;
        for (int k = 0; k < 3; k++) by[k] -= back * (way[k] - since * f->n[k]);
        for (size_t i = 0; i < arity && s->gamma > 0; i++) {
            sk_vec4 *start = &all->bar_start[slot[i]];
            double c = share * s->gamma * q[i];
            start->x += (real)(c * f->n[0]), start->y += (real)(c * f->n[1]), start->z += (real)(c * f->n[2]);
        }
        s->by_gamma -= share * (since + f->change * weight);
    }
    for (size_t i = 0; i < arity; i++) {
        sk_vec4 *bar = &all->bar[slot[i]];
        bar->x += (real)(q[i] * by[0]), bar->y += (real)(q[i] * by[1]), bar->z += (real)(q[i] * by[2]);
    }
    if (s->keeps) s->p->bar[lane] -= share * soft;
    s->by_softness -= share * soft * (f->multiplier + f->change);
}

/* ---- ops ---- */

static pass begin_pass(sk_adjoint *a, const sk_op *op, double time, skein_error *error) {
    const sk_sweep *sweep = op->rule;
    const sk_rules *rules = &a->world->rules;
    size_t number = 0;
    while (rules->batches.data[number] != sweep->batch) number++;
    pass s = {.a = a,
              .op = op,
              .sweep = sweep,
              .p = &a->projections->data[number],
              .time = time - op->before_end,
              .keeps = op->source[1] == SK_X0,
              .arity = sweep->batch->arity,
              .error = error};
    s.per_step = op->coefficient[0] / (op->dt * op->dt);
    s.gamma = s.keeps ? sk_batch_damping_time(sweep->batch) / op->dt : 0;
    bool any = s.p->sort == BY_DIFFERENCES;
    s.bytes = any ? offsetof(found, x) + 2 * s.arity * sizeof(double[3]) : sizeof(found_length);
    s.looks_back = s.gamma > 0;
    for (size_t i = 0; i < a->effect_count; i++) s.looks_back |= a->effects[i].damping[number] != 0;
    return s;
}

/* Room for a record, at the end of all. */
static char *new_record(pass *s) {
    sk_projections *all = s->a->projections;
    char *at = all->records + all->used;
    all->used += s->bytes;
    return at;
}
static char *last_record(pass *s) {
    sk_projections *all = s->a->projections;
    return all->records + (all->used -= s->bytes);
}

/* One has only as many particles as its element, so that the gradients stand behind those. */
static void put_record(pass *s, const found *f) {
    size_t head = offsetof(found, x), part = s->arity * sizeof(double[3]);
    char *to = new_record(s);
    memcpy(to, f, head);
    memcpy(to + head, f->x, part);
    memcpy(to + head + part, f->gradient, part);
}

static void take_record(pass *s, found *f) {
    size_t head = offsetof(found, x), part = s->arity * sizeof(double[3]);
    const char *from = last_record(s);
    memcpy(f, from, head);
    memcpy(f->x, from + head, part);
    memcpy(f->gradient, from + head + part, part);
}

static bool run_element(pass *s, size_t lane, uint32_t element) {
    if (s->p->sort == BY_LENGTH) {
        found_length *f = (found_length *)(void *)new_record(s);
        return s->arity == 2   ? project_length(s, lane, element, 2, f)
               : s->arity == 3 ? project_length(s, lane, element, 3, f)
                               : project_length(s, lane, element, s->arity, f);
    }
    found f;
    f.element = element;
    if (!project(s, lane, &f)) return false;
    put_record(s, &f);
    return true;
}

static bool reverse_element(pass *s, size_t lane, uint32_t element) {
    if (s->p->sort == BY_LENGTH) {
        const found_length *f = (const found_length *)(const void *)last_record(s);
        if (s->arity == 2) reverse_length(s, lane, element, 2, f);
        else if (s->arity == 3) reverse_length(s, lane, element, 3, f);
        else reverse_length(s, lane, element, s->arity, f);
        return true;
    }
    found f;
    take_record(s, &f);
    return reverse(s, lane, &f);
}

static bool run_op(sk_adjoint *a, const sk_op *op, double time, skein_error *error) {
    pass s = begin_pass(a, op, time, error);
    sk_projections *all = a->projections;
    size_t first = s.sweep->first_lane, count = sk_sweep_lane_count(s.sweep);
    bool good = true, projects = !clears(op);
    size_t most = all->used + (projects ? s.sweep->element_count * s.bytes : 0);
    if (!sk_reserve(&a->world->allocator, (void **)&all->records, &all->capacity, most, 1))
        return !sk_fail_memory(error, "a gradient");
    for (size_t l = 0; l < count && good; l++) {
        uint32_t element = s.p->element[first + l];
        if (element == NOBODY || !sk_sweep_half_has(s.sweep, op->half, l)) continue;
        if (projects) good = run_element(&s, first + l, element);
        else s.p->multiplier[first + l] = 0;
    }
    return good;
}

/* What a batch's stiffness and damping change: a = 1/(k ...), and c = damping/(k h). */
static void add_effects(const pass *s) {
    sk_adjoint *a = s->a;
    const sk_material *material = s->p->batch->params;
    size_t number = (size_t)(s->p - a->projections->data);
    double k = material->stiffness, by_stiffness = isfinite(k) ? -(s->by_softness + s->by_gamma * s->gamma) / k : 0;
    double by_damping = isfinite(k) ? s->by_gamma / (k * s->op->dt) : 0;
    for (size_t i = 0; i < a->effect_count; i++)
        a->by_effect[i] += by_stiffness * a->effects[i].stiffness[number] + by_damping * a->effects[i].damping[number];
}

static bool reverse_op(sk_adjoint *a, const sk_op *op, double time, skein_error *error) {
    pass s = begin_pass(a, op, time, error);
    size_t first = s.sweep->first_lane;
    bool good = true;
    for (size_t l = sk_sweep_lane_count(s.sweep); l-- > 0 && good;) {
        uint32_t element = s.p->element[first + l];
        if (element == NOBODY || !sk_sweep_half_has(s.sweep, op->half, l)) continue;
        if (!clears(op)) good = reverse_element(&s, first + l, element);
        else s.p->bar[first + l] = 0;
    }
    if (!clears(op)) add_effects(&s);
    return good;
}

/* ---- a substep's projections ---- */

static void unpack(const sk_adjoint *a, const real *from, sk_vec4 *to) {
    for (size_t p = 0; p < a->world->particles.count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride);
        to[a->world->particles.slot_of[p]] =
            (sk_vec4){from[at], from[at + stride], from[at + 2 * stride], a->inverse_mass[at]};
    }
}

static void pack(const sk_adjoint *a, const sk_vec4 *from, real *to, bool adds) {
    for (size_t p = 0; p < a->world->particles.count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride);
        const sk_vec4 *x = &from[a->world->particles.slot_of[p]];
        const real number[3] = {x->x, x->y, x->z};
        for (size_t k = 0; k < 3; k++, at += stride) to[at] = number[k] + (adds ? to[at] : 0);
    }
}

skein_status sk_adjoint_reverse_projections(sk_adjoint *a, const sk_op *ops, size_t count, size_t iteration,
                                            const sk_taped *at, double time, skein_error *error) {
    sk_projections *all = a->projections;
    const sk_run run = {.iteration = iteration};
    bool good = true;
    unpack(a, at->x, all->x);
    unpack(a, at->v, all->start);
    unpack(a, a->of[SK_X], all->bar);
    memset(all->bar_start, 0, a->world->particles.slot_capacity * sizeof(sk_vec4));
    for (size_t i = 0; i < all->count; i++) {
        const projected *p = &all->data[i];
        if (p->bar) memset(p->bar, 0, p->batch->lane_count * sizeof *p->bar);
        if (p->bar) memset(p->multiplier, 0, p->batch->lane_count * sizeof *p->multiplier);
    }
    all->used = 0;
    for (size_t k = 0; k < count && good; k++)
        if (sk_op_is_due(&run, &ops[k])) good = run_op(a, &ops[k], time, error);
    for (size_t k = count; k-- > 0 && good;)
        if (sk_op_is_due(&run, &ops[k])) good = reverse_op(a, &ops[k], time, error);
    if (!good) return error->status;
    pack(a, all->bar, a->of[SK_X], false);
    pack(a, all->bar_start, a->of[SK_X0], true);
    return SKEIN_OK;
}
