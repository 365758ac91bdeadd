/* Reading numbers independent of the locale: with exact powers of ten where these are enough, else by strtod of the
 * digits without a point. */
#include "base/number.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_POWER = 99999, MOST_DIGITS = 780 /* further digits matter for rounding only if all others are a tie */ };

static bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/* Digits of [text, end) without the point, times ten to `power`: by strtod, which without a point knows no locale. */
static double nearest(const char *text, const char *end, int power) {
    char digits[MOST_DIGITS + 16];
    size_t count = 0;
    bool after_point = false, more = false;
    for (; text < end; text++) {
        if (*text == '.') {
            after_point = true;
        } else if (count < MOST_DIGITS) {
            if (count || *text != '0') digits[count++] = *text;
            power -= after_point;
        } else {
            more |= *text != '0';
            power += !after_point;
        }
    }
    if (!count) return 0;
    if (more) digits[count++] = '1', power--;
    snprintf(digits + count, sizeof digits - count, "e%d", power);
    return strtod(digits, NULL);
}

size_t sk_number_read(const char *text, double *number) {
    static const double tens[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                  1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *c = text;
    uint64_t mantissa = 0;
    int places = 0, digits = 0, power = 0;
    bool fraction = false;
    for (; is_digit(*c) || (*c == '.' && !fraction); c++) {
        if (*c == '.') {
            fraction = true;
            continue;
        }
        digits++;
        places += fraction;
        if (mantissa < 1000000000000000) mantissa = mantissa * 10 + (uint64_t)(*c - '0');
        else mantissa = UINT64_MAX; // certainly more than a double holds
    }
    if (!digits) return 0;
    const char *end = c;
    if (*c == 'e' || *c == 'E') {
        const char *e = c + 1;
        bool negative = *e == '-';
        e += *e == '-' || *e == '+';
        for (; is_digit(*e); e++, end = e) power = power < MOST_POWER ? power * 10 + (*e - '0') : power;
        if (power > MOST_POWER) power = MOST_POWER;
        if (negative) power = -power;
    }
    int exponent = power - places;
    if (mantissa < UINT64_C(1) << 53 && exponent >= -22 && exponent <= 22) // one operation on exact numbers
        *number = exponent < 0 ? (double)mantissa / tens[-exponent] : (double)mantissa * tens[exponent];
    else *number = nearest(text, c, power);
    return (size_t)(end - text);
}

size_t sk_number_read_signed(const char *text, double *number) {
    const char *c = text;
    while (isspace((unsigned char)*c)) c++;
    bool negative = *c == '-';
    c += *c == '-' || *c == '+';
    size_t size = sk_number_read(c, number);
    if (negative) *number = -*number;
    return size ? (size_t)(c - text) + size : 0;
}
