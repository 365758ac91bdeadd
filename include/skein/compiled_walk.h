/* What the macros of an emitted formula mean (compiled.h): value, gradient and all that constraints make of them, for
 * groups of sixteen elements, gather to scatter. Included by the emitted file, which says beforehand how many
 * particles, parameters and rest values an element has; without that there is nothing here. It needs gcc 12 or clang,
 * for their vectors.
 *
 * The arithmetic is that of src/constraints/formula.c, operation by operation, so that the bits are those of the tape
 * (tests/test_compiled.c). */
#ifndef SKEIN_COMPILED_WALK_H
#define SKEIN_COMPILED_WALK_H

#include <skein/compiled_lanes.h>

#ifdef SKEIN_PARTICLES

/* ---- an element's numbers, for all lanes ---- */

typedef struct skein_element {
    skein_lanes x[SKEIN_PARTICLES][3], w[SKEIN_PARTICLES]; /* places, inverse masses */
    skein_lanes parameter[SKEIN_PARAMETERS + SKEIN_RESTS + 1], time;
    skein_lanes shared[SKEIN_SHARED + 1]; /* what depends on parameters and time alone */
    skein_lanes value, by_time, gradient[SKEIN_PARTICLES][3];
    skein_mask active; /* finite, and not on the free side */
    const skein_elementary *elementary;
} skein_element;

#define SKEIN_EACH(i, count) SKEIN_UNROLLED for (int i = 0; i < (count); i++)
#ifdef SKEIN_LONG // compiling it into each walk would take too long
#define FORMULA(name) static __attribute__((noinline)) void name(skein_element *e)
#else
#define FORMULA(name) SKEIN_INLINE void name(skein_element *e)
#endif
#define SHARED_BY_ALL(name) SKEIN_INLINE void name(skein_element *e)
#define SECOND(name) static void name(skein_element *e, skein_lanes *entry)
#define REAL skein_lanes
#define NUMBER(x) skein_splat((skein_real)(x))
#define POSITION(particle, axis) e->x[particle][axis]
#define PARAMETER(index) e->parameter[index]
#define TIME e->time
#define SHARE(index, number) e->shared[index] = (number)
#define SHARED(index) e->shared[index]
#define VALUE(component, number) e->value = (number)
#define GRADIENT(component, particle, axis, number) e->gradient[particle][axis] = (number)
#define BY_TIME(component, number) e->by_time = (number)
#define HESSIAN(row, column, number) entry[(row) * ((row) + 1) / 2 + (column)] = (number)
#define RECIPROCAL(x) skein_reciprocal(x)
#define SQRT(x) skein_guarded_root(x)
#define ABS(x) skein_abs(x)
#define LESS(a, b, yes, no) skein_select((b) > (a), yes, no)
#define EXP(x) skein_guarded_exp(e->elementary, x)
#define LOG(x) skein_guarded_log(e->elementary, x)
#define SIN(x) skein_call(e->elementary->sin, x)
#define COS(x) skein_call(e->elementary->cos, x)
#define TAN(x) skein_call(e->elementary->tan, x)
#define ASIN(x) skein_call(e->elementary->asin, skein_within_one(x))
#define ACOS(x) skein_call(e->elementary->acos, skein_within_one(x))
#define ATAN2(y, x) skein_call_two(e->elementary->atan2, y, x)
#define POW(x, y) skein_guarded_pow(e->elementary, x, y)

#if SKEIN_SHARED
SHARED_BY_ALL(shared);
#endif

/* What is the same for all elements. */
SKEIN_INLINE void skein_begin(skein_element *e, const skein_real *parameters, skein_real time,
                              const skein_elementary *elementary) {
    for (int i = 0; i < SKEIN_PARAMETERS; i++) e->parameter[i] = skein_splat(parameters[i]);
    e->time = skein_splat(time);
    e->by_time = (skein_lanes){0};
    e->elementary = elementary;
#if SKEIN_SHARED
    shared(e);
#endif
}

/* Infinities and NaN go through sums. */
SKEIN_INLINE skein_mask skein_is_finite(skein_lanes sum) {
    return ~(sum - sum != (skein_lanes){0});
}

SKEIN_INLINE skein_lanes skein_dot(const skein_lanes *a, const skein_lanes *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether a < most in all lanes; a NaN is not. */
SKEIN_INLINE bool skein_all_under(skein_lanes a, skein_real most) {
#if SKEIN_LANE_BYTES == 64 && defined(SKEIN_DOUBLE)
    return _mm512_cmp_pd_mask((__m512d)a, _mm512_set1_pd(most), _CMP_LT_OQ) == 0xff;
#elif SKEIN_LANE_BYTES == 64
    return _mm512_cmp_ps_mask((__m512)a, _mm512_set1_ps(most), _CMP_LT_OQ) == 0xffff;
#else
    skein_mask over = ~(a < skein_splat(most));
    uint64_t words[SKEIN_LANE_BYTES / 8], any = 0;
    memcpy(words, &over, sizeof words);
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) any |= words[i];
    return !any;
#endif
}

