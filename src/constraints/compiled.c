/* Running what a C compiler has made of a constraint's formula (include/skein/compiled.h), in place of its tapes. */
#include "formula/compiled.h"

#include <string.h>

#include "constraints/formula.h"

sk_formula_factors sk_formula_find_factors(const sk_batch *batch, const sk_row *row) {
    double damping_time = sk_batch_damping_time(batch);
    if (!(row->dt > 0)) return (sk_formula_factors){(real)damping_time, 0, 0}; // a force knows no step
    return (sk_formula_factors){(real)damping_time, (real)(row->coefficient[0] / (row->dt * row->dt)),
                                (real)(damping_time / row->dt)};
}

void sk_formula_run_compiled(void *params, const skein_compiled *compiled) {
    sk_constraint_formula *made = ((sk_formula_params *)params)->made;
    const skein_formula *f = made->formula;
    made->compiled = compiled;
    // its formula names the same parameters, perhaps in another order, and perhaps some that nothing depends on
    for (size_t i = 0; compiled && compiled->parameters[i]; i++) {
        made->parameter_of[i] = 0;
        for (int k = 0; k < f->parameters; k++)
            if (!strcmp(compiled->parameters[i], f->parameter_name[k])) made->parameter_of[i] = (uint8_t)k;
    }
}

static void find_parameters(const sk_formula_params *params, real value[SKEIN_FORMULA_MOST_PARAMETERS]) {
    const sk_constraint_formula *made = params->made;
    for (size_t i = 0; made->compiled->parameters[i]; i++) value[i] = (real)params->parameter[made->parameter_of[i]];
}

void sk_compiled_walk(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_row_kind kind, bool damped) {
    const sk_sweep *sweep = row->rule;
    const sk_batch *batch = sweep->batch;
    const sk_formula_params *params = batch->params;
    const skein_compiled *compiled = params->made->compiled;
    sk_formula_factors f = sk_formula_find_factors(batch, row);
    real parameters[SKEIN_FORMULA_MOST_PARAMETERS];
    find_parameters(params, parameters);
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    size_t lane = sweep->first_lane + begin * SK_LANES;
    const skein_groups groups = {
        .count = end - begin,
        .slots = sweep->slots + begin * batch->arity * SK_LANES,
        .ahead = sweep->ahead + begin,
        .packed = row->packed,
        .positions = &run->vector[SK_X]->x,
        .other = damped ? &run->vector[row->source[1]]->x : NULL,
        .forces = kind == SK_ROW_FORCE ? &run->vector[row->dst]->x : NULL,
        .rest = batch->lane_rest + lane,
        .rest_stride = batch->lane_count,
        .stiffness = batch->lane_stiffness + lane,
        .compliance = batch->lane_compliance + lane,
        .multiplier = batch->lane_multiplier + lane,
        .parameters = parameters,
        .time = (real)(run->time - row->before),
        .substep = (real)row->dt,
        .damping_time = f.damping_time,
        .per_step = f.per_step,
        .gamma = f.gamma,
        .elementary = sk_compiled_elementary(compiled->lanes),
    };
    if (kind == SK_ROW_FORCE) compiled->force(&groups);
    else if (damped) compiled->project_damped(&groups);
    else compiled->project(&groups);
}

void sk_compiled_evaluate(const sk_batch *batch, double time, bool second, const real *positions, const real *rest,
                          real *const *outputs, real *finite) {
    const sk_formula_params *params = batch->params;
    const skein_compiled *compiled = params->made->compiled;
    real parameters[SKEIN_FORMULA_MOST_PARAMETERS];
    find_parameters(params, parameters);
    const skein_group_values elements = {.positions = positions,
                                         .rest = rest,
                                         .parameters = parameters,
                                         .time = (real)time,
                                         .elementary = sk_compiled_elementary(compiled->lanes),
                                         .outputs = outputs,
                                         .finite = finite};
    if (second) compiled->second(&elements);
    else compiled->evaluate(&elements);
}
