/* The two formulas of a pair rule: parsed and checked, compiled to tapes, and written as GLSL. */
#include "forces/pair_formula.h"

#include "base/status.h"
#include "formula/emit.h"

void sk_pair_formula_release(sk_pair_formula *pair, sk_allocator *allocator) {
    if (!pair) return;
    for (int k = 0; k < SK_PAIR_WEIGHTS; k++) {
        if (pair->formula[k]) sk_tape_free(&pair->tape[k]);
        skein_formula_destroy(pair->formula[k]);
    }
    sk_release(allocator, pair);
}

/* Refuses formulas that use anything but the relative distance and t. */
static skein_status judge(const skein_formula *formula, skein_error *error) {
    if (formula->uses & (SK_USES_POSITION | SK_USES_VELOCITY))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "it depends on particles; a weight is a function of relative_distance (and t)");
    if (formula->rests) return sk_fail(error, SKEIN_ERROR_VALUE, "", "rest(...) has no meaning for neighbours");
    return SKEIN_OK;
}

static skein_status make(sk_pair_formula *pair, int k, const char *text, sk_allocator *allocator, skein_error *error) {
    if (!text[0]) return SKEIN_OK;
    skein_formula_desc desc = {
        .text = text, .parameters = (const char *const[]){"relative_distance", NULL}, .result = SKEIN_FORMULA_NUMBER};
    skein_formula *formula = sk_formula_create(&desc, allocator, NULL, error);
    if (!formula) return error->status;
    skein_status status = judge(formula, error);
    if (!status) status = sk_tape_create(&pair->tape[k], &formula->graph, formula->value, 1, allocator, error);
    if (status) {
        skein_formula_destroy(formula);
        return status;
    }
    pair->formula[k] = formula;
    pair->relative_distance[k] = UINT16_MAX;
    for (size_t i = 0; i < pair->tape[k].loads.count; i++)
        if (pair->tape[k].loads.data[i].source == SK_TAPE_PARAMETER)
            pair->relative_distance[k] = pair->tape[k].loads.data[i].to;
    return SKEIN_OK;
}

skein_status sk_pair_formula_create(sk_pair_formula **made, const char *const texts[SK_PAIR_WEIGHTS],
                                    const char *const fields[SK_PAIR_WEIGHTS], sk_allocator *allocator,
                                    skein_error *error) {
    *made = NULL;
    if (!texts[0][0] && !texts[1][0]) return SKEIN_OK;
    sk_pair_formula *pair = sk_allocate(allocator, sizeof *pair);
    if (!pair) return sk_fail_memory(error, "a formula");
    for (int k = 0; k < SK_PAIR_WEIGHTS; k++) {
        skein_error why = {SKEIN_OK, "", ""};
        skein_status status = make(pair, k, texts[k], allocator, &why);
        if (!status) continue;
        sk_pair_formula_release(pair, allocator);
        return sk_fail(error, status, fields[k], "%s%s%s", why.where, why.where[0] ? ": " : "", why.message);
    }
    *made = pair;
    return SKEIN_OK;
}

bool sk_pair_formula_put_glsl(const sk_pair_formula *pair, void (*put)(void *user, const char *text), void *user) {
    static const char *const heads[SK_PAIR_WEIGHTS] = {"float towards@(float relative_distance, float t) {\n",
                                                       "float along@(float relative_distance, float t) {\n"};
    put(user, "#define parameter@(i) relative_distance\n");
    for (int w = 0; w < SK_PAIR_WEIGHTS; w++) {
        const skein_formula *f = pair->formula[w];
        if (f && !sk_formula_put_glsl(f, heads[w], f->value, 1, put, user)) return false;
        if (!f) put(user, heads[w]), put(user, "    return 0;\n}\n");
        else put(user, "    return abs(o[0]) <= 3.4e38 ? o[0] : 0;\n}\n");
    }
    return true;
}
