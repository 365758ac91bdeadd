/* What the macros of an emitted formula mean (compiled.h): value, gradient and second derivatives of as many elements at a time
 * as the processor works on at once. Included by the emitted file, which says beforehand how many particles, parameters
 * and rest values an element has; without that there is nothing here. It needs gcc 12 or clang, for their vectors.
 *
 * Operations and guards are those of tapes, one by one, and the walk and the projection are the library's own (inside/), so
 * that the bits are the tape's (tests/test_compiled.c). */
#ifndef SKEIN_COMPILED_FORMULA_H
#define SKEIN_COMPILED_FORMULA_H

#include <skein/compiled.h>

#ifdef SKEIN_PARTICLES

#ifdef __FAST_MATH__
#error "-ffast-math would take the guards away, and give other bits: compile this file without it"
#endif
#ifdef __clang__
#pragma STDC FP_CONTRACT OFF // no fused operations: they round otherwise
#else
#pragma GCC optimize("fp-contract=off,no-math-errno")
#endif

/* Lanes: as many as the processor works on at once. */
#if defined(__AVX512F__) && defined(__AVX512DQ__) && defined(__AVX512BW__) && defined(__AVX512VL__)
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_AVX512
#define SK_WIDTH 64
#elif defined(__AVX2__)
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_AVX2
#define SK_WIDTH 32
#else
#define SKEIN_NEEDS SKEIN_INSTRUCTIONS_PLAIN
#define SK_WIDTH 16
#endif
#define SK_ARITY SKEIN_PARTICLES
#define SK_RESTS SKEIN_RESTS
#include <skein/inside/wide.h>

#include <skein/inside/projection.h>

/* What is the same for all elements. */
typedef struct skein_common {
    sk_wide parameter[SKEIN_PARAMETERS + 1], time, shared[SKEIN_SHARED + 1];
    const skein_elementary *elementary;
} skein_common;

/* ---- the formula's operations, with the guards of docs/formula.md ---- */

#ifdef SKEIN_DOUBLE
#define SKEIN_MOST_EXP 709.0
#else
#define SKEIN_MOST_EXP 88.0f
#endif

SK_INLINE sk_wide skein_reciprocal(sk_wide x) {
    return sk_keep(sk_splat(SK_LEAST_NORMAL) <= sk_wide_abs(x), 1 / x);
}
SK_INLINE sk_wide skein_root(sk_wide x) {
    return sk_wide_sqrt(sk_keep((sk_wide){0} <= x, x));
}
SK_INLINE sk_wide skein_call(skein_function *function, sk_wide x) {
    sk_wide out;
    function((const real *)&x, (real *)&out, SK_PART);
    return out;
}
SK_INLINE sk_wide skein_call_two(skein_function_of_two *function, sk_wide x, sk_wide y) {
    sk_wide out;
    function((const real *)&x, (const real *)&y, (real *)&out, SK_PART);
    return out;
}
SK_INLINE sk_wide skein_at_most(sk_wide x, sk_wide most) {
    return sk_select(x <= most, x, most);
}
SK_INLINE sk_wide skein_at_least(sk_wide x, sk_wide least) {
    return sk_select(least <= x, x, least);
}
SK_INLINE sk_wide skein_power(const skein_elementary *f, sk_wide x, sk_wide y) {
    sk_wide one = sk_splat(1), zero = {0};
    sk_wide power = sk_keep(x > zero, skein_call_two(f->pow, sk_select(x > zero, x, one), y));
    return sk_select(y != zero, power, one);
}
SK_INLINE sk_wide skein_within_one(sk_wide x) {
    sk_wide one = sk_splat(1);
    x = sk_select(x > one, one, x);
    return sk_select(-one > x, -one, x);
}

#ifdef SKEIN_LONG // compiling it into each walk would take too long
#define FORMULA(name) static __attribute__((noinline)) void name(sk_element *e, const skein_common *all)
#else
#define FORMULA(name) SK_INLINE void name(sk_element *e, const skein_common *all)
#endif
#define SHARED_BY_ALL(name) SK_INLINE void name(const sk_element *e, skein_common *all)
#define SECOND(name) static void name(sk_element *e, const skein_common *all, sk_wide *entry)
#define REAL sk_wide
#define NUMBER(x) sk_splat((real)(x))
#define SKEIN_AXIS_0 x
#define SKEIN_AXIS_1 y
#define SKEIN_AXIS_2 z
#define POSITION(particle, axis) e->x[particle].SKEIN_AXIS_##axis
/* Parameters, and then rest values. */
#define PARAMETER(index)                                                                   \
    ((index) < SKEIN_PARAMETERS ? all->parameter[(index) < SKEIN_PARAMETERS ? (index) : 0] \
                                : e->rest[(index) < SKEIN_PARAMETERS ? 0 : (index)-SKEIN_PARAMETERS])
