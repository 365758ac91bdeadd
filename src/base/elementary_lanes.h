/* The elementary functions in float, on one lane or on a vector of them (no include guard: see elementary.c, which
 * tells how they work, and wide_elementary.h). The bits are the same however many lanes there are. The includer defines
 *
 *     lane, lane_int, lane_bits, lane_double   float, int32_t, uint32_t and double, or vectors of them
 *     LANE(name)                               a function's name
 *     LANE(widen), LANE(narrow), LANE(number_of), LANE(last_bits)   between those types
 *     PICK(mask, yes, no), LANE_SQRT(x), LANE_INLINE
 *     LANE_REDUCE_FAR(x, wide, r, quarters)    reduces lanes with x of 2^25 and more, like reduce() in elementary.c */

#define SIGN_F 0x80000000u
#define ROUND_F 0x1.8p23f
#define ROUND_BITS_F 0x4b400000u
#define SQRT_HALF_F 0x3f3504f3u // its bits

LANE_INLINE lane_bits LANE(bits_of)(lane x) {
    lane_bits bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

LANE_INLINE lane LANE(of_bits)(lane_bits bits) {
    lane x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

LANE_INLINE lane LANE(size_of)(lane x) {
    return LANE(of_bits)(LANE(bits_of)(x) & ~SIGN_F);
}

LANE_INLINE lane LANE(with_sign)(lane x, lane_bits sign) {
    return LANE(of_bits)(LANE(bits_of)(x) ^ (sign & SIGN_F));
}

/* The upper 12 bits. */
LANE_INLINE lane LANE(head_of)(lane x) {
    return LANE(of_bits)(LANE(bits_of)(x) & ~0xfffu);
}

LANE_INLINE lane LANE(two_to)(lane_int k) {
    return LANE(of_bits)((lane_bits)(k + 127) << 23);
}

LANE_INLINE lane LANE(residue)(lane n, lane q, lane d) {
    lane qh = LANE(head_of)(q), qt = q - qh, dh = LANE(head_of)(d), dt = d - dh;
    return ((n - qh * dh) - (qh * dt + qt * dh)) - qt * dt;
}

typedef struct LANE(quarter) {
    lane r, lo;
    lane_bits k;
} LANE(quarter);

/* In double, two parts of pi/2 are enough up to 2^25: no float below is so near a multiple that their error would show.
 * In a wide version this costs about as much as the five parts that it would take in float. */
LANE_INLINE LANE(quarter) LANE(reduce)(lane x) {
    lane_double wide = LANE(widen)(x), t = wide * TWO_BY_PI + ROUND, k = t - ROUND;
    lane_double r = (wide - k * 0x1.921fb54p+0) - k * 0x1.10b4611a62633p-30;
    lane_bits quarters = LANE(last_bits)(t);
    LANE_REDUCE_FAR(x, wide, r, quarters);
    lane big = LANE(narrow)(r);
    return (LANE(quarter)){big, LANE(narrow)(r - LANE(widen)(big)), quarters};
}

typedef struct LANE(circle) {
    lane sine, sine_lo, cosine, cosine_lo;
} LANE(circle);

/* Relative errors 2^-32.5 and 2^-33.0. */
LANE_INLINE LANE(circle) LANE(circle_of)(lane r, lane lo) {
    lane z = r * r, z2 = z * z, h = LANE(head_of)(r), half = 0.5f * h * h, one = 1 - half;
    lane s = r * z * P4(z, z2, -0.166666672f, 0.0083333794f, -0.000198530615f, 2.83256645e-06f) + lo * (1 - 0.5f * z);
    lane rest = z2 * P3(z, z2, 0.0416666456f, -0.00138873095f, 2.44323237e-05f) - r * lo;
    lane c = ((1 - one) - half) + (rest - 0.5f * (r - h) * (r + h));
    lane sine = r + s, cosine = one + c;
    return (LANE(circle)){sine, (r - sine) + s, cosine, (one - cosine) + c};
}

LANE_INLINE void LANE(sincos)(lane x, lane *sine, lane *cosine) {
    LANE(quarter) q = LANE(reduce)(LANE(size_of)(x));
    LANE(circle) c = LANE(circle_of)(q.r, q.lo);
    lane_int odd = (q.k & 1) != 0;
    *sine = LANE(with_sign)(PICK(odd, c.cosine, c.sine), q.k << 30 ^ LANE(bits_of)(x));
    *cosine = LANE(with_sign)(PICK(odd, c.sine, c.cosine), (q.k + 1) << 30);
}

LANE_INLINE lane LANE(sin)(lane x) {
    LANE(quarter) q = LANE(reduce)(LANE(size_of)(x));
    LANE(circle) c = LANE(circle_of)(q.r, q.lo);
    return LANE(with_sign)(PICK((q.k & 1) != 0, c.cosine, c.sine), q.k << 30 ^ LANE(bits_of)(x));
}

LANE_INLINE lane LANE(cos)(lane x) {
    LANE(quarter) q = LANE(reduce)(LANE(size_of)(x));
    LANE(circle) c = LANE(circle_of)(q.r, q.lo);
    return LANE(with_sign)(PICK((q.k & 1) != 0, c.sine, c.cosine), (q.k + 1) << 30);
}

LANE_INLINE lane LANE(tan)(lane x) {
    LANE(quarter) q = LANE(reduce)(LANE(size_of)(x));
    LANE(circle) c = LANE(circle_of)(q.r, q.lo);
    lane_int odd = (q.k & 1) != 0;
    lane n = PICK(odd, c.cosine, c.sine), n_lo = PICK(odd, c.cosine_lo, c.sine_lo);
    lane d = PICK(odd, c.sine, c.cosine), d_lo = PICK(odd, c.sine_lo, c.cosine_lo);
    lane t = n / d;
    return LANE(with_sign)(t + ((LANE(residue)(n, t, d) + n_lo) - t * d_lo) / d, q.k << 31 ^ LANE(bits_of)(x));
}

#define LN2_HIGH_F 0x1.62e4p-1f // 15 bits
#define LN2_LOW_F 0x1.7f7d1cp-20f

/* Relative error 2^-28.2. */
LANE_INLINE lane LANE(exp)(lane x) {
    x = PICK(x > 89, 89, x);
    x = PICK(x < -104, -104, x);
    lane t = x * 0x1.715476p+0f + ROUND_F, k = t - ROUND_F;
    lane a = x - k * LN2_HIGH_F, b = k * LN2_LOW_F, r = a - b, lo = (a - r) - b;
    lane r2 = r * r, one = 1 + r;
    lane p = P4(r, r2, 0.49999994f, 0.166665167f, 0.0416681059f, 0.00836910121f) + 0.00138354569f * (r2 * r2);
    lane e = one + ((r - (one - 1)) + (r2 * p + (lo + lo * r)));
    lane_int power = (lane_int)(LANE(bits_of)(t) - ROUND_BITS_F), half = power >> 1;
    return e * LANE(two_to)(half) * LANE(two_to)(power - half);
}

/* Relative error 2^-30.2. */
LANE_INLINE lane LANE(log)(lane x) {
    lane_int tiny = x < 0x1p-126f;
    lane_bits bits = LANE(bits_of)(PICK(tiny, x * 0x1p24f, x));
    lane_int e = (lane_int)(bits - SQRT_HALF_F) >> 23;
    lane k = LANE(number_of)(e) - PICK(tiny, 24.0f, 0.0f);
    lane f = LANE(of_bits)(bits - ((lane_bits)e << 23)) - 1, s = f / (2 + f), z = s * s;
    lane p = P3(z, z * z, 0.666667759f, 0.399775803f, 0.298709422f);
    lane h = LANE(head_of)(f), half = 0.5f * h * h, half_rest = 0.5f * (f - h) * (f + h);
    lane big = k * LN2_HIGH_F, sum = big + f, less = sum - half;
    lane lost = ((big - sum) + f) + ((sum - less) - half) + (k * LN2_LOW_F - half_rest);
    lane y = less + (lost + s * ((half + half_rest) + z * p));
    y = PICK(x < INFINITY, y, x);
    y = PICK(x == 0, -INFINITY, y);
    return PICK(x < 0, NAN, y);
}

/* Relative error 2^-27.6. */
LANE_INLINE lane LANE(arc_sine)(lane x, lane *rest) {
    lane size = LANE(size_of)(x), z = PICK(size > 0.5f, 0.5f * (1 - size), size * size), z2 = z * z;
    lane s = PICK(size > 0.5f, LANE_SQRT(z), size);
    lane lost = PICK((size > 0.5f) & (size < 1), LANE(residue)(z, s, s) / (s + s), 0);
    lane p = P4(z, z2, 0.166667521f, 0.0749530941f, 0.045469135f, 0.0241849385f) + 0.0421579033f * (z2 * z2);
    *rest = s * z * p + lost;
    return s;
}

LANE_INLINE lane LANE(angle_sum)(lane quarters, lane t, lane rest) {
    lane big = quarters * 0x1.921fbp-1f, sum = big + t;
    return sum + (((big - sum) + t) + (rest + quarters * 0x1.5110b4p-23f));
}

LANE_INLINE lane LANE(asin)(lane x) {
    lane rest, s = LANE(arc_sine)(x, &rest);
    lane_int far = LANE(size_of)(x) > 0.5f;
    lane y = LANE(angle_sum)(PICK(far, 2.0f, 0.0f), PICK(far, -2 * s, s), PICK(far, -2 * rest, rest));
    return LANE(with_sign)(y, LANE(bits_of)(x));
}

LANE_INLINE lane LANE(acos)(lane x) {
    lane rest, s = LANE(arc_sine)(x, &rest), side = PICK(x < 0, 1.0f, -1.0f);
    lane_int far = LANE(size_of)(x) > 0.5f;
    lane times = PICK(far, -2 * side, side);
    return LANE(angle_sum)(PICK(far, PICK(x < 0, 4.0f, 0.0f), 2.0f), times * s, times * rest);
}

/* Relative error 2^-30.4. */
LANE_INLINE lane LANE(atan2)(lane y, lane x) {
    lane size_x = LANE(size_of)(x), size_y = LANE(size_of)(y);
    lane_int steep = size_y > size_x;
    lane n = PICK(steep, size_x, size_y), d = PICK(steep, size_y, size_x);
    d = PICK((d == 0) | (n == INFINITY), 1, d);
    n = PICK(n == INFINITY, 1, n);
    lane scale = PICK(d < 0x1p-60f, 0x1p80f, PICK(d > 0x1p120f, 0x1p-80f, 1));
    n *= scale, d *= scale;

    lane_int fold = n > 0.414213568f * d;
    lane minus = n - d, plus = n + d;
    lane top = PICK(fold, minus, n), top_lo = PICK(fold, n - (d + minus), 0);
    lane low = PICK(fold, plus, d), low_lo = PICK(fold, (d - plus) + n, 0);
    lane t = top / low, lost = ((LANE(residue)(top, t, low) + top_lo) - t * low_lo) / low;
    lost = PICK(n < 0x1p-30f * d, 0, lost);

    lane z = t * t, z2 = z * z;
    lane p = P4(z, z2, -0.333333164f, 0.199985266f, -0.142443448f, 0.105987281f) - 0.0608873181f * (z2 * z2);
    lane rest = t * z * p + lost * (1 - z);

    lane quarters = PICK(fold, 1.0f, 0.0f), side = PICK(steep, -1.0f, 1.0f);
    quarters = PICK(steep, 2 - quarters, quarters);
    lane_int left = (LANE(bits_of)(x) & SIGN_F) != 0;
    side = PICK(left, -side, side), quarters = PICK(left, 4 - quarters, quarters);
    lane angle = LANE(with_sign)(LANE(angle_sum)(quarters, side * t, side * rest), LANE(bits_of)(y));
    return PICK((x == x) & (y == y), angle, x + y);
}

#undef SIGN_F
#undef ROUND_F
#undef ROUND_BITS_F
#undef SQRT_HALF_F
#undef LN2_HIGH_F
#undef LN2_LOW_F
