/* Forces by a formula of one particle, which is a force or a potential energy. The file that includes this defines
 *
 *   SIGN                          1 if the first outputs are the force, -1 if they are a potential's gradient
 *   TEXT                          the text field's name
 *   choose_force, choose_slopes   the outputs of the formula: a vector, and for implicit methods xx yy zz xy xz yz of
 *                                 the stiffness, and of the damping if it depends on velocities
 *   force_desc, slopes_desc       how the text is parsed for each
 *
 * and by_formula_params, its parameters. */
#include "forces/force.h"
#include "formula/pointwise.h"

enum { PER_MASS, PER_PARTICLE };

typedef struct by_formula_params {
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    char *text;
    int32_t per;
    sk_pointwise *force, *slopes;
} by_formula_params;

#ifdef SK_ISA

#include "forces/blocks.h"

/* Evaluates the outputs for the particles of a part; returns the factor that makes newtons or joules of them: the mass
 * or 1, and 0 for slots without a particle. */
SK_INLINE sk_wide outputs_of(const sk_pointwise *formula, sk_run *run, const sk_op *op, size_t slot, sk_wide *out) {
    const by_formula_params *params = ((const sk_force *)op->rule)->params;
    bool packed = slot < op->packed;
    sk_mask guarded;
    sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), v = sk_load_part(run->vector[SK_V], slot, packed);
    sk_wide3 p = {x.x, x.y, x.z}, u = {v.x, v.y, v.z};
    sk_pointwise_run_of[SK_THIS_ISA](formula, params->parameter, run->time - op->before_end, &p, &u, out, &guarded);
    return params->per == PER_MASS ? v.w : sk_keep(sk_positive(v.w), sk_splat(1));
}

void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const by_formula_params *params = ((const sk_force *)op->rule)->params;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide out[SK_POINTWISE_MOST_OUTPUTS];
        sk_wide m = SIGN * outputs_of(params->force, run, op, slot, out);
        sk_wide4 f = {0};
        if (!op->sets) f = sk_load_part(run->vector[op->dst], slot, packed);
        f.x += m * out[0], f.y += m * out[1], f.z += m * out[2];
        sk_store_part(run->vector[op->dst], slot, packed, f);
    }
}

/* a times the stiffness and b times the damping. */
SK_INLINE stiffness_block slopes_of(sk_run *run, const sk_op *op, size_t slot) {
    const by_formula_params *params = ((const sk_force *)op->rule)->params;
    real a = (real)op->coefficient[0], b = (real)op->coefficient[1];
    sk_wide out[SK_POINTWISE_MOST_OUTPUTS], k[6];
    sk_wide m = outputs_of(params->slopes, run, op, slot, out);
    for (int i = 0; i < 6; i++) k[i] = SIGN > 0 ? m * (a * out[i] + b * out[6 + i]) : a * m * out[i];
    stiffness_block block = {k[0], k[1], k[2], k[3], k[4], k[5]};
    make_positive(&block);
    return block;
}

void SK_KERNEL(apply)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = slopes_of(run, op, slot);
        add_product(run, op, slot, &block);
    }
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = slopes_of(run, op, slot);
        add_block(run, op, slot, &block);
    }
}

#else

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    by_formula_params *params = data;
    sk_pointwise *force, *slopes;
    bool first = !params->force;
    skein_status status =
        sk_pointwise_create(TEXT, params->text, force_desc, choose_force, kind, first, allocator, &force, error);
    if (status) return status;
    status =
        sk_pointwise_create(TEXT, params->text, slopes_desc, choose_slopes, kind, first, allocator, &slopes, error);
    if (status) {
        sk_pointwise_destroy(force, allocator);
        return status;
    }
    sk_pointwise_destroy(params->force, allocator);
    sk_pointwise_destroy(params->slopes, allocator);
    params->force = force, params->slopes = slopes;
    return SKEIN_OK;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_pointwise_destroy(((by_formula_params *)data)->force, allocator);
    sk_pointwise_destroy(((by_formula_params *)data)->slopes, allocator);
}

static void pack(const void *data, float (*block)[4]) {
    const by_formula_params *params = data;
    block[0][0] = params->per == PER_MASS, block[0][1] = SIGN;
    sk_pointwise_pack(params->force, params->parameter, block + 1);
}

static bool write(const void *data, void (*put)(void *user, const char *text), void *user) {
    return sk_pointwise_put_glsl(((const by_formula_params *)data)->force, 1, put, user);
}

static bool changes(const void *data) {
    return ((const by_formula_params *)data)->force->formula->uses & SK_USES_TIME;
}

static bool is_guarded(const void *data, const double x[3], const double v[3], double time) {
    const by_formula_params *params = data;
    double value[3];
    bool guarded;
    sk_pointwise_value(params->force, params->parameter, time, x, v, value, &guarded);
    return guarded;
}

static bool at(const void *data, const double x[3], double time, double force[3]) {
    const by_formula_params *params = data;
    static const double rests[3];
    skein_formula_point point = {.positions = x, .velocities = rests, .parameters = params->parameter, .time = time};
    skein_formula_value value;
    if (skein_formula_evaluate(params->force->formula, &point, &value, NULL)) return false;
    for (int k = 0; k < 3; k++) force[k] = SIGN > 0 ? value.number[k] : -value.by_position[0][k];
    return true;
}

static const sk_making making = {.make = make, .unmake = unmake, .by_text = true};

/* The members that both types have in common. */
#define BY_FORMULA                                                                                             \
    .domain = SK_OVER_PARTICLES, .sets = true, .kernel = {SK_EACH_ISA(kernel)}, .apply = {SK_EACH_ISA(apply)}, \
    .diagonal = {SK_EACH_ISA(diagonal)}, .guarded = is_guarded, .at = at, .making = &making,                   \
    .shader = {                                                                                                \
        .file = "forces/by_formula", .size = 1 + SK_POINTWISE_BLOCK, .pack = pack, .write = write, .changes = changes}
#endif
