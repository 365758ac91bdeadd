/* Tests of skein/dual.h: every operation against the derivative by hand and against central differences, in double and
 * in float; guarded points; aliasing; plain numbers on either side; several N and reals in one program (this one); and
 * the example, run as a process, whose every line is known.
 *
 * The functions under test are listed once, with what they ought to be; the list makes the tables for both reals. That
 * the header compiles as C++ is house.sh's to check. */
#define SKEIN_DUAL_N 3
#define SKEIN_DUAL_REAL double
#include <skein/dual.h>

#define SKEIN_DUAL_N 3
#include <skein/dual.h>

#define SKEIN_DUAL_N 6
#include <skein/dual.h>

#define SKEIN_DUAL_N 12
#define SKEIN_DUAL_REAL double
#define SKEIN_DUAL_NAME wide
#include <skein/dual.h>

#include "helpers.h"

enum { TRIALS = 400 };

/* ---- What is tested: f(x) or f(x, y), its slopes by hand, and where it is tried ----------------------------- */

#define UNARY(F_)                                       \
    F_(neg, -x, -1 + 0 * x, -9, 9)                      \
    F_(abs, fabs(x), x > 0 ? 1 : -1, -9, 9)             \
    F_(sqrt, sqrt(x), 1 / (2 * sqrt(x)), 0.1, 99)       \
    F_(exp, exp(x), exp(x), -5, 5)                      \
    F_(log, log(x), 1 / x, 0.1, 99)                     \
    F_(sin, sin(x), cos(x), -9, 9)                      \
    F_(cos, cos(x), -sin(x), -9, 9)                     \
    F_(tan, tan(x), 1 / (cos(x) * cos(x)), -1.4, 1.4)   \
    F_(asin, asin(x), 1 / sqrt(1 - x * x), -0.95, 0.95) \
    F_(acos, acos(x), -1 / sqrt(1 - x * x), -0.95, 0.95)

#define BINARY(F_)                                                                   \
    F_(add, x + y, 1 + 0 * x, 1 + 0 * y, -9, 9, -9, 9)                               \
    F_(sub, x - y, 1 + 0 * x, -1 + 0 * y, -9, 9, -9, 9)                              \
    F_(mul, x *y, y + 0 * x, x + 0 * y, -9, 9, -9, 9)                                \
    F_(div, x / y, 1 / y + 0 * x, -x / (y * y), -9, 9, 0.2, 9)                       \
    F_(atan2, atan2(x, y), y / (x * x + y * y), -x / (x * x + y * y), 0.2, 9, -9, 9) \
    F_(pow, pow(x, y), y *pow(x, y - 1), pow(x, y) * log(x), 0.2, 4, -3, 3)          \
    F_(min, fmin(x, y), x < y ? 1 : 0, x < y ? 0 : 1, -9, 9, -9, 9)                  \
    F_(max, fmax(x, y), x > y ? 1 : 0, x > y ? 0 : 1, -9, 9, -9, 9)

#define WRITE_UNARY(name_, value_, is_, low_, high_) \
    static double plain_##name_(double x) {          \
        return value_;                               \
    }                                                \
    static double slope_##name_(double x) {          \
        return is_;                                  \
    }
UNARY(WRITE_UNARY)

#define WRITE_BINARY(name_, value_, one_, other_, ...) \
    static double plain_##name_(double x, double y) {  \
        return value_;                                 \
    }                                                  \
    static double by_x_##name_(double x, double y) {   \
        (void)x, (void)y;                              \
        return one_;                                   \
    }                                                  \
    static double by_y_##name_(double x, double y) {   \
        (void)x, (void)y;                              \
        return other_;                                 \
    }
BINARY(WRITE_BINARY)

typedef struct unary {
    const char *name;
    skein_dual3d (*f)(skein_dual3d);
    skein_dual3 (*single)(skein_dual3);
    double (*plain)(double), (*slope)(double), low, high;
} unary;

