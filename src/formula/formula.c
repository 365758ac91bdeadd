/* The public functions of formulas: making one with its derivatives, and evaluating it at one place. */
#include "formula/formula.h"

#include <string.h>

#include "base/status.h"
#include "formula/compiled_code.h"
#include "formula/evaluate.h"

/* ---- derivatives ---- */

static void differentiate(skein_formula *f) {
    uint32_t inputs[SK_INPUT_COUNT];
    sk_node derivatives[SK_INPUT_COUNT];
    size_t coordinates = 3 * (size_t)f->particles, count = 2 * coordinates + 1;
    for (uint32_t i = 0; i < coordinates; i++) {
        inputs[i] = SK_INPUT_POSITION + i;
        inputs[coordinates + i] = SK_INPUT_VELOCITY + i;
    }
    inputs[2 * coordinates] = SK_INPUT_TIME;
    for (int k = 0; k < f->size; k++) {
        if (!sk_gradient(&f->graph, f->value[k], inputs, count, derivatives)) return;
        memcpy(f->by_position[k], derivatives, coordinates * sizeof *derivatives);
        memcpy(f->by_velocity[k], derivatives + coordinates, coordinates * sizeof *derivatives);
        f->by_time[k] = derivatives[2 * coordinates];
    }
}

static void differentiate_again(skein_formula *f) {
    size_t coordinates = 3 * (size_t)f->particles;
    f->hessian = sk_allocate(f->allocator, (coordinates * coordinates + 1) * sizeof *f->hessian);
    if (!f->hessian) f->graph.no_memory = true;
    else sk_second_derivatives(&f->graph, f->value[0], (size_t)f->particles, f->hessian);
}

/* ---- making ---- */

static void destroy(skein_formula *f) {
    sk_allocator *allocator = f->allocator, own;
    sk_graph_free(&f->graph);
    sk_release(allocator, f->hessian);
    sk_release(allocator, f->let_name);
    sk_release(allocator, f->text);
    if (allocator == &f->own) { // it is a member of what is released
        own = f->own;
        allocator = &own;
    }
    sk_release(allocator, f);
}

static skein_status complete(skein_formula *f, const skein_formula_desc *desc, skein_formula_mark *mark,
                             skein_error *error) {
    f->text = sk_copy_text(f->allocator, desc->text);
    if (!f->text) return sk_fail_memory(error, "a formula");
    if (desc->particles < 0 || desc->particles > SKEIN_FORMULA_MOST_PARTICLES)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "a formula is on 1 to %d particles, not %d",
                       SKEIN_FORMULA_MOST_PARTICLES, desc->particles);
    skein_status status = sk_formula_parse(f, desc, mark, error);
    if (status) return status;
    for (int k = 0; k < f->size; k++) f->uses |= f->graph.data[f->value[k]].uses;
    differentiate(f);
    if (desc->second && f->size == 1) differentiate_again(f);
    if (f->graph.no_memory) return sk_fail_memory(error, "a formula's derivatives");
    if (f->graph.too_large)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "",
                       "the formula is too large: more than %d operations with its "
                       "derivatives",
                       SK_GRAPH_MOST_NODES);
    return sk_formula_find_hash(f, error);
}

skein_formula *sk_formula_create(const skein_formula_desc *desc, sk_allocator *allocator, skein_formula_mark *mark,
                                 skein_error *error) {
    skein_formula *f = sk_allocate(allocator, sizeof *f);
    if (!f) {
        sk_fail_memory(error, "a formula");
        return NULL;
    }
    f->allocator = allocator;
    sk_graph_init(&f->graph, allocator);
    if (complete(f, desc, mark, error) == SKEIN_OK) return f;
    destroy(f);
    return NULL;
}

skein_formula *skein_formula_create(const skein_formula_desc *desc, skein_formula_mark *mark, skein_error *error) {
    if (!desc || !desc->text) {
        sk_fail_null(error, desc ? "desc->text" : "desc");
        return NULL;
    }
    sk_allocator allocator = sk_default_allocator();
    skein_formula *f = sk_formula_create(desc, &allocator, mark, error);
    if (!f) return NULL;
    f->own = allocator;
    f->allocator = f->graph.allocator = &f->own;
    return f;
}

void skein_formula_destroy(skein_formula *formula) {
    if (formula) destroy(formula);
}

uint64_t skein_formula_hash(const skein_formula *f) {
    return f ? f->hash : 0;
}

/* ---- answers ---- */

const char *skein_formula_warning(const skein_formula *formula, size_t index, skein_formula_mark *mark) {
    if (!formula || index >= (size_t)formula->warnings) return NULL;
    if (mark) *mark = formula->warning[index].mark;
    return formula->warning[index].text;
}

/* The value's and the derivatives' nodes, one after the other; returns how many. */
static size_t outputs_of(const skein_formula *f, sk_node outputs[static SK_FORMULA_MOST_OUTPUTS]) {
    size_t count = 0;
    for (int k = 0; k < f->size; k++) {
        outputs[count++] = f->value[k];
        outputs[count++] = f->by_time[k];
        for (int i = 0; i < 3 * f->particles; i++) {
            outputs[count++] = f->by_position[k][i];
            outputs[count++] = f->by_velocity[k][i];
        }
    }
    return count;
}

