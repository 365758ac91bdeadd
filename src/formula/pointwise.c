/* Making and running formulas of one particle, on the processor and as GLSL. */
#include "formula/pointwise.h"

#include <stdio.h>
#include <string.h>

#include "base/fields.h"
#include "base/kernels.h"
#include "base/status.h"
#include "formula/emit.h"
#include "formula/evaluate.h"

#define SK_UNIT pointwise
SK_KERNELS(sk_pointwise_run, run);

#ifdef SK_ISA

void SK_KERNEL(run)(const sk_pointwise *pointwise, const double *parameters, double time, const sk_wide3 *p,
                    const sk_wide3 *v, sk_wide *out, sk_mask *guarded) {
    const sk_tape *tape = &pointwise->tape;
    const sk_tape_kernels *kernels = sk_tape_kernels_of[SK_THIS_ISA];
    sk_wide registers[SK_TAPE_MEMORY / sizeof(sk_wide)];
    sk_tape_verdict verdict;
    real number[SKEIN_FORMULA_MOST_PARAMETERS];
    const real *parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    for (int i = 0; i < pointwise->parameters; i++) number[i] = (real)parameters[i], parameter[i] = &number[i];
    kernels->begin(tape, &(sk_tape_input){.parameter = parameter, .uniform = UINT64_MAX, .time = (real)time}, registers,
                   1);
    for (size_t l = 0; l < tape->loads.count; l++) {
        const sk_tape_load *load = &tape->loads.data[l];
        const sk_wide3 *from = load->source == SK_TAPE_POSITION ? p : load->source == SK_TAPE_VELOCITY ? v : NULL;
        if (!from) continue;
        sk_wide *to = registers + load->to;
        to[0] = from->x, to[1] = from->y, to[2] = from->z;
    }
    kernels->run(tape, registers, 1, 1, &verdict);
    // a force beyond the range of fields would overflow within a few substeps
    sk_mask good = verdict.finite[0];
    for (size_t k = 0; k < tape->outputs; k++)
        good &= sk_at_most(sk_wide_abs(registers[tape->output[k]]), sk_splat((real)SK_FAR));
    for (size_t k = 0; k < tape->outputs; k++) out[k] = sk_keep(good, registers[tape->output[k]]);
    *guarded = verdict.guarded[0] | ~good;
}

#else

sk_pointwise_run *const sk_pointwise_run_of[SK_ISA_COUNT] = SK_EACH_ISA(run);

static skein_status complete(sk_pointwise *pointwise, sk_pointwise_choice *choose, const skein_kind *own, bool first,
                             sk_allocator *allocator, skein_error *error) {
    skein_formula *f = pointwise->formula;
    const skein_formula *all[] = {f};
    sk_node outputs[SK_POINTWISE_MOST_OUTPUTS + 3];
    pointwise->parameters = f->parameters;
    if (f->rests)
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "there is no rest(...) here: only what is made of particles has a rest pose");
    skein_status status = first ? sk_formula_check_used(own, all, 1, error) : SKEIN_OK;
    if (status) return status;
    size_t count = choose(f, outputs);
    if (f->graph.no_memory) return sk_fail_memory(error, "a formula's derivatives");
    if (f->graph.too_large)
        return sk_fail(error, SKEIN_ERROR_LIMIT, "", "the formula is too large: more than %d operations",
                       SK_GRAPH_MOST_NODES);
    status = sk_tape_create(&pointwise->tape, &f->graph, outputs, count, allocator, error);
    if (status) return status;
    pointwise->tape.wides = 1;
    pointwise->live = sk_allocate(allocator, f->graph.count * sizeof *pointwise->live);
    pointwise->values = sk_allocate(allocator, f->graph.count * sizeof *pointwise->values);
    if (!pointwise->live || !pointwise->values) return sk_fail_memory(error, "a formula");
    memcpy(pointwise->output, outputs, count * sizeof *outputs);
    memcpy(outputs + count, f->value, (size_t)f->size * sizeof *outputs);
    sk_graph_mark(&f->graph, outputs, count + (size_t)f->size, pointwise->live);
    return SKEIN_OK;
}

