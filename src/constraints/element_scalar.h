/* One element of a kind at a time, in double: its rest values, strain and energy, and its value and gradient for
 * inspection. Once in each kind, after element.h, outside of instruction sets. */
#include "base/elementary.h"

typedef struct one_element {
    double x[SK_ARITY][3], rest[SK_RESTS], value;
    double gradient[SK_ARITY][3], divisor; /* the gradient is `gradient` over the divisor */
    bool guarded;
} one_element;

static inline double reciprocal(one_element *e, double x) {
    bool good = x >= 2.2250738585072014e-308 || x <= -2.2250738585072014e-308;
    e->guarded |= !good;
    return good ? 1 / x : 0;
}

#define TEXT(text) static const char formula_text[] = text;
#define FORMULA(name) static void name(one_element *e)
#define RESTS(name) static void name(one_element *e)
#define REAL double
#define NUMBER(x) (x)
#define POSITION(particle, axis) e->x[particle][axis]
#define PARAMETER(index) e->rest[index]
#define VALUE(component, x) e->value = (x)
#define REST(index, x) e->rest[index] = (x)
#define GRADIENT(component, particle, axis, x) e->gradient[particle][axis] = (x)
#define OPPOSITE(particle, of) \
    for (int axis = 0; axis < 3; axis++) e->gradient[particle][axis] = 0 - e->gradient[of][axis]
#define UNIT_DIVISOR(x) e->divisor = (x)
#define RECIPROCAL(x) reciprocal(e, x)
#define SQRT(x) __builtin_sqrt(x)
#define ABS(x) __builtin_fabs(x)
#define LESS(a, b, yes, no) ((a) < (b) ? (yes) : (no))
#define ATAN2(y, x) sk_atan2(y, x)

#include SK_FORMULA

#ifdef SK_MOST_CHANGE
#define SK_MOST_CHANGE_OR_0 SK_MOST_CHANGE
#else
#define SK_MOST_CHANGE_OR_0 0
#endif

#ifdef SK_ONE_SIDED // (element_arithmetic.h)
#define SK_IS_ONE_SIDED true
#else
#define SK_IS_ONE_SIDED false
#endif

static bool rest_of(const void *params, const double (*x)[3], double *rest) {
    (void)params;
    one_element e = {.divisor = 1};
    memcpy(e.x, x, sizeof e.x);
    rests(&e);
    memcpy(rest, e.rest, sizeof e.rest);
    return true;
}

static void evaluate_one(const sk_batch *batch, const sk_vec4 *x, size_t element, one_element *e) {
    for (size_t i = 0; i < SK_ARITY; i++) {
        sk_vec4 p = x[batch->slot[SK_ARITY * element + i]];
        e->x[i][0] = (double)p.x, e->x[i][1] = (double)p.y, e->x[i][2] = (double)p.z;
    }
    for (size_t r = 0; r < SK_RESTS; r++) e->rest[r] = (double)batch->rest[r * batch->count + element];
    formula(e);
}

static double value_of(const sk_batch *batch, const sk_vec4 *x, size_t element) {
    one_element e = {.divisor = 1};
    evaluate_one(batch, x, element, &e);
    return e.value;
}

static bool evaluate(const sk_batch *batch, double time, const sk_vec4 *x, size_t element, size_t most,
                     sk_constraint_answer *answer, double (*gradient)[3]) {
    (void)time;
    one_element e = {.divisor = 1};
    evaluate_one(batch, x, element, &e);
    double over = reciprocal(&e, e.divisor);
    *answer = (sk_constraint_answer){.value = e.value, .one_sided = SK_IS_ONE_SIDED, .guarded = e.guarded};
    for (size_t i = 0; i < SK_ARITY && i < most; i++)
        for (int k = 0; k < 3; k++) gradient[i][k] = over * e.gradient[i][k];
    return true;
}

#ifdef SK_WITH_STRAIN
static void strain(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, real *out) {
    for (size_t e = begin; e < end; e++)
        out[e - begin] = batch->rest[e] > 0
                             ? (real)((SK_IS_ONE_SIDED ? -1 : 1) * value_of(batch, x, e) / (double)batch->rest[e])
                             : 0;
}
#endif

static size_t energy(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *out) {
    (void)time;
    for (size_t e = begin; e < end; e++) {
        double value = value_of(batch, x, e);
        if (SK_IS_ONE_SIDED && value >= 0) value = 0;
        out[e - begin] = 0.5 * value * value;
    }
    return 0;
}

#undef TEXT
#undef FORMULA
#undef RESTS
#undef REAL
#undef NUMBER
#undef POSITION
#undef PARAMETER
#undef VALUE
#undef REST
#undef GRADIENT
#undef OPPOSITE
#undef UNIT_DIVISOR
#undef RECIPROCAL
#undef SQRT
#undef ABS
#undef LESS
#undef ATAN2

/* The members of a kind's constant struct for its kernels and measures, besides its name and fields. */
#ifdef SK_WITH_STRIPS
#define SK_WALKS_OF(mode)               \
    {                                   \
        {SK_EACH_ISA(mode##_strips)}, { \
            SK_EACH_ISA(mode##_groups)  \
        }                               \
    }
#else
#define SK_WALKS_OF(mode)                        \
    {                                            \
        .groups = { SK_EACH_ISA(mode##_groups) } \
    }
#endif
#ifdef SK_LINEAR
#define SK_IS_LINEAR true
#else
#define SK_IS_LINEAR false
#endif
#ifdef SK_ONLY_BOUNDS
#define SK_ELEMENT_RULES                                                                                \
    .arity = SK_ARITY, .rest_count = SK_RESTS, .rest = rest_of, .energy = energy, .evaluate = evaluate, \
    .text = formula_text
#else
#define SK_ELEMENT_RULES                                                                                               \
    .arity = SK_ARITY, .rest_count = SK_RESTS, .rest = rest_of, .force = SK_WALKS_OF(force),                           \
    .project = SK_WALKS_OF(project), .project_damped = SK_WALKS_OF(project_damped), .apply_sweep = SK_WALKS_OF(apply), \
    .diagonal = {SK_EACH_ISA(diagonal)}, .blocks = {SK_EACH_ISA(blocks)}, .energy = energy, .evaluate = evaluate,      \
    .text = formula_text, .linear = SK_IS_LINEAR, .most_change = SK_MOST_CHANGE_OR_0
#endif
