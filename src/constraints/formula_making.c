/* Compiling a constraint's formula: its tapes, compiled code and rest values. */
#include "constraints/formula.h"

#include <string.h>

#include "base/status.h"
#include "formula/compiled_code.h"
#include "formula/evaluate.h"

/* ---- making ---- */

static void release(sk_constraint_formula *made, sk_allocator *allocator) {
    if (!made) return;
    sk_tape_free(&made->tape);
    sk_tape_free(&made->hessian);
    skein_formula_destroy(made->formula);
    sk_release(allocator, made);
}

static skein_status make_tapes(sk_constraint_formula *made, sk_allocator *allocator, skein_error *error) {
    skein_formula *f = made->formula;
    sk_node outputs[9 * SKEIN_FORMULA_MOST_PARTICLES * SKEIN_FORMULA_MOST_PARTICLES];
    size_t count = 0, coordinates = 3 * (size_t)f->particles;
    outputs[count++] = f->value[0];
    for (size_t i = 0; i < coordinates; i++) outputs[count++] = f->by_position[0][i];
    outputs[count++] = f->by_time[0];
    skein_status status = sk_tape_create(&made->tape, &f->graph, outputs, count, allocator, error);
    if (made->tape.wides > SK_FORMULA_GROUPS) made->tape.wides = SK_FORMULA_GROUPS;
    made->single = made->tape;
    made->single.wides = 1;
    made->tape.unjudged = true; // group_walk.h judges the elements itself
    if (status || !made->is_energy) return status;
    count = 0;
    for (size_t i = 0; i < coordinates; i++)
        for (size_t j = 0; j <= i; j++) outputs[count++] = f->hessian[i * coordinates + j];
    status = sk_tape_create(&made->hessian, &f->graph, outputs, count, allocator, error);
    made->hessian.wides = 1;
    return status;
}

/* An existing constraint keeps its particles and its rest values, so a new text must match them. */
static skein_status check_change(const sk_constraint_formula *now, const skein_formula *f, const char *field,
                                 skein_error *error) {
    if (f->particles == 0)
        return sk_fail(error, SKEIN_ERROR_VALUE, field, "the formula names no particle: p0, p1 ... are its particles");
    if (now && f->particles != now->formula->particles)
        return sk_fail(error, SKEIN_ERROR_VALUE, field,
                       "the formula is on %d particles, and the constraint was made for %d: remove it and add another",
                       f->particles, now->formula->particles);
    if (now && (f->rests || now->formula->rests))
        return sk_fail(error, SKEIN_ERROR_VALUE, field,
                       "rest(...) is taken when a constraint is made: remove it and add another");
    return SKEIN_OK;
}

static skein_status make(sk_formula_params *params, const skein_kind *kind, bool is_energy, sk_allocator *allocator,
                         skein_error *error) {
    const char *field = is_energy ? "energy" : "constraint";
    skein_formula_desc desc = {.result = SKEIN_FORMULA_NUMBER, .comparison = !is_energy, .second = is_energy};
    skein_formula *formula = sk_formula_of_field(field, params->text, desc, kind, allocator, error);
    if (!formula) return error->status;
    skein_status status = check_change(params->made, formula, field, error);
    if (!status && !params->made)
        status = sk_formula_check_used(kind, (const skein_formula *const[]){formula}, 1, error);
    sk_constraint_formula *made = status ? NULL : sk_allocate(allocator, sizeof *made);
    if (!made) {
        skein_formula_destroy(formula);
        return status ? status : sk_fail_memory(error, "a formula");
    }
    *made = (sk_constraint_formula){.formula = formula, .is_energy = is_energy, .one_sided = formula->at_least_zero};
    made->tape.allocator = made->hessian.allocator = allocator;
    status = make_tapes(made, allocator, error);
    if (status) {
        release(made, allocator);
        return status;
    }
    release(params->made, allocator);
    params->made = made;
    return SKEIN_OK;
}

static skein_status make_constraint(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    return make(params, kind, false, allocator, error);
}

