/* The inside of a closed surface: a volume to be kept (`enclosed_volume`), or gas (`pressure`).
 *
 * Both are an energy of a single number, the volume V inside all of the batch's triangles:
 *
 *     p(V) = -dE/dV        the pressure, outwards positive
 *     force                (p - c dV/dt) grad V
 *     project              x += w grad V dl,   dl = (p - l n/h^2 - c dV/h) / ((k + c/h) W + n/h^2)
 *                          with k = -dp/dV, W = sum w |grad V|^2, dV = grad V . (x - x0), n passes that share k
 *     implicit solves      k grad V grad V^T (Gauss-Newton), which couples all particles
 *
 * which is XPBD's projection if p = -k (V - target), and its linearisation for other laws. The sums over triangles and
 * the loop over particles run in a fixed order on one thread, so their bits do not depend on the number of threads. */
#define SK_ARITY 3
#define SK_RESTS 1 // it has none, but an array needs at least one
#define SK_FORMULA "constraints/emitted/enclosed.h"
#include "base/elementary.h"
#include "base/kernels.h"
#include "base/layout.h"
#include "base/status.h"
#include "constraints/element.h"
#include "constraints/enclosure.h"

typedef struct enclosed_params {
    sk_material material; /* of gas, the stiffness is its pressure at rest, Pa */
    double inflation;     /* of a volume */
    double outside, exponent;
} enclosed_params;

/* ---- the laws ---- */

/* Pressure and so on at some volume. */
typedef struct law {
    double pressure, stiffness; /* Pa, Pa/m3 */
    double missing;             /* m3: what a kept volume lacks */
    double energy;              /* J, from the volume at rest on */
    bool guarded;
} law;

/* Below a thousandth of its volume (a surface may even turn inside out) gas follows the tangent of its law. */
static const double least_share = 1e-3;

/* p = p0 (V0/V)^n - outside: isothermal for n = 1, adiabatic for 1.4 in air. */
static law law_of_gas(const enclosed_params *params, double rest, double volume) {
    double p0 = params->material.stiffness, n = params->exponent, share = volume / rest;
    law now = {.guarded = share < least_share};
    double at = now.guarded ? least_share : share, logarithm = sk_log(at);
    double inside = p0 * sk_exp(-n * logarithm), beyond = (share - at) * rest;
    now.stiffness = n * inside / (at * rest);
    now.pressure = inside - now.stiffness * beyond - params->outside;
    double work = n == 1 ? -logarithm : (sk_exp((1 - n) * logarithm) - 1) / (n - 1);
    now.energy =
        p0 * rest * work - inside * beyond + 0.5 * now.stiffness * beyond * beyond + params->outside * (volume - rest);
    return now;
}

extern const sk_constraint_type sk_pressure; // below

static law law_of(const sk_batch *batch, double volume) {
    const enclosed_params *params = batch->params;
    double rest = batch->enclosure->rest_volume, k = params->material.stiffness;
    if (batch->type == &sk_pressure) return law_of_gas(params, rest, volume);
    double missing = params->inflation * rest - volume;
    return (law){.pressure = k * missing, .stiffness = k, .missing = missing, .energy = 0.5 * k * missing * missing};
}

typedef double measurer(sk_enclosure *s, const sk_vec4 *x, size_t packed);

#define SK_UNIT pressure
SK_KERNELS(measurer, measure);
SK_KERNELS(sk_op_kernel, force_groups);
SK_KERNELS(sk_op_kernel, project_groups);
SK_KERNELS(sk_op_kernel, project_damped_groups);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);

#ifdef SK_ISA

#include "constraints/element_arithmetic.h"

/* ---- over the particles ---- */

/* grad V . u, or grad V . (u - from). */
static double along(const sk_enclosure *s, const sk_vec4 *u, const sk_vec4 *from, size_t packed) {
    double sum = 0;
    for (size_t v = 0; v < s->vertex_count; v++) {
        const real *g = s->gradient + 3 * v;
        sk_vec3 d = sk_xyz(sk_load(u, packed, s->slot[v]));
        if (from) d = sk_sub(d, sk_xyz(sk_load(from, packed, s->slot[v])));
        sum += (double)(g[0] * d.x + g[1] * d.y + g[2] * d.z);
    }
    return sum;
}