#define UNARY_ROW(name_, value_, is_, low_, high_) \
    {#name_, skein_dual3d_##name_, skein_dual3_##name_, plain_##name_, slope_##name_, low_, high_},
static const unary unaries[] = {UNARY(UNARY_ROW)};

typedef struct binary {
    const char *name;
    skein_dual3d (*f)(skein_dual3d, skein_dual3d);
    skein_dual3 (*single)(skein_dual3, skein_dual3);
    double (*plain)(double, double), (*by_x)(double, double), (*by_y)(double, double), low, high, y_low, y_high;
} binary;

#define BINARY_ROW(name_, value_, one_, other_, ...) \
    {#name_, skein_dual3d_##name_, skein_dual3_##name_, plain_##name_, by_x_##name_, by_y_##name_, __VA_ARGS__},
static const binary binaries[] = {BINARY(BINARY_ROW)};

/* ---- Judging -------------------------------------------------------------------------------------------- */

static void check(double is, double ought, double share, const char *name, const char *what, double x, double y) {
    if (fabs(is - ought) <= share * fmax(1, fabs(ought))) return;
    fprintf(stderr, "%s(%.9g, %.9g): %s is %.17g, expected %.17g\n", name, x, y, what, is, ought);
    fail();
}

#define assert_dual(is_, value_, d1_, d2_, d3_)                                                                       \
    do {                                                                                                              \
        skein_dual3d is = (is_);                                                                                      \
        const double ought[] = {(value_), (d1_), (d2_), (d3_)};                                                       \
        for (int i = 0; i <= 3; i++) check(is.d[i], ought[i], 0, #is_, i ? "a derivative" : "the value", is.d[0], i); \
    } while (0)

static void assert_same(skein_dual3d a, skein_dual3d b, const char *what) {
    for (int i = 0; i <= 3; i++) check(a.d[i], b.d[i], 0, what, i ? "a derivative" : "the value", b.d[0], i);
}

static skein_dual3d random_dual(uint64_t *seed, double low, double high) {
    skein_dual3d a;
    a.d[0] = random_between(seed, low, high);
    for (int i = 1; i <= 3; i++) a.d[i] = random_between(seed, -2, 2);
    return a;
}

static skein_dual3 narrowed(skein_dual3d a) {
    skein_dual3 r;
    for (int i = 0; i <= 3; i++) r.d[i] = (float)a.d[i];
    return r;
}

static skein_dual3d widened(skein_dual3 a) {
    skein_dual3d r;
    for (int i = 0; i <= 3; i++) r.d[i] = a.d[i];
    return r;
}

/* ---- Every operation -------------------------------------------------------------------------------------- */

static void one_operand(void **state) {
    (void)state;
    uint64_t seed = 1;
    const double h = 1e-5;
    for (size_t k = 0; k < COUNT(unaries); k++)
        for (int trial = 0; trial < TRIALS; trial++) {
            const unary *u = &unaries[k];
            skein_dual3d a = widened(narrowed(random_dual(&seed, u->low, u->high))), r = u->f(a);
            if (u->f == skein_dual3d_abs && fabs(a.d[0]) < h) continue; /* a difference across the kink says nothing */
            skein_dual3d single = widened(u->single(narrowed(a)));
            double x = a.d[0], central = (u->plain(x + h) - u->plain(x - h)) / (2 * h);
            check(r.d[0], u->plain(x), 1e-15, u->name, "the value", x, 0);
            check(single.d[0], u->plain(x), 1e-6, u->name, "the value in float", x, 0);
            for (int i = 1; i <= 3; i++) {
                check(r.d[i], u->slope(x) * a.d[i], 1e-13, u->name, "a derivative", x, 0);
                check(r.d[i], central * a.d[i], 1e-6, u->name, "by central differences, a derivative", x, 0);
                check(single.d[i], u->slope(x) * a.d[i], 4e-5, u->name, "a derivative in float", x, 0);
            }
        }
}

static void two_operands(void **state) {
    (void)state;
    uint64_t seed = 2;
    const double h = 1e-5;
    for (size_t k = 0; k < COUNT(binaries); k++)
        for (int trial = 0; trial < TRIALS; trial++) {
            const binary *o = &binaries[k];
            skein_dual3d a = widened(narrowed(random_dual(&seed, o->low, o->high)));
            skein_dual3d b = widened(narrowed(random_dual(&seed, o->y_low, o->y_high)));
            double x = a.d[0], y = b.d[0];
            if (fabs(x - y) < 2 * h) continue; /* the kink of min and max */
            skein_dual3d r = o->f(a, b), single = widened(o->single(narrowed(a), narrowed(b)));
            double by_x = (o->plain(x + h, y) - o->plain(x - h, y)) / (2 * h);
            double by_y = (o->plain(x, y + h) - o->plain(x, y - h)) / (2 * h);
            check(r.d[0], o->plain(x, y), 1e-15, o->name, "the value", x, y);
            check(single.d[0], o->plain(x, y), 1e-6, o->name, "the value in float", x, y);
            for (int i = 1; i <= 3; i++) {
                double hand = o->by_x(x, y) * a.d[i] + o->by_y(x, y) * b.d[i];
                check(r.d[i], hand, 1e-12, o->name, "a derivative", x, y);
                check(r.d[i], by_x * a.d[i] + by_y * b.d[i], 1e-6, o->name, "by central differences, one", x, y);
                check(single.d[i], hand, 4e-5, o->name, "a derivative in float", x, y);
            }
        }
}

/* A plain number on either side does what a dual without derivatives does there. */
static void plain_operands(void **state) {
    (void)state;
    uint64_t seed = 3;
    for (int trial = 0; trial < TRIALS; trial++) {
        skein_dual3d a = random_dual(&seed, 0.2, 4);
        double x = random_between(&seed, 0.2, 4);
        skein_dual3d plain = skein_dual3d_of(x);
#define BOTH_SIDES(op_)                                                                       \
    assert_same(skein_dual3d_##op_##_real(a, x), skein_dual3d_##op_(a, plain), #op_ "_real"); \
    assert_same(skein_dual3d_real_##op_(x, a), skein_dual3d_##op_(plain, a), "real_" #op_);
        BOTH_SIDES(add)
        BOTH_SIDES(sub)
        BOTH_SIDES(mul)
        BOTH_SIDES(div)
        BOTH_SIDES(atan2)
        BOTH_SIDES(pow)
        assert_same(skein_dual3d_min_real(a, x), skein_dual3d_min(a, plain), "min_real");
        assert_same(skein_dual3d_max_real(a, x), skein_dual3d_max(a, plain), "max_real");
    }
}

/* ---- Making, changing, aliasing ------------------------------------------------------------------------------ */

static void making(void **state) {
    (void)state;
    assert_dual(skein_dual3d_of(4), 4, 0, 0, 0);
    assert_dual(skein_dual3d_seed(4, 1), 4, 1, 0, 0);
    assert_dual(skein_dual3d_seed(4, 3), 4, 0, 0, 1);
    assert_dual(skein_dual3d_seed(4, 0), 4, 0, 0, 0); /* no such controls */
    assert_dual(skein_dual3d_seed(4, 4), 4, 0, 0, 0);
    skein_dual3d a = {{5, 1, 2, 3}};
    a.d[2] = 7;
    assert_dual(a, 5, 1, 7, 3);
    skein_dual3d_set(&a, 6);
    assert_dual(a, 6, 0, 0, 0);
    assert_dual(skein_dual3d_chain(2, 3, ((skein_dual3d){{9, 1, 0, -1}})), 2, 3, 0, -3);
    assert_dual(skein_dual3d_chain2(2, 3, skein_dual3d_seed(0, 1), 5, ((skein_dual3d){{0, 1, 1, 0}})), 2, 8, 5, 0);
}

static void compound_forms(void **state) {
    (void)state;
    const skein_dual3d a = {{3, 1, -2, 0}}, b = {{2, 4, 0, 1}};
    skein_dual3d c;
#define AFTER(call_) (c = a, skein_dual3d_##call_, c)
    assert_dual(AFTER(add_to(&c, b)), 5, 5, -2, 1);
    assert_dual(AFTER(sub_from(&c, b)), 1, -3, -2, -1);
    assert_dual(AFTER(mul_by(&c, b)), 6, 14, -4, 3);
    assert_dual(AFTER(div_by(&c, b)), 1.5, -2.5, -1, -0.75);
    assert_dual(AFTER(add_real_to(&c, 2)), 5, 1, -2, 0);
    assert_dual(AFTER(sub_real_from(&c, 2)), 1, 1, -2, 0);
    assert_dual(AFTER(mul_by_real(&c, 2)), 6, 2, -4, 0);
    assert_dual(AFTER(div_by_real(&c, 2)), 1.5, 0.5, -1, 0);
    /* a += a, a -= a, a *= a, a /= a */
    assert_dual(AFTER(add_to(&c, c)), 6, 2, -4, 0);
    assert_dual(AFTER(sub_from(&c, c)), 0, 0, 0, 0);
    assert_dual(AFTER(mul_by(&c, c)), 9, 6, -12, 0);
    assert_dual(AFTER(div_by(&c, c)), 1, 0, 0, 0);
}

/* ---- Guards --------------------------------------------------------------------------------------------------- */

static void guarded_points(void **state) {
    (void)state;
#define AT(x_) (skein_dual3d_seed((x_), 1))
    assert_dual(skein_dual3d_sqrt(AT(0)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_sqrt(AT(-4)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_sqrt(AT(4 * DBL_MIN)), 2 * sqrt(DBL_MIN), 0.25 / sqrt(DBL_MIN), 0, 0);
    assert_dual(skein_dual3d_acos(AT(1)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_acos(AT(-1)), acos(-1), 0, 0, 0);
    assert_dual(skein_dual3d_acos(AT(1 + DBL_EPSILON)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_asin(AT(1)), asin(1), 0, 0, 0);
    assert_dual(skein_dual3d_asin(AT(-7)), asin(-1), 0, 0, 0);
    assert_true(skein_dual3d_acos(AT(1 - DBL_EPSILON)).d[1] < -1e7); /* steep, not yet guarded */
    assert_dual(skein_dual3d_abs(AT(0)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_div(AT(3), AT(0)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_div_real(AT(3), 0), 0, 0, 0, 0);
    assert_dual(skein_dual3d_real_div(3, AT(-0.0)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_log(AT(0)), log(DBL_MIN), 0, 0, 0);
    assert_dual(skein_dual3d_log(AT(-1)), log(DBL_MIN), 0, 0, 0);
    assert_dual(skein_dual3d_exp(AT(800)), DBL_MAX, 0, 0, 0);
    assert_dual(skein_dual3d_exp(AT(-800)), 0, 0, 0, 0);
    assert_dual(skein_dual3d_atan2(AT(0), AT(0)), 0, 0, 0, 0);
    /* of equals, the first */
    assert_dual(skein_dual3d_min(AT(2), skein_dual3d_of(2)), 2, 1, 0, 0);
    assert_dual(skein_dual3d_max(AT(2), skein_dual3d_of(2)), 2, 1, 0, 0);
    assert_dual(skein_dual3d_max_real(AT(2), 2), 2, 1, 0, 0);
    /* powers: at 0, of negative numbers, beyond the range */
    assert_dual(skein_dual3d_pow_real(AT(0), 0), 1, 0, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(0), 1), 0, 1, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(0), 2), 0, 0, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(0), 0.5), 0, 0, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(0), -1), 0, 0, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(-2), 3), -8, 12, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(-2), 2.5), 0, 0, 0, 0);
    assert_dual(skein_dual3d_pow(AT(-2), skein_dual3d_seed(3, 2)), -8, 12, 0, 0);
    assert_dual(skein_dual3d_pow_real(AT(-1e200), 3), -DBL_MAX, 0, 0, 0);
    assert_dual(skein_dual3d_real_pow(0, AT(2)), 0, 0, 0, 0);
}

/* Rounding where it matters: along an axis a length has the slopes 1 and -1 exactly, and close to the guard at 1 and
 * -1 the slope of asin keeps all the digits that its argument has. */
static void precise_slopes(void **state) {
    (void)state;
    for (int x = 1; x <= 200; x++) {
        skein_dual6_vec v = skein_dual6_vec_seed((float)-x, 0, 0, 1);
        assert_true(skein_dual6_vec_length(v).d[1] == -1);
    }
    for (int k = 1; k <= 100; k++) {
        float x = 1 - (float)k * FLT_EPSILON / 2;
        double ought = 1 / sqrt(1 - (double)x * (double)x);
        assert_share(skein_dual3_asin(skein_dual3_seed(x, 1)).d[1], ought, 3e-7);
        assert_share(skein_dual3_acos(skein_dual3_seed(-x, 1)).d[1], -ought, 3e-7);
    }
}

/* Whatever awkward numbers go in, no function makes a NaN or an infinity of them, in either real. */
static void always_finite(void **state) {
    (void)state;
    const double odd[] = {0,
                          DBL_TRUE_MIN,
                          DBL_MIN,
                          FLT_TRUE_MIN,
                          FLT_MIN,
                          1e-20,
                          1e-10,
                          FLT_EPSILON,
                          0.5,
                          1 - DBL_EPSILON,
                          1 - FLT_EPSILON,
                          1,
                          1 + FLT_EPSILON,
                          PI / 2,
                          3,
                          88.8,
                          710,
                          1e10,
                          3e18,
                          3e38,
                          FLT_MAX,
                          DBL_MAX};
    for (size_t k = 0; k < 2 * COUNT(odd); k++) {
        double x = k % 2 ? -odd[k / 2] : odd[k / 2];
        float narrow = (float)fmax(-FLT_MAX, fmin(FLT_MAX, x));
        for (size_t u = 0; u < COUNT(unaries); u++) {
            skein_dual3d wide_one = unaries[u].f(skein_dual3d_seed(x, 1));
            skein_dual3 single = unaries[u].single(skein_dual3_seed(narrow, 1));
            for (int i = 0; i <= 3; i++)
                if (!isfinite(wide_one.d[i]) || !isfinite(single.d[i]))
                    check(wide_one.d[i], single.d[i], 0, unaries[u].name, "not finite: a number", x, i);
        }
        for (size_t j = 0; j < 2 * COUNT(odd); j++) {
            double y = j % 2 ? -odd[j / 2] : odd[j / 2];
            skein_dual3d a = skein_dual3d_seed(x, 1), b = skein_dual3d_seed(y, 2);
            skein_dual3d results[] = {skein_dual3d_pow(a, b), skein_dual3d_atan2(a, b), skein_dual3d_min(a, b)};
            float narrow_y = (float)fmax(-FLT_MAX, fmin(FLT_MAX, y));
            skein_dual3 c = skein_dual3_seed(narrow, 1), d = skein_dual3_seed(narrow_y, 2);
            skein_dual3 singles[] = {skein_dual3_pow(c, d), skein_dual3_atan2(c, d), skein_dual3_min(c, d)};
            for (size_t r = 0; r < COUNT(results); r++)
                for (int i = 0; i <= 3; i++)
                    if (!isfinite(results[r].d[i]) || !isfinite(singles[r].d[i]))
                        check(results[r].d[i], singles[r].d[i], 0, "pow, atan2 or min", "not finite: a number", x, y);
        }
    }
    assert_true(isnan(skein_dual3d_sqrt(AT((double)NAN)).d[0])); /* a fault upstream is not hidden */
    assert_true(isnan(skein_dual3d_div(AT(1), AT((double)NAN)).d[0]));
    assert_true(isnan(skein_dual3d_pow_real(AT((double)NAN), 2).d[0]));
}

/* ---- Vectors ---------------------------------------------------------------------------------------------------- */

/* Two vectors of six controls, and the six numbers by themselves. */
static void random_vectors(uint64_t *seed, double p[6], wide_vec *v, wide_vec *w) {
    for (int i = 0; i < 6; i++) p[i] = random_between(seed, -3, 3);
    *v = wide_vec_seed(p[0], p[1], p[2], 1);
    *w = wide_vec_seed(p[3], p[4], p[5], 4);
}

static const wide *part(const wide_vec *v, int k) {
    return k == 0 ? &v->x : k == 1 ? &v->y : &v->z;
}

static void vectors(void **state) {
    (void)state;
    uint64_t seed = 4;
    for (int trial = 0; trial < TRIALS; trial++) {
        double p[6];
        wide_vec v, w;
        random_vectors(&seed, p, &v, &w);
        double far = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]), apart = 0;
        for (int k = 0; k < 3; k++) apart += (p[k] - p[3 + k]) * (p[k] - p[3 + k]);
        apart = sqrt(apart);
        wide dot = wide_vec_dot(v, w), length = wide_vec_length(v), distance = wide_vec_distance(v, w);
        wide_vec sum = wide_vec_add(v, w), by = wide_vec_scale(v, w.y), cross = wide_vec_cross(v, w);
        wide_vec less = wide_vec_sub(v, w), half = wide_vec_scale_real(v, 0.5), unit = wide_vec_normalize(v);
        check(length.d[0], far, 1e-15, "length", "the value", p[0], p[1]);
        check(distance.d[0], apart, 1e-15, "distance", "the value", p[0], p[1]);
        check(dot.d[0], p[0] * p[3] + p[1] * p[4] + p[2] * p[5], 1e-14, "dot", "the value", p[0], p[1]);
        for (int k = 0; k < 3; k++) {
            int n = (k + 1) % 3, o = (k + 2) % 3;
            const wide *s = part(&sum, k), *l = part(&less, k), *b = part(&by, k), *h = part(&half, k);
            const wide *u = part(&unit, k), *c = part(&cross, k);
            check(s->d[0], p[k] + p[3 + k], 0, "vec_add", "the value", k, 0);
            check(l->d[0], p[k] - p[3 + k], 0, "vec_sub", "the value", k, 0);
            check(b->d[0], p[k] * p[4], 0, "vec_scale", "the value", k, 0);
            check(h->d[0], p[k] / 2, 0, "vec_scale_real", "the value", k, 0);
            check(u->d[0], p[k] / far, 1e-15, "vec_normalize", "the value", k, 0);
            check(c->d[0], p[n] * p[3 + o] - p[o] * p[3 + n], 1e-14, "vec_cross", "the value", k, 0);
            for (int i = 0; i < 12; i++) { /* row k of each Jacobian, by control i */
                double own = i == k, other = i == 3 + k;
                check(s->d[1 + i], own + other, 0, "vec_add", "a derivative", k, i);
                check(l->d[1 + i], own - other, 0, "vec_sub", "a derivative", k, i);
                check(b->d[1 + i], own * p[4] + (i == 4) * p[k], 1e-15, "vec_scale", "a derivative", k, i);
                check(h->d[1 + i], own / 2, 0, "vec_scale_real", "a derivative", k, i);
                double slope = i < 3 ? (own - p[k] * p[i] / (far * far)) / far : 0;
                check(u->d[1 + i], slope, 1e-12, "vec_normalize", "a derivative", k, i);
                double turned = (i == n) * p[3 + o] + (i == 3 + o) * p[n] - (i == o) * p[3 + n] - (i == 3 + n) * p[o];
                check(c->d[1 + i], turned, 1e-14, "vec_cross", "a derivative", k, i);
            }
            check(dot.d[1 + k], p[3 + k], 1e-14, "dot", "a derivative", k, 0);
            check(dot.d[4 + k], p[k], 1e-14, "dot", "a derivative", k, 1);
            check(length.d[1 + k], p[k] / far, 1e-14, "length", "a derivative", k, 0);
            check(distance.d[1 + k], (p[k] - p[3 + k]) / apart, 1e-13, "distance", "a derivative", k, 0);
            check(distance.d[4 + k], (p[3 + k] - p[k]) / apart, 1e-13, "distance", "a derivative", k, 1);
        }
    }
}

static void vectors_at_zero(void **state) {
    (void)state;
    wide_vec v = wide_vec_seed(1, 2, 3, 1), w = wide_vec_seed(1, 2, 3, 4),
             unit = wide_vec_normalize(wide_vec_sub(v, w));
    wide distance = wide_vec_distance(v, w);
    for (int i = 0; i <= 12; i++) {
        assert_true(distance.d[i] == 0);
        assert_true(unit.x.d[i] == 0 && unit.y.d[i] == 0 && unit.z.d[i] == 0);
    }
    wide_vec plain = wide_vec_of(1, 2, 3);
    for (int i = 1; i <= 12; i++) assert_true(plain.x.d[i] == 0 && plain.y.d[i] == 0 && plain.z.d[i] == 0);
}

/* The angle between two triangles at the edge p0 p1: twelve controls, and most of the functions at once. */
static wide dihedral(const double p[12]) {
    wide_vec at[4];
    for (int k = 0; k < 4; k++) at[k] = wide_vec_seed(p[3 * k], p[3 * k + 1], p[3 * k + 2], 1 + 3 * k);
    wide_vec edge = wide_vec_normalize(wide_vec_sub(at[1], at[0]));
    wide_vec left = wide_vec_cross(edge, wide_vec_sub(at[2], at[0]));
    wide_vec right = wide_vec_cross(wide_vec_sub(at[3], at[0]), edge);
    return wide_atan2(wide_vec_dot(wide_vec_cross(left, right), edge), wide_vec_dot(left, right));
}

static void long_formula(void **state) {
    (void)state;
    uint64_t seed = 5;
    const double h = 1e-6;
    for (int trial = 0; trial < TRIALS; trial++) {
        double p[12] = {0, 0, 0, 1, 0, 0, 0.5, 1, 0.4, 0.5, -1, 0.4};
        for (int i = 0; i < 12; i++) p[i] += random_between(&seed, -0.3, 0.3);
        wide angle = dihedral(p);
        double sum[3] = {0};
        for (int i = 0; i < 12; i++) {
            double kept = p[i];
            p[i] = kept + h;
            double above = dihedral(p).d[0];
            p[i] = kept - h;
            double below = dihedral(p).d[0];
            p[i] = kept;
            check(angle.d[1 + i], (above - below) / (2 * h), 1e-7, "dihedral", "a derivative", i, 0);
            sum[i % 3] += angle.d[1 + i];
        }
        for (int k = 0; k < 3; k++) assert_under(sum[k], 1e-12); /* moving everything changes no angle */
    }
}

/* ---- One spring ----------------------------------------------------------------------------------------------------
 */

/* One solve, in float, whatever the library's real is. */
static skein_dual6 spring_solve(float p[6], float rest_length) {
    skein_dual6_vec p1 = skein_dual6_vec_seed(p[0], p[1], p[2], 1), p2 = skein_dual6_vec_seed(p[3], p[4], p[5], 4);
    skein_dual6 c = skein_dual6_sub_real(skein_dual6_vec_distance(p1, p2), rest_length);
    float square = 0;
    for (int i = 1; i <= 6; i++) square += c.d[i] * c.d[i];
    for (int i = 1; i <= 6; i++) p[i - 1] -= c.d[0] / square * c.d[i];
    return c;
}

static void spring_exactly(void **state) {
    (void)state;
    const float cases[][3] = {{0.5f, 0.5f, 0.25f}, {10.5f, 5.5f, 2.75f}}, slopes[] = {-1, 0, 0, 1, 0, 0};
    for (size_t k = 0; k < COUNT(cases); k++) {
        float p[6] = {-cases[k][0], 0, 0, cases[k][0], 0, 0}, ought[6] = {-cases[k][2], 0, 0, cases[k][2], 0, 0};
        for (int turn = 0; turn < 2; turn++) { /* the second moves nothing */
            skein_dual6 c = spring_solve(p, cases[k][1]);
            assert_true(c.d[0] == (turn ? 0 : 2 * cases[k][0] - cases[k][1]));
            for (int i = 0; i < 6; i++) assert_true(c.d[1 + i] == slopes[i] && p[i] == ought[i]);
        }
    }
}

static void spring_from_anywhere(void **state) {
    (void)state;
    uint64_t seed = 6;
    for (int trial = 0; trial < TRIALS; trial++) {
        float p[6];
        for (int i = 0; i < 6; i++) p[i] = (float)random_between(&seed, -5, 5);
        float rest_length = (float)random_between(&seed, 2, 9);
        spring_solve(p, rest_length);
        assert_share(hypot(hypot(p[0] - p[3], p[1] - p[4]), p[2] - p[5]), rest_length, 1e-6);
    }
}

/* ---- The example ----------------------------------------------------------------------------------------------------
 */

static const char example_says[] = "from 1 to the rest length 0.5\n"
                                   "  C 0.5, derivatives -1 0 0 1 0 0\n"
                                   "    -> (-0.25, 0, 0) and (0.25, 0, 0)\n"
                                   "  C 0, derivatives -1 0 0 1 0 0\n"
                                   "    -> (-0.25, 0, 0) and (0.25, 0, 0)\n"
                                   "every frame, from 21 to the rest length 5.5\n"
                                   "frame 0\n"
                                   "  C 15.5, derivatives -1 0 0 1 0 0\n"
                                   "    -> (-2.75, 0, 0) and (2.75, 0, 0)\n"
                                   "frame 1\n"
                                   "  C 0, derivatives -1 0 0 1 0 0\n"
                                   "    -> (-2.75, 0, 0) and (2.75, 0, 0)\n";

static void read_all(FILE *file, char *text, size_t size) {
    assert_non_null(file);
    size_t length = fread(text, 1, size - 1, file);
    assert_true(length < size - 1);
    text[length] = 0;
}

/* Its first lines are known by hand; every solve ends at the rest length along a unit gradient; and the document shows
 * what it prints. */
static void example(void **state) {
    (void)state;
    FILE *process = popen(SKEIN_ONE_SPRING, "r");
    char says[4096], document[32768];
    read_all(process, says, sizeof says);
    assert_int_equal(pclose(process), 0);
    if (strncmp(says, example_says, strlen(example_says))) fprintf(stderr, "the example said:\n%s", says);
    assert_int_equal(strncmp(says, example_says, strlen(example_says)), 0);
    int solves = 0;
    for (const char *at = says; (at = strstr(at, "derivatives")) != NULL; at++, solves++) {
        double d[6], p[6];
        assert_int_equal(sscanf(at, "derivatives %lf %lf %lf %lf %lf %lf -> (%lf, %lf, %lf) and (%lf, %lf, %lf)", &d[0],
                                &d[1], &d[2], &d[3], &d[4], &d[5], &p[0], &p[1], &p[2], &p[3], &p[4], &p[5]),
                         12);
        double apart = hypot(hypot(p[0] - p[3], p[1] - p[4]), p[2] - p[5]);
        assert_share(apart, solves < 2 ? 0.5 : 5.5, 2e-6); /* six digits are printed */
        assert_under(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1, 1e-5);
        for (int i = 0; i < 3; i++) {
            assert_true(d[i] == -d[3 + i]);
            assert_near(d[i], (p[i] - p[3 + i]) / apart, 1e-5); /* a solve does not turn the spring */
        }
    }
    assert_int_equal(solves, 8);
    assert_non_null(strstr(says, "ends with C = 0\n"));
    FILE *file = fopen(SKEIN_SOURCE_DIR "/docs/dual.md", "r");
    read_all(file, document, sizeof document);
    fclose(file);
    assert_non_null(strstr(document, says));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_operand),
        cmocka_unit_test(two_operands),
        cmocka_unit_test(plain_operands),
        cmocka_unit_test(making),
        cmocka_unit_test(compound_forms),
        cmocka_unit_test(guarded_points),
        cmocka_unit_test(precise_slopes),
        cmocka_unit_test(always_finite),
        cmocka_unit_test(vectors),
        cmocka_unit_test(vectors_at_zero),
        cmocka_unit_test(long_formula),
        cmocka_unit_test(spring_exactly),
        cmocka_unit_test(spring_from_anywhere),
        cmocka_unit_test(example),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
