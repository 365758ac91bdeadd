#include "forces/pair_formula.h"

#include <string.h>

#include "base/status.h"
#include "formula/formula.h"

void sk_pair_formula_release(sk_pair_formula *state, sk_allocator *allocator) {
    if (!state) return;
    for (int k = 0; k < SK_PAIR_WEIGHTS; k++) {
        if (state->formula[k]) sk_tape_free(&state->tape[k]);
        skein_formula_destroy(state->formula[k]);
        sk_release(allocator, state->text[k]);
    }
    sk_release(allocator, state);
}

/* A pair rule knows percent and t alone. */
static skein_status judge(const skein_formula *formula, skein_error *error) {
    if (formula->uses & (SK_USES_POSITION | SK_USES_VELOCITY))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "it depends on particles; a weight is a function of percent (and t)");
    if (formula->rests) return sk_fail(error, SKEIN_ERROR_VALUE, "", "rest(...) has no meaning for neighbours");
    return SKEIN_OK;
}

static skein_status make(sk_pair_formula *state, int k, const char *text, sk_allocator *allocator, skein_error *error) {
    state->text[k] = sk_copy_text(allocator, text);
    if (!state->text[k]) return sk_fail_memory(error, "a formula");
    if (!text[0]) return SKEIN_OK;
    skein_formula_desc desc = {
        .text = text, .parameters = (const char *const[]){"percent", NULL}, .result = SKEIN_FORMULA_NUMBER};
    skein_formula *formula = sk_formula_create(&desc, allocator, NULL, error);
    if (!formula) return error->status;
    skein_status status = judge(formula, error);
    if (!status) status = sk_tape_create(&state->tape[k], &formula->graph, formula->value, 1, allocator, error);
    if (status) {
        skein_formula_destroy(formula);
        return status;
    }
    state->formula[k] = formula;
    state->percent[k] = UINT16_MAX;
    for (size_t i = 0; i < state->tape[k].loads.count; i++)
        if (state->tape[k].loads.data[i].source == SK_TAPE_PARAMETER)
            state->percent[k] = state->tape[k].loads.data[i].to;
    return SKEIN_OK;
}

skein_status sk_pair_formula_prepare(sk_pair_formula **state, const char *const texts[SK_PAIR_WEIGHTS],
                                     const char *const fields[SK_PAIR_WEIGHTS], sk_allocator *allocator,
                                     skein_error *error) {
    if (*state && !strcmp((*state)->text[0], texts[0]) && !strcmp((*state)->text[1], texts[1])) return SKEIN_OK;
    sk_pair_formula_release(*state, allocator);
    *state = NULL;
    if (!texts[0][0] && !texts[1][0]) return SKEIN_OK;
    sk_pair_formula *made = sk_allocate(allocator, sizeof *made);
    if (!made) return sk_fail_memory(error, "a formula");
    for (int k = 0; k < SK_PAIR_WEIGHTS; k++) {
        skein_error why = {SKEIN_OK, "", ""};
        skein_status status = make(made, k, texts[k], allocator, &why);
        if (!status) continue;
        sk_pair_formula_release(made, allocator);
        return sk_fail(error, status, fields[k], "%s%s%s", why.where, why.where[0] ? ": " : "", why.message);
    }
    *state = made;
    return SKEIN_OK;
}
