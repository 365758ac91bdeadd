/* Numbers in texts, as C writes them, whatever the program's locale says: a decimal point is a point. Exact: the double
 * that is nearest. */
#ifndef SK_BASE_NUMBER_H
#define SK_BASE_NUMBER_H

#include <stddef.h>

/* Reads digits with a point and an exponent, as one likes, and no sign, at the beginning of `text`. Returns how many
 * characters it took, 0 where there is no digit; what is too large becomes infinity. */
size_t sk_number_read(const char *text, double *number);
/* The same behind blanks and a sign. */
size_t sk_number_read_signed(const char *text, double *number);

#endif
