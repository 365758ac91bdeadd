/* Running tapes: kernels alone (base/kernels.h). */
#include "formula/tape.h"

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/layout.h"
#include "base/polynomial.h"
#include "formula/evaluate.h"

#ifdef SKEIN_DOUBLE
#define LEAST SK_LEAST_DOUBLE
#define MOST_EXP SK_MOST_EXP_DOUBLE
#else
#define LEAST SK_LEAST_FLOAT
#define MOST_EXP SK_MOST_EXP_FLOAT
#endif

#define SK_UNIT tape
SK_KERNELS(const sk_tape_kernels, kernels);

#ifdef SK_ISA

#ifdef SK_SMALL
#define EACH(value_)                                                                           \
    _Pragma("clang loop unroll_count(4)") for (size_t i = 0; i < count; i++) to[i] = (value_); \
    break
#else
#define EACH(value_)                                     \
    for (size_t i = 0; i < count; i++) to[i] = (value_); \
    break
#endif

#include "base/wide_elementary.h"

/* ---- guards, as in evaluate_in.h ---- */

SK_INLINE sk_wide reciprocal(sk_wide x, sk_mask *guarded) {
    sk_mask good = sk_at_most(sk_splat(LEAST), sk_wide_abs(x));
    *guarded |= ~good;
    return sk_keep(good, 1 / x);
}

SK_INLINE sk_wide root(sk_wide x, sk_mask *guarded) {
    sk_mask good = sk_at_most((sk_wide){0}, x);
    *guarded |= ~good;
    return sk_wide_sqrt(sk_keep(good, x));
}

SK_INLINE sk_wide guarded_exp(sk_wide x, sk_mask *guarded) {
    sk_wide most = sk_splat(MOST_EXP);
    sk_mask good = sk_at_most(x, most);
    *guarded |= ~good;
    return sk_wide_exp(sk_select(good, x, most));
}

SK_INLINE sk_wide guarded_log(sk_wide x, sk_mask *guarded) {
    sk_wide least = sk_splat(LEAST);
    sk_mask good = sk_at_most(least, x);
    *guarded |= ~good;
    return sk_wide_log(sk_select(good, x, least));
}

SK_INLINE sk_wide guarded_pow(sk_wide x, sk_wide y, sk_mask *guarded) {
    sk_wide one = sk_splat(1);
    sk_mask good = sk_positive(x), plain = sk_differ(y, (sk_wide){0});
    *guarded |= ~good & plain;
    sk_wide power = sk_keep(good, sk_wide_pow(sk_select(good, x, one), y));
    return sk_select(plain, power, one);
}

/* x, taken into -1 to 1. */
SK_INLINE sk_wide within_one(sk_wide x) {
    sk_wide one = sk_splat(1);
    x = sk_select(sk_more(x, one), one, x);
    return sk_select(sk_more(-one, x), -one, x);
}

/* ---- functions: called, and so compiled, once for all lengths of a block ---- */

#define FUNCTION(name_, value_)                                                                         \
    static __attribute__((noinline)) void each_##name_(sk_wide *to, const sk_wide *x, const sk_wide *y, \
                                                       sk_mask *guarded, size_t count) {                \
        (void)y, (void)guarded;                                                                         \
        for (size_t i = 0; i < count; i++) to[i] = (value_);                                            \
    }
FUNCTION(exp, guarded_exp(x[i], &guarded[i]))
FUNCTION(log, guarded_log(x[i], &guarded[i]))
FUNCTION(sin, sk_wide_sin(x[i]))
FUNCTION(cos, sk_wide_cos(x[i]))
FUNCTION(tan, sk_wide_tan(x[i]))
FUNCTION(asin, sk_wide_asin(within_one(x[i])))
FUNCTION(acos, sk_wide_acos(within_one(x[i])))
FUNCTION(atan2, sk_wide_atan2(x[i], y[i]))
FUNCTION(pow, guarded_pow(x[i], y[i], &guarded[i]))
#undef FUNCTION

/* ---- instructions ---- */

