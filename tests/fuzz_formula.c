/* Feeds any bytes to the parser of formulas, and judges what it makes of them.
 *
 *   flags formula      one byte: velocities, comparisons, what the result should be, second derivatives
 *
 * Owns nothing. Called as fuzz/fuzz.h says.
 * Invariant: there is a formula or a fault; a fault has a place within the text and words on one line; a formula can be
 * evaluated, written as text and run as a tape, whose outputs are finite and those of the graph. */
#include <ctype.h>
#include <math.h>

#include "formula/evaluate.h"
#include "formula/formula.h"
#include "formula/tape.h"
#include "fuzz/fuzz.h"

enum { ELEMENTS = 20, OUTPUTS = 1 + SK_INPUT_VELOCITY };

static void judge_fault(const char *text, const skein_formula_mark *mark, const skein_error *error) {
    char shown[512];
    require(error->status != SKEIN_OK && error->message[0]);
    for (const char *c = error->message; *c; c++) require(!iscntrl((unsigned char)*c));
    require(mark->line >= 1 && mark->column >= 1 && mark->column <= strlen(text) + 1);
    require(skein_formula_show(text, mark, shown, sizeof shown) < sizeof shown);
}

static void judge_text(void *user, const char *text) {
    *(size_t *)user += strlen(text);
}

static void judge_tape(const skein_formula *f) {
    static const double odd[] = {0, 1, -1, 0.5, 1e-20, 1e20, -3, 0.001};
    sk_node outputs[OUTPUTS];
    size_t count = 0;
    outputs[count++] = f->value[0];
    for (int i = 0; i < 3 * f->particles; i++) outputs[count++] = f->by_position[0][i];
    sk_allocator allocator = sk_default_allocator();
    sk_tape tape;
    skein_error error;
    if (sk_tape_create(&tape, &f->graph, outputs, count, &allocator, &error)) {
        require(error.status == SKEIN_ERROR_LIMIT && allocator.bytes == 0);
        return;
    }
    static _Alignas(64) sk_vec4 positions[64];
    static uint32_t slots[SK_FORMULA_PARTICLES][ELEMENTS];
    static real values[64][ELEMENTS], out[OUTPUTS][ELEMENTS];
    const uint32_t *slot[SK_FORMULA_PARTICLES];
    const real *parameter[64];
    real *arrays[OUTPUTS];
    for (int i = 0; i < 64; i++) positions[i] = (sk_vec4){(real)odd[i % 8], (real)odd[i / 8], (real)odd[i * 5 % 7], 1};
    for (int k = 0; k < SK_FORMULA_PARTICLES; k++) {
        for (int i = 0; i < ELEMENTS; i++) slots[k][i] = (uint32_t)(i * 11 + k * 17) % 64;
        slot[k] = slots[k];
    }
    for (int k = 0; k < 64; k++) parameter[k] = values[k];
    for (size_t k = 0; k < count; k++) arrays[k] = out[k];
    const sk_tape_input input = {positions, positions, 0, slot, parameter, 0, (real)0.25};
    sk_tape_kernels_of[0]->evaluate(&tape, &input, 0, ELEMENTS, arrays);
    for (size_t k = 0; k < count; k++)
        for (int i = 0; i < ELEMENTS; i++) require(isfinite(out[k][i]));
    sk_tape_free(&tape);
    require(allocator.bytes == 0);
}

static void judge_formula(const skein_formula *f) {
    double positions[3 * SK_FORMULA_PARTICLES] = {0.5, 1, -2, 0}, parameters[2] = {1, 0.5};
    double hessian[9 * SK_FORMULA_PARTICLES * SK_FORMULA_PARTICLES];
    const skein_formula_point point = {positions, positions, NULL, parameters, 1};
    skein_formula_value value;
    skein_formula_info info = skein_formula_about(f);
    require(info.particles >= 0 && info.particles <= 8 && (info.size == 1 || info.size == 3));
    require(skein_formula_evaluate(f, &point, &value, NULL) == SKEIN_OK);
    if (f->hessian) require(skein_formula_hessian(f, &point, hessian, NULL) == SKEIN_OK);
    for (int language = SKEIN_FORMULA_C; language <= SKEIN_FORMULA_GRAPH; language++) {
        size_t length = 0;
        if (language == SKEIN_FORMULA_KERNEL && info.size != 1) continue; // a constraint is a number
        require(!skein_formula_emit(f, (skein_formula_language)language, judge_text, &length, NULL) && length > 0);
    }
    judge_tape(f);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    uint8_t flags = size ? data[0] : 0;
    // exactly as large as it is, so that a sanitizer sees the first byte too many
    size_t length = size ? size - 1 : 0;
    char *text = malloc(length + 1);
    require(text != NULL);
    memcpy(text, size ? data + 1 : data, length);
    text[length] = '\0';
    skein_formula_desc desc = {.text = text,
                               .parameters = (const char *[]){"L", "k", NULL},
                               .particles = flags >> 5 & 3,
                               .velocities = flags & 1,
                               .comparison = flags >> 1 & 1,
                               // second derivatives of large formulas take long
                               .second = (flags >> 2 & 1) && length < 200,
                               .result = (skein_formula_result)((flags >> 3 & 3) % 3)};
    skein_formula_mark mark;
    skein_error error = {SKEIN_OK, "", ""};
    skein_formula *f = skein_formula_create(&desc, &mark, &error);
    if (f) judge_formula(f);
    else judge_fault(text, &mark, &error);
    skein_formula_destroy(f);
    free(text);
    return 0;
}