#define TIME all->time
#define SHARE(index, number) all->shared[index] = (number)
#define SHARED(index) all->shared[index]
#define VALUE(component, number) e->value = (number)
#define GRADIENT(component, particle, axis, number) e->gradient[particle].SKEIN_AXIS_##axis = (number)
#define BY_TIME(component, number) e->by_time = (number)
#define HESSIAN(row, column, number) entry[(row) * ((row) + 1) / 2 + (column)] = (number)
#define RECIPROCAL(x) skein_reciprocal(x)
#define SQRT(x) skein_root(x)
#define ABS(x) sk_wide_abs(x)
#define LESS(a, b, yes, no) sk_select((b) > (a), yes, no)
#define EXP(x) skein_call(all->elementary->exp, skein_at_most(x, sk_splat(SKEIN_MOST_EXP)))
#define LOG(x) skein_call(all->elementary->log, skein_at_least(x, sk_splat(SK_LEAST_NORMAL)))
#define SIN(x) skein_call(all->elementary->sin, x)
#define COS(x) skein_call(all->elementary->cos, x)
#define TAN(x) skein_call(all->elementary->tan, x)
#define ASIN(x) skein_call(all->elementary->asin, skein_within_one(x))
#define ACOS(x) skein_call(all->elementary->acos, skein_within_one(x))
#define ATAN2(y, x) skein_call_two(all->elementary->atan2, y, x)
#define POW(x, y) skein_power(all->elementary, x, y)

FORMULA(formula);
#if SKEIN_SHARED
SHARED_BY_ALL(shared);
#endif

SK_INLINE void skein_begin(skein_common *all, const real *parameters, real time, const skein_elementary *elementary) {
    for (int i = 0; i < SKEIN_PARAMETERS; i++) all->parameter[i] = sk_splat(parameters[i]);
    all->time = sk_splat(time), all->elementary = elementary;
#if SKEIN_SHARED
    shared(NULL, all); // of no element
#endif
}

/* ---- groups ---- */

SK_INLINE bool skein_work_out(sk_element *e, const sk_element_constants *c, sk_element_mode mode,
                              const skein_common *all) {
    e->judged = e->timed = true, e->divided = e->opposite = false;
    e->is_energy = SKEIN_ENERGY, e->one_sided = SKEIN_ONE_SIDED;
    e->by_time = (sk_wide){0};
    formula(e, all);
    judge(e, mode != SK_MODE_FORCE);
    answer(e, c, mode);
    return true;
}
#define WORK_OUT skein_work_out
#include <skein/inside/group_walk.h>

SK_INLINE void skein_walk(const skein_groups *g, sk_element_mode mode) {
    const sk_element_constants c = {
        .damping_time = g->damping_time, .per_step = g->per_step, .gamma = g->gamma, .step = g->step};
    skein_common all;
    skein_begin(&all, g->parameters, g->time, g->elementary);
    walk_elements(g, &c, mode, &all);
}
static void skein_project(const skein_groups *g) {
    skein_walk(g, SK_MODE_PROJECT);
}
static void skein_project_damped(const skein_groups *g) {
    if (g->gamma > 0) skein_walk(g, SK_MODE_PROJECT_DAMPED);
    else skein_walk(g, SK_MODE_PROJECT_KEPT);
}
static void skein_force(const skein_groups *g) {
    skein_walk(g, SK_MODE_FORCE);
}

/* ---- elements ---- */

SK_INLINE void skein_take(sk_element *e, const skein_element_values *in, size_t lane) {
    e->by_time = (sk_wide){0};
    for (int p = 0; p < SKEIN_PARTICLES; p++) {
        const real *x = in->positions[p] + lane;
        e->x[p] = (sk_wide3){lanes_at(x), lanes_at(x + in->stride), lanes_at(x + 2 * in->stride)};
    }
    for (int r = 0; r < SKEIN_RESTS; r++) e->rest[r] = lanes_at(in->rest[r] + lane);
}

static void skein_evaluate(const skein_element_values *in) {
    skein_common all;
    skein_begin(&all, in->parameters, in->time, in->elementary);
    for (size_t lane = 0; lane < in->count; lane += SK_PART) {
        sk_element e;
        real *const *out = in->outputs;
        skein_take(&e, in, lane);
        formula(&e, &all);
        memcpy(*out++ + lane, &e.value, sizeof e.value);
        for (int p = 0; p < SKEIN_PARTICLES; p++, out += 3) {
            memcpy(out[0] + lane, &e.gradient[p].x, sizeof(sk_wide));
            memcpy(out[1] + lane, &e.gradient[p].y, sizeof(sk_wide));
            memcpy(out[2] + lane, &e.gradient[p].z, sizeof(sk_wide));
        }
        memcpy(*out + lane, &e.by_time, sizeof e.by_time);
    }
}

#if SKEIN_ENERGY
SECOND(second);

static void skein_second(const skein_element_values *in) {
    enum { ENTRIES = 3 * SKEIN_PARTICLES * (3 * SKEIN_PARTICLES + 1) / 2 };
    skein_common all;
    skein_begin(&all, in->parameters, in->time, in->elementary);
    for (size_t lane = 0; lane < in->count; lane += SK_PART) {
        sk_element e;
        sk_wide entry[ENTRIES];
        skein_take(&e, in, lane);
        second(&e, &all, entry);
        for (int i = 0; i < ENTRIES; i++) memcpy(in->outputs[i] + lane, &entry[i], sizeof(sk_wide));
    }
}
#else
#define skein_second NULL
#endif

/* What an emitted file ends with. */
#define SKEIN_COMPILED(name, hash_of_formula, text_of_formula, names)                                                   \
    extern const skein_compiled name;                                                                                   \
    const skein_compiled name = {SKEIN_COMPILED_ABI, sizeof(real),   SK_PART,      SKEIN_NEEDS,   hash_of_formula,      \
                                 text_of_formula,    names,          SKEIN_ENERGY, skein_project, skein_project_damped, \
                                 skein_force,        skein_evaluate, skein_second}

#endif
#endif