#define FROM(k_) (registers + instruction->from[k_] * vectors)[i]
#define CALL(name_)                                                                                                   \
    each_##name_(to, registers + instruction->from[0] * vectors, registers + instruction->from[1] * vectors, guarded, \
                 count);                                                                                              \
    break
#define A(k_) FROM(k_)
#define P(k_) (FROM(k_) * FROM((k_) + 1))
#define SIZE_A 1
#define SIZE_P 2
#define SUM2(number_, first_, sign_, second_) \
    case SK_TAPE_SUM2 + (number_):            \
        EACH(first_(0) sign_ second_(SIZE_##first_));
#define SUM3(number_, first_, sign_, second_, other_, third_) \
    case SK_TAPE_SUM3 + (number_):                            \
        EACH((first_(0) sign_ second_(SIZE_##first_))other_ third_(SIZE_##first_ + SIZE_##second_));
/* The four ways to go on from a first sum. */
#define SUM3_OF(number_, first_, sign_, second_)        \
    SUM3((number_)*4 + 0, first_, sign_, second_, +, A) \
    SUM3((number_)*4 + 1, first_, sign_, second_, +, P) \
    SUM3((number_)*4 + 2, first_, sign_, second_, -, A) \
    SUM3((number_)*4 + 3, first_, sign_, second_, -, P)
#define SUMS(kind_)                                                                                             \
    kind_(0, A, +, A) kind_(1, A, +, P) kind_(2, A, -, A) kind_(3, A, -, P) kind_(4, P, +, A) kind_(5, P, +, P) \
        kind_(6, P, -, A) kind_(7, P, -, P)

#define MINUS2(number_, first_, second_) \
    case SK_TAPE_MINUS2 + (number_):     \
        EACH(-(first_(0) + second_(SIZE_##first_)));
#define MINUS3(number_, first_, second_, third_) \
    case SK_TAPE_MINUS3 + (number_):             \
        EACH(-((first_(0) + second_(SIZE_##first_)) + third_(SIZE_##first_ + SIZE_##second_)));
#define MINUS          \
    MINUS2(0, A, A)    \
    MINUS2(1, A, P)    \
    MINUS2(2, P, A)    \
    MINUS2(3, P, P)    \
    MINUS3(0, A, A, A) \
    MINUS3(1, A, A, P) \
    MINUS3(2, A, P, A) MINUS3(3, A, P, P) MINUS3(4, P, A, A) MINUS3(5, P, A, P) MINUS3(6, P, P, A) MINUS3(7, P, P, P)

/* The first `count` vectors of a block. `vectors` and `count` are known where this is inlined. */
SK_INLINE void run_code(const sk_tape *tape, sk_wide *registers, sk_mask *guarded, const size_t vectors,
                        const size_t count) {
    for (size_t at = 0; at < tape->code.count; at++) {
        const sk_instruction *instruction = &tape->code.data[at];
        sk_wide *to = registers + instruction->to * vectors;
        switch (instruction->op) {
            SUMS(SUM2)
            SUMS(SUM3_OF)
            MINUS
        case SK_NODE_MULTIPLY: EACH(FROM(0) * FROM(1));
        case SK_NODE_NEGATE: EACH(-FROM(0));
        case SK_NODE_RECIPROCAL: EACH(reciprocal(FROM(0), &guarded[i]));
        case SK_NODE_SQRT: EACH(root(FROM(0), &guarded[i]));
        case SK_NODE_ABS: EACH(sk_wide_abs(FROM(0)));
        case SK_NODE_LESS: EACH(sk_select(sk_more(FROM(1), FROM(0)), FROM(2), FROM(3)));
        case SK_NODE_EXP: CALL(exp);
        case SK_NODE_LOG: CALL(log);
        case SK_NODE_SIN: CALL(sin);
        case SK_NODE_COS: CALL(cos);
        case SK_NODE_TAN: CALL(tan);
        case SK_NODE_ASIN: CALL(asin);
        case SK_NODE_ACOS: CALL(acos);
        case SK_NODE_ATAN2: CALL(atan2);
        case SK_NODE_POW: CALL(pow);
        default: break;
        }
    }
}

/* Infinities and NaN propagate through sums; elements whose sum overflows are left out too. The four sums are
 * variables, since compilers would keep an array of them in memory. */
SK_INLINE void judge(const sk_tape *tape, const sk_wide *registers, sk_mask *finite, const size_t vectors,
                     const size_t count) {
    const sk_wide zero = {0};
    size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        sk_wide a = zero, b = zero, c = zero, d = zero;
        for (size_t k = 0; k < tape->outputs; k++) {
            const sk_wide *from = registers + tape->output[k] * vectors + i;
            a += from[0], b += from[1], c += from[2], d += from[3];
        }
        finite[i] = ~sk_differ(a - a, zero), finite[i + 1] = ~sk_differ(b - b, zero);
        finite[i + 2] = ~sk_differ(c - c, zero), finite[i + 3] = ~sk_differ(d - d, zero);
    }
    for (size_t left = count % 4; left; left--, i++) {
        sk_wide sum = zero;
        for (size_t k = 0; k < tape->outputs; k++) sum += registers[tape->output[k] * vectors + i];
        finite[i] = ~sk_differ(sum - sum, zero);
    }
}

SK_INLINE void run_and_judge(const sk_tape *tape, sk_wide *registers, sk_tape_verdict *verdict, const size_t vectors,
                             const size_t count) {
    for (size_t i = 0; i < count; i++) verdict->guarded[i] = (sk_mask){0};
    run_code(tape, registers, verdict->guarded, vectors, count);
    if (!tape->unjudged) judge(tape, registers, verdict->finite, vectors, count);
}

static void run(const sk_tape *tape, sk_wide *registers, size_t vectors, size_t count, sk_tape_verdict *verdict) {
    enum { MOST = SK_TAPE_WIDES * SK_PARTS, HALF = MOST / 2 };
    if (vectors == MOST && count > HALF) run_and_judge(tape, registers, verdict, MOST, MOST);
#ifndef SK_SMALL // where bytes are dear, those three are enough
    else if (vectors == MOST) run_and_judge(tape, registers, verdict, MOST, HALF);
    else if (vectors == HALF) run_and_judge(tape, registers, verdict, HALF, HALF);
#endif
    else if (vectors == 1) run_and_judge(tape, registers, verdict, 1, 1); // within a kernel: pointwise.h
    else run_and_judge(tape, registers, verdict, vectors, count);
}

static void judge_outputs(const sk_tape *tape, const sk_wide *registers, size_t vectors, size_t count, sk_mask *finite) {
    judge(tape, registers, finite, vectors, count);
}

/* ---- in and out ---- */

static void begin_block(const sk_tape *tape, const sk_tape_input *input, sk_wide *registers, size_t vectors) {
    for (size_t c = 0; c < tape->constants.count; c++)
        for (size_t i = 0; i < vectors; i++)
            registers[tape->constants.data[c].to * vectors + i] = sk_splat(tape->constants.data[c].value);
    for (size_t l = 0; l < tape->loads.count; l++) {
        const sk_tape_load *load = &tape->loads.data[l];
        bool uniform = load->source == SK_TAPE_PARAMETER && (input->uniform >> load->index & 1);
        if (!uniform && load->source != SK_TAPE_TIME) continue;
        real value = uniform ? input->parameter[load->index][0] : input->time;
        for (size_t i = 0; i < vectors; i++) registers[load->to * vectors + i] = sk_splat(value);
    }
}

/* Loads elements [element, element + count) into the registers that need them; lanes past them repeat the last. */
static void load(const sk_tape *tape, const sk_tape_input *input, size_t element, size_t count, sk_wide *registers,
                 size_t vectors) {
    for (size_t l = 0; l < tape->loads.count; l++) {
        const sk_tape_load load = tape->loads.data[l];
        sk_wide *to = registers + load.to * vectors;
        if (load.source == SK_TAPE_TIME || (load.source == SK_TAPE_PARAMETER && (input->uniform >> load.index & 1)))
            continue;
        for (size_t i = 0; i < vectors; i++) {
            // the last, partial vector repeats its last element; all that follow repeat it, too
            size_t first = element + SK_PART * i, left = SK_PART * i < count ? count - SK_PART * i : 0;
            bool whole = left >= SK_PART;
            if (load.source == SK_TAPE_PARAMETER) {
                const real *from = input->parameter[load.index];
                real lane[SK_PART];
                for (size_t k = 0; k < SK_PART && !whole; k++)
                    lane[k] = from[k < left ? first + k : element + count - 1];
                memcpy(to + i, whole ? from + first : lane, sizeof *to);
                continue;
            }
            const uint32_t *slot = input->slot[load.index];
            uint32_t lane[SK_PART];
            for (size_t k = 0; k < SK_PART && !whole; k++) lane[k] = slot[k < left ? first + k : element + count - 1];
            const sk_vec4 *vector = load.source == SK_TAPE_POSITION ? input->positions : input->velocities;
            sk_wide4 got = sk_gather_any(vector, input->packed, whole ? slot + first : lane);
            to[i] = got.x, to[vectors + i] = got.y, to[2 * vectors + i] = got.z;
        }
    }
}

static void store(const sk_tape *tape, const sk_wide *registers, size_t vectors, const sk_tape_verdict *verdict,
                  size_t element, size_t count, real *const *outputs) {
    for (size_t k = 0; k < tape->outputs; k++) {
        const sk_wide *from = registers + tape->output[k] * vectors;
        for (size_t i = 0; SK_PART * i < count; i++) {
            size_t left = count - SK_PART * i;
            sk_wide out = sk_keep(verdict->finite[i], from[i]);
            real *to = outputs[k] + element + SK_PART * i;
            // of a size that is known, it is a store
            if (left >= SK_PART) memcpy(to, &out, sizeof out);
            else memcpy(to, &out, left * sizeof(real));
        }
    }
}

static size_t count_guarded(const sk_tape_verdict *verdict, size_t count) {
    size_t guarded = 0;
    for (size_t i = 0; SK_PART * i < count; i++) {
        sk_mask mask = verdict->guarded[i] | ~verdict->finite[i];
        if (!sk_any(mask)) continue;
        for (size_t l = 0; l < SK_PART && SK_PART * i + l < count; l++) guarded += mask[l] != 0;
    }
    return guarded;
}

/* Elements [begin, end) block by block; into outputs, if there are any. */
SK_INLINE size_t go_through(const sk_tape *tape, const sk_tape_input *input, size_t begin, size_t end,
                            real *const *outputs) {
    sk_wide registers[SK_TAPE_MEMORY / sizeof(sk_wide)];
    sk_tape_verdict verdict;
    size_t block = SK_LANES * tape->wides, vectors = tape->wides * SK_PARTS, guarded = 0;
    begin_block(tape, input, registers, vectors);
    for (size_t element = begin; element < end; element += block) {
        size_t count = end - element < block ? end - element : block;
        load(tape, input, element, count, registers, vectors);
        run(tape, registers, vectors, (count + SK_PART - 1) / SK_PART, &verdict);
        if (!outputs) continue;
        store(tape, registers, vectors, &verdict, element, count, outputs);
        guarded += count_guarded(&verdict, count);
    }
    return guarded;
}

static size_t evaluate(const sk_tape *tape, const sk_tape_input *input, size_t begin, size_t end, real *const *outputs) {
    return go_through(tape, input, begin, end, outputs);
}

static void work(const sk_tape *tape, const sk_tape_input *input, size_t begin, size_t end) {
    go_through(tape, input, begin, end, NULL);
}

const sk_tape_kernels SK_KERNEL(kernels) = {begin_block, run, judge_outputs, evaluate, work};

#else

const sk_tape_kernels *const sk_tape_kernels_of[SK_ISA_COUNT] = SK_EACH_ISA(kernels);
#endif
