/* Numbers in texts, in C's notation whatever the program's locale is: the decimal separator is a point. Reading gives
 * the nearest double. */
#ifndef SK_BASE_NUMBER_H
#define SK_BASE_NUMBER_H

#include <stddef.h>

/* Reads digits with an optional point and exponent, without a sign, at the beginning of `text`. Returns how many
 * characters it took, 0 if there is no digit; too large a number becomes infinity. */
size_t sk_number_read(const char *text, double *number);
/* The same after optional blanks and a sign. */
size_t sk_number_read_signed(const char *text, double *number);

#endif
