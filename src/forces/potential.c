/* A potential energy by a formula: F = -grad U. */
#include "base/kernels.h"
#include "forces/force.h"
#include "formula/pointwise.h"

enum { PER_MASS, PER_PARTICLE };

typedef struct potential_params {
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    char *energy;
    int32_t per;
    sk_pointwise *slope, *curvature;
} potential_params;

#define SK_UNIT potential
SK_KERNELS(sk_op_kernel, kernel);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);

#ifdef SK_ISA

#include "forces/blocks.h"

/* What a formula's value counts in joules: a particle's mass, or 1; 0 for slots without a particle. */
SK_INLINE sk_wide weight(const potential_params *params, sk_wide mass) {
    if (params->per == PER_MASS) return mass;
    return sk_keep(sk_positive(mass), sk_splat(1));
}

void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const potential_params *params = ((const sk_force *)op->rule)->params;
    double time = run->time - op->before_end;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide out[SK_POINTWISE_MOST_OUTPUTS];
        sk_mask guarded;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), f = {0};
        sk_wide mass = sk_load_part(run->vector[SK_V], slot, packed).w;
        sk_wide3 p = {x.x, x.y, x.z};
        sk_pointwise_run_of[SK_THIS_ISA](params->slope, params->parameter, time, &p, NULL, out, &guarded);
        sk_wide m = weight(params, mass);
        if (!op->sets) f = sk_load_part(run->vector[op->dst], slot, packed);
        f.x -= m * out[0], f.y -= m * out[1], f.z -= m * out[2];
        sk_store_part(run->vector[op->dst], slot, packed, f);
    }
}

/* a times the stiffness. */
SK_INLINE stiffness_block curve(sk_run *run, const sk_op *op, size_t slot) {
    const potential_params *params = ((const sk_force *)op->rule)->params;
    bool packed = slot < op->packed;
    sk_wide out[SK_POINTWISE_MOST_OUTPUTS];
    sk_mask guarded;
    sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
    sk_wide mass = sk_load_part(run->vector[SK_V], slot, packed).w;
    sk_wide3 p = {x.x, x.y, x.z};
    sk_pointwise_run_of[SK_THIS_ISA](params->curvature, params->parameter, run->time - op->before_end, &p, NULL, out,
                                     &guarded);
    sk_wide m = (real)op->coefficient[0] * weight(params, mass);
    stiffness_block block = {m * out[0], m * out[1], m * out[2], m * out[3], m * out[4], m * out[5]};
    make_positive(&block);
    return block;
}

void SK_KERNEL(apply)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = curve(run, op, slot);
        add_product(run, op, slot, &block);
    }
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = curve(run, op, slot);
        add_block(run, op, slot, &block);
    }
}

#else

static const skein_field fields[] = {
    SK_TEXT(potential_params, energy, "energy", "0",
            "a number, as a formula of p and t: the force goes down its slope"),
    SK_CHOICE(potential_params, per, "per", PER_MASS, "mass|particle",
              "mass: the formula is J/kg, as g times a height; particle: J for each"),
    SK_PARAMETERS(potential_params, parameter, "a number that the formula names: { \"k\": 2 }, say"),
};

static size_t choose_slope(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    for (int axis = 0; axis < 3; axis++) outputs[axis] = f->by_position[0][axis];
    return 3;
}

static size_t choose_curvature(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    static const int places[6] = {0, 4, 8, 1, 2, 5}; // xx yy zz xy xz yz
    for (int i = 0; i < 6; i++) outputs[i] = f->hessian[places[i]];
    return 6;
}

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    potential_params *params = data;
    skein_formula_desc desc = {.result = SKEIN_FORMULA_NUMBER};
    sk_pointwise *slope, *curvature;
    bool first = !params->slope;
    skein_status status =
        sk_pointwise_create("energy", params->energy, desc, choose_slope, kind, first, allocator, &slope, error);
    if (status) return status;
    desc.second = true;
    status = sk_pointwise_create("energy", params->energy, desc, choose_curvature, kind, first, allocator, &curvature,
                                 error);
    if (status) {
        sk_pointwise_destroy(slope, allocator);
        return status;
    }
    sk_pointwise_destroy(params->slope, allocator);
    sk_pointwise_destroy(params->curvature, allocator);
    params->slope = slope, params->curvature = curvature;
    return SKEIN_OK;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_pointwise_destroy(((potential_params *)data)->slope, allocator);
    sk_pointwise_destroy(((potential_params *)data)->curvature, allocator);
}

static double energy_of(const void *data, const double x[3], double mass, double time) {
    const potential_params *params = data;
    double value[3];
    sk_pointwise_value(params->slope, params->parameter, time, x, NULL, value, NULL);
    return (params->per == PER_MASS ? mass : 1) * value[0];
}

static void pack(const void *data, float (*block)[4]) {
    const potential_params *params = data;
    block[0][0] = params->per == PER_MASS;
    sk_pointwise_pack(params->slope, params->parameter, block + 1);
}

static bool write(const void *data, void (*put)(void *user, const char *text), void *user) {
    return sk_pointwise_put_glsl(((const potential_params *)data)->slope, 1, put, user);
}

static bool changes(const void *data) {
    return ((const potential_params *)data)->slope->formula->uses & SK_USES_TIME;
}

static bool is_guarded(const void *data, const double x[3], const double v[3], double time) {
    const potential_params *params = data;
    double value[3];
    bool guarded;
    sk_pointwise_value(params->slope, params->parameter, time, x, v, value, &guarded);
    return guarded;
}

static bool at(const void *data, const double x[3], double time, double force[3]) {
    const potential_params *params = data;
    static const double rests[3];
    skein_formula_point point = {.positions = x, .velocities = rests, .parameters = params->parameter, .time = time};
    skein_formula_value value;
    if (skein_formula_evaluate(params->slope->formula, &point, &value, NULL)) return false;
    for (int k = 0; k < 3; k++) force[k] = -value.by_position[0][k];
    return true;
}

static const sk_making making = {.make = make, .unmake = unmake};
const sk_force_type sk_potential = {
    .kind = {"potential", "any potential energy of place (and time) that is a formula", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(potential_params)},
    .domain = SK_OVER_PARTICLES,
    .sets = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .potential = energy_of,
    .apply = {SK_EACH_ISA(apply)},
    .diagonal = {SK_EACH_ISA(diagonal)},
    .guarded = is_guarded,
    .at = at,
    .making = &making,
    .shader =
        {.file = "forces/potential", .size = 1 + SK_POINTWISE_BLOCK, .pack = pack, .write = write, .changes = changes},
};
#endif
