/* Elementary functions, with the accuracy that elementary.h promises.
 *
 * Every function works in the same way, without branches: bring the argument into a short interval, evaluate a
 * polynomial there, undo the reduction. What rounding loses on the way is carried as a second, small number:
 *
 *     x = 2^k m, k pi/2 + r, ...      value = big + (what big lost + polynomial of the rest)
 *
 * so that nearly all of the error is that of the last addition. Special cases are selected at the end.
 *
 * The polynomials are minimax fits of our own: Remez exchange in 60 digits on the error relative to the function's
 * value, each coefficient rounded in turn, the lowest first, and the others fitted again. Each names its error.
 * Terms are summed in pairs (Estrin's scheme), which gives the processor more to do at a time than Horner's.
 *
 * The float functions stand in elementary_lanes.h, written for a type `lane`. If that and its related types are
 * vectors, with four small conversion functions and PICK as a blend of bits, they are wide functions with the same bits
 * (wide_elementary.h). Only angles beyond 2^25 are then reduced lane by lane. */
#include "base/elementary.h"

#include "base/polynomial.h"

#include <math.h> // INFINITY, NAN; none of its functions
#include <stdint.h>
#include <string.h>

#ifdef __FAST_MATH__
#error "the sums below are in the order that makes them exact: no -ffast-math"
#endif

/* Both sides are evaluated: a blend, not a branch. */
#define PICK(take_, yes_, no_) ((take_) ? (yes_) : (no_))

/* ---- double: bits and pairs ---- */

#define SIGN (UINT64_C(1) << 63)