/* An element that is not finite gives 0s. */
SKEIN_INLINE void skein_judge(skein_element *e) {
    skein_lanes sum = (skein_lanes){0} + e->value;
    SKEIN_EACH (p, SKEIN_PARTICLES)
        for (int k = 0; k < 3; k++) sum += e->gradient[p][k];
    skein_mask finite = skein_is_finite(sum + e->by_time);
    e->value = skein_keep(finite, e->value);
    SKEIN_EACH (p, SKEIN_PARTICLES)
        for (int k = 0; k < 3; k++) e->gradient[p][k] = skein_keep(finite, e->gradient[p][k]);
    e->by_time = skein_keep(finite, e->by_time);
    e->active = finite;
    if (SKEIN_ONE_SIDED) e->active &= (skein_lanes){0} > e->value;
}

/* The same where all are known to be finite. */
SKEIN_INLINE void skein_trust(skein_element *e) {
    e->active = (skein_lanes){0} == (skein_lanes){0};
    if (SKEIN_ONE_SIDED) e->active = (skein_lanes){0} > e->value;
}

SKEIN_INLINE skein_lanes skein_rate(const skein_element *e, const skein_lanes (*u)[3]) {
    skein_lanes sum = skein_dot(e->gradient[0], u[0]);
    SKEIN_EACH (p, SKEIN_PARTICLES) sum = p ? sum + skein_dot(e->gradient[p], u[p]) : sum;
    return sum;
}

/* The sum of w |gradient|^2. */
SKEIN_INLINE skein_lanes skein_weight(const skein_element *e) {
    skein_lanes sum = e->w[0] * skein_dot(e->gradient[0], e->gradient[0]);
    SKEIN_EACH (p, SKEIN_PARTICLES) sum = p ? sum + e->w[p] * skein_dot(e->gradient[p], e->gradient[p]) : sum;
    return sum;
}

/* ---- from value and gradient to a factor of the gradient (docs/formula.md, Constraints and energies) ---- */

SKEIN_INLINE skein_lanes skein_pull(const skein_element *e, const skein_groups *g, const skein_lanes (*v)[3],
                                    size_t lane) {
    skein_lanes stiffness = skein_load(g->stiffness + lane);
    if (SKEIN_ENERGY) return skein_keep(e->active, -stiffness);
    skein_lanes rate = skein_rate(e, v) + e->by_time;
    return skein_keep(e->active, stiffness * (-e->value - g->damping_time * rate));
}

SKEIN_INLINE skein_lanes skein_push(const skein_element *e, const skein_groups *g, skein_lanes weight, size_t lane) {
    const skein_lanes zero = {0};
    skein_lanes soft = skein_load(g->compliance + lane) * g->per_step, below = weight, above = -e->value;
    if (SKEIN_ENERGY) { // C^2 = 2 E in place of C = sqrt(2 E), whose gradient has no value where E is 0
        skein_lanes square = skein_keep(e->value > zero, 2 * e->value);
        below += skein_keep(square > zero, soft * square); // an infinite compliance times 0 is nothing
        above = -square;
    } else {
        below += soft;
    }
    return skein_keep(e->active & (below > zero), above / below);
}

/* `moved` from the substep's start on; the multiplier is kept up to date. */
SKEIN_INLINE skein_lanes skein_push_damped(const skein_element *e, const skein_groups *g, const skein_lanes (*moved)[3],
                                           skein_lanes weight, size_t lane) {
    const skein_lanes zero = {0};
    skein_lanes soft = skein_load(g->compliance + lane) * g->per_step, multiplier = skein_load(g->multiplier + lane);
    skein_lanes held = skein_keep(multiplier != zero, soft * multiplier);
    if (SKEIN_ENERGY) {
        skein_lanes square = skein_keep(e->value > zero, 2 * e->value), root = skein_square_root(square);
        skein_lanes below = weight + skein_keep(square > zero, soft * square);
        skein_lanes s = skein_keep(e->active & (below > zero), root * (-root - held) / below);
        skein_store(g->multiplier + lane, multiplier + root * s);
        return s;
    }
    skein_lanes rate = skein_rate(e, moved) + g->substep * e->by_time, below = (1 + g->gamma) * weight + soft;
    skein_mask on = (below > zero) & (SKEIN_ONE_SIDED ? e->active | (multiplier > zero) : e->active);
    skein_lanes change = skein_keep(on, (-e->value - held - g->gamma * rate) / below);
    if (SKEIN_ONE_SIDED) change = skein_select(zero > multiplier + change, -multiplier, change); // it only pushes
    skein_store(g->multiplier + lane, multiplier + change);
    return change;
}