skein_status sk_pointwise_create(const char *field, const char *text, skein_formula_desc desc,
                                 sk_pointwise_choice *choose, const skein_kind *own, bool first,
                                 sk_allocator *allocator, sk_pointwise **made, skein_error *error) {
    skein_error words = {SKEIN_OK, "", ""};
    sk_pointwise *pointwise = sk_allocate(allocator, sizeof *pointwise);
    if (!pointwise) return sk_fail_memory(error, "a formula");
    desc.particles = 1;
    pointwise->formula = sk_formula_of_field(field, text, desc, own, allocator, &words);
    skein_status status = words.status;
    if (pointwise->formula) status = complete(pointwise, choose, own, first, allocator, &words);
    if (!status) {
        *made = pointwise;
        return SKEIN_OK;
    }
    sk_pointwise_destroy(pointwise, allocator);
    if (!words.where[0] && status != SKEIN_ERROR_MEMORY) snprintf(words.where, sizeof words.where, "%s", field);
    if (error) *error = words;
    return status;
}

void sk_pointwise_destroy(sk_pointwise *pointwise, sk_allocator *allocator) {
    if (!pointwise) return;
    skein_formula_destroy(pointwise->formula);
    sk_tape_free(&pointwise->tape);
    sk_release(allocator, pointwise->live);
    sk_release(allocator, pointwise->values);
    sk_release(allocator, pointwise);
}

void sk_pointwise_pack(const sk_pointwise *pointwise, const double *parameters, float (*block)[4]) {
    for (int i = 0; i < pointwise->parameters; i++) block[i / 4][i % 4] = (float)parameters[i];
}

bool sk_pointwise_put_glsl(const sk_pointwise *pointwise, int first, void (*put)(void *user, const char *text),
                           void *user) {
    size_t count = pointwise->tape.outputs;
    char text[320];
    snprintf(text, sizeof text, "#define parameter@(i) rule@[%d + (i) / 4][(i) %% 4]\n", first);
    put(user, text);
    snprintf(text, sizeof text, "void formula@(vec3 p0, vec3 v0, float t, out float result[%zu]) {\n", count);
    if (!sk_formula_put_glsl(pointwise->formula, text, pointwise->output, count, put, user)) return false;
    // as on the processor: all outputs are 0 if one is beyond the range of fields
    snprintf(text, sizeof text,
             "    bool good = true;\n    for (int k = 0; k < %zu; k++) good = good && abs(o[k]) <= 1e15;\n"
             "    for (int k = 0; k < %zu; k++) result[k] = good ? o[k] : 0;\n}\n",
             count, count);
    put(user, text);
    return true;
}

static bool is_sane(double x) {
    return x >= -SK_FAR && x <= SK_FAR;
}

void sk_pointwise_value(const sk_pointwise *pointwise, const double *parameters, double time, const double p[3],
                        const double v[3], double value[3], bool *guarded) {
    const skein_formula *f = pointwise->formula;
    double inputs[SK_INPUT_COUNT] = {0};
    memcpy(inputs + SK_INPUT_POSITION, p, 3 * sizeof *p);
    if (v) memcpy(inputs + SK_INPUT_VELOCITY, v, 3 * sizeof *v);
    inputs[SK_INPUT_TIME] = time;
    bool acted = sk_evaluate_double(&f->graph, pointwise->live, inputs, parameters, pointwise->values);
    for (size_t k = 0; k < pointwise->tape.outputs; k++) acted |= !is_sane(pointwise->values[pointwise->output[k]]);
    for (int k = 0; k < f->size; k++) {
        double x = pointwise->values[f->value[k]];
        value[k] = is_sane(x) ? x : 0;
    }
    if (guarded) *guarded = acted;
}
#endif