static inline uint64_t bits_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline double of_bits(uint64_t bits) {
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline double size_of(double x) {
    return of_bits(bits_of(x) & ~SIGN);
}

static inline double with_sign(double x, uint64_t sign) {
    return of_bits(bits_of(x) ^ (sign & SIGN));
}

/* The upper 26 bits of x: products of two heads are exact. */
static inline double head_of(double x) {
    return of_bits(bits_of(x) & ~UINT64_C(0x7ffffff));
}

/* n - q d, the remainder that rounding left of q = n / d: exact but for its own last bits (Dekker 1971). */
static inline double residue(double n, double q, double d) {
    double qh = head_of(q), qt = q - qh, dh = head_of(d), dt = d - dh;
    return ((n - qh * dh) - (qh * dt + qt * dh)) - qt * dt;
}

/* A number of twice the precision: a head of 26 bits and a tail. */
typedef struct pair {
    double h, t;
} pair;

static inline pair pair_of(double big, double small) {
    double h = head_of(big);
    return (pair){h, (big - h) + small};
}

static inline pair pair_times(pair a, pair b) {
    return pair_of(a.h * b.h, a.h * b.t + a.t * (b.h + b.t));
}

/* The first must be the larger one, or zero. */
static inline pair pair_plus(pair a, pair b) {
    double sum = a.h + b.h;
    return pair_of(sum, ((a.h - sum) + b.h) + (a.t + b.t));
}

/* ---- double: sine, cosine, tangent ---- */

/* |x| = k pi/2 + r + lo with |r| <= pi/4 and a bit: k counts modulo 4. */
typedef struct quarter {
    double r, lo;
    uint64_t k;
} quarter;

/* For |x| of 2^30 and more (Payne and Hanek 1983). With x = m 2^e, those bits of 2/pi whose products with m 2^e are
 * multiples of 4 are left out, and so are those too small to matter: six words are left.
 *
 *     2/pi  = 0. 10100010 11111001 10000011 01101110 ...
 *                     [ from 2^(1 - e) on: 192 bits ] * m = k . fraction    (modulo 4) */
static quarter reduce_far(double x) {
    static const uint32_t two_by_pi[] = {
        0x00000000, 0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab,
        0xdebbc561, 0xb7246e3a, 0x424dd2e0, 0x06492eea, 0x09d1921c, 0xfe1deb1c, 0xb129a73e, 0xe88235f5,
        0x2ebb4484, 0xe99c7026, 0xb45f7e41, 0x3991d639, 0x835339f4, 0x9c845f8b, 0xbdf9283b, 0x1ff897ff,
        0xde05980f, 0xef2f118b, 0x5a0a6d1f, 0x6d367ecf, 0x27cb09b7, 0x4f463f66, 0x9e5fea2d, 0x7527bac7,
        0xebe5f17b, 0x3d0739f7, 0x8a5292ea, 0x6bfb5fb1, 0x1f8d5d08, 0x56033046};
    if (!(x < INFINITY)) return (quarter){NAN, 0, 0};
    uint64_t bits = bits_of(x), m = (bits & 0xfffffffffffff) | 0x10000000000000;
    unsigned from = (unsigned)(bits >> 52) - 1075 + 30, word = from / 32, shift = from % 32;

    // 192 bits of 2/pi, the highest word first, times the lower and the upper half of m
    uint64_t w[6], carry = 0;
    for (unsigned i = 0; i < 6; i++)
        w[i] = (((uint64_t)two_by_pi[word + i] << 32 | two_by_pi[word + i + 1]) << shift) >> 32;
    uint64_t product[6];
    for (int i = 5; i >= 0; i--) {
        carry += w[i] * (m & 0xffffffff);
        product[i] = carry & 0xffffffff, carry >>= 32;
    }
    carry = 0;
    for (int i = 4; i >= 0; i--) {
        carry += w[i + 1] * (m >> 32) + product[i];
        product[i] = carry & 0xffffffff, carry >>= 32;
    }

    // the nearest k; what is left is a fraction from -1/2 to 1/2, of which the size is taken
    uint64_t k = (product[0] + 0x20000000) >> 30, flip = product[0] & 0x20000000 ? 0xffffffff : 0;
    for (int i = 0; i < 5; i++) w[i] = ((product[i] << 2 | product[i + 1] >> 30) & 0xffffffff) ^ flip;
    double high = (double)w[0] * 0x1p-32, low = (double)w[1] * 0x1p-64, sum = high + low;
    double rest = (double)(w[2] << 32 | w[3]) * 0x1p-128 + (double)w[4] * 0x1p-160;

    pair r = pair_times(pair_of(sum, ((high - sum) + low) + rest), (pair){0x1.921fb5p+0, 0x1.110b4611a6263p-26});
    sum = r.h + r.t;
    uint64_t sign = flip ? SIGN : 0;
    return (quarter){with_sign(sum, sign), with_sign((r.h - sum) + r.t, sign), k & 3};
}

/* Up to 2^30 the parts of pi/2 are so short (23 bits) that their products with k are exact (Cody and Waite 1980).
 * The first two leave `a` without an error; the others, which count where x is next to a multiple of pi/2, are
 * carried in `lo`. x >= 0, or NaN. */
static inline quarter reduce(double x) {
    if (x >= 0x1p30) return reduce_far(x);
    double t = x * TWO_BY_PI + ROUND, k = t - ROUND;
    double a = (x - k * 0x1.921fb4p+0) - k * 0x1.4442dp-24, b = k * 0x1.846988p-48;
    double sum = a - b, lo = ((a - sum) - b) - k * 0x1.8cc514p-72;
    double r = sum + lo;
    return (quarter){r, ((sum - r) + lo) - k * 0x1.80dc1cd129025p-95, bits_of(t) & 3};
}

/* The terms to add to r for its sine, and to 1 - z/2 for its cosine. Relative errors 2^-63.2 and 2^-63.9. */
static inline double sine_rest(double r, double z, double lo) {
    double z2 = z * z;
    double p = P4(z, z2, -0.16666666666666666, 0.0083333333333330418, -0.00019841269840962481, 2.7557319073980669e-06) +
               P3(z, z2, -2.5052070917859577e-08, 1.6054310208073442e-10, -7.3893568601103876e-13) * (z2 * z2);
    return r * z * p + lo * (1 - 0.5 * z);
}

static inline double cosine_rest(double r, double z, double lo) {
    double z2 = z * z;
    double p =
        P4(z, z2, 0.041666666666666595, -0.0013888888888873325, 2.4801587288983546e-05, -2.7557314209982976e-07) +
        P2(z, 2.0875704250654409e-09, -1.1358681878246231e-11) * (z2 * z2);
    return z2 * p - r * lo;
}

/* Sine and cosine of a reduced angle, each with the rounding error of its last addition. */
typedef struct circle {
    double sine, sine_lo, cosine, cosine_lo;
} circle;

static inline circle circle_of(double r, double lo) {
    double z = r * r, h = head_of(r), half = 0.5 * h * h, one = 1 - half; // half is exact
    double s = sine_rest(r, z, lo);
    double c = ((1 - one) - half) + (cosine_rest(r, z, lo) - 0.5 * (r - h) * (r + h));
    double sine = r + s, cosine = one + c;
    return (circle){sine, (r - sine) + s, cosine, (one - cosine) + c};
}

void sk_sincos(double x, double *sine, double *cosine) {
    quarter q = reduce(size_of(x));
    circle c = circle_of(q.r, q.lo);
    int odd = (q.k & 1) != 0;
    *sine = with_sign(PICK(odd, c.cosine, c.sine), q.k << 62 ^ bits_of(x));
    *cosine = with_sign(PICK(odd, c.sine, c.cosine), (q.k + 1) << 62);
}

double sk_sin(double x) {
    quarter q = reduce(size_of(x));
    circle c = circle_of(q.r, q.lo);
    return with_sign(PICK((q.k & 1) != 0, c.cosine, c.sine), q.k << 62 ^ bits_of(x));
}

double sk_cos(double x) {
    quarter q = reduce(size_of(x));
    circle c = circle_of(q.r, q.lo);
    return with_sign(PICK((q.k & 1) != 0, c.sine, c.cosine), (q.k + 1) << 62);
}

double sk_tan(double x) {
    quarter q = reduce(size_of(x));
    circle c = circle_of(q.r, q.lo);
    int odd = (q.k & 1) != 0;
    double n = PICK(odd, c.cosine, c.sine), n_lo = PICK(odd, c.cosine_lo, c.sine_lo);
    double d = PICK(odd, c.sine, c.cosine), d_lo = PICK(odd, c.sine_lo, c.cosine_lo);
    double t = n / d;
    return with_sign(t + ((residue(n, t, d) + n_lo) - t * d_lo) / d, q.k << 63 ^ bits_of(x));
}

/* ---- double: exponential, logarithm, power ---- */

#define LOG2_E 0x1.71547652b82fep+0
#define LN2_HIGH 0x1.62e42fefa38p-1 // 42 bits: its products with exponents are exact
#define LN2_LOW 0x1.ef35793c76730p-45
#define SQRT_HALF UINT64_C(0x3fe6a09e667f3bcd) // its bits

/* e^(r + lo) 2^k for |r| up to ln 2 / 2. Relative error 2^-62.9, with 1/2, 1/6 and 1/24 kept and the rest rounded at
 * once. The power is multiplied on in two halves, since 2^k itself may overflow where the value does not. */
static inline double scaled_exp(double r, double lo, int64_t k) {
    double r2 = r * r, r4 = r2 * r2;
    double p =
        P4(r, r2, 0.5, 0.16666666666666666, 0.041666666666666664, 0.0083333333333285679) +
        P4(r, r2, 0.0013888888888937958, 0.00019841269871353305, 2.4801587145647076e-05, 2.7557257112952642e-06) * r4 +
        P3(r, r2, 2.7557468851681899e-07, 2.5105049701247759e-08, 2.0845753915713952e-09) * (r4 * r4);
    double one = 1 + r;
    double e = one + ((r - (one - 1)) + (r2 * p + (lo + lo * r)));
    int64_t half = k >> 1;
    return e * of_bits((uint64_t)(half + 1023) << 52) * of_bits((uint64_t)(k - half + 1023) << 52);
}

double sk_exp(double x) {
    // beyond these the result is infinite or 0 anyway
    x = PICK(x > 710, 710, x);
    x = PICK(x < -746, -746, x);
    double t = x * LOG2_E + ROUND, k = t - ROUND;
    double a = x - k * LN2_HIGH, b = k * LN2_LOW, r = a - b;
    return scaled_exp(r, (a - r) - b, (int64_t)(bits_of(t) - ROUND_BITS));
}

/* x = 2^k m with m from sqrt(1/2) to sqrt(2), for x > 0. Anything else gives some number. */
static inline double split(double x, double *k) {
    int tiny = x < 0x1p-1022;
    uint64_t bits = bits_of(PICK(tiny, x * 0x1p54, x));
    int64_t e = (int64_t)(bits - SQRT_HALF) >> 52;
    *k = (double)e - PICK(tiny, 54, 0);
    return of_bits(bits - ((uint64_t)e << 52));
}

/* With s = f / (2 + f), ln(1 + f) = 2 artanh s = f - s f + s R(s^2), and s f = f^2/2 - s f^2/2. The large terms are
 * summed together with their rounding errors: k ln 2 + f - h^2/2, where h is the head of f. Relative error 2^-59.5. */
double sk_log(double x) {
    double k, m = split(x, &k), f = m - 1, s = f / (2 + f), z = s * s, z2 = z * z;
    double p = P4(z, z2, 0.6666666666666734, 0.3999999999941648, 0.28571428742088462, 0.22222198596784937) +
               P3(z, z2, 0.18183563374838943, 0.15314069331724339, 0.14795807444700435) * (z2 * z2);
    double h = head_of(f), half = 0.5 * h * h, half_rest = 0.5 * (f - h) * (f + h);
    double big = k * LN2_HIGH, sum = big + f, less = sum - half;
    double lost = ((big - sum) + f) + ((sum - less) - half) + (k * LN2_LOW - half_rest);
    double y = less + (lost + s * ((half + half_rest) + z * p));
    y = PICK(x < INFINITY, y, x); // infinity and NaN stay what they are
    y = PICK(x == 0, -INFINITY, y);
    return PICK(x < 0, NAN, y);
}

/* ln x to 64 bits, for pow: 2 artanh s = s (2 + z (2/3 + z (2/5 + z p))) with z = s^2, each term in a pair where its
 * last bits count. Relative error of the fit 2^-72.8. */
static inline pair pair_log(double x) {
    double k, m = split(x, &k), f = m - 1, d = 2 + f, d_lo = (2 - d) + f, s = f / d;
    pair root = pair_of(s, (residue(f, s, d) - s * d_lo) * (1 / d)), square = pair_times(root, root);
    double z = s * s, z2 = z * z;
    double p = P4(z, z2, 0.28571428571433161, 0.22222222220012589, 0.18181818605417793, 0.15384572900273655) +
               P3(z, z2, 0.13335763091042011, 0.11685041636483309, 0.11910981959541546) * (z2 * z2);
    double term = (square.h + square.t) * (0.4 + z * p);
    pair sum = pair_plus((pair){0x1.555555p-1, 0x1.5555555555555p-27}, (pair){term, 0});
    pair log_m = pair_times(root, pair_plus((pair){2, 0}, pair_times(square, sum)));
    return pair_plus((pair){k * LN2_HIGH, k * LN2_LOW}, log_m);
}

static inline int whole(double x) {
    x = size_of(x);
    return (x >= 0x1p52) | ((x + 0x1p52) - 0x1p52 == x);
}

/* From |x|^y for ordinary x and y to x^y for all (C17, F.9.4.4). */
static inline double pow_cases(double power, double x, double y) {
    double size = size_of(x);
    int odd = whole(y) & !whole(0.5 * y);
    power = PICK(size == 1, 1, power);
    power = PICK((size == 0) | (size == INFINITY), PICK((size == 0) == (y < 0), INFINITY, 0), power);
    power = with_sign(power, PICK(odd, bits_of(x), 0));
    power = PICK((x < 0) & (size < INFINITY) & !whole(y), NAN, power);
    power = PICK((x == x) & (y == y), power, x + y);
    return PICK((x == 1) | (y == 0), 1, power);
}

double sk_pow(double x, double y) {
    // a larger y changes nothing: |ln x| is 0 or at least 2^-53
    double z = PICK(y > 0x1p66, 0x1p66, y);
    z = PICK(z < -0x1p66, -0x1p66, z);
    pair w = pair_times(pair_of(z, 0), pair_log(size_of(x)));
    int over = w.h > 710, under = w.h < -746;
    w.h = PICK(over, 710, PICK(under, -746, w.h));
    w.t = PICK(over | under, 0, w.t);
    double t = w.h * LOG2_E + ROUND, k = t - ROUND;
    double a = w.h - k * LN2_HIGH, b = w.t - k * LN2_LOW, r = a + b;
    return pow_cases(scaled_exp(r, (a - r) + b, (int64_t)(bits_of(t) - ROUND_BITS)), x, y);
}

/* In double there are bits enough for a plain product. */
float sk_powf(float x, float y) {
    return (float)pow_cases(sk_exp((double)y * sk_log(size_of((double)x))), (double)x, (double)y);
}

/* ---- double: arc sine, arc cosine, arc tangent ---- */

/* The arc sine of |x| up to 1/2 is s + rest with s = |x|; beyond, pi/2 - 2 (s + rest) with s = sqrt((1 - |x|) / 2).
 * Relative error 2^-58.1. */
static inline double arc_sine(double x, double *rest) {
    double size = size_of(x), z = PICK(size > 0.5, 0.5 * (1 - size), size * size), z2 = z * z, z4 = z2 * z2;
    double s = PICK(size > 0.5, __builtin_sqrt(z), size);
    double lost = PICK((size > 0.5) & (size < 1), residue(z, s, s) / (s + s), 0);
    double p = P4(z, z2, 0.1666666666666676, 0.074999999999708633, 0.044642857174565218, 0.030381942709616271) +
               P4(z, z2, 0.022372214943671486, 0.017351612704749879, 0.013980813160986618, 0.011398966826882977) * z4 +
               (P4(z, z2, 0.010779973629793212, 0.003707377698824984, 0.021705267461540275, -0.020996198767565782) +
                0.032626961328338616 * z4) *
                   (z4 * z4);
    *rest = s * z * p + lost;
    return s;
}

/* quarters pi/4 + t + rest: for 0 to 4 quarters the first product is exact. */
static inline double angle_sum(double quarters, double t, double rest) {
    double big = quarters * 0x1.921fb54442d18p-1, sum = big + t;
    return sum + (((big - sum) + t) + (rest + quarters * 0x1.1a62633145c07p-55));
}

double sk_asin(double x) {
    double rest, s = arc_sine(x, &rest);
    int far = size_of(x) > 0.5;
    double y = angle_sum(PICK(far, 2, 0), PICK(far, -2 * s, s), PICK(far, -2 * rest, rest));
    return with_sign(y, bits_of(x));
}

/* |x| <= 1/2: pi/2 - asin x; beyond: 2 (s + rest), or pi less that. */
double sk_acos(double x) {
    double rest, s = arc_sine(x, &rest), side = PICK(x < 0, 1, -1);
    int far = size_of(x) > 0.5;
    double times = PICK(far, -2 * side, side);
    return angle_sum(PICK(far, PICK(x < 0, 4, 0), 2), times * s, times * rest);
}

/* In the eighth of the plane where 0 <= n <= d: t = n/d, or (n - d)/(n + d) and one quarter more, so that |t| is at
 * most tan(pi/8). Relative error 2^-59.4. */
double sk_atan2(double y, double x) {
    double size_x = size_of(x), size_y = size_of(y);
    int steep = size_y > size_x;
    double n = PICK(steep, size_x, size_y), d = PICK(steep, size_y, size_x);
    d = PICK((d == 0) | (n == INFINITY), 1, d);
    n = PICK(n == INFINITY, 1, n);
    double scale = PICK(d < 0x1p-500, 0x1p600, PICK(d > 0x1p1000, 0x1p-600, 1));
    n *= scale, d *= scale;

    int fold = n > 0.41421356237309503 * d;
    double minus = n - d, plus = n + d;
    double top = PICK(fold, minus, n), top_lo = PICK(fold, n - (d + minus), 0);
    double low = PICK(fold, plus, d), low_lo = PICK(fold, (d - plus) + n, 0);
    double t = top / low, lost = ((residue(top, t, low) + top_lo) - t * low_lo) / low;
    lost = PICK(n < 0x1p-30 * d, 0, lost); // it may have underflowed, and is negligible there

    double z = t * t, z2 = z * z, z4 = z2 * z2;
    double p =
        P4(z, z2, -0.33333333333333193, 0.19999999999952187, -0.14285714280054621, 0.11111110776336998) +
        P4(z, z2, -0.090908975523151303, 0.076920565510631755, -0.066630622786161081, 0.058475843595519932) * z4 +
        P3(z, z2, -0.050379256857804471, 0.038029390532628306, -0.017868543360390846) * (z4 * z4);
    double rest = t * z * p + lost * (1 - z);

    // back to the eighth that the point lies in: mirrored at the diagonal, then at the y axis
    double quarters = PICK(fold, 1, 0), side = PICK(steep, -1, 1);
    quarters = PICK(steep, 2 - quarters, quarters);
    int left = (bits_of(x) & SIGN) != 0;
    side = PICK(left, -side, side), quarters = PICK(left, 4 - quarters, quarters);
    double angle = with_sign(angle_sum(quarters, side * t, side * rest), bits_of(y));
    return PICK((x == x) & (y == y), angle, x + y);
}

/* ---- float: the same functions on 32 bits, written so that they are wide functions, too ---- */

#define lane float
#define lane_int int32_t
#define lane_bits uint32_t
#define lane_double double
#define LANE(name_) name_##_lane
#define LANE_INLINE static inline
#define LANE_SQRT __builtin_sqrtf
#define LANE_REDUCE_FAR(x_, wide_, r_, quarters_) \
    if ((x_) >= 0x1p25f) sk_reduce_far((wide_), &(r_), &(quarters_))

static inline double widen_lane(float x) {
    return (double)x;
}
static inline float narrow_lane(double x) {
    return (float)x;
}
static inline uint32_t last_bits_lane(double x) {
    return (uint32_t)bits_of(x);
}
static inline float number_of_lane(int32_t i) {
    return (float)i;
}

void sk_reduce_far(double x, double *r, uint32_t *quarters) {
    quarter far = reduce(x);
    *r = far.r, *quarters = (uint32_t)far.k;
}

#include "base/elementary_lanes.h"

void sk_sincosf(float x, float *sine, float *cosine) {
    sincos_lane(x, sine, cosine);
}
float sk_sinf(float x) {
    return sin_lane(x);
}
float sk_cosf(float x) {
    return cos_lane(x);
}
float sk_tanf(float x) {
    return tan_lane(x);
}
float sk_expf(float x) {
    return exp_lane(x);
}
float sk_logf(float x) {
    return log_lane(x);
}
float sk_asinf(float x) {
    return asin_lane(x);
}
float sk_acosf(float x) {
    return acos_lane(x);
}
float sk_atan2f(float y, float x) {
    return atan2_lane(y, x);
}