/* ---- walks ---- */

FORMULA(formula);

/* Two groups that share no particle hide each other's latency, where registers are enough for both. */
#if SKEIN_PARTICLES == 2 && !defined(SKEIN_LONG)
#define SKEIN_TOGETHER 2
#else
#define SKEIN_TOGETHER 1
#endif

typedef enum skein_walk { SKEIN_WALK_PROJECT, SKEIN_WALK_PROJECT_DAMPED, SKEIN_WALK_FORCE } skein_walk;

/* The lanes of `count` groups from `part` on; elements of a group share no particle, so they may go in parts. `walk`,
 * `careful` and `count` are constants where this is inlined.
 *
 * Projections know the weight, the sum of w |gradient|^2: where it and the value are far from what a number can hold,
 * all outputs are, and no sum of them is needed to tell. Where they are not (false is returned, and nothing has
 * happened), one must be careful. */
SKEIN_INLINE bool skein_meet(skein_element *e, const skein_groups *g, size_t group, size_t part, size_t packed,
                             skein_walk walk, bool careful, size_t count) {
    const uint32_t *slots = g->slots + group * SKEIN_PARTICLES * SKEIN_GROUP + part;
    size_t lane = group * SKEIN_GROUP + part, slots_a_group = SKEIN_PARTICLES * SKEIN_GROUP;
    bool force = walk == SKEIN_WALK_FORCE, good = true;
    skein_lanes at[SKEIN_TOGETHER][SKEIN_PARTICLES][4], weight[SKEIN_TOGETHER], s[SKEIN_TOGETHER];
    for (size_t i = 0; i < count; i++) {
        SKEIN_EACH (p, SKEIN_PARTICLES) {
            skein_gather(at[i][p], g->positions, packed, slots + i * slots_a_group + p * SKEIN_GROUP);
            for (int k = 0; k < 3; k++) e[i].x[p][k] = at[i][p][k];
            e[i].w[p] = at[i][p][3];
        }
        for (int r = 0; r < SKEIN_RESTS; r++)
            e[i].parameter[SKEIN_PARAMETERS + r] =
                skein_load(g->rest + (size_t)r * g->rest_stride + lane + i * SKEIN_GROUP);
    }
    for (size_t i = 0; i < count; i++) {
        formula(&e[i]);
        if (careful || force) skein_judge(&e[i]);
        else skein_trust(&e[i]);
        if (force) continue;
        weight[i] = skein_weight(&e[i]);
        if (!careful)
            good &= skein_all_under(weight[i] + skein_abs(e[i].value) + skein_abs(e[i].by_time), (skein_real)1e30);
    }
    if (!good) return false;
    for (size_t i = 0; i < count; i++) {
        skein_lanes other[SKEIN_PARTICLES][3] = {{{0}}};
        if (walk == SKEIN_WALK_PROJECT_DAMPED || (force && g->other)) {
            SKEIN_EACH (p, SKEIN_PARTICLES) {
                skein_lanes o[4];
                skein_gather(o, g->other, packed, slots + i * slots_a_group + p * SKEIN_GROUP);
                for (int k = 0; k < 3; k++) other[p][k] = force ? o[k] : at[i][p][k] - o[k];
            }
        }
        s[i] = force ? skein_pull(&e[i], g, (const skein_lanes(*)[3])other, lane + i * SKEIN_GROUP)
               : walk == SKEIN_WALK_PROJECT
                   ? skein_push(&e[i], g, weight[i], lane + i * SKEIN_GROUP)
                   : skein_push_damped(&e[i], g, (const skein_lanes(*)[3])other, weight[i], lane + i * SKEIN_GROUP);
    }
    for (size_t i = 0; i < count; i++)
        SKEIN_EACH (p, SKEIN_PARTICLES) {
            const uint32_t *slot = slots + i * slots_a_group + p * SKEIN_GROUP;
            skein_lanes factor = force ? s[i] : s[i] * e[i].w[p];
            if (force) skein_gather(at[i][p], g->forces, packed, slot);
            for (int k = 0; k < 3; k++) at[i][p][k] += factor * e[i].gradient[p][k];
            skein_scatter(at[i][p], force ? g->forces : g->positions, packed, slot);
        }
    return true;
}

/* For the few: groups with a particle in a packed block, and those whose numbers are large. */
static __attribute__((noinline)) void skein_meet_few(const skein_groups *g, size_t group, size_t part, size_t packed,
                                                     skein_walk walk) {
    skein_element e;
    skein_begin(&e, g->parameters, g->time, g->elementary);
    if (walk == SKEIN_WALK_FORCE) skein_meet(&e, g, group, part, packed, SKEIN_WALK_FORCE, true, 1);
    else if (walk == SKEIN_WALK_PROJECT) skein_meet(&e, g, group, part, packed, SKEIN_WALK_PROJECT, true, 1);
    else skein_meet(&e, g, group, part, packed, SKEIN_WALK_PROJECT_DAMPED, true, 1);
}

