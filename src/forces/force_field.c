/* A force by a formula of place, velocity and time. */
#include "base/kernels.h"
#include "forces/force.h"
#include "formula/pointwise.h"

enum { PER_MASS, PER_PARTICLE };

typedef struct force_field_params {
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    char *text;
    int32_t per;
    sk_pointwise *force, *slopes;
} force_field_params;

#define SK_UNIT force_field
SK_KERNELS(sk_op_kernel, kernel);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);

#ifdef SK_ISA

#include "forces/blocks.h"

/* What a formula's value counts in newtons: a particle's mass, or 1; 0 for slots without a particle. */
SK_INLINE sk_wide weight(const force_field_params *params, sk_wide mass) {
    if (params->per == PER_MASS) return mass;
    return sk_keep(sk_positive(mass), sk_splat(1));
}

void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const force_field_params *params = ((const sk_force *)op->rule)->params;
    double time = run->time - op->before_end;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide out[SK_POINTWISE_MOST_OUTPUTS];
        sk_mask guarded;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed), f = {0};
        sk_wide3 p = {x.x, x.y, x.z}, u = {v.x, v.y, v.z};
        sk_pointwise_run_of[SK_THIS_ISA](params->force, params->parameter, time, &p, &u, out, &guarded);
        sk_wide m = weight(params, v.w);
        if (!op->sets) f = sk_load_part(run->vector[op->dst], slot, packed);
        f.x += m * out[0], f.y += m * out[1], f.z += m * out[2];
        sk_store_part(run->vector[op->dst], slot, packed, f);
    }
}

/* a times the stiffness and b times the damping. */
SK_INLINE stiffness_block slope(sk_run *run, const sk_op *op, size_t slot) {
    const force_field_params *params = ((const sk_force *)op->rule)->params;
    bool packed = slot < op->packed;
    real a = (real)op->coefficient[0], b = (real)op->coefficient[1];
    sk_wide out[SK_POINTWISE_MOST_OUTPUTS], k[6];
    sk_mask guarded;
    sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
    sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
    sk_wide3 p = {x.x, x.y, x.z}, u = {v.x, v.y, v.z};
    sk_pointwise_run_of[SK_THIS_ISA](params->slopes, params->parameter, run->time - op->before_end, &p, &u, out,
                                     &guarded);
    sk_wide m = weight(params, v.w);
    for (int i = 0; i < 6; i++) k[i] = m * (a * out[i] + b * out[6 + i]);
    stiffness_block block = {k[0], k[1], k[2], k[3], k[4], k[5]};
    make_positive(&block);
    return block;
}

void SK_KERNEL(apply)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = slope(run, op, slot);
        add_product(run, op, slot, &block);
    }
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        stiffness_block block = slope(run, op, slot);
        add_block(run, op, slot, &block);
    }
}

#else

static const skein_field fields[] = {
    SK_TEXT(force_field_params, text, "force", "vec3(0, 0, 0)", "a vector, as a formula of p, v and t"),
    SK_CHOICE(force_field_params, per, "per", PER_MASS, "mass|particle",
              "mass: the formula is an acceleration, m/s2; particle: a force on each, N"),
    SK_PARAMETERS(force_field_params, parameter, "a number that the formula names: { \"k\": 2 }, say"),
};

static size_t choose_force(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    for (int axis = 0; axis < 3; axis++) outputs[axis] = f->value[axis];
    return 3;
}

/* The symmetric parts of -dF/dp and -dF/dv: xx yy zz xy xz yz of each. */
static size_t choose_slopes(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    static const int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    for (int which = 0; which < 2; which++)
        for (int i = 0; i < 6; i++) {
            int row = pairs[i][0], column = pairs[i][1];
            sk_node one = which ? f->by_velocity[row][column] : f->by_position[row][column];
            sk_node two = which ? f->by_velocity[column][row] : f->by_position[column][row];
            sk_node sum = sk_plus(&f->graph, one, two), half = sk_constant(&f->graph, -0.5);
            outputs[6 * which + i] = sk_times(&f->graph, half, sum);
        }
    return 12;
}

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    force_field_params *params = data;
    skein_formula_desc desc = {.result = SKEIN_FORMULA_VECTOR, .velocities = true};
    sk_pointwise *force, *slopes;
    bool first = !params->force;
    skein_status status =
        sk_pointwise_create("force", params->text, desc, choose_force, kind, first, allocator, &force, error);
    if (status) return status;
    status = sk_pointwise_create("force", params->text, desc, choose_slopes, kind, first, allocator, &slopes, error);
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
    sk_pointwise_destroy(((force_field_params *)data)->force, allocator);
    sk_pointwise_destroy(((force_field_params *)data)->slopes, allocator);
}

static bool uses_velocity(const void *data) {
    return ((const force_field_params *)data)->force->formula->uses & SK_USES_VELOCITY;
}

static void pack(const void *data, float (*block)[4]) {
    const force_field_params *params = data;
    block[0][0] = params->per == PER_MASS;
    sk_pointwise_pack(params->force, params->parameter, block + 1);
}

static bool write(const void *data, void (*put)(void *user, const char *text), void *user) {
    return sk_pointwise_put_glsl(((const force_field_params *)data)->force, 1, put, user);
}

static bool changes(const void *data) {
    return ((const force_field_params *)data)->force->formula->uses & SK_USES_TIME;
}

static bool is_guarded(const void *data, const double x[3], const double v[3], double time) {
    const force_field_params *params = data;
    double value[3];
    bool guarded;
    sk_pointwise_value(params->force, params->parameter, time, x, v, value, &guarded);
    return guarded;
}

static bool at(const void *data, const double x[3], double time, double force[3]) {
    const force_field_params *params = data;
    static const double rests[3];
    skein_formula_point point = {.positions = x, .velocities = rests, .parameters = params->parameter, .time = time};
    skein_formula_value value;
    if (skein_formula_evaluate(params->force->formula, &point, &value, NULL)) return false;
    for (int k = 0; k < 3; k++) force[k] = value.number[k];
    return true;
}

static const sk_making making = {.make = make, .unmake = unmake};
const sk_force_type sk_force_field = {
    .kind = {"force_field", "any force that is a formula of place, velocity and time", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(force_field_params)},
    .domain = SK_OVER_PARTICLES,
    .sets = true,
    .uses_velocity = uses_velocity,
    .kernel = {SK_EACH_ISA(kernel)},
    .apply = {SK_EACH_ISA(apply)},
    .diagonal = {SK_EACH_ISA(diagonal)},
    .guarded = is_guarded,
    .at = at,
    .making = &making,
    .shader = {.file = "forces/force_field",
               .size = 1 + SK_POINTWISE_BLOCK,
               .pack = pack,
               .write = write,
               .changes = changes},
};
#endif
