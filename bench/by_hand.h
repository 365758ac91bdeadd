/* Values and gradients by hand, one element after the other: what tapes of formulas are measured against. Built as
 * plain.c is, -O3 -march=native. Positions are four floats each; `slot` are `particles` arrays; outputs are arrays, the
 * value's first, then those of x, y and z of each particle. */
#ifndef SKEIN_BENCH_BY_HAND_H
#define SKEIN_BENCH_BY_HAND_H

#include <skein/skein.h>

typedef struct by_hand_input {
    const skein_real *positions;
    const uint32_t *slot[4];
    const skein_real *parameter[10];
    skein_real *output[13];
    size_t count;
} by_hand_input;

void by_hand_distance(void *input);
void by_hand_dihedral(void *input);
void by_hand_volume(void *input);
void by_hand_neo_hookean(void *input);
void by_hand_stvk(void *input);

/* The same sixteen at a time (by_hand_wide.c); arrays must go on to the next multiple of sixteen elements. */
void by_hand_wide_distance(void *input);
void by_hand_wide_dihedral(void *input);
void by_hand_wide_volume(void *input);
void by_hand_wide_neo_hookean(void *input);
void by_hand_wide_stvk(void *input);

#endif