SKEIN_INLINE bool skein_is_packed(const skein_groups *g, size_t group) {
    const uint32_t *slots = g->slots + group * SKEIN_PARTICLES * SKEIN_GROUP;
    bool packed = false;
    for (int i = 0; i < SKEIN_PARTICLES * SKEIN_GROUP && g->packed; i++) packed |= slots[i] < g->packed;
    return packed;
}

SKEIN_INLINE void skein_meet_all(const skein_groups *g, skein_walk walk) {
    skein_element e[SKEIN_TOGETHER];
    for (size_t i = 0; i < SKEIN_TOGETHER; i++) skein_begin(&e[i], g->parameters, g->time, g->elementary);
    for (size_t group = 0, count; group < g->count; group += count) {
        bool packed = skein_is_packed(g, group);
        count = SKEIN_TOGETHER == 2 && walk == SKEIN_WALK_PROJECT && !g->packed && group + 1 < g->count &&
                        g->ahead[group] > 1
                    ? 2
                    : 1;
        for (size_t part = 0; part < SKEIN_GROUP; part += SKEIN_LANES) {
            bool done = count == 2 ? skein_meet(e, g, group, part, 0, walk, false, SKEIN_TOGETHER)
                                   : !packed && skein_meet(e, g, group, part, 0, walk, false, 1);
            for (size_t i = 0; i < count && !done; i++)
                skein_meet_few(g, group + i, part, packed ? g->packed : 0, walk);
        }
    }
}

static void skein_project(const skein_groups *g) {
    skein_meet_all(g, SKEIN_WALK_PROJECT);
}
static void skein_project_damped(const skein_groups *g) {
    skein_meet_all(g, SKEIN_WALK_PROJECT_DAMPED);
}
static void skein_force(const skein_groups *g) {
    skein_meet_all(g, SKEIN_WALK_FORCE);
}

/* ---- elements for implicit solves ---- */

SKEIN_INLINE void skein_take(skein_element *e, const skein_group_values *in, size_t lane) {
    skein_begin(e, in->parameters, in->time, in->elementary);
    for (size_t p = 0; p < SKEIN_PARTICLES; p++)
        for (size_t k = 0; k < 3; k++) e->x[p][k] = skein_load(in->positions + (4 * p + k) * SKEIN_GROUP + lane);
    for (int r = 0; r < SKEIN_RESTS; r++)
        e->parameter[SKEIN_PARAMETERS + r] = skein_load(in->rest + (size_t)r * SKEIN_GROUP + lane);
}

SKEIN_INLINE void skein_give(const skein_group_values *out, size_t lane, const skein_lanes *numbers, size_t count) {
    skein_lanes sum = {0};
    for (size_t i = 0; i < count; i++) sum += numbers[i];
    for (size_t i = 0; i < count; i++) skein_store(out->outputs[i] + lane, numbers[i]);
    skein_store(out->finite + lane, skein_keep(skein_is_finite(sum), skein_splat(1)));
}

static void skein_evaluate(const skein_group_values *in) {
    for (size_t lane = 0; lane < SKEIN_GROUP; lane += SKEIN_LANES) {
        skein_element e;
        skein_lanes out[3 * SKEIN_PARTICLES + 2];
        skein_take(&e, in, lane);
        formula(&e);
        out[0] = e.value, out[3 * SKEIN_PARTICLES + 1] = e.by_time;
        memcpy(out + 1, e.gradient, sizeof e.gradient);
        skein_give(in, lane, out, sizeof out / sizeof *out);
    }
}

#if SKEIN_ENERGY
SECOND(second);

static void skein_second(const skein_group_values *in) {
    for (size_t lane = 0; lane < SKEIN_GROUP; lane += SKEIN_LANES) {
        skein_element e;
        skein_lanes out[3 * SKEIN_PARTICLES * (3 * SKEIN_PARTICLES + 1) / 2];
        skein_take(&e, in, lane);
        second(&e, out);
        skein_give(in, lane, out, sizeof out / sizeof *out);
    }
}
#else
#define skein_second NULL
#endif

/* What an emitted file ends with. */
#define SKEIN_COMPILED(name, hash_of_formula, text_of_formula, names)                                   \
    extern const skein_compiled name;                                                                   \
    const skein_compiled name = {SKEIN_COMPILED_ABI, sizeof(skein_real),   SKEIN_LANES, SKEIN_NEEDS,    \
                                 hash_of_formula,    text_of_formula,      names,       SKEIN_ENERGY,   \
                                 skein_project,      skein_project_damped, skein_force, skein_evaluate, \
                                 skein_second}

#endif
#endif