static skein_status make_energy(void *params, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    return make(params, kind, true, allocator, error);
}

static void unmake(void *params, sk_allocator *allocator) {
    release(((sk_formula_params *)params)->made, allocator);
}

static void run_compiled(void *params, const skein_compiled *compiled) {
    sk_constraint_formula *made = ((sk_formula_params *)params)->made;
    const skein_formula *f = made->formula;
    made->compiled = compiled;
    // its formula has the same parameters, perhaps in another order, and perhaps some without effect
    for (size_t i = 0; compiled && compiled->parameters[i]; i++) {
        made->parameter_of[i] = 0;
        for (int k = 0; k < f->parameters; k++)
            if (!strcmp(compiled->parameters[i], f->parameter_name[k])) made->parameter_of[i] = (uint8_t)k;
    }
}

static const skein_formula *formula_of(const void *params) {
    return ((const sk_formula_params *)params)->made->formula;
}

static const double *parameters_of(const void *params) {
    return ((const sk_formula_params *)params)->parameter;
}

const sk_making sk_formula_making = {make_constraint, unmake, formula_of, run_compiled, parameters_of, true},
                sk_energy_making = {make_energy, unmake, formula_of, run_compiled, parameters_of, true};

/* ---- functions of the type ---- */

int sk_formula_arity_of(const void *params) {
    return ((const sk_formula_params *)params)->made->formula->particles;
}

int sk_formula_rest_count_of(const void *params) {
    return ((const sk_formula_params *)params)->made->formula->rests;
}

bool sk_formula_rest(const void *data, const double (*x)[3], double *rest) {
    const sk_formula_params *params = data;
    const skein_formula *f = params->made->formula;
    sk_allocator *allocator = f->allocator;
    double inputs[SK_INPUT_COUNT] = {0};
    memcpy(inputs, x, 3 * (size_t)f->particles * sizeof *inputs);
    double *values = sk_allocate(allocator, f->graph.count * sizeof *values);
    bool *live = sk_allocate(allocator, f->graph.count * sizeof *live);
    if (values && live) {
        sk_graph_mark(&f->graph, f->rest, (size_t)f->rests, live);
        sk_evaluate_double(&f->graph, live, inputs, params->parameter, values);
        for (int r = 0; r < f->rests; r++) rest[r] = values[f->rest[r]];
    }
    bool good = values && live;
    sk_release(allocator, values);
    sk_release(allocator, live);
    return good;
}

/* Evaluates the same nodes that the tape runs. */
bool sk_formula_evaluate_one(const sk_batch *batch, double time, const sk_vec4 *x, size_t element, size_t most,
                             sk_constraint_answer *answer, double (*gradient)[3]) {
    const sk_formula_params *params = batch->params;
    const sk_constraint_formula *made = params->made;
    const skein_formula *f = made->formula;
    double positions[3 * SK_MOST_ARITY], parameters[SKEIN_FORMULA_MOST_PARAMETERS + SKEIN_FORMULA_MOST_RESTS];
    for (size_t i = 0; i < batch->arity; i++) {
        sk_vec4 p = x[batch->slot[element * batch->arity + i]];
        positions[3 * i] = (double)p.x, positions[3 * i + 1] = (double)p.y, positions[3 * i + 2] = (double)p.z;
    }
    memcpy(parameters, params->parameter, (size_t)f->parameters * sizeof *parameters);
    for (size_t r = 0; r < batch->rest_count; r++)
        parameters[(size_t)f->parameters + r] = (double)batch->rest[r * batch->count + element];
    skein_formula_value value;
    if (!sk_formula_value_at(f, positions, parameters, time, &value)) return false;
    *answer =
        (sk_constraint_answer){value.number[0], value.by_time[0], made->is_energy, made->one_sided, value.guarded};
    for (size_t i = 0; i < batch->arity && i < most; i++)
        memcpy(gradient[i], value.by_position[0] + 3 * i, sizeof gradient[i]);
    return true;
}