static double weigh(const sk_enclosure *s, const sk_vec4 *x, size_t packed) {
    double sum = 0;
    for (size_t v = 0; v < s->vertex_count; v++) {
        const real *g = s->gradient + 3 * v;
        sum += (double)(sk_load(x, packed, s->slot[v]).w * (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
    }
    return sum;
}

/* dst += scale grad V, times the inverse masses of `weights` if there are any. */
static void push(const sk_enclosure *s, sk_vec4 *dst, const sk_vec4 *weights, size_t packed, double scale) {
    for (size_t v = 0; v < s->vertex_count; v++) {
        const real *g = s->gradient + 3 * v;
        real one = weights ? (real)scale * sk_load(weights, packed, s->slot[v]).w : (real)scale;
        sk_add_at(dst, packed, s->slot[v], sk_v3(one * g[0], one * g[1], one * g[2]));
    }
}

/* Returns the volume, m3; leaves the vertices' places and the gradient in the enclosure. */
double SK_KERNEL(measure)(sk_enclosure *s, const sk_vec4 *x, size_t packed) {
    sk_vec3 origin = sk_xyz(sk_load(x, packed, s->slot[0]));
    for (size_t v = 0; v < s->vertex_count; v++) {
        sk_vec3 p = sk_sub(sk_xyz(sk_load(x, packed, s->slot[v])), origin);
        real *place = s->place + 3 * v;
        place[0] = p.x, place[1] = p.y, place[2] = p.z;
    }
    memset(s->gradient, 0, 3 * s->vertex_count * sizeof *s->gradient);
    double volume = 0;
    for (size_t t = 0; t < s->lane_count; t += SK_PART) {
        sk_element e;
        real places[SK_ARITY][3][SK_PART];
        SK_EACH_PARTICLE (i)
            for (size_t l = 0; l < SK_PART; l++) {
                const real *place = s->place + 3 * (size_t)s->corner[i][t + l];
                places[i][0][l] = place[0], places[i][1][l] = place[1], places[i][2][l] = place[2];
            }
        memcpy(e.x, places, sizeof places);
        formula(&e);
        for (size_t l = 0; l < SK_PART; l++) volume += (double)e.value[l];
        for (size_t l = 0; l < SK_PART; l++)
            SK_EACH_PARTICLE (i) {
                real *gradient = s->gradient + 3 * (size_t)s->corner[i][t + l];
                gradient[0] += e.gradient[i].x[l], gradient[1] += e.gradient[i].y[l];
                gradient[2] += e.gradient[i].z[l];
            }
    }
    return volume;
}

void SK_KERNEL(force_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_batch *batch = ((const sk_sweep *)op->rule)->batch;
    sk_enclosure *s = batch->enclosure;
    law now = law_of(batch, SK_KERNEL(measure)(s, run->vector[SK_X], op->packed));
    double damping = ((const sk_material *)batch->params)->damping;
    double rate = damping > 0 ? along(s, run->vector[SK_V], NULL, op->packed) : 0;
    push(s, run->vector[op->dst], NULL, op->packed, now.pressure - damping * rate);
}

static void project_whole(sk_run *run, const sk_op *op, bool damped) {
    const sk_sweep *sweep = op->rule;
    const sk_batch *batch = sweep->batch;
    const sk_material *material = batch->params;
    sk_enclosure *s = batch->enclosure;
    real *multiplier = batch->lane_multiplier + sweep->first_lane;
    sk_vec4 *x = run->vector[SK_X];
    law now = law_of(batch, SK_KERNEL(measure)(s, x, op->packed));
    double weight = weigh(s, x, op->packed), change = 0;
    if (material->stiffness >= SK_UNBOUNDED) {
        change = weight > 0 ? now.missing / weight : 0;
    } else {
        double h = op->dt, inertia = op->coefficient[0] / (h * h), drag = damped ? material->damping / h : 0;
        double moved = damped ? along(s, x, run->vector[op->source[1]], op->packed) : 0;
        double held = damped ? (double)*multiplier * inertia : 0;
        change = (now.pressure - held - drag * moved) / ((now.stiffness + drag) * weight + inertia);
    }
    if (damped) *multiplier += (real)change;
    push(s, x, x, op->packed, change);
}

void SK_KERNEL(project_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    project_whole(run, op, false);
}
void SK_KERNEL(project_damped_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    project_whole(run, op, true);
}

/* Returns a k + b c at the present volume; leaves the gradient in the enclosure. */
static double stiffen(const sk_run *run, const sk_op *op) {
    const sk_batch *batch = op->rule;
    law now = law_of(batch, SK_KERNEL(measure)(batch->enclosure, run->vector[SK_X], op->packed));
    return op->coefficient[0] * now.stiffness + op->coefficient[1] * ((const sk_material *)batch->params)->damping;
}

void SK_KERNEL(apply)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    sk_enclosure *s = ((const sk_batch *)op->rule)->enclosure;
    double both = stiffen(run, op);
    push(s, run->vector[op->dst], NULL, op->packed, both * along(s, run->vector[op->source[1]], NULL, op->packed));
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)begin, (void)end;
    const sk_enclosure *s = ((const sk_batch *)op->rule)->enclosure;
    real both = (real)stiffen(run, op);
    for (size_t v = 0; v < s->vertex_count; v++) {
        const real *g = s->gradient + 3 * v;
        sk_add_at(run->vector[op->dst], op->packed, s->slot[v],
                  sk_v3(both * g[0] * g[0], both * g[1] * g[1], both * g[2] * g[2]));
        sk_add_at(run->vector[op->source[1]], op->packed, s->slot[v],
                  sk_v3(both * g[0] * g[1], both * g[0] * g[2], both * g[1] * g[2]));
    }
}

