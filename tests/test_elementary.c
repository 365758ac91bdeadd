/* Tests of base/elementary: the errors that its header states, against the C library; special cases; and the bits,
 * which must be the same in every build on every machine.
 *
 * Arguments are made from counted random bits by integer steps alone, so that the golden hashes below see the same
 * ones everywhere. A hash that differs means a build that would not repeat another's motion: look for contraction,
 * -ffast-math, a rounding mode. (Who changes a function on purpose takes the new hashes from the failing test.) */
#include "base/elementary.h"
#include "base/hash.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

enum { TRIALS = 100000, HASHED = 20000 };

/* ---- Arguments ----------------------------------------------------------------------------- */

static double of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static float float_of_bits(uint32_t bits) {
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static uint32_t bits_of_float(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static uint64_t dice(uint64_t *state) {
    return sk_hash_mix(*state += 0x9e3779b97f4a7c15u);
}

/* Any sign and bits, with an exponent from `least` to `most`: all exponents are as likely. */
static double random_double(uint64_t *state, int least, int most) {
    uint64_t bits = dice(state), exponent = (uint64_t)least + 1023 + dice(state) % (uint64_t)(most - least + 1);
    return of_bits((bits & 0x800fffffffffffff) | exponent << 52);
}

static float random_float(uint64_t *state, int least, int most) {
    uint32_t bits = (uint32_t)dice(state);
    uint32_t exponent = (uint32_t)least + 127 + (uint32_t)(dice(state) % (uint64_t)(most - least + 1));
    return float_of_bits((bits & 0x807fffff) | exponent << 23);
}

/* Half a turn of the dice: 1 and what is next to it, at any distance from 2^-52 (2^-23) to 1/2. */
static double near_one(uint64_t *state) {
    uint64_t bits = dice(state) & 0xfffffffffffff;
    int shift = (int)(dice(state) % 53);
    return of_bits(0x3ff0000000000000 + (bits >> shift) - (dice(state) & 1 ? bits >> shift << 1 : 0));
}

static float near_one_float(uint64_t *state) {
    uint32_t bits = dice(state) & 0x7fffff;
    int shift = (int)(dice(state) % 24);
    return float_of_bits(0x3f800000 + (bits >> shift) - (dice(state) & 1 ? bits >> shift << 1 : 0));
}

static const double special[] = {
    0, DBL_TRUE_MIN, DBL_MIN, 1e-300, 1e-160, 1e-40, FLT_TRUE_MIN, FLT_MIN, 1e-20, 0x1p-53, 0x1p-30, 0x1p-24, 1e-3,
    0.4142135623730950, 0.4142135623730951, 0.5, 0.7071067811865475, 0.7071067811865476, 0.7853981633974483, 1,
    0x1.fffffffffffffp-1, 0x1.0000000000001p0, 0x1.fffffep-1, 0x1.000002p0, 1.4142135623730951, 1.5, 2, 3,
    // next to multiples of pi/2, the last three as near as a double comes
    1.5707963267948966, 3.141592653589793, 4.71238898038469, 6.283185307179586, 11, 22, 333, 355, 103993, 104348,
    5.319372648326541e+255, 6381956970095103.0 * 0x1p797, 16367173.0 * 0x1p72,
    // the bounds of the reductions, and of overflow and underflow
    33554431, 33554432, 33554434, 1073741823.9999999, 1073741824, 1e9, 1e15, 1e22, 1e38, 1e100, 1e300, 86.6, 87.3365,
    88.7228, 88.7229, 88.8, 103.28, 103.98, 104, 708.3964185322641, 709.782712893384, 709.7827128933841, 710, 744.44,
    745.1332191019411, 745.1332191019412, 746, 800, FLT_MAX, DBL_MAX, HUGE_VAL};

/* ---- Errors -------------------------------------------------------------------------------- */

/* The formats, and the exponents of their least and of the first number too large. */
typedef struct format {
    int digits, least, most;
} format;
static const format binary64 = {53, -1074, 1024}, binary32 = {24, -149, 128};

/* |got - exact| in units in the last place of `exact`; infinity counts as the first number too large. */
static double ulps(double got, long double exact, format f) {
    if (isnan(exact) || isnan(got)) return isnan(exact) && isnan(got) ? 0 : HUGE_VAL;
    if (!signbit(got) != !signbit(exact)) return HUGE_VAL;
    long double limit = ldexpl(1, f.most), size = fminl(fabsl(exact), limit),
                value = fminl(fabsl((long double)got), limit);
    int exponent;
    frexpl(size, &exponent);
    exponent = exponent > f.most ? f.most : exponent;
    exponent = size == 0 || exponent - f.digits < f.least ? f.least : exponent - f.digits;
    return (double)ldexpl(fabsl(value - size), -exponent);
}

typedef struct worst {
    double error, x, y;
} worst;

static void note(worst *w, double error, double x, double y) {
    if (error > w->error) *w = (worst){error, x, y};
}

/* ---- One argument -------------------------------------------------------------------------- */

typedef struct one {
    const char *name;
    double (*of)(double);
    float (*of_float)(float);
    long double (*exact)(long double);
    double (*exact_float)(double);
    double bar, bar_float;                    /* ulp, as elementary.h states them */
    int least, most, least_float, most_float; /* exponents of likely arguments */
    uint64_t golden, golden_float;
} one;

static const one ones[] = {
    {"sin", sk_sin, sk_sinf, sinl, sin, 0.87, 0.83, -20, 30, -12, 25, 0xc4595789929ebcc0, 0x8dc8c3d437d677e1},
    {"cos", sk_cos, sk_cosf, cosl, cos, 0.87, 0.83, -20, 30, -12, 25, 0xff6ea696cfb698c7, 0x1c5cd73fc811d6c6},
    {"tan", sk_tan, sk_tanf, tanl, tan, 1.05, 1.02, -20, 30, -12, 25, 0x2612644c6d29b428, 0xb7dfe159454b1bad},
    {"exp", sk_exp, sk_expf, expl, exp, 0.79, 0.80, -20, 9, -12, 6, 0x96e609605e824e5c, 0x463be7e37810cd05},
    {"log", sk_log, sk_logf, logl, log, 0.68, 0.67, -40, 40, -20, 20, 0xacc1724b2912be17, 0x69bc280281b3828a},
    {"asin", sk_asin, sk_asinf, asinl, asin, 0.73, 0.74, -20, -1, -10, -1, 0xa88049d9475dd797, 0x412cc63083a47876},
    {"acos", sk_acos, sk_acosf, acosl, acos, 0.70, 0.72, -20, -1, -10, -1, 0x8d51029a5dfb63b8, 0x67d8da4c77ea7063},
};

/* All exponents, the likely ones, near 1, and multiples of pi/2. */
static double argument(const one *f, uint64_t *state) {
    switch (dice(state) % 4) {
    case 0: return of_bits(dice(state));
    case 1: return near_one(state);
    case 2: return (double)(dice(state) % 1000000000) * 1.5707963267948966;
    default: return random_double(state, f->least, f->most);
    }
}

static float argument_float(const one *f, uint64_t *state) {
    switch (dice(state) % 4) {
    case 0: return float_of_bits((uint32_t)dice(state));
    case 1: return near_one_float(state);
    case 2: return (float)((double)(dice(state) % 1000000) * 1.5707963267948966);
    default: return random_float(state, f->least_float, f->most_float);
    }
}

/* Whether long double is longer, and its functions are: some libraries hand on what they have for double. */
static bool can_measure(void) {
    volatile long double little = 1e-18L; // asked when it runs
    return LDBL_MANT_DIG >= 64 && expl(little) != 1;
}

static void doubles_are_as_near_as_stated(void **state) {
    (void)state;
    if (!can_measure()) skip();
    bool good = true;
    for (size_t i = 0; i < COUNT(ones); i++) {
        const one *f = &ones[i];
        worst w = {0};
        uint64_t seed = i;
        for (int k = 0; k < TRIALS; k++) {
            double x = argument(f, &seed);
            note(&w, ulps(f->of(x), f->exact(x), binary64), x, 0);
        }
        for (size_t k = 0; k < 2 * COUNT(special); k++) {
            double x = k & 1 ? -special[k / 2] : special[k / 2];
            note(&w, ulps(f->of(x), f->exact(x), binary64), x, 0);
        }
        print_message("%-6s %.3f ulp at %.17g\n", f->name, w.error, w.x);
        good &= w.error <= f->bar;
    }
    assert_true(good);
}

static void floats_are_as_near_as_stated(void **state) {
    (void)state;
    bool good = true;
    for (size_t i = 0; i < COUNT(ones); i++) {
        const one *f = &ones[i];
        worst w = {0};
        uint64_t seed = i;
        for (int k = 0; k < TRIALS; k++) {
            float x = argument_float(f, &seed);
            note(&w, ulps((double)f->of_float(x), f->exact_float((double)x), binary32), (double)x, 0);
        }
        for (size_t k = 0; k < 2 * COUNT(special); k++) {
            float x = (float)(k & 1 ? -special[k / 2] : special[k / 2]);
            note(&w, ulps((double)f->of_float(x), f->exact_float((double)x), binary32), (double)x, 0);
        }
        print_message("%-6s %.3f ulp at %.9g\n", f->name, w.error, w.x);
        good &= w.error <= f->bar_float;
    }
    assert_true(good);
}

/* ---- Two arguments ------------------------------------------------------------------------- */

typedef struct two {
    const char *name;
    double (*of)(double, double);
    float (*of_float)(float, float);
    long double (*exact)(long double, long double);
    double (*exact_float)(double, double);
    double bar, bar_float;
    uint64_t golden, golden_float;
} two;

static const two twos[] = {
    {"atan2", sk_atan2, sk_atan2f, atan2l, atan2, 0.74, 0.75, 0x63cda9fc2333c6cf, 0x865bd04179f2092b},
    {"pow", sk_pow, sk_powf, powl, pow, 0.79, 0.51, 0x9a42278aa9aafd88, 0x6fe096f2fd981af6},
};

/* Any bits; of like size; and for powers, whole numbers and results all over the range. */
static void arguments(uint64_t *state, double *a, double *b) {
    switch (dice(state) % 4) {
    case 0: *a = of_bits(dice(state)), *b = of_bits(dice(state)); break;
    case 1: *a = random_double(state, -4, 4), *b = random_double(state, -4, 4); break;
    case 2: *a = random_double(state, -20, 20), *b = (double)(dice(state) % 64) - 32; break;
    default: {
        *a = near_one(state);
        uint64_t away = bits_of(*a - 1) >> 52 & 0x7ff; // the power's exponent makes up for nearness to 1
        *b = random_double(state, 0, 10) * (away ? of_bits((2046 - away) << 52) : 1);
    }
    }
}

static void arguments_float(uint64_t *state, float *a, float *b) {
    switch (dice(state) % 4) {
    case 0: *a = float_of_bits((uint32_t)dice(state)), *b = float_of_bits((uint32_t)dice(state)); break;
    case 1: *a = random_float(state, -4, 4), *b = random_float(state, -4, 4); break;
    case 2: *a = random_float(state, -20, 20), *b = (float)(dice(state) % 64) - 32; break;
    default: {
        *a = near_one_float(state);
        uint32_t away = bits_of_float(*a - 1) >> 23 & 0xff;
        *b = random_float(state, 0, 7) * (away ? float_of_bits((254 - away) << 23) : 1);
    }
    }
}

static void pairs_of_doubles_are_as_near_as_stated(void **state) {
    (void)state;
    if (!can_measure()) skip();
    bool good = true;
    for (size_t i = 0; i < COUNT(twos); i++) {
        const two *f = &twos[i];
        worst w = {0};
        uint64_t seed = i;
        for (int k = 0; k < TRIALS; k++) {
            double a, b;
            arguments(&seed, &a, &b);
            note(&w, ulps(f->of(a, b), f->exact(a, b), binary64), a, b);
        }
        for (size_t k = 0; k < 4 * COUNT(special) * COUNT(special); k++) {
            double a = special[k / 4 % COUNT(special)], b = special[k / 4 / COUNT(special)];
            a = k & 1 ? -a : a, b = k & 2 ? -b : b;
            note(&w, ulps(f->of(a, b), f->exact(a, b), binary64), a, b);
        }
        print_message("%-6s %.3f ulp at %.17g, %.17g\n", f->name, w.error, w.x, w.y);
        good &= w.error <= f->bar;
    }
    assert_true(good);
}

static void pairs_of_floats_are_as_near_as_stated(void **state) {
    (void)state;
    bool good = true;
    for (size_t i = 0; i < COUNT(twos); i++) {
        const two *f = &twos[i];
        worst w = {0};
        uint64_t seed = i;
        for (int k = 0; k < TRIALS; k++) {
            float a, b;
            arguments_float(&seed, &a, &b);
            note(&w, ulps((double)f->of_float(a, b), f->exact_float((double)a, (double)b), binary32), (double)a,
                 (double)b);
        }
        for (size_t k = 0; k < 4 * COUNT(special) * COUNT(special); k++) {
            float a = (float)special[k / 4 % COUNT(special)], b = (float)special[k / 4 / COUNT(special)];
            a = k & 1 ? -a : a, b = k & 2 ? -b : b;
            note(&w, ulps((double)f->of_float(a, b), f->exact_float((double)a, (double)b), binary32), (double)a,
                 (double)b);
        }
        print_message("%-6s %.3f ulp at %.9g, %.9g\n", f->name, w.error, w.x, w.y);
        good &= w.error <= f->bar_float;
    }
    assert_true(good);
}

/* ---- Special cases ------------------------------------------------------------------------- */

static void check_same(const char *what, double x, double y, double got, double want) {
    if (isnan(want) ? isnan(got) : bits_of(got) == bits_of(want)) return;
    fail_msg("%s of %g, %g: got %.17g, not %.17g", what, x, y, got, want);
}

static void special_cases_of_one(void **state) {
    (void)state;
    static const double inf = HUGE_VAL, none = NAN, quarter = 1.5707963267948966;
    const struct {
        double x, sin, cos, tan, exp, log, asin, acos;
    } rows[] = {
        {0.0, 0.0, 1, 0.0, 1, -inf, 0.0, quarter},        {-0.0, -0.0, 1, -0.0, 1, -inf, -0.0, quarter},
        {inf, none, none, none, inf, inf, none, none},    {-inf, none, none, none, 0.0, none, none, none},
        {none, none, none, none, none, none, none, none},
    };
    for (size_t i = 0; i < COUNT(rows); i++) {
        double x = rows[i].x,
               want[] = {rows[i].sin, rows[i].cos, rows[i].tan, rows[i].exp, rows[i].log, rows[i].asin, rows[i].acos};
        for (size_t f = 0; f < COUNT(ones); f++) {
            check_same(ones[f].name, x, 0, ones[f].of(x), want[f]);
            check_same(ones[f].name, x, 0, (double)ones[f].of_float((float)x), (double)(float)want[f]);
        }
    }
    check_same("log", 1, 0, sk_log(1), 0.0);
    check_same("log", 1, 0, (double)sk_logf(1), 0.0);
    check_same("acos", 1, 0, sk_acos(1), 0.0);
    check_same("acos", 1, 0, (double)sk_acosf(1), 0.0);
    check_same("acos", -1, 0, sk_acos(-1), 2 * quarter);
    check_same("asin", -1, 0, sk_asin(-1), -quarter);
    check_same("log", -1, 0, sk_log(-DBL_TRUE_MIN), none);
    check_same("exp", 800, 0, sk_exp(DBL_MAX), inf);
    check_same("exp", -800, 0, sk_exp(-DBL_MAX), 0.0);
    check_same("asin", 1, 0, sk_asin(0x1.0000000000001p0), none);
    check_same("sin", 1e22, 0, sk_sin(1e22), -0.8522008497671888);
}

static void special_cases_of_two(void **state) {
    (void)state;
    static const double values[] = {
        0.0, 1, 0.5, 2, 3, 2.5, 0x1p52, 0x1.8p53, 9007199254740991.0, DBL_TRUE_MIN, 1e300, DBL_MAX, HUGE_VAL, NAN};
    for (size_t k = 0; k < 4 * COUNT(values) * COUNT(values); k++) {
        double a = values[k / 4 % COUNT(values)], b = values[k / 4 / COUNT(values)];
        a = k & 1 ? -a : a, b = k & 2 ? -b : b;
        // where the C library's value is 0, infinite or no number, ours is the same
        double want = pow(a, b);
        if (!isfinite(want) || want == 0) check_same("pow", a, b, sk_pow(a, b), want);
        float want_float = powf((float)a, (float)b);
        if (!isfinite(want_float) || want_float == 0)
            check_same("powf", a, b, (double)sk_powf((float)a, (float)b), (double)want_float);
        want = atan2(a, b);
        if (!isfinite(want) || want == 0 || isinf(a) || isinf(b) || a == 0 || b == 0)
            check_same("atan2", a, b, sk_atan2(a, b), want);
    }
    check_same("pow", NAN, 0, sk_pow(NAN, 0), 1);
    check_same("pow", 1, NAN, sk_pow(1, NAN), 1);
    check_same("pow", -1, HUGE_VAL, sk_pow(-1, HUGE_VAL), 1);
    check_same("pow", -2, 3, sk_pow(-2, 3), -8);
    check_same("pow", -8, 1 / 3.0, sk_pow(-8, 1 / 3.0), NAN);
    check_same("powf", 3, 4, (double)sk_powf(3, 4), 81);
}

static void sincos_is_sine_and_cosine(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int k = 0; k < TRIALS; k++) {
        double x = argument(&ones[0], &seed), s, c;
        sk_sincos(x, &s, &c);
        check_same("sincos", x, 0, s, sk_sin(x));
        check_same("sincos", x, 0, c, sk_cos(x));
        float y = argument_float(&ones[0], &seed), t, d;
        sk_sincosf(y, &t, &d);
        check_same("sincosf", (double)y, 0, (double)t, (double)sk_sinf(y));
        check_same("sincosf", (double)y, 0, (double)d, (double)sk_cosf(y));
    }
}

/* ---- The same bits ------------------------------------------------------------------------- */

static uint64_t hash_double(uint64_t hash, double x) {
    return sk_hash_word(hash, isnan(x) ? 1 : bits_of(x));
}
static uint64_t hash_float(uint64_t hash, float x) {
    return sk_hash_word(hash, isnan(x) ? 1 : bits_of_float(x));
}

static bool is_golden(const char *name, const char *type, uint64_t hash, uint64_t golden) {
    if (hash == golden) return true;
    print_message("%s, %s: the hash is 0x%016llx\n", name, type, (unsigned long long)hash);
    return false;
}

static void bits_are_the_same_everywhere(void **state) {
    (void)state;
    bool good = true;
    for (size_t i = 0; i < COUNT(ones); i++) {
        const one *f = &ones[i];
        uint64_t seed = 100 + i, hash = SK_HASH_START, hash_f = SK_HASH_START;
        for (int k = 0; k < HASHED; k++) {
            hash = hash_double(hash, f->of(argument(f, &seed)));
            hash_f = hash_float(hash_f, f->of_float(argument_float(f, &seed)));
        }
        good &= is_golden(f->name, "double", hash, f->golden);
        good &= is_golden(f->name, "float", hash_f, f->golden_float);
    }
    for (size_t i = 0; i < COUNT(twos); i++) {
        const two *f = &twos[i];
        uint64_t seed = 200 + i, hash = SK_HASH_START, hash_f = SK_HASH_START;
        for (int k = 0; k < HASHED; k++) {
            double a, b;
            float c, d;
            arguments(&seed, &a, &b);
            arguments_float(&seed, &c, &d);
            hash = hash_double(hash, f->of(a, b));
            hash_f = hash_float(hash_f, f->of_float(c, d));
        }
        good &= is_golden(f->name, "double", hash, f->golden);
        good &= is_golden(f->name, "float", hash_f, f->golden_float);
    }
    assert_true(good);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(doubles_are_as_near_as_stated),
        cmocka_unit_test(floats_are_as_near_as_stated),
        cmocka_unit_test(pairs_of_doubles_are_as_near_as_stated),
        cmocka_unit_test(pairs_of_floats_are_as_near_as_stated),
        cmocka_unit_test(special_cases_of_one),
        cmocka_unit_test(special_cases_of_two),
        cmocka_unit_test(sincos_is_sine_and_cosine),
        cmocka_unit_test(bits_are_the_same_everywhere),
    };
    return cmocka_run_group_tests_name("elementary", tests, NULL, NULL);
}