skein_formula_info skein_formula_about(const skein_formula *f) {
    if (!f) return (skein_formula_info){0};
    skein_formula_info info = {.particles = f->particles,
                               .parameters = f->parameters,
                               .rests = f->rests,
                               .size = f->size,
                               .at_least_zero = f->at_least_zero,
                               .positions = f->uses & SK_USES_POSITION,
                               .velocities = f->uses & SK_USES_VELOCITY,
                               .time = f->uses & SK_USES_TIME};
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS];
    sk_allocator allocator = sk_default_allocator();
    bool *live = sk_allocate(&allocator, f->graph.count * sizeof *live);
    if (live) sk_graph_mark(&f->graph, outputs, outputs_of(f, outputs), live);
    for (size_t i = 0; i < f->graph.count && live; i++)
        info.operations += live[i] && f->graph.data[i].op > SK_NODE_PARAMETER;
    sk_release(&allocator, live);
    return info;
}

/* Values of the nodes that `outputs` depend on, at a point; NULL when there is no memory. */
typedef struct answer {
    sk_allocator allocator;
    double *values;
    bool *live;
    bool guarded;
} answer;

static bool take(double *to, const double *from, size_t count) {
    if (from) memcpy(to, from, count * sizeof *to);
    return from;
}

static void release_answer(answer *a) {
    sk_release(&a->allocator, a->values);
    sk_release(&a->allocator, a->live);
}

static skein_status find_answer(const skein_formula *f, const skein_formula_point *point, const sk_node *outputs,
                                size_t count, answer *a, skein_error *error) {
    double inputs[SK_INPUT_COUNT] = {0}, parameters[SKEIN_FORMULA_MOST_PARAMETERS + SKEIN_FORMULA_MOST_RESTS] = {0};
    size_t coordinates = 3 * (size_t)f->particles;
    *a = (answer){.allocator = sk_default_allocator()};
    if (f->parameters && !take(parameters, point->parameters, (size_t)f->parameters))
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "the formula has %d parameters, and no values are given for them",
                       f->parameters);
    if (coordinates && !take(inputs, point->positions, coordinates))
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "the formula is on %d particles, and no positions are given",
                       f->particles);
    if ((f->uses & SK_USES_VELOCITY) && !point->velocities)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "the formula needs velocities, and none are given");
    a->values = sk_allocate(&a->allocator, f->graph.count * sizeof *a->values);
    a->live = sk_allocate(&a->allocator, f->graph.count * sizeof *a->live);
    if (!a->values || !a->live) {
        release_answer(a);
        return sk_fail_memory(error, "a formula's values");
    }
    if (point->rest_positions) take(inputs, point->rest_positions, coordinates);
    sk_graph_mark(&f->graph, f->rest, (size_t)f->rests, a->live);
    sk_evaluate_double(&f->graph, a->live, inputs, parameters, a->values);
    for (int i = 0; i < f->rests; i++) parameters[f->parameters + i] = a->values[f->rest[i]];
    take(inputs, point->positions, coordinates);
    take(inputs + SK_INPUT_VELOCITY, point->velocities, coordinates);
    inputs[SK_INPUT_TIME] = point->time;
    sk_graph_mark(&f->graph, outputs, count, a->live);
    a->guarded = sk_evaluate_double(&f->graph, a->live, inputs, parameters, a->values);
    return SKEIN_OK;
}

static void take_value(const skein_formula *f, const answer *a, skein_formula_value *value) {
    *value = (skein_formula_value){.guarded = a->guarded};
    for (int k = 0; k < f->size; k++) {
        value->number[k] = a->values[f->value[k]];
        value->by_time[k] = a->values[f->by_time[k]];
        for (int i = 0; i < 3 * f->particles; i++) {
            value->by_position[k][i] = a->values[f->by_position[k][i]];
            value->by_velocity[k][i] = a->values[f->by_velocity[k][i]];
        }
    }
}

bool sk_formula_value_at(const skein_formula *f, const double *positions, const double *parameters, double time,
                         skein_formula_value *value) {
    double inputs[SK_INPUT_COUNT] = {0};
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS];
    answer a = {.allocator = *f->allocator};
    a.values = sk_allocate(&a.allocator, f->graph.count * sizeof *a.values);
    a.live = sk_allocate(&a.allocator, f->graph.count * sizeof *a.live);
    bool good = a.values && a.live;
    if (good) {
        take(inputs, positions, 3 * (size_t)f->particles);
        inputs[SK_INPUT_TIME] = time;
        sk_graph_mark(&f->graph, outputs, outputs_of(f, outputs), a.live);
        a.guarded = sk_evaluate_double(&f->graph, a.live, inputs, parameters, a.values);
        take_value(f, &a, value);
    }
    release_answer(&a);
    return good;
}

skein_status skein_formula_evaluate(const skein_formula *f, const skein_formula_point *point,
                                    skein_formula_value *value, skein_error *error) {
    if (!f) return sk_fail_null(error, "formula");
    if (!point) return sk_fail_null(error, "point");
    if (!value) return sk_fail_null(error, "value");
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS];
    answer a;
    skein_status status = find_answer(f, point, outputs, outputs_of(f, outputs), &a, error);
    if (status) return status;
    take_value(f, &a, value);
    release_answer(&a);
    return SKEIN_OK;
}

skein_status skein_formula_hessian(const skein_formula *f, const skein_formula_point *point, double *hessian,
                                   skein_error *error) {
    if (!f) return sk_fail_null(error, "formula");
    if (!point) return sk_fail_null(error, "point");
    if (!hessian) return sk_fail_null(error, "hessian");
    if (!f->hessian)
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "there are no second derivatives: ask for them when making the formula, which must be a number");
    answer a;
    size_t count = 9 * (size_t)f->particles * (size_t)f->particles;
    skein_status status = find_answer(f, point, f->hessian, count, &a, error);
    if (status) return status;
    for (size_t i = 0; i < count; i++) hessian[i] = a.values[f->hessian[i]];
    release_answer(&a);
    return SKEIN_OK;
}