#else

/* Every version gives the same bits; the first runs on every machine. */
static double volume_of(sk_enclosure *s, const sk_vec4 *x) {
    static measurer *const versions[] = SK_EACH_ISA(measure);
    return versions[0](s, x, 0);
}

static skein_status enclose(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                            skein_error *error) {
    skein_status status = sk_enclosure_create(batch, allocator, particles, error);
    if (status) return status;
    sk_enclosure *s = batch->enclosure;
    s->rest_volume = volume_of(s, particles->vector[SK_X]);
    if (s->rest_volume < 0) {
        sk_enclosure_turn(s); // its triangles face inwards
        s->rest_volume = volume_of(s, particles->vector[SK_X]);
    }
    if (s->rest_volume > 0 && s->rest_volume <= SK_FAR) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "", "the surface is closed, but there is no volume inside (%g m3)",
                   s->rest_volume);
}

static double whole_energy(const sk_batch *batch, const sk_vec4 *x, size_t *guarded) {
    law now = law_of(batch, volume_of(batch->enclosure, x));
    *guarded += now.guarded;
    return ((const sk_material *)batch->params)->stiffness >= SK_UNBOUNDED ? 0 : now.energy;
}

/* A kept volume has the C by which it is too large; gas is an energy. */
static bool evaluate(const sk_batch *batch, double time, const sk_vec4 *x, size_t element, size_t most,
                     sk_constraint_answer *answer, double (*gradient)[3]) {
    (void)time, (void)element;
    const sk_enclosure *s = batch->enclosure;
    bool gas = batch->type == &sk_pressure;
    law now = law_of(batch, volume_of(batch->enclosure, x));
    *answer = (sk_constraint_answer){gas ? now.energy : -now.missing, 0, gas, false, now.guarded};
    for (size_t v = 0; v < s->vertex_count && v < most; v++)
        for (int k = 0; k < 3; k++) gradient[v][k] = (gas ? -now.pressure : 1) * (double)s->gradient[3 * v + (size_t)k];
    return true;
}

static const skein_field volume_fields[] = {
    SK_REAL(enclosed_params, material.stiffness, "stiffness", "Pa/m3", 1e6, 0, SK_UNBOUNDED,
            "pressure a cubic metre of change; \"infinite\" is rigid (position methods only)"),
    SK_REAL(enclosed_params, material.damping, "damping", "Pa s/m3", 0, 0, SK_FAR,
            "the same against the volume's change in time"),
    SK_REAL(enclosed_params, inflation, "inflation", "", 1, 0, 1e6,
            "the volume that it wants, by what it was when it was added: 1.2 blows it up by a fifth"),
};

static const skein_field pressure_fields[] = {
    SK_REAL(enclosed_params, material.stiffness, "pressure", "Pa", 1000, 0, SK_FAR,
            "of the gas, at the volume that the surface had when it was added"),
    SK_REAL(enclosed_params, outside, "outside", "Pa", 0, 0, SK_FAR, "of the air around: 101325 at sea level"),
    SK_REAL(enclosed_params, exponent, "exponent", "", 1, 0, 10,
            "pressure times volume to this power stays: 1 at one temperature, 1.4 for quick changes of air, 0 for a "
            "pressure that stays"),
    SK_REAL(enclosed_params, material.damping, "damping", "Pa s/m3", 0, 0, SK_FAR,
            "pressure against the volume's change in time"),
};

/* The members that both kinds have in common. */
#define AROUND_A_VOLUME                                                                                              \
    .arity = SK_ARITY, .force.groups = {SK_EACH_ISA(force_groups)}, .project.groups = {SK_EACH_ISA(project_groups)}, \
    .project_damped.groups = {SK_EACH_ISA(project_damped_groups)}, .apply = {SK_EACH_ISA(apply)},                    \
    .diagonal = {SK_EACH_ISA(diagonal)}, .enclose = enclose, .whole_energy = whole_energy, .evaluate = evaluate

const sk_constraint_type sk_enclosed_volume = {
    .kind = {"enclosed_volume", "keeps the volume inside a closed surface of triangles", SKEIN_CONSTRAINT,
             volume_fields, sizeof volume_fields / sizeof *volume_fields, sizeof(enclosed_params)},
    AROUND_A_VOLUME,
};

const sk_constraint_type sk_pressure = {
    .kind = {"pressure", "gas inside a closed surface of triangles", SKEIN_CONSTRAINT, pressure_fields,
             sizeof pressure_fields / sizeof *pressure_fields, sizeof(enclosed_params)},
    AROUND_A_VOLUME,
};
#endif
